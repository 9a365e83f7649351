"""Where a cam or a spring comes from: a lift table, a law, or a component of a scenario."""

import difflib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from models.core import roles
from models.core.system import suggestion
from models.valve_train.cams.rises import RISES

from ..assessment.trains import find_train
from ..errors import Command, MistakeError, Option, one_of
from ..scenario import Scenario
from ..scenario.cam_files import is_contour
from ..scenario.cams import name_follower
from ..scenario.component_table import ComponentTable
from ..scenario.files import find, list_shipped, load, read_contents
from ..scenario.system import build_system, list_parameters
from ..scenario.values import to_value
from ..texts import to_path
from ._cam_profile import FIELDS, list_lift_parameters, read_base_radius

# Of these a wire has one.
LENGTHS = {"pitch", "free_length"}


def find_settings(source: str, component: str | None = None) -> dict[str, Any]:
    """The parameters of the analysis `cam` for a lift table, a law, or a scenario's component.

    MistakeError if it is none of them.
    """
    kind = Path(source).suffix
    if _is_scenario(source):
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
    if not to_path(source).exists():
        near = difflib.get_close_matches(source, map(str, Path(source).parent.glob(f"*{kind}")), 1)
        known = f"a path, a law ({', '.join(RISES)}) or a shipped scenario"
        raise MistakeError(f"{source}: no such file", f"did you mean {near[0]}?" if near else f"give {known}")
    if is_contour(Path(source)):
        return {"contour": source, "base_radius": read_base_radius(source)}
    return {"lift_table": source}


def find_spring_settings(
    source: str | None, component: str | None = None, cam: str | None = None, given: Sequence[str] = ()
) -> dict[str, Any]:
    """The parameters of the analysis `spring`: of a scenario the wire and a cam, else of a cam alone.

    MistakeError for a scenario without a wire, unless the settings `given` have its diameter. A pitch or free
    length among them replaces both of the scenario.
    """
    names = {text.partition("=")[0].strip() for text in given}
    if source is None:
        return {}
    scenario = _is_scenario(source)
    wires = _read_wires(source) if scenario else {}
    if scenario and not wires and "diameter" not in names:
        raise MistakeError(
            f"{source}: its springs have no wire",
            ("give one by [components.SPRING.wire], or by ", Option("set", "diameter=4 mm"), " and the like"),
        )
    if component is not None and not wires:
        raise MistakeError((Option("component", component), f": {source} has no spring with a wire"))
    wire = wires[_choose(source, component, wires, "springs")] if wires else {}
    left = LENGTHS if names & LENGTHS else set()
    kept = {key: _write(value) for key, value in wire.items() if key not in left}
    ratio = {key: value for key, value in find_valve_settings(source, cam).items() if key != "lash"}
    return kept | find_lift_settings(source, cam) | ratio


def find_lift_settings(source: str, component: str | None = None) -> dict[str, Any]:
    """Those of `find_settings` that make the lift; MistakeError for a contour, which alone makes none."""
    found = find_settings(source, component)
    if "contour" in found:
        raise MistakeError(
            f"{source}: is a contour, whose lift is that of a follower",
            ("take the lift table that ", Command("cam", (source,)), " writes"),
        )
    return {key: value for key, value in found.items() if key in list_lift_parameters()}


def find_valve_settings(source: str, component: str | None = None) -> dict[str, Any]:
    """Lash and ratio at the valve that a scenario's cam lifts, as the analysis `clearance` has them; none of
    a cam alone. The ratio is that at the largest lift; a retainer has the lash of the valve on its stem."""
    if not _is_scenario(source):
        return {}
    scenario = load(source)
    name, _ = _find_cam(source, scenario, component)
    train = find_train(build_system(scenario), name)
    if train is None:
        return {}
    return {"lash": next(iter(train.list_of_valves("lash")), 0.0), "valve_ratio": train.ratio}


def _is_scenario(source: str) -> bool:
    return source in list_shipped() or Path(source).suffix in (".toml", ".ssp")


def _choose(source: str, component: str | None, known: Mapping[str, Any], kind: str) -> str:
    """The component asked for, or the only one; MistakeError for an unknown one, or of several."""
    if component is None and len(known) > 1:
        raise MistakeError(
            f"{source}: has the {kind} {', '.join(known)}", ("choose one with ", Option("component"))
        )
    name = component or next(iter(known))
    if name not in known:
        raise MistakeError((Option("component", name), f": {one_of(known, name)}"))
    return name


def _write(value: Any) -> Any:
    """As a setting has it."""
    if isinstance(value, bool):
        return str(value).lower()
    return ", ".join(map(str, value)) if isinstance(value, list) else value


def _read_wires(source: str) -> dict[str, dict[str, Any]]:
    """By component; of a scenario whose faults have been told."""
    load(source)
    components = read_contents(find(source))["components"]
    return {name: table["wire"] for name, table in components.items() if "wire" in table}


def _find_cam(source: str, scenario: Scenario, component: str | None) -> tuple[str, dict[str, Any]]:
    """The component with the cam, and its values."""
    every = {name: _list_values(table) for name, table in scenario.components.items()}
    cams = {name: values for name, values in every.items() if values}
    if not cams:
        raise MistakeError(f"{source}: no component has a cam; give a lift table, or another scenario")
    name = _choose(source, component, cams, "cams")
    return name, cams[name]


def _read_scenario(source: str, component: str | None) -> dict[str, Any]:
    scenario = load(source)
    name, values = _find_cam(source, scenario, component)
    follower = name_follower(values)
    wanted = {*list_lift_parameters(), *FIELDS[follower]}
    found = {key: value for key, value in values.items() if key in wanted} | {"follower": follower}
    found |= _find_speed(scenario)
    if "law" in values:
        return found
    lift_table = read_contents(find(source))["components"][name].get("lift_table")
    if lift_table is None:
        raise MistakeError(f"{name}: has a cam through points; give the file of its lift table instead")
    return {"lift_table": lift_table, **found}


def _find_speed(scenario: Scenario) -> dict[str, Any]:
    """Of the cam (rad/s): the larger one of the drive, of a free one that at the start, by the shaft's ratio;
    none without a drive."""
    values, speeds = list_parameters(scenario), list[float]()
    for name, table in scenario.components.items():
        if (component := table.resolve()).has_role(roles.Drive):
            begun = float(table.start.get("speed", component.state.field("speed").start))
            ends = [values[f"{name}.{end}"] for end in ("initial_speed", "final_speed")]
            speeds += [begun] if table.parameters.get("motion") == "free" else ends
    ratio = min((value for name, value in values.items() if name.endswith(".drive_ratio")), default=1.0)
    return {"speed": ratio * max(speeds)} if max(speeds, default=0.0) > 0.0 else {}


def _list_values(table: ComponentTable) -> dict[str, Any]:
    """All parameters of a component with a cam, as the analysis names them; none of another one."""
    if table.third_party:
        return {}
    values = {f.name: to_value(f.quantity, f.start) for f in table.resolve().parameters.fields}
    values |= table.parameters
    if "base_radius" not in values:
        return {}
    return {"radius" if name == "follower_radius" else name: value for name, value in values.items()}
