"""How the figures of merit of a steady cycle or of a run change with parameters: by tangents, or differences.

Where a cycle has no tangents, whole cycles are compared.

For a share h of the parameter, D(h) = (g(1 + h) - g(1 - h))/(2 h) is the change of a figure g, and
(4 D(h) - D(2 h))/3 has an error of order h^4. Its distance from D(h) is published with it: it is large where
a figure is not smooth, as at the loss of contact.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray
from rich.table import Column, Table

from models.core.quantities import Vector
from models.core.words import tally
from models.monolithic.cycle import STEADY as LARGEST_CHANGE

from ...analyses import Parameter, Result
from ...analyses._evaluate import create_folder
from ...analyses.stability.chosen import choose_master
from ...assessment.friction.remarks import remark_friction
from ...assessment.notices import list_notices
from ...errors import MistakeError, Option, RunError, one_of
from ...plots.merits import LEAST, draw_tornado
from ...plots.style import save_figure
from ...report.answer import Answer
from ...reporter import Reporter
from ...scenario import Scenario, build_scenario
from ...scenario.display import format_number, say, show, show_unit
from ...scenario.files import put_parameters, to_full_toml
from ...scenario.system import Builder, build_system, list_parameters, list_quantities, resolve
from ...scenario.values import Value
from ...store.csv_file import write_sheet
from ...store.output_folder import PRINTED, refuse_file
from ...texts import parse_toml
from ..files import plan_axis
from ..run import Where, run
from ..store import DONE
from ..subjects import NumberedSubject
from .coupled import CoupledSubject, describe_statistics, is_coupled
from .figure_slopes import SPEED, FigureSlopes, find_run_slopes, find_slopes
from .subject import (
    STEADY,
    SpeedSubject,
    check_varied,
    describe_numbers,
    find_flywheel,
    find_own_speed,
)
from .sweep import parse_speed

# Of a parameter; of the solver; of a cycle. At a tenth of this share the noise of figures, 1e-7, makes errors
# of 1e-3; at ten times of it contacts' vibrations end in another phase.
SHARE, TOLERANCE, CLOSED = 1e-3, 1e-11, 1e-9
SHARES = (-2.0, -1.0, 1.0, 2.0)
SIDES = ("below", "above")
BY_DIFFERENCES = (
    f"differences over {SHARE:.1%} and {2.0 * SHARE:.1%} of each parameter; ± is by what both steps, or both "
    "sides, differ"
)
PERIOD = Parameter(0.02, "s", "period of the cycle", positive=True)
CASE = Parameter(0.0, "1", "number of the cycle: the first is that of the scenario itself")
PAGE, CYCLES = "sensitivities.html", "cycles.zarr"
TABLE, FIGURE = "sensitivities.csv", "sensitivities.png"
# A difference of more than this of itself between both steps, or both sides, is told.
DOUBTFUL = 0.05
# Rows of the table that is printed, and the figures that are its columns.
SHOWN = 12
MAIN = (
    "least_load", "spring_margin", "peak_pressure", "least_film", "seating_velocity", "surge_force",
    "friction_power", "largest_torque",
)  # fmt: skip
RPM = 30.0 / math.pi


@dataclass(frozen=True)
class Asked:
    """By which parameters, "component.name" or "speed", and of what motion: the steady cycle at a speed, or
    with a period, texts with units, or the run of the scenario."""

    parameters: Sequence[str] = ()
    speed: str | None = None
    period: str | None = None
    run: bool = False


@dataclass(frozen=True)
class SensitivitySubject(NumberedSubject):
    """The motions of a scenario beside that at a speed (rad/s), by the parameters "component.name"; `halved`:
    all of them in halved macro steps, too."""

    axis = CASE

    base: SpeedSubject
    speed: float
    parameters: tuple[str, ...]
    halved: bool = False

    @property
    def count(self) -> int:
        """Of the cases in one length of macro steps."""
        return 1 + len(SHARES) * len(self.parameters)

    @property
    def results(self) -> Mapping[str, Result]:
        return self.base.results

    def content(self) -> str:
        cycles = {"speed": self.speed, "parameters": self.parameters, "share": SHARE}
        return json.dumps(cycles) + self.base.content()

    def evaluate(self, values: Mapping[str, Value]) -> Mapping[str, float | str]:
        subject, speed = self.find_case(round(float(values["case"])))
        return subject.measure_at(speed, TOLERANCE, CLOSED)

    def find_case(self, case: int) -> tuple[SpeedSubject, float]:
        """The scenario and the speed (rad/s) of a cycle."""
        base, (finer, case) = self.base, divmod(case, self.count)
        if finer:
            base = replace(base, tables={**base.tables, "macro_step": 0.5 * base.scenario.macro_step})
        if not case:
            return base, self.speed
        which, step = divmod(case - 1, len(SHARES))
        name, factor = self.parameters[which], 1.0 + SHARE * SHARES[step]
        if name == SPEED:
            return base, self.speed * factor
        value = list_parameters(self.base.scenario)[name] * factor
        return replace(base, tables=put_parameters(base.tables, {name: value})), self.speed


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


def differentiate(table: Mapping[str, Vector], count: int) -> dict[str, tuple[Vector, ...]]:
    """By figure its elasticities dg/g over dp/p (count,), their errors, and those below and above; without
    those of a figure that is zero or unknown. `table`: the values of all cases.

    The error is the distance from D(h), a third of what both steps differ by, or half of what both sides
    differ by if that is more. Sides are of second order: of a smooth figure they differ by noise alone, the
    fourth difference over 2 h. Where one has no values, as beyond the edge of a range, the other one is the
    elasticity, and its distance from that of first order the error.
    """
    found: dict[str, tuple[Vector, ...]] = {}
    for name, values in table.items():
        if not values[0]:
            continue
        far_below, near_below, near_above, far_above = values[1:].reshape(count, len(SHARES)).T / values[0]
        near = (near_above - near_below) / (2.0 * SHARE)
        elasticity = (4.0 * near - (far_above - far_below) / (4.0 * SHARE)) / 3.0
        below, above = (
            side * (4.0 * one - two - 3.0) / (2.0 * SHARE)
            for side, one, two in ((-1.0, near_below, far_below), (1.0, near_above, far_above))
        )
        error = np.maximum(np.abs(elasticity - near), 0.5 * np.abs(above - below))
        for side, one, own in ((-1.0, near_below, below), (1.0, near_above, above)):
            alone = np.isnan(elasticity)
            error = np.where(alone, np.abs(own - side * (one - 1.0) / SHARE), error)
            elasticity = np.where(alone, own, elasticity)
        if np.isfinite(elasticity).any():
            found[name] = elasticity, error, below, above
    return found


def find_usable(cycles: xarray.Dataset, reporter: Reporter) -> NDArray[np.bool_]:
    """The cases with a steady cycle; RunError where the first, the scenario itself, has none."""
    done = cycles["status"].values == DONE
    usable = np.asarray(done & (cycles["change"].values <= LARGEST_CHANGE))
    if not done[0]:
        raise RunError(f"the scenario's own cycle was not found: {cycles['message'].values[0]}")
    if not usable[0]:
        raise RunError("the scenario has no steady cycle at this speed: there are no sensitivities")
    if unsteady := int(np.sum(done & ~usable)):
        reporter.line(
            f"{unsteady} cycles are not steady, see cycles.csv: their parameters have no sensitivities"
        )
    return usable


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
    return _compare(subject, out / CYCLES, where, reporter, overwrite)


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
        found = _compare(subject, out / CYCLES, where, reporter, overwrite)
    stop = {"stop_time": scenario.stop_time} if asked.run else {"period": period} if period > 0.0 else {}
    return found.assign_attrs(stop)


def _find_coupled_cycle(scenario: Scenario, asked: Asked) -> tuple[str, float, float]:
    """The flywheel ("": none), the speed and the period that are asked for (nan: none)."""
    speed = math.nan if asked.speed is None else parse_speed("speed", asked.speed)
    period = math.nan if asked.period is None else parse_speed("period", asked.period, PERIOD, ("ms", "s"))
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


def _compare(
    subject: SensitivitySubject, store: Path, where: Where, reporter: Reporter, overwrite: bool
) -> xarray.Dataset:
    """The elasticities by differences of all cases; those in halved macro steps, if there are any, with what
    they differ by from the others in their errors."""
    count, last = len(subject.parameters), subject.count * (1 + subject.halved) - 1
    reporter.line(
        f"{last + 1} motions: {len(SHARES)} for each of {tally(count, 'parameter')}, and one"
        f"{', in two lengths of macro steps' if subject.halved else ''}"
    )
    name = subject.base.scenario.name
    description = f"{name}: motions beside that at {subject.speed:.6g} rad/s"
    plan = plan_axis(name, description, subject, "case", (0.0, float(last)), last + 1)
    status = run(plan, store, where, reporter, overwrite)
    with xarray.open_zarr(store) as stored:
        cycles = stored.load()
    found = _differentiate_cases(cycles.isel(case=slice(subject.count)), subject, reporter)
    if subject.halved:
        try:
            finer = _differentiate_cases(cycles.isel(case=slice(subject.count, None)), subject, reporter)
        except RunError as error:
            reporter.line(f"what macro steps cost is not known, as they cannot be halved: {error}")
        else:
            steps = abs(finer["elasticity"] - found["elasticity"])
            finer = finer.sel(figure=steps["figure"])
            found = finer.assign(error=finer["error"] + steps).assign_attrs(halved=1)
    friction = _remark(subject.base, cycles.isel(case=0).data_vars)
    return found.assign_attrs(status=status, friction=friction)


def _differentiate_cases(
    cycles: xarray.Dataset, subject: SensitivitySubject, reporter: Reporter
) -> xarray.Dataset:
    usable = find_usable(cycles, reporter)
    values = {
        name: np.where(usable, cycles[name].values, np.nan)
        for name in subject.results
        if name not in STEADY and not name.endswith("_angle")
    }
    found = differentiate(values, len(subject.parameters))
    turning = {} if math.isnan(subject.speed) else {"speed": subject.speed}
    known = {name: (values[name][0], *one) for name, one in found.items()}
    return _build(known, subject.parameters, **turning, method="differences")


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


def _build(
    found: Mapping[str, tuple[Any, ...]], parameters: Sequence[str], **attributes: Any
) -> xarray.Dataset:
    """By figure its value, elasticities, their errors, and those below and above."""
    if not found:
        raise RunError(f"no figure of merit changes with {', '.join(parameters)}")
    value, *slopes = (np.array(column) for column in zip(*found.values(), strict=True))
    names, both = ("elasticity", "error", *SIDES), ("figure", "parameter")
    return xarray.Dataset(
        {"value": ("figure", value)} | {n: (both, one) for n, one in zip(names, slopes, strict=True)},
        {"figure": list(found), "parameter": list(parameters)},
        attributes,
    )


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


def _remark(base: SpeedSubject, values: Mapping[str, Any]) -> str:
    """Lines to stand beside friction and torques."""
    return "\n".join(remark_friction(build_system(base.scenario), values))


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
    friction = _remark(base, {name: one.value for name, one in found.items()})
    return _build(shares, parameters, **attributes, friction=friction, status=0, method="tangents")


def select_figures(dataset: xarray.Dataset) -> list[str]:
    """What is printed and drawn: each number in MAIN of the first part that has it, contacts first."""
    names = [str(name) for name in dataset["figure"].values]
    found = []
    for figure in MAIN:
        having = [name for name in names if name.rpartition(".")[2] == figure]
        contacts = [name for name in having if f"{name.rpartition('.')[0]}.least_load" in names]
        found += (contacts or having)[:1]
    # Of parts without figures of their own.
    return [*found, *(n for n in names if n.endswith((".minimum", ".maximum")))][: len(MAIN)]


def _name_figure(name: str) -> str:
    """In words; statistics are told with the output."""
    whole = name.endswith((".minimum", ".maximum"))
    return (name.replace(".", " ") if whole else name.rpartition(".")[2]).replace("_", " ")


def publish(dataset: xarray.Dataset, scenario: Scenario, out: Path, reporter: Reporter) -> None:
    """Print the largest elasticities of the main figures, and write all to a table, those to a figure and a
    page."""
    main = dataset.sel(figure=select_figures(dataset))
    largest = np.nanmax(np.abs(main["elasticity"].values), axis=0, initial=0.0)
    order = np.argsort(-largest, kind="stable")[:SHOWN]
    results = describe_numbers(scenario) | describe_statistics(scenario)
    attributes, at = dataset.attrs, scenario.name
    at += f" at {RPM * attributes['speed']:.0f} r/min" if "speed" in attributes else ""
    for name, motion in (("stop_time", "run"), ("period", "cycle")):
        at += f" in a {motion} of {1e3 * attributes[name]:.4g} ms" if name in attributes else ""
    title = f"{at}: change in % for 1 % more of a parameter; ~ where it is uncertain by more than 5 %"
    title += "; less | more of it" if _doubts(main).any() else ""
    title += "; ± error of differences" if attributes["method"] == "differences" else ""
    heads = (_name_figure(str(name)) for name in main["figure"].values)
    columns = Column("parameter", no_wrap=True), "its value"
    shown = Table(*columns, *heads, title=title, title_justify="left", padding=0)
    units = (
        show_unit(one.unit, one.display_unit) for one in (results[str(n)] for n in main["figure"].values)
    )
    own = [say(float(value), unit) for value, unit in zip(main["value"].values, units, strict=True)]
    shown.add_row("value of the figure", "", *own, end_section=True)
    values = _say_parameters(dataset, scenario)
    for k in order:
        name, column = str(main["parameter"].values[k]), main.isel(parameter=k)
        cells = (_cell(column.isel(figure=i)) for i in range(column.sizes["figure"]))
        shown.add_row(name, values[name], *cells)
    answer = Answer(f"{at}: sensitivities", reporter)
    answer.table(shown)
    if attributes["method"] == "differences":
        halved = "halved" in attributes
        answer.line(f"{BY_DIFFERENCES}, and what halved macro steps change" if halved else BY_DIFFERENCES)
    for text in dataset.attrs["friction"].splitlines():
        answer.line(text)
    out.mkdir(parents=True, exist_ok=True)
    frame = dataset["elasticity"].to_pandas()
    frame.insert(0, "value", dataset["value"].values)
    frame.insert(1, "unit", [results[name].unit for name in dataset["figure"].values])
    sides = np.any(_differ(dataset, abs(dataset["above"] - dataset["below"])), axis=0)
    for k, name in enumerate(dataset["parameter"].values):
        errors = ["error"] if attributes["method"] == "differences" else []
        for column in [*errors, *(SIDES if sides[k] else ())]:
            frame[f"{name} {column}"] = dataset[column].values[:, k]
    write_sheet(out / TABLE, frame.to_csv())
    drawn = main.isel(parameter=order).assign_coords(
        shown=("figure", own), size=("parameter", [values[str(main["parameter"].values[k])] for k in order])
    )
    save_figure(lambda: draw_tornado(drawn, at), out / FIGURE)
    answer.write(out, PAGE, (TABLE, FIGURE))


def _say_parameters(dataset: xarray.Dataset, scenario: Scenario) -> dict[str, str]:
    """By parameter its value in the scenario, with its unit."""
    values, quantities = list_parameters(scenario), list_quantities(scenario)
    said = {SPEED: f"{RPM * dataset.attrs.get('speed', math.nan):.4g} r/min"}
    names = [str(name) for name in dataset["parameter"].values if name != SPEED]
    return said | {name: say(values[name], show(quantities[name])) for name in names}


def _differ(dataset: xarray.Dataset, by: xarray.DataArray) -> NDArray[np.bool_]:
    """Which elasticities differ by more than may be."""
    return np.asarray(by > DOUBTFUL * np.maximum(np.abs(dataset["elasticity"]), LEAST))


def _doubts(dataset: xarray.Dataset) -> NDArray[np.bool_]:
    """Which are uncertain. The error of differences is a third of what both steps differ by, that of tangents
    what both sides do."""
    return _differ(dataset, dataset["error"] * (3.0 if dataset.attrs["method"] == "differences" else 1.0))


def _cell(one: xarray.Dataset) -> str:
    """An elasticity, of differences with its error; an uncertain one marked, with both sides where these
    differ."""
    if not math.isfinite(one["elasticity"]):
        return "–"
    differ = bool(_differ(one, abs(one["above"] - one["below"])))
    told = [float(one[side]) for side in (SIDES if differ else ("elasticity",))]
    said = "|".join(format_number(value, 3) if abs(value) >= LEAST else "0" for value in told)
    error = f" ±{float(one['error']):.1g}" if one.attrs["method"] == "differences" else ""
    return f"{'~' if _doubts(one) else ''}{said}{error}"
