"""Where a cam comes from: a lift table, a law, or a component of a scenario."""

from pathlib import Path
from typing import Any

from models.core.system import suggestion
from models.valve_train.cams.rises import RISES

from ..errors import MistakeError, Option, one_of
from ..scenario.cams import name_follower
from ..scenario.component_table import ComponentTable
from ..scenario.files import find, list_shipped, load, read_contents
from ..scenario.values import to_value
from ._cam_profile import FIELDS, TABLE_EVENT, list_law_parameters


def find_settings(source: str, component: str | None = None) -> dict[str, Any]:
    """The parameters of the analysis `cam` for a lift table, a law, or a scenario's component.

    MistakeError if it is none of them.
    """
    kind = Path(source).suffix
    if source in list_shipped() or kind in (".toml", ".ssp"):
        return _read_scenario(source, component)
    if component is not None:
        raise MistakeError((Option("component", component), f": {source} is no scenario"), "leave it out")
    if source in RISES:
        return {"law": source}
    if not kind:
        raise MistakeError(
            f"cam {source!r}: {suggestion(source, [*RISES, *list_shipped()])} (a law, a shipped "
            "scenario, or a file: a lift table .csv, a scenario .toml or .ssp)"
        )
    return {"lift_table": source}


def _read_scenario(source: str, component: str | None) -> dict[str, Any]:
    cams = {name: table for name, table in load(source).components.items() if _list_values(table)}
    if not cams:
        raise MistakeError(f"{source}: no component has a cam; give a lift table, or another scenario")
    if component is None and len(cams) > 1:
        raise MistakeError(
            f"{source}: has the cams {', '.join(cams)}", ("choose one with ", Option("component"))
        )
    name = component or next(iter(cams))
    if name not in cams:
        raise MistakeError((Option("component", name), f": {one_of(cams, name)}"))
    values = _list_values(cams[name])
    follower = name_follower(values)
    wanted = {*list_law_parameters(), *TABLE_EVENT, *FIELDS[follower]}
    found = {key: value for key, value in values.items() if key in wanted} | {"follower": follower}
    if "law" in values:
        return found
    lift_table = read_contents(find(source))["components"][name].get("lift_table")
    if lift_table is None:
        raise MistakeError(f"{name}: has a cam through points; give the file of its lift table instead")
    return {"lift_table": lift_table, **found}


def _list_values(table: ComponentTable) -> dict[str, Any]:
    """All parameters of a component with a cam, as the analysis names them; none of another one."""
    if table.third_party:
        return {}
    values = {f.name: to_value(f.quantity, f.start) for f in table.resolve().parameters.fields}
    values |= table.parameters
    if "base_radius" not in values:
        return {}
    return {"radius" if name == "follower_radius" else name: value for name, value in values.items()}
