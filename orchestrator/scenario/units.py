"""Numbers with units, such as "8 mm", "1000 rpm", "20 degree"."""

import contextlib
import difflib
import functools
import math
import os
import re
import unicodedata
from typing import Any

from models.compile.cache_folder import open_folder

from ..errors import MistakeError
from ..participants.description import Unit


class UnitError(MistakeError):
    """A string that is no number with a unit of the wanted dimension."""


# Suggestions for unknown units.
COMMON = (
    *("mm", "um", "cm", "m", "metre", "millimetre", "micrometre", "inch"),
    *("ms", "us", "s", "second", "millisecond", "microsecond", "minute"),
    *("g", "kg", "gram", "kilogram", "N", "kN", "mN", "newton", "N.m", "N.mm", "kN.m"),
    *("Pa", "kPa", "MPa", "GPa", "bar", "pascal", "Pa.s", "mPa.s", "1/GPa", "1/Pa"),
    *("deg", "rad", "mrad", "degree", "radian", "rpm", "rad/s", "deg/s", "r/min"),
    *("mm/s", "m/s", "km/h", "N/mm", "N/m", "kg.m2", "J", "kJ", "mJ", "W", "kW", "Hz", "kHz"),
    *("degC", "K", "mm2/s", "cSt", "m2/s", "kg/m3", "g/cm3"),
)

# What is measured in some units.
DIMENSIONS = {
    "m": "length", "s": "time", "kg": "mass", "N": "force", "N.m": "torque", "J": "work", "W": "power",
    "Pa": "pressure", "Pa.s": "viscosity", "K": "temperature", "rad": "plane angle", "rad/s": "speed",
    "m/s": "velocity", "N/m": "stiffness", "kg.m2": "moment of inertia", "Hz": "frequency",
}  # fmt: skip

# In which quantities are shown that name no unit. Lengths name theirs: lifts are in mm, films in um.
USUAL = {"Pa": "MPa", "rad": "deg", "rad/s": "rpm", "m2": "mm2"}
# Of examples.
EXAMPLES = USUAL | {"m": "mm", "N/m": "N/mm"}

# Pint's names of FMI's base units, in the order of FMI's attributes.
BASE = ("kilogram", "meter", "second", "ampere", "kelvin", "mole", "candela", "radian")

# Factors of common units; pint, which knows all units, takes 0.2 s to start.
FACTORS = {
    ("s", "s"): 1.0, ("ms", "s"): 1e-3, ("us", "s"): 1e-6,
    ("m", "m"): 1.0, ("mm", "m"): 1e-3, ("um", "m"): 1e-6,
    ("deg", "rad"): math.pi / 180.0, ("rpm", "rad/s"): math.pi / 30.0, ("N/mm", "N/m"): 1e3,
    ("MPa", "Pa"): 1e6, ("%", "1"): 0.01, ("degC", "K"): 1.0,
}  # fmt: skip
# Their zeros, as those of `find_conversion`.
ZEROS = {("degC", "K"): 273.15}

_NUMBER_AND_UNIT = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*)")
_MASS = re.compile(r"\b(lb|kg|oz)s?\b")
# Units of temperature as FMUs write them; pint knows some, and takes the C of others for the coulomb.
_DEGREES = re.compile(
    r"(?<![^\W\d])(?:(?:(?:deg(?:ree)?s?|°)[ _]*)?(celsius|fahrenheit|kelvin)"
    r"|(?:deg(?:ree)?s?[ _]|°) *([CF]))\b",
    re.IGNORECASE,
)
# Of speeds; those of German, French and Italian, where U is no enzyme's and tr no pint's.
_REVOLUTIONS = re.compile(r"\b(?:(?:r|revs?|u|tr|tours?|giri) */ *min|upm|rpm)\b", re.IGNORECASE)
_PER_MINUTE = ("1/min", "min^-1", "min-1", "min⁻¹")
_COMMA = re.compile(r"([+-]?[\d.]*),(\d+)(.*)")
_SHORT = {"C": "degC", "F": "degF", "K": "K"}
LONGEST = 200  # characters of a number with its unit
# Pint computes powers of numbers, which may take for ever: none above two digits, none of a power.
_UNIT = re.compile(r"[\w\s*/^.()%°'\"+-]{0,60}")
_POWER = re.compile(r"\*\*|\^")
_EXPONENT = re.compile(r"[\s(]*[+-]?\s*\d{1,2}(?:\.\d+)?[)\s]*(?![\w.])")


# Offsets of one unit are given with five digits or more, as 255.37 K of degF.
OFFSETS_AGREE = 1e-3

