"""Find, read, extend, override and write scenario files.

A file may extend another: `extends = "valve-train"`, a shipped scenario or a relative path. Its tables are
merged into the other's and its connections are added (see `extending`), after what `without` names has left.
With [step_control] the other's `output_step` leaves too.
"""

import copy
import difflib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from models.catalogue import CATALOGUE
from models.core.quantities import Layout
from models.core.remedies import in_python
from models.core.system import suggestion

from ..errors import Command, MistakeError, Set, Words, find_near
from ..texts import DEEPEST, parse_value, read_toml, to_path
from . import Scenario, ScenarioError, build_scenario, find_tables
from .component_table import ComponentTable
from .extending import EXTENDS, WITHOUT, drop, merge
from .oil import OILED, evaluate, name_oil
from .origin import SET, Origin
from .ssp import read_package as contents_of_package
from .values import ALIKE, SECTIONS, Value, WithUnit, build_component, find_idle, list_layouts, to_value

LISTED: Words = (Command("scenarios"), " lists those shipped")

SHIPPED = Path(__file__).parent / "shipped"


def list_shipped() -> dict[str, Path]:
    """The shipped scenarios by name."""
    return {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}


def find(name: str | Path, beside: Path | None = None) -> Path:
    """The file of a shipped scenario, or the path itself; ScenarioError if there is no such file.

    Also where a file of a shipped scenario's name lies in the working folder: either may be meant.
    """
    if shipped := list_shipped().get(str(name)):
        own = Path(f"{name}.toml")
        if beside is None and own.is_file() and not own.samefile(shipped):
            raise ScenarioError(
                f"{name}: is a shipped scenario, but {own} lies here",
                f"give {own} for that file, or rename it to use the shipped scenario",
            )
        return shipped
    path = (beside or Path()) / to_path(name)
    if path.is_file():
        return path
    if path.is_dir():
        raise ScenarioError(f"{path}: is a folder", ("give ", _suggest_in_folder(path)))
    if path.suffix in (".toml", ".ssp"):
        raise ScenarioError(f"{path}: no such scenario file", _suggest_near(path))
    raise ScenarioError(
        f"no scenario {str(name)!r}", (_suggest_near(path), "; or give the path of a .toml or .ssp file")
    )


def _suggest_in_folder(folder: Path) -> Words:
    """Suggest a file in place of a folder."""
    found = [*sorted(folder.glob("*.toml")), *sorted(folder.glob("*/scenario.toml"))]
    files = [str(file) for file in found if file.name != "pyproject.toml"]
    if files:
        return f"a file in it: {', '.join(files[:5])}"
    return "the path of a .toml file, or a shipped scenario: ", LISTED


def _suggest_near(path: Path) -> Words:
    """Suggest files of a similar name, and how to list those shipped."""
    near = {file.stem: str(file) for file in path.parent.glob("*.toml")} | {
        name: name for name in list_shipped()
    }
    written = path.stem[:100]
    close = find_near(written, near)
    return f"did you mean {' or '.join(near[one] for one in close)}? " if close else "", LISTED


def load(name: str | Path, overrides: Sequence[str] = ()) -> Scenario:
    """The scenario with `overrides` ("path=value") applied; the faults of a ScenarioError have sources."""
    return build_from(*read(name, overrides))


def build_from(content: Mapping[str, Any], origin: Origin) -> Scenario:
    """The scenario of tables that were read from there; the faults of a ScenarioError have sources."""
    try:
        return build_scenario(content).read_from(origin)
    except ScenarioError as error:
        raise ScenarioError.of(
            replace(fault, source=origin.find_source(in_python(fault.words))) for fault in error.faults
        ) from None


def read(name: str | Path, overrides: Sequence[str] = ()) -> tuple[dict[str, Any], Origin]:
    """The tables of a shipped scenario or a file, with `overrides` ("path=value"), and their origin."""
    path = find(name)
    content = read_contents(path)
    own = _read(path) if path.suffix == ".toml" else content
    inherited = _list_inputs(content) - _list_inputs(own)
    changed = override(content, overrides)
    resolve_paths(content, Path.cwd())  # of the overrides; those of the file are absolute
    return content, Origin(path, changed, inherited)


def _list_inputs(content: Mapping[str, Any]) -> frozenset[str]:
    """The inputs "component.input" that have values."""
    components = content.get("components")
    tables = components.items() if isinstance(components, dict) else ()
    given = {name: table.get("inputs") for name, table in tables if isinstance(table, dict)}
    return frozenset(f"{name}.{one}" for name, own in given.items() if isinstance(own, dict) for one in own)


def read_changed(name: str | Path, overrides: Sequence[str] = ()) -> dict[str, Any]:
    """The tables of `read`."""
    return read(name, overrides)[0]


