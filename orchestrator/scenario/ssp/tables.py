"""Mapping tables of the standard: truth values, whole numbers or items to others, entry by entry."""

from typing import Any

from .. import ScenarioError
from .names import expand_tag

KINDS = {
    kind: expand_tag(f"ssc:{kind}MappingTransformation") for kind in ("Boolean", "Integer", "Enumeration")
}
# Of a line through whole numbers.
ROUNDING = 1e-9
TRUTHS = {"true": 1.0, "1": 1.0, "false": 0.0, "0": 0.0}


def find_table(element: Any) -> tuple[str, dict[str, str]] | None:
    """The kind and the entries of the table of a connection or of a mapping's entry; None without one."""
    for kind, tag in KINDS.items():
        table = element.find(tag)
        if table is not None:
            entries = table.findall(expand_tag("ssc:MapEntry"))
            return kind, {entry.get("source"): entry.get("target") for entry in entries}
    return None


def look_up(kind: str, entries: dict[str, str], value: float | bool | str, where: str) -> float | bool | str:
    """The value that the table has for this one."""
    if kind == "Enumeration":
        if value not in entries:
            raise ScenarioError(f"{where}: its mapping has no entry for {value!r}; add one")
        return entries[str(value)]
    read = _read_number if kind == "Integer" else _read_truth
    numbers = {read(source, where): read(target, where) for source, target in entries.items()}
    if float(value) not in numbers:
        raise ScenarioError(f"{where}: its mapping has no entry for {value}; add one")
    found = numbers[float(value)]
    return bool(found) if kind == "Boolean" else found


def to_line(kind: str, entries: dict[str, str], where: str) -> tuple[float, float]:
    """Factor and offset of a table whose entries lie on a straight line, as two always do."""
    if kind == "Enumeration":
        raise ScenarioError(
            f"{where}: a mapping of an enumeration's items; connections take numbers, so connect its numbers"
        )
    read = _read_number if kind == "Integer" else _read_truth
    points = sorted((read(source, where), read(target, where)) for source, target in entries.items())
    if len(points) < 2:
        raise ScenarioError(f"{where}: its mapping has {len(points)} entries; give it all that occur")
    (x0, y0), (x1, y1) = points[0], points[-1]
    factor = (y1 - y0) / (x1 - x0)
    offset = y0 - factor * x0
    if any(abs(y - factor * x - offset) > ROUNDING * (1.0 + abs(y)) for x, y in points):
        raise ScenarioError(
            f"{where}: the entries of its mapping lie on no straight line, which connections need; let the "
            "FMU at its end map them"
        )
    return factor, offset


def _read_truth(text: str, where: str) -> float:
    if text not in TRUTHS:
        raise ScenarioError(f"{where}: {text!r} in its mapping: must be true or false")
    return TRUTHS[text]


def _read_number(text: str, where: str) -> float:
    try:
        return float(int(text))
    except ValueError:
        raise ScenarioError(f"{where}: {text!r} in its mapping: must be a whole number") from None
