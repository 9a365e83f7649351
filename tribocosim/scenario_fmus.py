"""FMUs of a scenario: its components with its values as defaults, or the whole train as one."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from models.compile.temporary import TemporaryFolder
from models.core.system import Instance, suggestion
from orchestrator.errors import MistakeError, Option

from .arguments import checks_arguments
from .fmu import FmuOptions, build_file, check_kind, check_place
from .scenario import Scenario, load

if TYPE_CHECKING:
    from fmus.fmi.description import Experiment
    from fmus.scenario_parts import Part
    from orchestrator.scenario import Scenario as CheckedScenario
    from orchestrator.scenario.system import Assembly

# What hosts that integrate by themselves take: at 1e-5 their trial steps leave a film's range.
TOLERANCE = 1e-8
# Angle of the drive (rad): at 0.24 deg a host missed 14 % of a load's peak of 801 N, at 0.1 deg 1.3 %.
FINE = math.radians(0.1)


@checks_arguments
def build_scenario_fmus(
    scenario: Scenario | str | Path,
    out: str | Path = ".",
    *,
    components: Sequence[str] = (),
    whole: bool = False,
    outside: Sequence[str] = (),
    native: bool = False,
    platforms: Sequence[str] = (),
    fmi: int = 2,
    progress: Callable[[str], None] = lambda step: None,
) -> list[Path]:
    """Build FMUs in the folder `out` whose defaults are the scenario's values; the paths of their files.

    Parameters, tables, oil and start values become defaults. One FMU for each component, or for those named
    in `components`; with `whole` a single one that has them all, connected, but those named `outside`:
    their outputs become its inputs. The other options are as for `build_fmu`. MistakeError for what cannot
    be built.
    """
    from fmus.scenario_parts import to_identifier, write_part
    from orchestrator.scenario.system import assemble, resolve_start

    checked = load(scenario).check()
    options = FmuOptions(None, native, platforms or None, fmi)
    check_kind(options)
    _check(checked, components, whole, outside)
    with TemporaryFolder() as folder:
        if whole:
            own = [write_whole(checked, folder, outside)]
        else:
            parts = _list_parts(checked, resolve_start(checked, assemble(checked).system).instances)
            names = list(dict.fromkeys(components)) or list(parts)
            check_place(Path(out), names)
            about, run = f"of {checked.name}", plan_experiment(checked)
            own = [
                write_part(folder, to_identifier(name), f"{name} {about}", parts[name], run) for name in names
            ]
        return [build_file(one, Path(out), options, progress) for one in own]


def write_whole(checked: CheckedScenario, folder: Path, outside: Sequence[str] = ()) -> str:
    """The name of a component, in a file of the folder, that has all of the scenario's but those outside."""
    from fmus.scenario_parts import to_identifier, write_train
    from orchestrator.scenario.system import assemble, resolve_start

    _check_whole(checked, outside)
    assembly = assemble(checked)
    system = resolve_start(checked, assembly.system)
    inside = {
        name: part for name, part in _list_parts(checked, system.instances).items() if name not in outside
    }
    parts = _transform(inside, assembly)
    lines = [(str(c.source), str(c.target)) for c in system.connections]
    about = f"{checked.description or checked.name}: {', '.join(parts)}"
    return write_train(folder, to_identifier(checked.name), about, parts, lines, plan_experiment(checked))


def plan_experiment(checked: CheckedScenario) -> Experiment:
    """The scenario's run, in its macro steps or in FINE of the drive, if these are shorter: a host that takes
    no longer ones sees the peaks."""
    from fmus.fmi.description import Experiment
    from orchestrator.scenario.revolutions import to_duration

    try:
        step = min(checked.macro_step, to_duration(FINE, checked.model_dump(include={"components"})))
    except ArithmeticError:
        step = checked.macro_step
    return Experiment(checked.stop_time, step, tolerance=TOLERANCE)


def _check(scenario: CheckedScenario, components: Sequence[str], whole: bool, outside: Sequence[str]) -> None:
    if whole and components:
        raise MistakeError((Option("whole", True), ": has all components; leave out the others by name"))
    if outside and not whole:
        raise MistakeError((Option("outside"), ": only with "), ("add ", Option("whole", True)))
    for name in (*components, *outside):
        if name not in scenario.components:
            known = suggestion(name, scenario.components)
            raise MistakeError(f"no component {name!r} in {scenario.name}; {known}")
    for name in components:
        if scenario.components[name].third_party:
            raise MistakeError(f"components.{name}: is an FMU of another tool; leave it out")


def _list_parts(scenario: CheckedScenario, instances: Mapping[str, Instance]) -> dict[str, Part]:
    from fmus.scenario_parts import Part

    return {
        name: Part(table.component, instances[name])
        for name, table in scenario.components.items()
        if table.component is not None
    }


def _transform(parts: Mapping[str, Part], assembly: Assembly) -> dict[str, Part]:
    """The parts with what their connections make of the values."""
    from models.core.transformed import Transformation

    def changes(name: str, part: Part) -> dict[str, Transformation]:
        inputs = assembly.system.instances[name].component.inputs
        return {
            key: Transformation(linear.factor, linear.offset, inputs.field(key).quantity.unit)
            for key, linear in assembly.linear.get(name, {}).items()
        }

    return {name: replace(part, transformed=changes(name, part)) for name, part in parts.items()}


def _check_whole(scenario: CheckedScenario, outside: Sequence[str]) -> None:
    if set(outside) >= set(scenario.components):
        raise MistakeError((Option("outside"), ": leaves no component for the FMU"))
    for name, table in scenario.components.items():
        if table.third_party and name not in outside:
            raise MistakeError(
                f"components.{name}: is an FMU of another tool, whose equations are unknown",
                ("leave it out: ", Option("outside", name)),
            )