def read_contents(path: Path, chain: tuple[Path, ...] = ()) -> dict[str, Any]:
    """The tables of a file, merged into those of the file that it extends."""
    path = path.resolve()
    if len(chain) > DEEPEST:
        raise ScenarioError(f"{chain[0].name}: extends more than {DEEPEST} files, one after the other")
    if path in chain:
        raise ScenarioError(f"{path.name}: extends itself ({' -> '.join(p.name for p in (*chain, path))})")
    content = contents_of_package(path) if path.suffix == ".ssp" else _read(path)
    base, without = content.pop(EXTENDS, None), content.pop(WITHOUT, None)
    content.setdefault("name", path.stem)
    resolve_paths(content, path.parent)
    if base is None:
        if without is not None:
            raise ScenarioError(f"{path.name}: {WITHOUT}: only beside {EXTENDS}, whose tables it takes from")
        return content
    if not isinstance(base, str):
        raise ScenarioError(f"{path.name}: extends = {base!r}: must be the name or path of a scenario")
    try:
        found = find(base, path.parent)
    except ScenarioError as error:
        raise ScenarioError((f"{path.name}: extends: ", error)) from None
    below = read_contents(found, (*chain, path))
    below.pop("description", None)  # it is of the other scenario
    try:
        drop(below, without or [])
    except MistakeError as error:
        raise ScenarioError(f"{path.name}: {error}") from None
    if "step_control" in content:
        below.pop("output_step", None)
    return merge(below, content)


# What files of other kinds are for.
_OTHERS = {
    ".fmu": "; an FMU takes part in a scenario: [components.NAME] participant = 'file.fmu'",
    ".csv": "; a cam's lift table is part of a scenario: [components.camshaft] lift_table = 'file.csv'",
}


def _read(path: Path) -> dict[str, Any]:
    return read_toml(path, ScenarioError, _OTHERS.get(path.suffix, ""))


def resolve_paths(content: dict[str, Any], folder: Path) -> None:
    """Make paths of .fmu files and of tables, which are relative to `folder`, absolute."""
    components = content.get("components")
    for table in components.values() if isinstance(components, dict) else ():
        if not isinstance(table, dict):
            continue
        kind = table.get("participant")
        if isinstance(kind, str) and kind.endswith(".fmu"):
            table["participant"] = str(folder / to_path(kind))
        for key in ("lift_table", "pressure_table"):
            if isinstance(table.get(key), str):
                table[key] = str(folder / to_path(table[key]))


def override(content: dict[str, Any], texts: Sequence[str]) -> dict[str, Any]:
    """Apply all "path=value", e.g. components.camshaft.parameters.lift=9 mm; the values by their paths.

    A value is TOML, or a string.
    """
    changed = dict(map(_parse, texts))
    try:
        change(content, changed)
    except ScenarioError as error:
        raise ScenarioError((SET, " ", error)) from None
    return changed


def _parse(text: str) -> tuple[str, Any]:
    path, equals, written = text.partition("=")
    path = path.strip()
    if not equals or not path:
        raise ScenarioError((SET, f" {text}: must be path=value, e.g. ", Set("macro_step", "2e-6")))
    try:
        return path, parse_value(written)
    except ValueError as error:
        raise ScenarioError((SET, f" {path}: {error}")) from None


def change(content: dict[str, Any], values: Mapping[str, Any]) -> None:
    """`put` values by their paths, and name them in the description, which may state others."""
    put(content, values)
    for path, value in values.items():
        place, _, key = path.rpartition(".")
        described = place.endswith((".parameters", ".structure", ".inputs", ".start")) or path == "stop_time"
        if described and content.get("description") and isinstance(value, str | float | int):
            text, _, changed = str(content["description"]).partition("; changed: ")
            known = [one for one in changed.split(", ") if one and not one.startswith(f"{key} = ")]
            content["description"] = f"{text}; changed: {', '.join([*known, f'{key} = {value}'])}"


def put(content: dict[str, Any], values: Mapping[str, Any]) -> None:
    """Put values at their paths, e.g. components.camshaft.parameters.lift, as one file would that extends
    this. Tables and lists are replaced as a whole."""
    over: dict[str, Any] = {}
    for path, value in values.items():
        keys = _check_path(content, path)
        below, above = content, over
        for i, key in enumerate(keys[:-1]):
            if i == 1 and key not in below:
                raise ScenarioError(f"{path}: no component {key!r}; {suggestion(key, below)}")
            inside = below.get(key, {})
            if isinstance(inside, dict):  # of an oil, which is merged with no other, all is kept
                above = above.setdefault(key, dict(inside) if key == "oil" else {})
            if not isinstance(inside, dict) or not isinstance(above, dict):
                raise ScenarioError(f"{path}: {'.'.join(keys[: i + 1])} is not a table")
            below = inside
        if isinstance(above.get(keys[-1]), dict):
            raise ScenarioError(f"{path}: a part of it is given too; leave one of them out")
        if isinstance(value, dict | list):
            below.pop(keys[-1], None)
        above[keys[-1]] = copy.deepcopy(value)
    if "step_control" in over:
        content.pop("output_step", None)
    content |= merge(content, over)


