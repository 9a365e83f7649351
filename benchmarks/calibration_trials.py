"""Fits of ten parameters of the pushrod train to noisy lift and force at four speeds, from random starts.

`python -m benchmarks.calibration_trials FILE [FIRST COUNT]` appends a line for each trial to FILE and skips
those that it has; the last line it prints is what all of them show.
"""

import json
import math
import sqlite3
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from models.core.quantities import Vector
from orchestrator.scenario.files import load
from orchestrator.scenario.system import list_parameters
from orchestrator.study.calibration.fit import fit, half_width
from orchestrator.study.calibration.measured import Experiment, Measured, Signal
from orchestrator.study.calibration.models import make_model
from orchestrator.study.calibration.objective import Objective
from orchestrator.study.calibration.parameters import LEAST, Fitted
from orchestrator.study.calibration.predictions import Predictions
from tribocosim.cached_fmus import build_fmu
from tribocosim.reporting import SilentReporter

# The valve is open; a lift sensor with 2 um of noise and an unknown zero, a load cell with 2 N, as the mean
# of some fifty cycles has.
SPEEDS, ANGLES = (1400.0, 1600.0, 1800.0, 2000.0), np.arange(140.0, 260.5, 0.5)
NOISES, ZERO = np.array([2e-6, 2.0]), 5e-5
SIGNALS = Signal("lift", "valve_spring.valve_lift", offset=True), Signal("force", "pushrod.lower_force")
PARAMETERS = (
    "pushrod.youngs_modulus", "pushrod.damping_time", "rocker.inertia", "valve_spring.valve_mass",
    "valve_spring.spring_rate", "valve_spring.surge_frequency", "valve_spring.damping_ratio",
    "valve_spring.preload", "valve_spring.lash", "valve_spring.seat_stiffness",
)  # fmt: skip
# Of a start, from the truth; chi-squared of a fit that reaches the noise: of 964 numbers it is within 15 %.
FAR, NOISY = 0.3, 1.15


def measure(base: Sequence[Vector], generator: np.random.Generator) -> Measured:
    """The signals at every speed with the noise, and the zero of the lift."""
    experiments = []
    for speed, rows in zip(SPEEDS, base, strict=False):
        values = rows + NOISES[:, None] * generator.normal(size=rows.shape)
        values[0] += ZERO
        place = np.radians(ANGLES[: rows.shape[1]])
        experiments.append(Experiment(speed * math.pi / 30.0, "cam_angle", place, values))
    return Measured(SIGNALS, tuple(experiments))


def open_objective(measured: Measured) -> Objective:
    """Of the train, whose parameters over their sizes are 1 in truth."""
    scenario = load("pushrod-train")
    model, values = make_model(scenario, measured, PARAMETERS, build_fmu), list_parameters(scenario)
    parameters = [
        Fitted(name, "", float(values[name]), low=LEAST * float(values[name])) for name in PARAMETERS
    ]
    predictions = Predictions(model, measured.experiments, sqlite3.connect(":memory:"))
    return Objective(parameters, measured, predictions, SilentReporter())


def predict_truth() -> list[Vector]:
    """The signals (signals, positions) at each speed without noise."""
    empty = measure([np.zeros((2, ANGLES.size))] * len(SPEEDS), np.random.default_rng(0))
    return [one.signals for one in open_objective(empty).predict(np.ones(len(PARAMETERS)))]


class Trial(NamedTuple):
    """Parameters over their truth, chi-squared of each signal per number, and seconds of processor time."""

    number: int
    start: list[float]
    found: list[float]
    deviations: list[float]
    chi2: list[float]
    seconds: float


def run_trial(number: int, base: Sequence[Vector]) -> Trial:
    generator = np.random.default_rng(number)
    measured = measure(base, generator)
    start = generator.uniform(1.0 - FAR, 1.0 + FAR, len(PARAMETERS))
    begun, objective = time.process_time(), open_objective(measured)
    found = fit(objective, start)
    count = [measured.pool(i).size for i in range(len(SIGNALS))]
    chi2 = objective.sum_squares(found.x) / NOISES**2 / count
    spent = time.process_time() - begun
    return Trial(number, start.tolist(), found.x.tolist(), found.deviations.tolist(), chi2.tolist(), spent)


def summarise(rows: Sequence[Trial]) -> str:
    reached = [row for row in rows if max(row.chi2) < NOISY]
    errors = np.array([np.array(row.found) - 1.0 for row in reached])
    widths = half_width(10**9) * np.array([row.deviations for row in reached])
    held = np.sum(np.abs(errors) <= widths, axis=0) if reached else np.zeros(0)
    return (
        f"{len(reached)} of {len(rows)} reach the noise; errors up to "
        f"{100.0 * np.abs(errors).max(initial=0.0):.2g} %; intervals hold in {held.tolist()}; "
        f"{np.median([row.seconds for row in rows]):.0f} s of processor time (median)"
    )


def main() -> None:
    file = Path(sys.argv[1])
    first, count = (int(sys.argv[2]), int(sys.argv[3])) if len(sys.argv) > 2 else (0, 100)
    base = predict_truth()
    lines = file.read_text("utf-8").splitlines() if file.exists() else []
    rows = [Trial(*json.loads(line)) for line in lines]
    for number in range(first, first + count):
        if number not in [row.number for row in rows]:
            rows.append(run_trial(number, base))
            with file.open("a", encoding="utf-8") as kept:
                kept.write(json.dumps(rows[-1]) + "\n")
        print(summarise(rows), flush=True)


if __name__ == "__main__":
    main()
