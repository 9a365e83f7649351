"""How the figures of merit of a steady cycle or of a run change with parameters: by tangents, or differences.

Where a cycle has no tangents, whole cycles are compared.

For a share h of the parameter, D(h) = (g(1 + h) - g(1 - h))/(2 h) is the change of a figure g, and
(4 D(h) - D(2 h))/3 has an error of order h^4. Its distance from D(h) is published with it: it is large where
a figure is not smooth, as at the loss of contact.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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
from ...assessment.friction.losses import remark_outside
from ...assessment.notices import list_notices
from ...errors import MistakeError, Option, RunError, one_of
from ...plots.merits import LEAST, draw_tornado
from ...plots.style import save_figure
from ...report.answer import Answer
from ...reporter import Reporter
from ...scenario import Scenario, build_scenario
from ...scenario.display import format_number, say, show, show_unit
from ...scenario.files import put_parameters, to_full_toml
from ...scenario.system import build_system, list_parameters, list_quantities
from ...scenario.values import Value
from ...store.csv_file import write_sheet
from ...store.output_folder import refuse_file
from ...texts import parse_toml
from ..files import plan_axis
from ..run import Where, run
from ..store import DONE
from ..subjects import NumberedSubject
from .figure_slopes import SPEED, FigureSlopes, find_run_slopes, find_slopes
from .subject import (
    STEADY,
    SpeedSubject,
    check_varied,
    describe_numbers,
    find_flywheel,
    find_own_speed,
    measure_cycle,
)

# Of a parameter; of the solver; of a cycle. At a tenth of this share the noise of figures, 1e-7, makes errors
# of 1e-3; at ten times of it contacts' vibrations end in another phase.
SHARE, TOLERANCE, CLOSED = 1e-3, 1e-11, 1e-9
SHARES = (-2.0, -1.0, 1.0, 2.0)
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
class SensitivitySubject(NumberedSubject):
    """The cycles of a scenario beside that at a speed (rad/s), by the parameters "component.name"."""

    axis = CASE

    base: SpeedSubject
    speed: float
    parameters: tuple[str, ...]

    @property
    def results(self) -> Mapping[str, Result]:
        return self.base.results

    def content(self) -> str:
        cycles = {"speed": self.speed, "parameters": self.parameters, "share": SHARE}
        return json.dumps(cycles) + self.base.content()

    def evaluate(self, values: Mapping[str, Value]) -> Mapping[str, float | str]:
        subject, speed = self.find_case(round(float(values["case"])))
        return measure_cycle(subject.find_cycle_at(speed, TOLERANCE, CLOSED), subject.flywheel)

    def find_case(self, case: int) -> tuple[SpeedSubject, float]:
        """The scenario and the speed (rad/s) of a cycle."""
        if not case:
            return self.base, self.speed
        which, step = divmod(case - 1, len(SHARES))
        name, factor = self.parameters[which], 1.0 + SHARE * SHARES[step]
        if name == SPEED:
            return self.base, self.speed * factor
        value = list_parameters(self.base.scenario)[name] * factor
        return SpeedSubject(put_parameters(self.base.tables, {name: value}), self.base.flywheel), self.speed


def choose_parameters(scenario: Scenario, flywheel: str, wanted: Sequence[str]) -> tuple[str, ...]:
    """The parameters "component.name" that `wanted` names; by default the speed and all continuous ones that
    are not zero, but the drive's and elements of arrays. MistakeError for one that cannot be varied."""
    values, quantities = list_parameters(scenario), list_quantities(scenario)
    # Only whole ratios of speeds have a period.
    fixed = {name for name in values if quantities[name].jumps or name.endswith(".drive_ratio")}
    varied = [name for name, value in values.items() if value != 0.0 and name not in fixed]
    if not wanted:
        return (SPEED, *(n for n in varied if not n.startswith(f"{flywheel}.") and "[" not in n))
    found = []
    for text in wanted:
        name = text.removeprefix("components.").replace(".parameters.", ".")
        check_varied(name, flywheel)
        if name != SPEED and name not in varied:
            if name not in values:
                raise MistakeError((Option("parameter", text), f": {one_of([SPEED, *varied], name)}"))
            why = "has no values in between" if name in fixed else "is zero, of which there is no share"
            raise MistakeError((Option("parameter", text), f": {why}; {one_of([SPEED, *varied], '')}"))
        found.append(name)
    return tuple(dict.fromkeys(found))


