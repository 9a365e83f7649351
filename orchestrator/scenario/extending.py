"""Scenario files that extend others: what of the other one leaves, and how the rest is merged."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

from models.core.system import suggestion

from ..errors import MistakeError
from ..masters import find_master
from .connection import parse_line
from .lift_table import CAM_KEYS, replace_law
from .wire import replace_rate

# Keys of a file that extends another, which leave before the tables are merged.
EXTENDS, WITHOUT = "extends", "without"


def drop(content: dict[str, Any], paths: object) -> None:
    """Take `paths` out of a scenario's tables: keys such as components.camshaft.parameters.lift, or lines of
    `connections`.

    A component leaves with its connections and its entries in `tolerance`. MistakeError for what is not
    there.
    """
    if not isinstance(paths, Sequence) or isinstance(paths, str):
        raise MistakeError(f"{WITHOUT} = {paths!r}: must be a list of keys or connections")
    for path in paths:
        if "->" in str(path):
            _drop_connection(content, str(path))
        else:
            _drop_key(content, str(path))


def _drop_connection(content: dict[str, Any], line: str) -> None:
    wanted, lines = " ".join(line.split()), content.get("connections", [])
    kept = [other for other in lines if " ".join(str(other).split()) != wanted]
    if len(kept) == len(lines):
        raise MistakeError(f"{WITHOUT}: no connection {wanted!r}; {suggestion(wanted, map(str, lines))}")
    content["connections"] = kept


def _drop_key(content: dict[str, Any], path: str) -> None:
    keys, table = path.split("."), content
    for i, key in enumerate(keys):
        rest = ".".join(keys[i:])  # names of variables may have dots
        if rest in table or not isinstance(table.get(key), dict):
            break
        table = table[key]
    if rest not in table:
        raise MistakeError(f"{WITHOUT}: no {path!r}; {suggestion(rest, table)}")
    del table[rest]
    if keys[0] == "components" and len(keys) == 2:
        _drop_lines_of(content, keys[1])


def _drop_lines_of(content: dict[str, Any], component: str) -> None:
    """The connections of a component, and its outputs' tolerances."""
    begin = f"{component}."

    def ends_there(line: object) -> bool:
        try:
            parsed = parse_line(str(line))
        except ValueError:  # the scenario's check names it
            return False
        return parsed.source.startswith(begin) or parsed.target.startswith(begin)

    content["connections"] = [line for line in content.get("connections", []) if not ends_there(line)]
    tolerances = content.get("tolerance", {})
    content["tolerance"] = {name: value for name, value in tolerances.items() if not name.startswith(begin)}


def merge(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Merge `over` into `base`: tables are merged, connections added, other values and oils replaced.

    A component's `lift_table` or `lift_segments` replaces the law and its ramps, and a law replaces them. A
    spring's `wire` replaces what follows from it.
    """
    result = dict(base)
    if "wire" in over:
        replace_rate(result)
    cams, parameters = CAM_KEYS & over.keys(), over.get("parameters")
    for key in cams:
        replace_law(result, key)
    if not cams and isinstance(parameters, Mapping) and "law" in parameters:
        for key in CAM_KEYS:
            result.pop(key, None)
    for key, value in over.items():
        below = result.get(key)
        if key == "connections" and isinstance(below, list) and isinstance(value, list):
            result[key] = [*below, *value]
        elif isinstance(below, dict) and isinstance(value, dict) and key != "oil":
            if key == "master" and "name" in value:
                below = _drop_other_options(below, str(value["name"]))
            result[key] = merge(below, value)
        else:
            result[key] = value
    return result


def _drop_other_options(table: Mapping[str, Any], name: str) -> dict[str, Any]:
    """The [master] table for the master `name`, without the options that it does not have."""
    try:
        known = {field.name for field in fields(find_master(name))}
    except ValueError:
        return {"name": name}  # which the scenario's check refuses
    same = table.get("name") == name
    return {key: value for key, value in table.items() if same or key in known} | {"name": name}
