"""Sensitivities as a table, a sheet, a figure and a page."""

import math
from pathlib import Path

import numpy as np
import xarray
from numpy.typing import NDArray
from rich.table import Column, Table

from ...plots.merits import LEAST, draw_tornado
from ...plots.style import save_figure
from ...report.answer import Answer
from ...reporter import Reporter
from ...scenario import Scenario
from ...scenario.display import format_number, say, show, show_unit
from ...scenario.system import list_parameters, list_quantities
from ...store.csv_file import write_sheet
from .coupled import describe_statistics
from .differences import SHARE, SIDES
from .figure_slopes import SPEED
from .subject import (
    describe_numbers,
)

BY_DIFFERENCES = (
    f"differences over {SHARE:.1%} and {2.0 * SHARE:.1%} of each parameter; ± is by what both steps, or both "
    "sides, differ"
)
PAGE = "sensitivities.html"
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