def differentiate(table: Mapping[str, Vector], count: int) -> dict[str, tuple[Vector, Vector]]:
    """By figure its elasticities dg/g over dp/p (count,) and their distance from D(h), a third of what both
    steps differ by; without those of a figure that is zero or unknown. `table`: the values of all cases."""
    found = {}
    for name, values in table.items():
        cases = (
            values[1:].reshape(count, len(SHARES)) / values[0] if values[0] else np.full((count, 4), np.nan)
        )
        near = (cases[:, 2] - cases[:, 1]) / (2.0 * SHARE)
        far = (cases[:, 3] - cases[:, 0]) / (4.0 * SHARE)
        elasticity = (4.0 * near - far) / 3.0
        if np.isfinite(elasticity).any():
            found[name] = elasticity, np.abs(elasticity - near)
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
    last = len(parameters) * len(SHARES)
    reporter.line(
        f"{last + 1} steady cycles: {len(SHARES)} for each of {tally(len(parameters), 'parameter')}, and one"
    )
    description = f"{scenario.name}: cycles beside that at {speed:.6g} rad/s"
    plan = plan_axis(scenario.name, description, subject, "case", (0.0, float(last)), last + 1)
    status = run(plan, out / CYCLES, where, reporter, overwrite)
    with xarray.open_zarr(out / CYCLES) as stored:
        cycles = stored.load()
    usable = find_usable(cycles, reporter)
    values = {
        name: np.where(usable, cycles[name].values, np.nan)
        for name in subject.results
        if name not in STEADY and not name.endswith("_angle")
    }
    found = {name: (values[name][0], *one) for name, one in differentiate(values, len(parameters)).items()}
    return _build(found, parameters, speed=speed, status=status, method="differences")


