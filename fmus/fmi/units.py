"""Units as FMI describes them: factor, offset and exponents of the SI base units.

A unit is a product of symbols with exponents, with at most one quotient: `N.s/m`, `kg.m2`, `1/Pa`.
"""

import math
import re
from collections.abc import Mapping

# Symbol: (factor to SI base units, exponents of the base units).
SYMBOLS: Mapping[str, tuple[float, Mapping[str, int]]] = {
    "kg": (1.0, {"kg": 1}),
    "m": (1.0, {"m": 1}),
    "s": (1.0, {"s": 1}),
    "A": (1.0, {"A": 1}),
    "K": (1.0, {"K": 1}),
    "mol": (1.0, {"mol": 1}),
    "cd": (1.0, {"cd": 1}),
    "rad": (1.0, {"rad": 1}),
    "Hz": (1.0, {"s": -1}),
    "N": (1.0, {"kg": 1, "m": 1, "s": -2}),
    "Pa": (1.0, {"kg": 1, "m": -1, "s": -2}),
    "J": (1.0, {"kg": 1, "m": 2, "s": -2}),
    "W": (1.0, {"kg": 1, "m": 2, "s": -3}),
    # For display only.
    "mm": (1e-3, {"m": 1}),
    "um": (1e-6, {"m": 1}),
    "nm": (1e-9, {"m": 1}),
    "g": (1e-3, {"kg": 1}),
    "ms": (1e-3, {"s": 1}),
    "us": (1e-6, {"s": 1}),
    "deg": (math.pi / 180.0, {"rad": 1}),
    "rpm": (math.pi / 30.0, {"rad": 1, "s": -1}),
    "kHz": (1e3, {"s": -1}),
    "kN": (1e3, {"kg": 1, "m": 1, "s": -2}),
    "kPa": (1e3, {"kg": 1, "m": -1, "s": -2}),
    "MPa": (1e6, {"kg": 1, "m": -1, "s": -2}),
    "GPa": (1e9, {"kg": 1, "m": -1, "s": -2}),
    "mJ": (1e-3, {"kg": 1, "m": 2, "s": -2}),
    "kW": (1e3, {"kg": 1, "m": 2, "s": -3}),
}

_TOKEN = re.compile(r"([A-Za-z]+)(-?\d+)?")


def factors(unit: str) -> dict[str, int]:
    """Symbols and exponents of a unit; ValueError for what isn't one."""
    found: dict[str, int] = {}
    above, _, below = unit.partition("/")
    for side, sign in ((above, 1), (below, -1)):
        for token in side.split(".") if side and side != "1" else ():
            match = _TOKEN.fullmatch(token)
            if match is None or match[1] not in SYMBOLS:
                known = ", ".join(SYMBOLS)
                raise ValueError(f"unit {unit!r}: {token!r} is not a known symbol ({known})")
            found[match[1]] = found.get(match[1], 0) + sign * int(match[2] or 1)
    return found


def per_second(unit: str, order: int) -> str:
    """The unit of the derivative of `order` by time."""
    if order == 0:
        return unit
    found = factors(unit)
    found["s"] = found.get("s", 0) - order

    def product(sign: int) -> str:
        powers = ((symbol, sign * power) for symbol, power in found.items() if sign * power > 0)
        return ".".join(f"{symbol}{power}" if power > 1 else symbol for symbol, power in powers)

    below = product(-1)
    return (product(1) or "1") + (f"/{below}" if below else "")


def base(unit: str) -> tuple[float, dict[str, int]]:
    """Factor to SI base units, and their exponents."""
    factor, exponents = 1.0, dict[str, int]()
    for symbol, power in factors(unit).items():
        scale, parts = SYMBOLS[symbol]
        factor *= scale**power
        for name, exponent in parts.items():
            exponents[name] = exponents.get(name, 0) + power * exponent
    return factor, {name: exponent for name, exponent in exponents.items() if exponent}


def display_factor(unit: str, display: str) -> float:
    """display value = factor * value; ValueError if the two measure different things."""
    (mine, exponents), (theirs, shown) = base(unit), base(display)
    if exponents != shown:
        raise ValueError(f"display unit {display!r} does not measure what {unit!r} does")
    return mine / theirs
