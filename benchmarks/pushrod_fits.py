"""`python -m benchmarks.pushrod_fits FILE [COUNT]`: fits of ten parameters of a pushrod train.

Lift and force at four speeds have the noise of sensors; every fit begins at the same wrong values. A line of
JSON for each trial goes to FILE, where a later call goes on; the table is that of all its lines: how often
the intervals of 95 % hold the truth, the largest error, and the processor time.
"""

import json
import math
import sqlite3
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from models.core.quantities import Vector
from orchestrator.reporter import Reporter
from orchestrator.scenario.files import load
from orchestrator.scenario.system import list_parameters
from orchestrator.study.calibration.fit import Fit, fit, half_width
from orchestrator.study.calibration.measured import Experiment, Measured, Signal
from orchestrator.study.calibration.models import make_model
from orchestrator.study.calibration.objective import Objective
from orchestrator.study.calibration.parameters import LEAST, Fitted
from orchestrator.study.calibration.predictions import Predictions
from tribocosim.cached_fmus import build_fmu

# Speeds at which cycles repeat: at 1600 r/min a change of the lash shows five times as much as at others, at
# 2300 r/min ten parameters by 1 % each change the signals otherwise than derivatives say. The valve closes,
# and what its opening made ring is over; a lift sensor with 2 um of noise and an unknown zero, a load cell
# with 2 N, as the mean of some fifty cycles has.
SPEEDS, ANGLES = (1800.0, 2000.0, 2100.0, 2200.0), np.arange(210.0, 255.25, 0.25)
NOISES, ZERO = np.array([2e-6, 2.0]), 5e-5
SIGNALS = Signal("lift", "valve_spring.valve_lift", offset=True), Signal("force", "pushrod.lower_force")
PARAMETERS = (
    "pushrod.youngs_modulus", "pushrod.damping_time", "rocker.inertia", "valve_spring.valve_mass",
    "valve_spring.spring_rate", "valve_spring.surge_frequency", "valve_spring.damping_ratio",
    "valve_spring.preload", "valve_spring.lash", "valve_spring.seat_stiffness",
)  # fmt: skip
# Trials begin at these multiples of the truth.
STARTS = np.array([0.93, 1.3, 0.9, 1.08, 1.05, 0.98, 1.3, 1.05, 0.93, 0.85])


def add_noise(base: Sequence[Vector], generator: np.random.Generator) -> Measured:
    """The signals at every speed with the noise, and the zero of the lift."""
    experiments = []
    for speed, rows in zip(SPEEDS, base, strict=False):
        values = rows + NOISES[:, None] * generator.normal(size=rows.shape)
        values[0] += ZERO
        place = np.radians(ANGLES[: rows.shape[1]])
        experiments.append(Experiment(speed * math.pi / 30.0, "cam_angle", place, values))
    return Measured(SIGNALS, tuple(experiments))


def open_objective(measured: Measured, reporter: Reporter) -> Objective:
    """Of the train, whose parameters over their sizes are 1 in truth."""
    scenario = load("pushrod-train")
    model, values = make_model(scenario, measured, PARAMETERS, build_fmu), list_parameters(scenario)
    parameters = [
        Fitted(name, "", float(values[name]), low=LEAST * float(values[name])) for name in PARAMETERS
    ]
    predictions = Predictions(model, measured.experiments, sqlite3.connect(":memory:"))
    return Objective(parameters, measured, predictions, reporter)


def predict_truth(reporter: Reporter) -> list[Vector]:
    """The signals (signals, positions) at each speed without noise."""
    empty = add_noise([np.zeros((2, ANGLES.size))] * len(SPEEDS), np.random.default_rng(0))
    return [one.signals for one in open_objective(empty, reporter).predict(np.ones(len(PARAMETERS)))]


def hold(found: Fit) -> Vector:
    """Whether the interval of each parameter holds the truth. Of so many numbers Student's t is normal."""
    return np.asarray(np.abs(found.x - 1.0) <= half_width(10**9) * found.deviations)


def main(file: Path, count: int) -> None:
    reporter = Reporter()
    base = predict_truth(reporter)
    lines = file.read_text("utf-8").splitlines() if file.exists() else []
    for seed in range(len(lines), len(lines) + count):
        begun = time.process_time()
        objective = open_objective(add_noise(base, np.random.default_rng(seed)), reporter)
        found = fit(objective, STARTS)
        line = json.dumps({
            "seed": seed, "seconds": time.process_time() - begun, "misfit": found.misfit,
            "predictions": objective.made, "errors": (found.x - 1.0).tolist(),
            "deviations": found.deviations.tolist(), "held": hold(found).tolist(),
            "unseen": [one.text for one in found.unseen],
        })  # fmt: skip
        with file.open("a", encoding="utf-8") as out:
            out.write(line + "\n")
        lines.append(line)
    trials = [json.loads(line) for line in lines]
    print("| parameter | held | largest error % |\n|---|---|---|")
    for k, name in enumerate(PARAMETERS):
        held, worst = (f([one[key][k] for one in trials]) for f, key in ((sum, "held"), (_worst, "errors")))
        print(f"| {name} | {held} of {len(trials)} | {100.0 * worst:.2g} |")
    seconds = [one["seconds"] for one in trials]
    print(f"processor time a fit: median {np.median(seconds):.0f} s, at most {max(seconds):.0f} s")


def _worst(values: Sequence[float]) -> float:
    return max(map(abs, values))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 100)
