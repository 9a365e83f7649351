"""How the figures of merit of a steady cycle change with parameters, by its tangents."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from rich.table import Column, Table

from models.core.words import tally

from ...assessment.friction.losses import remark_outside
from ...errors import MistakeError, Option, RunError, one_of
from ...plots.sensitivities import LEAST, draw_tornado
from ...plots.style import save_figure
from ...report.answer import Answer
from ...reporter import Reporter
from ...scenario import Scenario, build_scenario
from ...scenario.display import format_number, say, show, show_unit
from ...scenario.files import to_full_toml
from ...scenario.system import build_system, list_parameters, list_quantities
from ...texts import parse_toml
from .figure_slopes import SPEED, find_slopes
from .subject import SpeedSubject, check_varied, describe_numbers, find_flywheel, find_own_speed

PAGE, TABLE, FIGURE = "sensitivities.html", "sensitivities.csv", "sensitivities.png"
# A derivative whose values to both sides differ by more than this of itself is marked.
DOUBTFUL = 0.05
# Rows of the table that is printed, and the figures that are its columns.
SHOWN = 12
MAIN = (
    "least_load", "spring_margin", "peak_pressure", "least_film", "seating_velocity", "surge_force",
    "friction_power", "largest_torque",
)  # fmt: skip
RPM = 30.0 / math.pi


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


def find_sensitivities(
    tables: Mapping[str, Any], speed: float | None, wanted: Sequence[str], reporter: Reporter
) -> xarray.Dataset:
    """The elasticities of all figures of the cycle at `speed` (rad/s), by default the scenario's own, over
    (figure, parameter), and by how much their values to both sides differ. RunError without a steady cycle,
    ModelError where it has no tangents."""
    scenario = build_scenario(tables)
    flywheel = find_flywheel(scenario)
    speed = find_own_speed(scenario, flywheel) if speed is None else speed
    parameters = choose_parameters(scenario, flywheel, wanted)
    # With the numbers that oils, tables and drawings give, so that each may vary alone.
    base = SpeedSubject(parse_toml(to_full_toml(scenario)), flywheel)
    values = {SPEED: speed, **list_parameters(base.scenario)}
    with reporter.stage(f"derivatives of the steady cycle by {tally(len(parameters), 'parameter')}"):
        slopes = find_slopes(base, speed, [{name: values[name]} for name in parameters])
    found = {name: one for name, one in slopes.items() if one.value and np.any(one.slopes)}
    if not found:
        raise RunError(f"no figure of the cycle changes with {', '.join(parameters)}")
    both = ("figure", "parameter")
    shares = {
        "elasticity": (both, [one.slopes / one.value for one in found.values()]),
        "error": (both, [one.corners / abs(one.value) for one in found.values()]),
        "value": ("figure", [one.value for one in found.values()]),
    }
    coordinates = {"figure": list(found), "parameter": list(parameters)}
    return xarray.Dataset(shares, coordinates, {"speed": speed})


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
    at = f"{scenario.name} at {RPM * dataset.attrs['speed']:.0f} r/min"
    title = f"{at}: change in % for 1 % more of a parameter; ~ where it is uncertain by more than 5 %"
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
        cells = zip(main["elasticity"].values[:, k], main["error"].values[:, k], strict=True)
        name = str(main["parameter"].values[k])
        shown.add_row(name, values[name], *(_cell(one, error) for one, error in cells))
    answer = Answer(f"{at}: sensitivities", reporter)
    answer.table(shown)
    for text in remark_outside(build_system(scenario)):
        answer.line(text)
    out.mkdir(parents=True, exist_ok=True)
    frame = dataset["elasticity"].to_pandas()
    frame.insert(0, "value", dataset["value"].values)
    frame.insert(1, "unit", [results[name].unit for name in dataset["figure"].values])
    frame.to_csv(out / TABLE)
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


def _cell(elasticity: float, differing: float) -> str:
    if not math.isfinite(elasticity):
        return "–"
    doubtful = differing > DOUBTFUL * max(abs(elasticity), LEAST)
    return f"{'~' if doubtful else ''}{format_number(elasticity, 3) if abs(elasticity) >= LEAST else 0}"