# Units of times in reports, each with its factor from seconds.
TIMES = (("s", 1.0), ("ms", 1e3), ("us", 1e6))


def choose_time_unit(span: float) -> tuple[str, float]:
    """The longest unit of time that is not longer than `span` (s), and its factor."""
    return next((shown for shown in TIMES if span * shown[1] >= 1.0), TIMES[-1])


def format_time(seconds: float) -> str:
    """A duration with a unit, e.g. 5 us; "-" for none."""
    if not (math.isfinite(seconds) and seconds > 0.0):
        return "-"
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= 0.9999 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def to_unit(text: str, unit: str, relative: bool = False, shown: str = "") -> float:
    """Convert a string to a number in `unit` (SI symbols as in `Quantity`); UnitError if it does not fit.

    A number without a unit is already in `unit`. A `relative` number is a difference: 5 degC are 5 K.
    `shown` is the unit of the error's example. Angles are a dimension, so that r/min is not Hz.
    """
    text = text.strip()
    if len(text) > LONGEST:
        raise UnitError(f"{text[:30]!r}... is no number with a unit: it has {len(text)} characters")
    if said := explain_comma(text):
        raise UnitError(f"{text!r}: {said}")
    match = _NUMBER_AND_UNIT.fullmatch(text)
    if match is None:
        if unit == "1":
            raise UnitError(f"{text!r} is not a number")
        example = shown or EXAMPLES.get(unit, unit)
        raise UnitError(f"{text!r} is not a number with a unit; write for example '8 {example}'")
    number, given = float(match[1]), match[2]
    if not given or given == unit:
        return number
    if not unit:
        raise UnitError(f"{text!r}: the FMU states no unit; write a plain number")
    pair = (given, unit)
    known = pair in FACTORS
    factor, zero = (FACTORS[pair], ZEROS.get(pair, 0.0)) if known else find_conversion(text, given, unit)
    if zero and not relative:
        return zero + number * factor
    parts = round(1.0 / factor) if factor < 1.0 else 0
    # 5 us is 5e-6 s and not 4.9999999999999996e-06: divide where the factor is one over a whole number.
    if parts and abs(factor * parts - 1.0) < 1e-14:
        return number / parts
    return number * factor


def explain_comma(text: str) -> str:
    """What to write for a number with a comma; "" without one."""
    if not (found := _COMMA.fullmatch(text.strip()[:LONGEST])):
        return ""
    whole, part, rest = found.groups()
    if rest.startswith((".", ",")):
        return f"write '{whole}{part}{rest.replace(',', '')}', without commas"
    point = f"a decimal comma; write '{whole.replace('.', '')}.{part}{rest}', with a point"
    return f"{point}, or '{whole}{part}{rest}'" if len(part) == 3 else point


def find_conversion(text: str, given: str, unit: str) -> tuple[float, float]:
    """The factor from the unit `given` to `unit`, and where its zero is in `unit` (273.15 for degC in K).

    UnitError if they do not fit.
    """
    try:
        wanted = _load_registry().Unit("" if unit == "1" else _to_pint(unit))
    except Exception:
        raise UnitError(f"{text!r}: the FMU's unit {unit!r} is unknown; write a plain number in it") from None
    if given in _PER_MINUTE and unit != "1" and _fits("rpm", unit):
        raise UnitError(
            f"{text!r}: the unit {given} does not fit a speed; write '{text.removesuffix(given).strip()} rpm'"
        )
    try:
        units = _load_registry().Unit(_to_pint(given))
    except Exception:
        raise UnitError(f"{text!r}: {given!r} is an unknown unit; {_suggest_unit(given, unit)}") from None
    if _find_dimension(units) != _find_dimension(wanted):
        what = f"a {DIMENSIONS[unit]}" if unit in DIMENSIONS else unit
        needed = "; a plain number is needed" if unit == "1" else f" {what}; {_list_units(unit)}"
        raise UnitError(f"{text!r}: the unit {given} does not fit{needed}{_hint(given, unit)}")
    try:
        return _find_line(units, wanted)
    except ValueError:
        raise UnitError(f"{text!r}: the unit {given} is no multiple of {unit}; convert the number") from None


def _hint(given: str, unit: str) -> str:
    """What a unit of another dimension may mean."""
    if (given, unit) == ("C", "K"):
        return " (C is the coulomb; degrees Celsius are degC)"
    if given in ("1/s", "Hz") and _fits("rpm", unit):
        return " (for revolutions write rpm or r/s)"
    mass, force = _MASS.search(given), _MASS.sub(r"\1f", given)
    if mass is None or unit == "1" or not _fits(force, unit):
        return ""
    return f" ({mass[1]} is a mass; did you mean {force}?)"