def _check_path(content: Mapping[str, Any], path: str) -> list[str]:
    """Its keys. ScenarioError for one that no scenario has."""
    keys = split_path(path)
    known = list(Scenario.model_fields)
    if keys[0] not in known:
        tables = " or ".join(find_tables(keys[0]))
        meant = tables or " or ".join(find_paths(content, path.split(".")))
        remedy = f"did you mean {meant}?" if meant else suggestion(keys[0], known)
        raise ScenarioError(f"{path}: unknown key {keys[0]!r}; {remedy}")
    own = keys[0] != "components" or len(keys) != 3 or keys[2] in ComponentTable.model_fields
    if not own and (meant := " or ".join(find_paths(content, keys))):
        raise ScenarioError(f"{path}: unknown key; did you mean {meant}?")
    return keys


def find_paths(content: Mapping[str, Any], keys: Sequence[str]) -> list[str]:
    """The paths components.NAME.TABLE.VARIABLE that parts of one, such as NAME.VARIABLE, may stand for."""
    *outer, variable = keys
    names, sections = set(outer) - {"components", *SECTIONS}, set(outer) & set(SECTIONS)
    known: dict[str, str] = {}
    instead: dict[str, str] = {}
    for name, table in content.get("components", {}).items():
        if isinstance(table, dict) and names <= {name} and table.get("component") in CATALOGUE:
            made = build_component(table["component"])
            for state, rule in find_idle(made, table.get("parameters", {})).items():
                instead[f"components.{name}.start.{state}"] = f"components.{name}.{rule.instead}"
            for section, layout in list_layouts(made).items():
                if section in (sections or SECTIONS):
                    known |= {f"components.{name}.{section}.{one}": one for one in layout.variables}
    close = difflib.get_close_matches(variable, known.values(), 1, ALIKE) if names else []
    found = [path for path, one in known.items() if one == variable or one in close]
    found = found or [path for path, one in known.items() if variable in one.split("_")]
    return [instead.get(path, path) for path in found][:3]


def has_path(content: Any, path: str) -> bool:
    """Whether there is a value at a path of `put`."""
    for key in split_path(path):
        if not isinstance(content, dict) or key not in content:
            return False
        content = content[key]
    return True


def put_parameters(content: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """A copy of the content with these values by "component.parameter"."""
    changed = copy.deepcopy(dict(content))
    put(changed, {f"components.{name.replace('.', '.parameters.', 1)}": v for name, v in values.items()})
    return changed


def split_path(path: str) -> list[str]:
    """The keys of a path: components.NAME.parameters.VARIABLE, else TABLE.KEY; the last key may have dots."""
    keys = path.split(".")
    depth = min(3 if keys[0] == "components" else 1, len(keys) - 1)
    return [*keys[:depth], ".".join(keys[depth:])]


def to_short_toml(scenario: Scenario, folder: Path, values: Mapping[str, Any] | None = None) -> str:
    """The scenario as TOML, without default values, with these `values` by "component.parameter"; paths of
    FMUs are relative to `folder`."""
    import tomli_w

    content = put_parameters(scenario.model_dump(exclude_defaults=True), values or {})
    for table in content["components"].values():
        path = Path(table.get("participant", ""))
        if path.is_relative_to(folder):
            table["participant"] = path.relative_to(folder).as_posix()
    return tomli_w.dumps(content)


def _keep_units(layout: Layout, values: Mapping[str, Value]) -> dict[str, str]:
    """The values that are plausible only in another unit than the one that they were given with."""
    return {
        name: f"{float(value)!r} {quantity.unit}"
        for name, value in values.items()
        if isinstance(value, WithUnit) and (quantity := layout.field(name).quantity).doubt(value)
    }


def to_full_toml(scenario: Scenario) -> str:
    """The scenario as TOML with all parameters but those that its oil gives; it gives the same run, bit for
    bit."""
    import tomli_w

    content, oil = scenario.model_dump(exclude_none=True), name_oil(scenario.oil, scenario.temperature)
    content |= oil
    given = evaluate(oil)[1] if oil else {}
    for name, table in scenario.components.items():
        layouts, written = list_layouts(table.resolve()), content["components"][name]
        if not table.third_party:  # its file holds its defaults
            values = {f.name: to_value(f.quantity, f.start) for f in layouts["parameters"].fields}
            written["parameters"] = values | table.parameters
        if table.resolve().has_role(*OILED):
            for parameter in [key for key, value in written["parameters"].items() if value == given.get(key)]:
                del written["parameters"][parameter]
        for section, values in table.values.items():
            kept = _keep_units(layouts[section], values).items()
            written[section] |= {key: value for key, value in kept if key in written[section]}
        for empty in ("structure", *SECTIONS):
            if not written.get(empty, True):
                del written[empty]
    return tomli_w.dumps(content)
