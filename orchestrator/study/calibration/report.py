"""What a calibration leaves: table, fitted scenario, and figure."""

import json
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from importlib import metadata
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import tomli_w
import xarray
from rich.table import Column, Table

from models.core.quantities import Quantity, Vector

from ...plots.calibration import Panel, draw_calibration, draw_parameters
from ...plots.style import save_figure
from ...report.answer import Answer
from ...scenario import Scenario
from ...scenario.display import Shown, format_number, say, show, show_unit
from ...scenario.files import to_short_toml
from ...scenario.system import list_outputs, list_quantities
from ...scenario.units import to_unit
from ...store.csv_file import write_rows
from ...texts import to_plain
from .doubts import find_doubt
from .fit import Fit, half_width
from .objective import Objective
from .unseen import find_places, list_correlated

PAGE, TABLE, NUMBERS, FITTED = "calibration.html", "calibration.csv", "calibration.json", "calibrated.toml"
# Of a fitted value, in all files.
DIGITS = 10
SIGNALS, FIGURE, INTERVALS = "calibration-signals.csv", "calibration.png", "calibration-parameters.png"


class Row(NamedTuple):
    """A parameter: its start, and the fitted value with its 95 % interval, in its unit; whether the signals
    show it; the fitted value as a scenario writes it."""

    name: str
    unit: str
    start: float
    fitted: float
    low: float
    high: float
    deviation: float
    identified: bool
    written: str


@dataclass(frozen=True)
class Calibration:
    """A fit, the residual over the noise that each start came to, and intervals by profiles."""

    scenario: Scenario
    objective: Objective
    fit: Fit
    ends: Sequence[float]
    profiles: dict[str, tuple[float, float]]

    @cached_property
    def rows(self) -> list[Row]:
        measured, hidden = self.objective.measured, {name for one in self.fit.unseen for name in one.shares}
        unknowns = len(self.objective.parameters) + measured.unknowns
        given = all(signal.noise for signal in measured.signals)
        width = half_width(10**9 if given else measured.count - unknowns)
        found, quantities = [], list_quantities(self.scenario)
        for one, x, deviation in zip(self.objective.parameters, self.fit.x, self.fit.deviations, strict=True):
            shown, spread = _show(quantities[one.name]), one.size * float(deviation)
            written = f"{shown.factor * one.size * float(x):.{DIGITS}g} {shown.unit}".strip()
            value = to_unit(written, one.unit)
            low, high = self.profiles.get(one.name, (value - width * spread, value + width * spread))
            seen = one.name not in hidden
            if not seen:
                low, high, spread = math.nan, math.nan, math.nan
            found.append(Row(one.name, one.unit, one.start, value, low, high, spread, seen, written))
        return found

    @cached_property
    def notes(self) -> list[str]:
        names = [one.name for one in self.objective.parameters]
        correlated = [f"correlation of {text}" for text in list_correlated(names, self.fit.correlation)]
        ends = {
            one.name: say(one.size * x, _show(list_quantities(self.scenario)[one.name]))
            for one, x in zip(self.objective.parameters, self.fit.x, strict=True)
            if min(abs(one.size * x - one.low), abs(one.size * x - one.high)) <= 1e-6 * one.size
        }
        bounded = [
            f"{name} ends at its bound {end}, beyond which the data pull it: its interval does not hold; "
            "widen the bound, or look for what data or model lack"
            for name, end in ends.items()
        ]
        doubt = find_doubt(self.objective, self.fit, self.ends)
        hidden = [one.text for one in self.fit.unseen if not one.shares.keys() <= ends.keys()]
        return [*bounded, *([doubt] if doubt else []), *hidden, *correlated]


def answer_fit(done: Calibration, answer: Answer) -> None:
    """The fitted parameters, what the signals show of them, and what they do not."""
    places = find_places(done.objective, done.fit.jacobian)
    table = Table(
        Column("parameter", no_wrap=True), "unit", "start", "fitted", "95 % interval", "+/- %",
        *(["seen best"] if any(places) else []),
        title=f"{done.scenario.name}: fitted parameters", title_justify="left", padding=0,
    )  # fmt: skip
    quantities, outputs = list_quantities(done.scenario), list_outputs(done.scenario)
    for row, place in zip(done.rows, places, strict=True):
        shown = _show(quantities[row.name])
        factor = shown.factor
        low, high = (format_number(factor * end) for end in (row.low, row.high))
        interval = f"{low} .. {high}" if row.identified else "not identified"
        share = (
            format_number(50.0 * (row.high - row.low) / abs(row.fitted), 2)
            if row.fitted and row.identified
            else "–"
        )
        start, fitted = format_number(factor * row.start), format_number(factor * row.fitted, 6)
        table.add_row(row.name, shown.text, start, fitted, interval, share, *filter(None, [place]))
    answer.table(table)
    for signal, noise, one in _list_signals(done):
        unit = _show(outputs[signal.variable])
        more = f", gain {format_number(one.gain)}" * signal.gain
        more += f", offset {say(one.offset, unit)}" * signal.offset
        level = "" if signal.noise else " (estimated)"
        more = f"{level}, residual {format_number(one.size, 3)} of it{more}"
        answer.line(f"{signal.column}: noise {say(noise, unit)}{more}")
    for note in done.notes:
        answer.line(note)
    if len(done.ends) > 1:
        answer.line(f"residuals over the noise by start: {', '.join(format_number(e) for e in done.ends)}")