def _fits(one: str, other: str) -> bool:
    registry = _load_registry()
    return _find_dimension(registry.Unit(_to_pint(one))) == _find_dimension(registry.Unit(_to_pint(other)))


def _find_line(units: Any, wanted: Any) -> tuple[float, float]:
    """Factor and offset from one unit to another; ValueError for logarithmic units."""
    zero, one, two = (
        float(_load_registry().Quantity(n, units).to(wanted).magnitude) for n in (0.0, 1.0, 2.0)
    )
    if not math.isclose(two - one, one - zero, rel_tol=1e-9):
        raise ValueError(f"{units} is no linear function of {wanted}")
    return (one - zero if zero else one), zero


def is_bare(text: str) -> bool:
    """Whether the string is a number without a unit."""
    match = _NUMBER_AND_UNIT.fullmatch(text.strip()[:LONGEST])
    return match is not None and not match[2]


def to_base_units(unit: str) -> Unit | None:
    """The unit in SI base units, with the offset of one such as degC; None if it is unknown, or no linear
    function of them."""
    try:
        made = _load_registry().Unit("" if unit == "1" else _to_pint(unit))
        factor, base = _load_registry().get_base_units(made)
        _, offset = _find_line(made, base)
        powers = {name: float(power) for name, power in base._units.items()}
    except Exception:
        return None
    exponents = tuple(int(powers.pop(name, 0.0)) for name in BASE)
    return None if powers else Unit(exponents, float(factor), offset)


def _suggest_unit(given: str, unit: str) -> str:
    """Suggest a unit in place of an unknown one."""
    if unit == "1":
        return "a plain number is needed"
    known = {name.lower(): name for name in (*_find_fitting(unit), unit)}
    close = difflib.get_close_matches(given.lower(), known, n=1)
    return f"did you mean {known[close[0]]}?" if close else _list_units(unit)


def _find_fitting(unit: str) -> list[str]:
    """Common units of its dimension."""
    return [name for name in COMMON if _fits(name, unit)]


def _list_units(unit: str) -> str:
    return f"write {' or '.join(dict.fromkeys((unit, *_find_fitting(unit)[:3])))}"


@functools.cache
def _load_registry() -> Any:
    import pint  # slow to import, and most numbers have no unit

    # Reading pint's file of units takes 0.3 s, its cache 0.02 s.
    # The cache may be of no use, or another process may be writing it.
    with contextlib.suppress(Exception), open_folder(f"pint-{pint.__version__}") as folder:
        folder.check_files()
        mask = os.umask(0o077)  # files that others may write would not be read again
        try:
            return pint.UnitRegistry(cache_folder=folder.path)
        finally:
            os.umask(mask)
    return pint.UnitRegistry()


def _to_pint(unit: str) -> str:
    """Convert FMI's notation (N.s/m, kg.m2), revolutions and degrees to pint's."""
    if len(unit) <= LONGEST:
        unit = unicodedata.normalize("NFKC", unit)  # ℃ becomes °C, m² m2
    if not _is_plain(unit):
        raise UnitError(f"{unit[:30]!r} is no unit")
    unit = _DEGREES.sub(lambda found: _SHORT[(found[1] or found[2])[0].upper()], unit)
    unit = "revolution" if unit == "rev" else unit
    unit = _REVOLUTIONS.sub("rpm", unit).replace("°", "degree").replace(".", "*").replace("·", "*")
    unit = re.sub(r"\b([kmM]?N)(mm?)\b", r"\1*\2", unit)  # pint's Nm is a number of yarn
    above, slash, below = unit.partition("/")
    if slash and "*" in below:
        unit = f"{above}/({below})"
    return re.sub(r"(?<=[A-Za-z])(\d)", r"**\1", unit)


def _is_plain(unit: str) -> bool:
    """Whether pint reads it at once."""
    first, *exponents = _POWER.split(unit)
    bases = [first, *exponents[:-1]]
    return (
        _UNIT.fullmatch(unit) is not None
        and all(map(_EXPONENT.match, exponents))
        and not any(map(_EXPONENT.fullmatch, exponents[:-1]))
        and (not exponents or sum(base.rstrip().endswith(")") for base in bases) <= 1)
    )


def _find_dimension(units: Any) -> dict[str, float]:
    """Exponents of the base units, the radian among them."""
    roots = _load_registry().get_root_units(units)[1]
    return {name: float(power) for name, power in roots._units.items() if power}
