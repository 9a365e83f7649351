"""How the figures of merit of a steady cycle or of a run change with parameters: by tangents, or differences.

Where a cycle has no tangents, whole cycles are compared.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from models.core.words import tally

from ...analyses import Parameter
from ...analyses._evaluate import create_folder
from ...analyses.stability.chosen import choose_master
from ...assessment.notices import list_notices
from ...errors import MistakeError, Option, one_of
from ...reporter import Reporter
from ...scenario import Scenario, build_scenario
from ...scenario.files import put_parameters, to_full_toml
from ...scenario.system import Builder, list_parameters, list_quantities, resolve
from ...store.output_folder import PRINTED, refuse_file
from ...texts import parse_toml
from ..run import Where
from .coupled import CoupledSubject, is_coupled
from .differences import CLOSED, TOLERANCE, SensitivitySubject, build_elasticities, compare_motions, remark
from .figure_slopes import SPEED, FigureSlopes, find_run_slopes, find_slopes
from .subject import (
    SpeedSubject,
    check_varied,
    find_flywheel,
    find_own_speed,
)
from .sweep import parse_speed, parse_stated

PERIOD = Parameter(0.02, "s", "period of the cycle", positive=True)
CYCLES = "cycles.zarr"


@dataclass(frozen=True)
class Asked:
    """By which parameters, "component.name" or "speed", and of what motion: the steady cycle at a speed, or
    with a period, texts with units, or the run of the scenario."""

    parameters: Sequence[str] = ()
    speed: str | None = None
    period: str | None = None
    run: bool = False


def choose_parameters(scenario: Scenario, flywheel: str, wanted: Sequence[str]) -> tuple[str, ...]:
    """The parameters "component.name" that `wanted` names; by default the speed, unless `flywheel` is "", and
    all continuous ones that are not zero, but the drive's and elements of arrays. MistakeError for one that
    cannot be varied."""
    values, quantities = list_parameters(scenario), list_quantities(scenario)
    # Only whole ratios of speeds have a period.
    fixed = {name for name in values if quantities[name].jumps or name.endswith(".drive_ratio")}
    driven = [SPEED] if flywheel else []
    varied = driven + [name for name, value in values.items() if value != 0.0 and name not in fixed]
    if not wanted:
        return tuple(n for n in varied if not n.startswith(f"{flywheel}.") and "[" not in n)
    found = []
    for text in wanted:
        name = text.removeprefix("components.").replace(".parameters.", ".")
        check_varied(name, flywheel)
        if name not in varied:
            why = "has no values in between; " if name in fixed else "is zero, of which there is no share; "
            why = why if name in values else _explain_other(scenario, name)
            raise MistakeError((Option("parameter", text), f": {why}{one_of(varied, name)}"))
        found.append(name)
    return tuple(dict.fromkeys(found))


def _explain_other(scenario: Scenario, name: str) -> str:
    """What a variable is that is no parameter."""
    part, _, variable = name.partition(".")
    if part in scenario.components:
        component = scenario.components[part].resolve()
        for kind, layout in (("n output", component.outputs), ("n input", component.inputs)):
            if variable in layout.names:
                return f"is a{kind}, which has no value of its own; "
    return ""


def find_asked_sensitivities(
    tables: Mapping[str, Any], asked: Asked, out: Path, where: Where, build: Builder, reporter: Reporter,
    overwrite: bool = False,
) -> xarray.Dataset:  # fmt: skip
    """The elasticities of all figures over (figure, parameter), with their errors; the folder `out` keeps
    what is compared. `build` makes the FMUs of coupled runs, which are taken where equations are unknown."""
    scenario = build_scenario(tables)
    for name, given in (("speed", asked.speed), ("period", asked.period)):
        if asked.run and given is not None:
            raise MistakeError(
                (Option(name, given), ": is that of a steady cycle"), "leave it out, for a run"
            )
    if is_coupled(scenario):
        return find_coupled_sensitivities(scenario, asked, out, where, build, reporter, overwrite)
    if asked.period is not None:
        raise MistakeError((Option("period", asked.period), ": is for FMUs of other tools"), "leave it out")
    if asked.run:
        return find_run_sensitivities(tables, asked.parameters, out, reporter)
    speed = None if asked.speed is None else parse_speed("speed", asked.speed)
    return find_sensitivities(tables, speed, asked.parameters, out, where, reporter, overwrite)


def find_sensitivities(
    tables: Mapping[str, Any],
    speed: float | None,
    wanted: Sequence[str],
    out: Path,
    where: Where,
    reporter: Reporter,
    overwrite: bool = False,
) -> xarray.Dataset:
    """The elasticities of all figures of the cycle at `speed` (rad/s), by default the scenario's own, with
    their errors, over (figure, parameter); the cycles are kept in the folder `out`. MistakeError before
    anything is computed."""
    refuse_file(out)
    base, parameters = _open(tables, wanted, reporter)
    scenario = base.scenario
    speed = find_own_speed(scenario, base.flywheel) if speed is None else speed
    subject = SensitivitySubject(base, speed, parameters)
    exact = _find_exact(base, speed, parameters, reporter)
    if exact is not None:
        return exact
    return compare_motions(subject, out / CYCLES, where, reporter, overwrite)


def find_run_sensitivities(
    tables: Mapping[str, Any], wanted: Sequence[str], out: Path, reporter: Reporter
) -> xarray.Dataset:
    """The same of the scenario's run, from its start to its `stop_time`. MistakeError where it has no
    tangents."""
    refuse_file(out)
    base, parameters = _open(tables, wanted, reporter)
    values, stage = list_parameters(base.scenario), _name_stage("run", parameters)
    largest = max((values[f"{base.flywheel}.{end}_speed"] for end in ("initial", "final")), key=abs)
    with reporter.stage(stage):
        found = find_run_slopes(base, _list_changes(base, largest, parameters))
    reporter.line(f"exact {stage}")
    return _divide(base, found, parameters, speed=largest, stop_time=base.scenario.stop_time)


def find_coupled_sensitivities(
    scenario: Scenario, asked: Asked, out: Path, where: Where, build: Builder, reporter: Reporter,
    overwrite: bool = False,
) -> xarray.Dataset:  # fmt: skip
    """The same of a coupled run, or of the cycle in which it settles, by differences alone: the directional
    derivatives of FMI are those of rates and outputs at an instant, by states and inputs, and no step's."""
    refuse_file(out)
    flywheel, speed, period = _find_coupled_cycle(scenario, asked)
    reporter.notice(list_notices(scenario))
    chosen = choose_master(resolve(scenario), reporter).scenario
    if not asked.run and chosen.step_control is not None:
        raise MistakeError(
            "step_control: a cycle takes equal macro steps",
            "leave [step_control] out",
            ("take the scenario's run with ", Option("run", True)),
        )
    tables = parse_toml(to_full_toml(chosen))
    if flywheel and not asked.run:
        speed = find_own_speed(scenario, flywheel) if math.isnan(speed) else speed
        tables = put_parameters(tables, {f"{flywheel}.{end}_speed": speed for end in ("initial", "final")})
    base = CoupledSubject(tables, flywheel, build=build, period=period, running=asked.run)
    parameters = choose_parameters(scenario, flywheel, asked.parameters)
    with create_folder(out), reporter.keep_prints(out / PRINTED):
        with reporter.stage("coupled run" if asked.run else "steady cycle of the coupled run"):
            periods = int(base.measure_at(base.own_speed, TOLERANCE, CLOSED)["periods"])
        if not asked.run:
            reporter.line(f"a steady cycle after {periods} periods")
        base, halved = replace(base, periods=periods), chosen.step_control is None
        subject = SensitivitySubject(base, base.own_speed, parameters, halved)
        found = compare_motions(subject, out / CYCLES, where, reporter, overwrite)
    stop = {"stop_time": scenario.stop_time} if asked.run else {"period": period} if period > 0.0 else {}
    return found.assign_attrs(stop)


