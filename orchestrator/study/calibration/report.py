"""What a calibration leaves: table, fitted scenario, and figure."""

import csv
import json
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
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
from ...reporter import Reporter
from ...scenario import Scenario, build_scenario
from ...scenario.display import format_number, show, show_unit
from ...scenario.files import put, to_short_toml
from ...scenario.system import list_quantities
from .fit import Fit, half_width
from .objective import Objective
from .unseen import list_correlated

TABLE, NUMBERS, FITTED = "calibration.csv", "calibration.json", "calibrated.toml"
# A residual over the given noise above this is told.
MISFIT = 1.5
SIGNALS, FIGURE, INTERVALS = "calibration-signals.csv", "calibration.png", "calibration-parameters.png"


class Row(NamedTuple):
    """A parameter: its start, and the fitted value with its 95 % interval, in its unit; whether the signals
    show it."""

    name: str
    unit: str
    start: float
    fitted: float
    low: float
    high: float
    deviation: float
    identified: bool


@dataclass(frozen=True)
class Calibration:
    """A fit, the residual over the noise that each start came to, and intervals by profiles."""

    scenario: Scenario
    objective: Objective
    fit: Fit
    ends: Sequence[float]
    profiles: dict[str, tuple[float, float]]

    @property
    def rows(self) -> list[Row]:
        measured, hidden = self.objective.measured, {name for one in self.fit.unseen for name in one.shares}
        unknowns = len(self.objective.parameters) + sum(signal.unknowns for signal in measured.signals)
        given = all(signal.noise for signal in measured.signals)
        width = half_width(10**9 if given else measured.count - unknowns)
        found = []
        for one, x, deviation in zip(self.objective.parameters, self.fit.x, self.fit.deviations, strict=True):
            value, spread = one.size * float(x), one.size * float(deviation)
            low, high = self.profiles.get(one.name, (value - width * spread, value + width * spread))
            seen = one.name not in hidden
            if not seen:
                low, high, spread = math.nan, math.nan, math.nan
            found.append(Row(one.name, one.unit, one.start, value, low, high, spread, seen))
        return found

    @property
    def notes(self) -> list[str]:
        names = [one.name for one in self.objective.parameters]
        correlated = [f"correlation of {text}" for text in list_correlated(names, self.fit.correlation)]
        bounded = [
            f"{one.name}: is at its bound {one.size * x:g} {one.unit}"
            for one, x in zip(self.objective.parameters, self.fit.x, strict=True)
            if min(abs(one.size * x - one.low), abs(one.size * x - one.high)) <= 1e-6 * one.size
        ]
        return [*(one.text for one in self.fit.unseen), *bounded, *self._list_misfits(), *correlated]

    def _list_misfits(self) -> list[str]:
        """Signals with a given noise that the model does not reach."""
        found = []
        for signal, _, one in _list_signals(self):
            times = float(np.sqrt(np.mean(one.residual**2)))
            if signal.noise and times > MISFIT:
                found.append(
                    f"{signal.column}: the residual is {times:.2g} times the noise that was given: the model "
                    "lacks something, or the fit was trapped; begin elsewhere, or from several starts"
                )
        return found


def print_table(done: Calibration, reporter: Reporter) -> None:
    shown = Table(
        Column("parameter", no_wrap=True), "unit", "start", "fitted", "95 % interval", "+/- %",
        title=f"{done.scenario.name}: fitted parameters", title_justify="left", padding=0,
    )  # fmt: skip
    quantities = list_quantities(done.scenario)
    for row in done.rows:
        factor, unit = _show(quantities[row.name])
        low, high = (format_number(factor * end) for end in (row.low, row.high))
        interval, share = f"{low} .. {high}", "–"
        if row.fitted:
            share = format_number(50.0 * (row.high - row.low) / abs(row.fitted), 2)
        if not row.identified:
            interval, share = "not identified", "–"
        start, fitted = format_number(factor * row.start), format_number(factor * row.fitted, 6)
        shown.add_row(row.name, unit, start, fitted, interval, share)
    reporter.console.print(shown)
    for signal, noise, one in _list_signals(done):
        component, _, output = signal.variable.partition(".")
        outputs = done.scenario.components[component].resolve().outputs.fields
        factor, unit = _show(next(one.quantity for one in outputs if one.name == output))
        more = f", gain {format_number(one.gain)}" * signal.gain
        more += f", offset {format_number(factor * one.offset)} {unit}" * signal.offset
        level = "" if signal.noise else " (estimated)"
        reporter.line(
            f"{signal.column}: noise {format_number(factor * noise, 3)} {unit}{level}, residual "
            f"{format_number(float(np.sqrt(np.mean(one.residual**2))), 3)} of it{more}"
        )
    for note in done.notes:
        reporter.line(note)
    if len(done.ends) > 1:
        reporter.line(f"residuals over the noise by start: {', '.join(format_number(e) for e in done.ends)}")