def _show(quantity: Quantity) -> Shown:
    """In tables and figures, and in the fitted scenario."""
    return show_unit(quantity.unit, "N/mm") if show(quantity).unit == "N/m" else show(quantity)


def _list_signals(done: Calibration) -> list[tuple[Any, float, Any]]:
    objective = done.objective
    found = objective.eliminate(done.fit.x)
    return list(zip(objective.measured.signals, objective.noises, found, strict=True))


def build_dataset(done: Calibration) -> xarray.Dataset:
    """Over `parameter`: start, fitted, low and high end, deviation; the correlation of each with `other`."""
    rows = done.rows
    columns = {
        name: ("parameter", [getattr(row, name) for row in rows])
        for name in ("unit", "start", "fitted", "low", "high", "deviation", "identified")
    }
    names = [row.name for row in rows]
    return xarray.Dataset(
        {**columns, "correlation": (("parameter", "other"), done.fit.correlation)},
        {"parameter": names, "other": names},
        {"notes": done.notes, "misfit": done.fit.misfit},
    )


def write(done: Calibration, extends: str, out: Path) -> list[str]:
    """All files of the results."""
    rows = done.rows
    hidden = (row.name for row in rows if not row.identified)
    doubts = (f"# {name}: not identified, its value alone says nothing\n" for name in hidden)
    (out / FITTED).write_text("".join(doubts) + _write_scenario(done, extends, out), "utf-8")
    write_rows(out / TABLE, [Row._fields, *rows])
    about = {
        "scenario": done.scenario.name,
        "version": metadata.version("tribocosim"),
        "misfit": done.fit.misfit,
        "starts": list(done.ends),
        "parameters": [row._asdict() for row in rows],
        "correlation": done.fit.correlation.tolist(),
        "signals": [
            {
                "column": signal.column, "variable": signal.variable, "noise": noise,
                "gain": one.gain, "offset": one.offset,
            }
            for signal, noise, one in _list_signals(done)
        ],
        "notes": done.notes,
    }  # fmt: skip
    (out / NUMBERS).write_text(json.dumps(to_plain(about), indent=1) + "\n", "utf-8")
    panels = _list_panels(done)
    signals = (
        [one.signal, one.unit, "" if one.speed is None else one.speed, *row]
        for one in panels
        for row in zip(one.positions, one.data, one.model, strict=True)
    )
    head = ["signal", "unit", "speed [rad/s]", "position [rad or s]", "measured", "model"]
    write_rows(out / SIGNALS, [head, *signals])
    name = done.scenario.name
    save_figure(lambda: draw_calibration(panels, f"{name}: measured signals and fitted model"), out / FIGURE)
    ends = np.array([[row.low, row.high] for row in rows]) / np.array([[row.fitted or 1.0] for row in rows])
    draw = partial(draw_parameters, [row.name for row in rows], ends, done.fit.correlation)
    save_figure(lambda: draw(f"{name}: fitted parameters"), out / INTERVALS)
    return [FITTED, TABLE, NUMBERS, SIGNALS, FIGURE, INTERVALS]


def _write_scenario(done: Calibration, extends: str, out: Path) -> str:
    values = {row.name: row.written if " " in row.written else row.fitted for row in done.rows}
    if not extends:
        return to_short_toml(done.scenario, out.resolve(), values)
    if Path(extends).suffix:
        extends = Path(os.path.relpath(Path(extends).resolve(), out.resolve())).as_posix()
    tables: dict[str, Any] = {}
    for name, value in values.items():
        component, _, parameter = name.partition(".")
        tables.setdefault(component, {"parameters": {}})["parameters"][parameter] = value
    head = {"extends": extends, "description": f"{done.scenario.name}, calibrated"}
    return tomli_w.dumps({**head, "components": tables})


def _list_panels(done: Calibration) -> list[Panel]:
    objective, found = done.objective, []
    predicted = objective.predict(done.fit.x)
    outputs = list_outputs(done.scenario)
    for i, (signal, _, one) in enumerate(_list_signals(done)):
        quantity = outputs[signal.variable]
        for experiment, model in zip(objective.measured.experiments, predicted, strict=True):
            seen = np.isfinite(experiment.values[i])
            order = np.argsort(experiment.positions[seen], kind="stable")

            def take(values: Vector, seen: Any = seen, order: Any = order) -> Vector:
                return np.asarray(values[seen][order])

            line = one.gain * model.signals[i] + one.offset
            found.append(
                Panel(
                    signal.column, quantity.unit, _show(quantity), experiment.speed, experiment.shaft,
                    take(experiment.positions), take(experiment.values[i]), take(line),
                )
            )  # fmt: skip
    return found