def _find_coupled_cycle(scenario: Scenario, asked: Asked) -> tuple[str, float, float]:
    """The flywheel ("": none), the speed and the period that are asked for (nan: none)."""
    speed = math.nan if asked.speed is None else parse_speed("speed", asked.speed)
    period = math.nan if asked.period is None else parse_stated("period", asked.period, PERIOD, ("ms", "s"))
    try:
        flywheel = find_flywheel(scenario)
    except MistakeError:
        if asked.speed:
            raise
        if not asked.run and asked.period is None:
            raise MistakeError(
                f"{scenario.name}: no flywheel prescribes the speed of a cam, and so the period of a cycle",
                ("give it, e.g. ", Option("period", "20 ms")),
                ("take the scenario's run with ", Option("run", True)),
            ) from None
        return "", speed, period
    if asked.period:
        raise MistakeError(
            (Option("period", asked.period), f": {flywheel} gives the period by its speed"),
            ("leave it out, and give the ", Option("speed")),
        )
    return flywheel, speed, period


def _open(
    tables: Mapping[str, Any], wanted: Sequence[str], reporter: Reporter
) -> tuple[SpeedSubject, tuple[str, ...]]:
    """The scenario with the numbers that oils, tables and drawings give, so that each may vary alone, and the
    parameters that do."""
    scenario = build_scenario(tables)
    flywheel = find_flywheel(scenario)
    reporter.notice(list_notices(scenario))
    base = SpeedSubject(parse_toml(to_full_toml(scenario)), flywheel)
    return base, choose_parameters(scenario, flywheel, wanted)


def _name_stage(motion: str, parameters: Sequence[str]) -> str:
    return f"derivatives of the {motion} by {tally(len(parameters), 'parameter')}"


def _list_changes(base: SpeedSubject, speed: float, parameters: Sequence[str]) -> list[dict[str, float]]:
    """Of each parameter by all of its value."""
    values = {SPEED: speed, **list_parameters(base.scenario)}
    return [{name: values[name]} for name in parameters]


def _find_exact(
    base: SpeedSubject, speed: float, parameters: Sequence[str], reporter: Reporter
) -> xarray.Dataset | None:
    """The same by the cycle's tangents; None, and why, where it has none. RunError without a steady cycle."""
    try:
        with reporter.stage(_name_stage("steady cycle", parameters)):
            found = find_slopes(base, speed, _list_changes(base, speed, parameters))
    except MistakeError as error:
        reporter.line(f"no exact derivatives, but differences of whole cycles: {error}")
        return None
    reporter.line(f"exact {_name_stage('cycle', parameters)}")
    return _divide(base, found, parameters, speed=speed)


def _divide(
    base: SpeedSubject, found: Mapping[str, FigureSlopes], parameters: Sequence[str], **attributes: float
) -> xarray.Dataset:
    """Slopes over their values."""
    shares = {}
    for name, one in found.items():
        if one.value and np.any(one.slopes):
            slopes, corners = one.slopes / one.value, one.corners / one.value
            sides = slopes - 0.5 * corners, slopes + 0.5 * corners
            shares[name] = one.value, slopes, np.abs(corners), *sides
    friction = remark(base, {name: one.value for name, one in found.items()})
    known = {"friction": friction, "status": 0, "method": "tangents"}
    return build_elasticities(shares, parameters, **attributes, **known)