def _show(quantity: Quantity) -> tuple[float, str]:
    """The factor and the unit of a table."""
    shown = show(quantity)
    if shown.unit == "N/m":
        shown = show_unit(shown.unit, "N/mm")
    return shown.factor, shown.text


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


def write(done: Calibration, extends: str, out: Path) -> list[Path]:
    """All files of the results."""
    hidden = [
        f"# {row.name}: not identified, its value alone says nothing\n"
        for row in done.rows
        if not row.identified
    ]
    (out / FITTED).write_text("".join(hidden) + _write_scenario(done, extends, out), "utf-8")
    with (out / TABLE).open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(Row._fields)
        table.writerows(done.rows)
    about = {
        "scenario": done.scenario.name,
        "version": metadata.version("tribocosim"),
        "misfit": done.fit.misfit,
        "starts": list(done.ends),
        "parameters": [row._asdict() for row in done.rows],
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
    (out / NUMBERS).write_text(json.dumps(_finite(about), indent=1) + "\n", "utf-8")
    panels = _list_panels(done)
    with (out / SIGNALS).open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["signal", "unit", "speed [rad/s]", "position [rad or s]", "measured", "model"])
        for one in panels:
            for row in zip(one.positions, one.data, one.model, strict=True):
                table.writerow([one.signal, one.unit, "" if one.speed is None else one.speed, *row])
    title = f"{done.scenario.name}: measured signals and fitted model"
    save_figure(lambda: draw_calibration(panels, title), out / FIGURE)
    rows = done.rows
    ends = np.array([[row.low, row.high] for row in rows]) / np.array([[row.fitted or 1.0] for row in rows])
    names, title = [row.name for row in rows], f"{done.scenario.name}: fitted parameters"
    save_figure(lambda: draw_parameters(names, ends, done.fit.correlation, title), out / INTERVALS)
    return [out / name for name in (FITTED, TABLE, NUMBERS, SIGNALS, FIGURE, INTERVALS)]


def _finite(value: Any) -> Any:
    """JSON has no infinite numbers."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _write_scenario(done: Calibration, extends: str, out: Path) -> str:
    values = {f"components.{_path(row.name)}": row.fitted for row in done.rows}
    if not extends:
        tables = done.scenario.model_dump(exclude_defaults=True)
        for path, value in values.items():
            put(tables, path, value)
        return to_short_toml(build_scenario(tables), out.resolve())
    if Path(extends).suffix:
        extends = Path(os.path.relpath(Path(extends).resolve(), out.resolve())).as_posix()
    content: dict[str, Any] = {
        "extends": extends,
        "description": f"{done.scenario.name}, calibrated",
        "components": {},
    }
    for row in done.rows:
        component, _, parameter = row.name.partition(".")
        content["components"].setdefault(component, {"parameters": {}})["parameters"][parameter] = row.fitted
    return tomli_w.dumps(content)


def _path(name: str) -> str:
    component, _, parameter = name.partition(".")
    return f"{component}.parameters.{parameter}"


def _list_panels(done: Calibration) -> list[Panel]:
    objective, found = done.objective, []
    predicted = objective.predict(done.fit.x)
    for i, (signal, _, one) in enumerate(_list_signals(done)):
        unit = objective.units[signal.variable]
        for experiment, model in zip(objective.measured.experiments, predicted, strict=True):
            seen = np.isfinite(experiment.values[i])
            order = np.argsort(experiment.positions[seen], kind="stable")

            def take(values: Vector, seen: Any = seen, order: Any = order) -> Vector:
                return np.asarray(values[seen][order])

            line = one.gain * model.signals[i] + one.offset
            found.append(
                Panel(
                    signal.column, unit, experiment.speed, experiment.shaft, take(experiment.positions),
                    take(experiment.values[i]), take(line),
                )
            )  # fmt: skip
    return found
