"""Values of whole arrays, and structural parameters of third-party FMUs."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from models.core.quantities import Layout
from models.core.system import suggestion

from ..participants.description import DescriptionError, read_description
from ..participants.third_party import ThirdPartyComponent
from .values import Faults, Value


def spread_arrays(values: Mapping[str, Value], layout: Layout) -> dict[str, Value]:
    """With every element of an array that is given as one value; elements given on their own come first."""
    found: dict[str, Value] = {}
    for name, value in values.items():
        found |= dict.fromkeys(_list_elements(name, layout), value) or {name: value}
    return found | {name: value for name, value in values.items() if name in layout}


def spread_lists(values: Any, layout: Layout) -> Any:
    """With every element of an array that is given as a list, or a list of rows; Faults for other shapes."""
    if not isinstance(values, dict):
        return values
    found: dict[str, Any] = {}
    faults = []
    for name, value in values.items():
        elements = _list_elements(str(name), layout) if isinstance(value, list) else []
        if not elements:
            found[name] = value
            continue
        shape = tuple(int(n) for n in elements[-1].rpartition("[")[2].rstrip("]").split(","))
        if _find_shape(value) != shape:
            asked = " x ".join(map(str, shape))
            rows = " (a list of rows)" if len(shape) > 1 else ""
            faults.append((str(name), f" = {value}: must have {asked} values{rows}"))
        found |= dict(zip(elements, _flatten(value), strict=False))
    if faults:
        raise Faults(*faults)
    return found


def _list_elements(name: str, layout: Layout) -> list[str]:
    return [element for element in layout.variables if element.startswith(f"{name}[")]


def _find_shape(value: Any) -> tuple[int, ...] | None:
    """The shape of nested lists; None if it differs between rows."""
    if not isinstance(value, list):
        return ()
    inner = {_find_shape(one) for one in value}
    shape = inner.pop() if len(inner) == 1 else None
    return None if shape is None else (len(value), *shape)


def _flatten(value: Any) -> Iterator[Any]:
    if not isinstance(value, list):
        yield value
        return
    for one in value:
        yield from _flatten(one)


def check_sizes(path: Path, interface: str, sizes: Mapping[str, int]) -> None:
    """Raise Faults for what are no structural parameters of the FMU, or out of their ranges."""
    try:
        known = read_description(path, interface).structural
    except DescriptionError:
        return  # reported with the file
    faults = []
    for name, size in sizes.items():
        if name not in known:
            remedy = suggestion(name, known) if known else "it has none; leave it out"
            faults.append((name, f": no such structural parameter; {remedy}"))
            continue
        variable = known[name]
        least, most = variable.minimum, variable.maximum
        if not least <= size <= most:
            high = "" if math.isinf(most) else f" and at most {most:.0f}"
            low = f"at least {max(least, 0.0):.0f}"
            faults.append((name, f" = {size} ({variable.description or name}): must be {low}{high}"))
    if faults:
        raise Faults(*faults)


def check_resized(component: ThirdPartyComponent, given: Mapping[str, Value]) -> None:
    """Raise Faults for parameters of changed sizes that are not given whole: start values do not fit."""
    lacking = {
        v.name.rpartition("[")[0]: v.size
        for v in component.about.variables.values()
        if component.about.sizes and v.settable and v.numeric and v.size > 1
        if v.start is None and v.name not in given
    }
    if lacking:
        said = (
            "has {} elements with these structural parameters, and its start values are for another size; "
            "give all of them"
        )
        raise Faults(*((f"parameters.{name}", f": {said.format(n)}") for name, n in lacking.items()))