def find_run_sensitivities(
    tables: Mapping[str, Any], speed: str | None, wanted: Sequence[str], out: Path, reporter: Reporter
) -> xarray.Dataset:
    """The same of the scenario's run, from its start to its `stop_time`. MistakeError where it has no
    tangents, and for a `speed`, which is that of a cycle."""
    if speed is not None:
        raise MistakeError((Option("speed", speed), ": is that of a steady cycle"), "leave it out, for a run")
    refuse_file(out)
    base, parameters = _open(tables, wanted, reporter)
    values, stage = list_parameters(base.scenario), _name_stage("run", parameters)
    largest = max((values[f"{base.flywheel}.{end}_speed"] for end in ("initial", "final")), key=abs)
    with reporter.stage(stage):
        found = find_run_slopes(base, _list_changes(base, largest, parameters))
    reporter.line(f"exact {stage}")
    return _divide(found, parameters, speed=largest, stop_time=base.scenario.stop_time)


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
    found: Mapping[str, tuple[float, Vector, Vector]], parameters: Sequence[str], **attributes: Any
) -> xarray.Dataset:
    """By figure its value, elasticities and their errors."""
    if not found:
        raise RunError(f"no figure of merit changes with {', '.join(parameters)}")
    value, elasticity, error = (np.array(column) for column in zip(*found.values(), strict=True))
    both = ("figure", "parameter")
    return xarray.Dataset(
        {"elasticity": (both, elasticity), "error": (both, error), "value": ("figure", value)},
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
    return _divide(found, parameters, speed=speed)


def _divide(
    found: Mapping[str, FigureSlopes], parameters: Sequence[str], **attributes: float
) -> xarray.Dataset:
    """Slopes over their values."""
    shares = {
        name: (one.value, one.slopes / one.value, np.abs(one.corners / one.value))
        for name, one in found.items()
        if one.value and np.any(one.slopes)
    }
    dataset = _build(shares, parameters, **attributes, status=0, method="tangents")
    half = np.array([0.5 * found[name].corners / found[name].value for name in shares])
    return dataset.assign(below=dataset["elasticity"] - half, above=dataset["elasticity"] + half)


def select_figures(dataset: xarray.Dataset) -> list[str]:
    """What is printed and drawn: each number in MAIN of the first part that has it, contacts first."""
    names = [str(name) for name in dataset["figure"].values]
    found = []
    for figure in MAIN:
        having = [name for name in names if name.rpartition(".")[2] == figure]
        contacts = [name for name in having if f"{name.rpartition('.')[0]}.least_load" in names]
        found += (contacts or having)[:1]
    return found


def publish(dataset: xarray.Dataset, scenario: Scenario, out: Path, reporter: Reporter) -> None:
    """Print the largest elasticities of the main figures, and write all to a table, those to a figure and a
    page."""
    main = dataset.sel(figure=select_figures(dataset))
    largest = np.nanmax(np.abs(main["elasticity"].values), axis=0, initial=0.0)
    order = np.argsort(-largest, kind="stable")[:SHOWN]
    results = describe_numbers(scenario)
    attributes = dataset.attrs
    run = f" in a run of {1e3 * attributes['stop_time']:.4g} ms" if "stop_time" in attributes else ""
    at = f"{scenario.name} at {RPM * attributes['speed']:.0f} r/min{run}"
    title = f"{at}: change in % for 1 % more of a parameter; ~ where it is uncertain by more than 5 %"
    title += "; less | more of it" if _list_sides(dataset) and _doubts(main).any() else ""
    heads = (str(name).rpartition(".")[2].replace("_", " ") for name in main["figure"].values)
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
    for text in remark_outside(build_system(scenario)):
        answer.line(text)
    out.mkdir(parents=True, exist_ok=True)
    frame = dataset["elasticity"].to_pandas()
    frame.insert(0, "value", dataset["value"].values)
    frame.insert(1, "unit", [results[name].unit for name in dataset["figure"].values])
    for k in np.flatnonzero(_doubts(dataset).any(axis=0)):
        for side in _list_sides(dataset):
            frame[f"{dataset['parameter'].values[k]} {side}"] = dataset[side].values[:, k]
    write_sheet(out / TABLE, frame.to_csv())
    drawn = main.isel(parameter=order).assign_coords(
        shown=("figure", own), size=("parameter", [values[str(main["parameter"].values[k])] for k in order])
    )
    save_figure(lambda: draw_tornado(drawn, at), out / FIGURE)
    answer.write(out, PAGE, (TABLE, FIGURE))


def _say_parameters(dataset: xarray.Dataset, scenario: Scenario) -> dict[str, str]:
    """By parameter its value in the scenario, with its unit."""
    values, quantities = list_parameters(scenario), list_quantities(scenario)
    said = {SPEED: f"{RPM * dataset.attrs['speed']:.4g} r/min"}
    names = [str(name) for name in dataset["parameter"].values if name != SPEED]
    return said | {name: say(values[name], show(quantities[name])) for name in names}


def _doubts(dataset: xarray.Dataset) -> NDArray[np.bool_]:
    """Which elasticities are uncertain. The error of differences is a third of what both steps differ by,
    that of tangents what both sides do."""
    differing = dataset["error"].values * (3.0 if dataset.attrs["method"] == "differences" else 1.0)
    return np.asarray(differing > DOUBTFUL * np.maximum(np.abs(dataset["elasticity"].values), LEAST))


def _list_sides(dataset: xarray.Dataset) -> list[str]:
    return [side for side in ("below", "above") if side in dataset]


def _cell(one: xarray.Dataset) -> str:
    """An elasticity; an uncertain one marked, where they are known with those below and above."""
    if not math.isfinite(one["elasticity"]):
        return "–"
    doubtful = bool(_doubts(one))
    told = [float(one[side]) for side in (doubtful and _list_sides(one)) or ["elasticity"]]
    said = "|".join(format_number(value, 3) if abs(value) >= LEAST else "0" for value in told)
    return f"{'~' if doubtful else ''}{said}"
