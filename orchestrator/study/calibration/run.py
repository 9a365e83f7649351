"""`tribocosim calibrate`: reads the data, fits, and leaves table, scenario and figure in a folder."""

import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from models.core.quantities import Vector
from models.core.words import tally

from ...analyses._evaluate import create_folder, find_results
from ...assessment.notices import list_notices
from ...errors import MistakeError, Option, RunError
from ...report.answer import Answer
from ...reporter import Reporter, tell_interruption
from ...scenario import build_scenario
from ...scenario.system import Builder, list_outputs
from ...store.output_folder import PRINTED
from ..run import Where
from .fit import Fit, fit, profile
from .measured import read_measured
from .models import make_model
from .objective import Objective
from .parameters import choose, list_starts
from .predictions import FILE, Predictions
from .report import FITTED, PAGE, SIGNALS, Calibration, answer_fit, build_dataset, write


@dataclass(frozen=True)
class Asked:
    """The parameters "component.name", their bounds, and the signals, as options state them; from how many
    starts, and the parameters whose intervals are profiles of the likelihood."""

    parameters: Sequence[str]
    bounds: Sequence[str] = ()
    signals: Sequence[str] = ()
    starts: int = 1
    profiles: Sequence[str] = ()


@dataclass(frozen=True)
class Source:
    """The tables of a scenario, and the file or name that a fitted one may extend ("": it has all tables)."""

    tables: Mapping[str, Any]
    extends: str = ""


def calibrate(
    source: Source, data: Sequence[Path], asked: Asked, out: Path, where: Where, build: Builder,
    reporter: Reporter, overwrite: bool = False,
) -> xarray.Dataset:  # fmt: skip
    """The fitted parameters with their intervals; `out` has the results and what was computed for them.

    MistakeError before anything is written.
    """
    scenario = build_scenario(source.tables)
    parameters = choose(scenario, asked.parameters, asked.bounds)
    profiled = _find_profiled([one.name for one in parameters], asked.profiles)
    measured, notes = read_measured(data, list_outputs(scenario), asked.signals)
    unknowns = len(parameters) + measured.unknowns
    if measured.count <= unknowns:
        raise MistakeError(
            f"{tally(measured.count, 'measured number')} cannot give {tally(unknowns, 'unknown')} "
            "(parameters, offsets, gains); fit fewer"
        )
    model = make_model(scenario, measured, [one.name for one in parameters], build)
    held = find_results(out, "calibration", overwrite, "calibration.json", FITTED, SIGNALS)
    reporter.notice([*list_notices(scenario), *notes])
    others = any(table.third_party for table in scenario.components.values())
    with (
        create_folder(out),
        reporter.keep_prints(out / PRINTED) if others else nullcontext(),
        closing(sqlite3.connect(out / FILE)) as file,
        _open_workers(where) as client,
        tell_interruption(lambda: f"what was computed is kept in {out / FILE}: the same command continues"),
    ):
        predictions = Predictions(model, measured.experiments, file, client)
        places = len(measured.experiments)
        reporter.line(
            f"{tally(measured.count, 'number')} of {tally(len(measured.signals), 'signal')} in "
            f"{tally(places, 'cycle' if measured.experiments[0].speed else 'run')}; differences take "
            f"{places * len(parameters)} of them"
        )
        objective = Objective(parameters, measured, predictions, reporter)
        with reporter.stage(f"fit of {tally(len(parameters), 'parameter')}"):
            best, ends = _fit_from(objective, asked.starts, reporter)
            limits = profile(objective, best, profiled) if profiled else {}
        done = Calibration(scenario, objective, best, ends, limits)
        for path in held:
            path.unlink()
        answer = Answer(f"{scenario.name}: calibration", reporter)
        answer_fit(done, answer)
        answer.write(out, PAGE, write(done, source.extends, out))
    return build_dataset(done)


def _fit_from(objective: Objective, count: int, reporter: Reporter) -> tuple[Fit, list[float]]:
    """The likeliest fit of all starts, and the residual of each over the noise of that fit (root mean
    square)."""
    found: list[Fit] = []
    squares: list[Vector] = []
    for number, start in enumerate(list_starts(objective.parameters, count), 1):
        if count > 1:
            reporter.line(f"start {number} of {count}")
        objective.refresh()
        try:
            one = fit(objective, start)
        except RunError as error:
            if number == 1:
                raise
            reporter.line(str(error))
            continue
        found.append(one)
        squares.append(objective.sum_squares(one.x))
    which = int(np.argmin([objective.find_unlikelihood(one) for one in squares]))
    best = found[which]
    if best is not found[-1]:  # its derivatives and noises again, from the file
        objective.refresh()
        best = fit(objective, best.x)
    noises = np.square(objective.noises)
    return best, [float(np.sqrt(np.sum(one / noises) / objective.measured.count)) for one in squares]


def _find_profiled(names: Sequence[str], wanted: Sequence[str]) -> list[int]:
    every = [part.strip() for text in wanted for part in text.split(",") if part.strip()]
    for name in every:
        if name not in names and name != "all":
            raise MistakeError((Option("profile", name), f": must be all, or one of {', '.join(names)}"))
    return [k for k, name in enumerate(names) if name in every or "all" in every]


@contextmanager
def _open_workers(where: Where) -> Iterator[Any]:
    """A client of the processes that compute; None for this process."""
    if where.workers == 1 and where.scheduler is None:
        yield None
        return
    from ..cluster import connect

    with connect(where.scheduler, where.workers, where.timeout) as client:
        yield client
