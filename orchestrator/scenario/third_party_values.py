"""Values for third-party FMUs: strings, enumerations, and numbers with units."""

from collections.abc import Mapping
from string import hexdigits

from ..errors import one_of
from ..participants.description import BINARY
from ..participants.third_party import ThirdPartyComponent
from .units import OFFSETS_AGREE, is_bare, to_base_units
from .values import Faults, Value


def select_strings(
    component: ThirdPartyComponent, values: Mapping[str, Value], causality: str
) -> dict[str, Value]:
    """The values of strings, and binary ones in hexadecimal digits; Faults for values that are none, and for
    unsupported types."""
    found: dict[str, Value] = {}
    faults = []
    for name, value in values.items():
        variable = component.about.variables.get(name)
        if variable is None or variable.numeric or variable.causality != causality:
            continue
        if name not in component.about.strings:
            array = "an element of an array of texts" if variable.size > 1 else ""
            kind = array or f"of type {variable.type}"
            faults.append((name, f": is {kind}, which cannot be set; leave it out (its start value stays)"))
        elif not isinstance(value, str) or "\0" in value:
            faults.append((name, f" = {value!r} (String): must be a string without null characters"))
        elif variable.type == BINARY and (len(value) % 2 or not set(value) <= set(hexdigits)):
            faults.append((name, f" = {value!r} (Binary): must be pairs of hexadecimal digits, as 666f6f"))
        else:
            found[name] = value
    if faults:
        raise Faults(*faults)
    return found


def convert_enumerations(component: ThirdPartyComponent, values: Mapping[str, Value]) -> dict[str, Value]:
    """The values of enumerations as numbers; Faults for values that are neither items nor their numbers."""
    found: dict[str, Value] = {}
    faults = []
    for name, value in values.items():
        variable = component.about.variables.get(name)
        if variable is None or not variable.items:
            continue
        items = dict(variable.items)
        numbers = [float(number) for number in items.values()]
        if isinstance(value, str) and value in items:
            found[name] = float(items[value])
        elif not isinstance(value, str | bool) and float(value) in numbers:
            found[name] = float(value)
        else:
            shown = f"{value:g}" if isinstance(value, float) else repr(value)
            known = one_of(tuple(items), value if isinstance(value, str) else "")
            said = f"{known}, or their numbers ({_format_numbers(numbers)})"
            faults.append((name, f" = {shown} ({variable.description or name}): {said}"))
    if faults:
        raise Faults(*faults)
    return found


def _format_numbers(numbers: list[float]) -> str:
    """E.g. "0 to 8"; numbers with gaps are listed."""
    ordered = sorted(int(number) for number in numbers)
    if len(ordered) > 2 and ordered[-1] - ordered[0] == len(ordered) - 1:
        return f"{ordered[0]} to {ordered[-1]}"
    return ", ".join(map(str, ordered))


def check_offsets(component: ThirdPartyComponent, values: Mapping[str, Value]) -> None:
    """Raise Faults for numbers in another unit than the FMU's, where it defines its own with another zero
    than usual, as degC like K."""
    faults = []
    for name, value in values.items():
        variable = component.about.variables.get(name)
        unit = variable.unit if variable and not variable.relative else ""
        own = component.about.units.get(unit)
        if own is None or not isinstance(value, str) or is_bare(value.strip().removesuffix(unit)):
            continue
        usual = to_base_units(unit)
        if usual and abs(own.offset - usual.offset) > OFFSETS_AGREE * max(abs(own.offset), abs(usual.offset)):
            zero = f"the FMU defines {unit} with its zero at {own.offset:g}, not {usual.offset:g}"
            faults.append((name, f" = {value!r}: {zero}; write a plain number, which it takes as it is"))
    if faults:
        raise Faults(*faults)
