"""The JSON schema of scenario files, for editors: names, units and descriptions of all variables."""

import json
from dataclasses import fields
from typing import Any

from models.catalogue import CATALOGUE
from models.core.quantities import Layout

from ..masters import MASTERS
from . import Scenario
from .master_table import AUTO, MasterTable
from .values import build_component, list_layouts


def build_schema() -> dict[str, Any]:
    """The schema of a scenario file; one that extends another needs no required keys."""
    made: dict[str, Any] = Scenario.model_json_schema()
    made["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    made["title"] = "tribocosim scenario"
    made["properties"]["extends"] = {
        "type": "string",
        "description": "A shipped scenario, or the path of a file, that this one changes",
    }
    made["properties"]["without"] = {
        "type": "array",
        "items": {"type": "string"},
        "description": "Keys and connections of the extended scenario that leave, e.g. "
        "components.camshaft.lift_table; a component leaves with its connections",
    }
    required = [name for name in made.pop("required") if name != "name"]
    made["if"] = {"not": {"required": ["extends"]}}
    made["then"] = {"required": required}
    table = made["$defs"]["ComponentTable"]
    component = table["properties"]["component"]
    table["properties"]["component"] = {
        "anyOf": [{"enum": list(CATALOGUE)}, {"type": "string", "pattern": ":"}],
        "description": component["description"],
    }
    table["allOf"] = [
        {
            "if": {"properties": {"component": {"const": name}}, "required": ["component"]},
            "then": describe_component(name),
        }
        for name in CATALOGUE
    ]
    made["$defs"]["MasterTable"] = _describe_masters()
    return made


def write_schema() -> str:
    """The text of docs/scenario.schema.json."""
    return json.dumps(build_schema(), indent=2, ensure_ascii=False) + "\n"


def describe_component(name: str) -> dict[str, Any]:
    component = build_component(name)
    return {
        "properties": {key: _describe_variables(layout) for key, layout in list_layouts(component).items()}
        | {
            "structure": {
                "properties": {
                    size: {"type": "integer", "minimum": _find_smallest_size(name, size)}
                    for size in component.structure
                }
            }
        }
    }


def _find_smallest_size(name: str, size: str) -> int:
    """The smallest size that the component accepts: 0 or 1."""
    try:
        build_component(name, ((size, 0),))
    except ValueError:
        return 1
    return 0


def _describe_variables(layout: Layout) -> dict[str, Any]:
    """The variables' entries. Names of vector elements are patterns, as their number varies."""
    plain: dict[str, Any] = {}
    patterns: dict[str, Any] = {}
    for field in map(layout.field, layout.variables):
        quantity = field.quantity
        unit = "" if quantity.unit == "1" else f" ({quantity.unit})"
        default = f"; default: as {quantity.same_as}" if quantity.same_as else ""
        text = f"{quantity.description}{unit}; {quantity.describe_range()}{default}"
        entry: dict[str, Any] = {"description": text}
        if quantity.choices:
            entry["enum"] = list(quantity.choices)
        elif quantity.boolean:
            entry["type"] = "boolean"
        else:
            entry["type"] = ["number", "string"]
        if quantity.size:
            patterns[rf"^{field.name.partition('[')[0]}(\[[1-9][0-9]*\])?$"] = entry
        else:
            plain[field.name] = entry
    made: dict[str, Any] = {"properties": plain, "additionalProperties": False}
    return made | ({"patternProperties": patterns} if patterns else {})


def _describe_masters() -> dict[str, Any]:
    options: dict[str, Any] = {}
    for name, kind in MASTERS.items():
        for field in fields(kind):
            options.setdefault(field.name, []).append(name)
    described = {option: {"description": f"option of {', '.join(of)}"} for option, of in options.items()}
    described["chosen"] = {"description": str(MasterTable.model_fields["chosen"].description)}
    return {
        "type": "object",
        "description": "The co-simulation master and its options",
        "properties": {"name": {"anyOf": [{"enum": [*MASTERS, AUTO]}, {"pattern": ":"}]}} | described,
        "if": {"not": {"properties": {"name": {"pattern": ":"}}, "required": ["name"]}},
        "then": {"propertyNames": {"enum": ["name", *described]}},
    }
