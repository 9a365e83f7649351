"""`python -m benchmarks.pushrod_fits FILE [COUNT [step]]`: fits of ten parameters of a pushrod train.

Lift and two forces at four speeds have the noise of sensors; every fit begins at the same wrong values. With
`step`, one begins where the derivatives at the truth lead, and goes one step of Gauss and Newton from the
cycles there. A line of JSON for each trial goes to FILE, where a later call goes on; the table is that of all
its lines: how often the intervals of 95 % hold the truth, the largest error, and the processor time.
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
from orchestrator.study.calibration.fit import fit, half_width
from orchestrator.study.calibration.measured import Experiment, Measured, Signal
from orchestrator.study.calibration.models import make_model
from orchestrator.study.calibration.objective import Objective
from orchestrator.study.calibration.parameters import LEAST, Fitted
from orchestrator.study.calibration.predictions import Predictions
from orchestrator.study.calibration.unseen import invert
from tribocosim.cached_fmus import build_fmu

# From 200 deg on, what the opening of the valve made ring is over; derivatives hold at these speeds. The
# forces at both arms of the rocker tell its inertia from the mass of the valve. The lift sensor, with unknown
# zero, has a noise of 2 um, the load cells of 2 N; so many cycles are averaged.
SPEEDS, ANGLES, CYCLES = (600.0, 800.0, 1000.0, 1200.0), np.arange(200.0, 255.25, 0.25), 64
NOISES, ZERO = np.array([2e-6, 2.0, 2.0]) / math.sqrt(CYCLES), 5e-5
SIGNALS = (
    Signal("lift", "valve_spring.valve_lift", offset=True),
    Signal("rod", "pushrod.lower_force"),
    Signal("tip", "valve_contact.load"),
)
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


def open_objective(
    measured: Measured, reporter: Reporter, file: sqlite3.Connection | None = None
) -> Objective:
    """Of the train, whose parameters over their sizes are 1 in truth; predictions are kept in `file`."""
    scenario = load("pushrod-train")
    model, values = make_model(scenario, measured, PARAMETERS, build_fmu), list_parameters(scenario)
    parameters = [
        Fitted(name, "", float(values[name]), low=LEAST * float(values[name])) for name in PARAMETERS
    ]
    predictions = Predictions(model, measured.experiments, file or sqlite3.connect(":memory:"))
    return Objective(parameters, measured, predictions, reporter)


def predict_truth(reporter: Reporter, file: sqlite3.Connection | None = None) -> list[Vector]:
    """The signals (signals, positions) at each speed without noise."""
    empty = add_noise([np.zeros((len(SIGNALS), ANGLES.size))] * len(SPEEDS), np.random.default_rng(0))
    return [one.signals for one in open_objective(empty, reporter, file).predict(np.ones(len(PARAMETERS)))]


def step(objective: Objective) -> tuple[Vector, Vector, float]:
    """A fit in two steps of Gauss and Newton from the truth by its derivatives, of which the second knows the
    residual where the first ended; its deviations; the length of the second step, at most, in these."""
    x = np.ones(len(PARAMETERS))
    slopes = objective.find_slopes(x)
    steps = []
    for _ in range(2):
        objective.noises = objective.estimate_noises(x)
        jacobian = objective.jacobian_with(x, slopes)
        covariance = invert(jacobian)
        steps.append(-covariance @ jacobian.T @ objective.residual(x))
        x = x + steps[-1]
    deviations = np.sqrt(np.diag(covariance))
    return x, deviations, float(np.max(np.abs(steps[-1]) / deviations))


def hold(x: Vector, deviations: Vector) -> Vector:
    """Whether the interval of each parameter holds the truth. Of so many numbers Student's t is normal."""
    return np.asarray(np.abs(x - 1.0) <= half_width(10**9) * deviations)


def main(file: Path, count: int, steps: bool) -> None:
    reporter, kept = Reporter(), sqlite3.connect(":memory:")
    base = predict_truth(reporter, kept)
    lines = file.read_text("utf-8").splitlines() if file.exists() else []
    for seed in range(len(lines), len(lines) + count):
        begun = time.process_time()
        measured = add_noise(base, np.random.default_rng(seed))
        objective = open_objective(measured, reporter, kept if steps else None)
        if steps:
            x, deviations, left = step(objective)
        else:
            found = fit(objective, STARTS)
            x, deviations, left = found.x, found.deviations, 0.0
        line = json.dumps({
            "seed": seed, "seconds": time.process_time() - begun, "predictions": objective.made,
            "noises": objective.estimate_noises(x), "errors": (x - 1.0).tolist(), "last_step": left,
            "deviations": deviations.tolist(), "held": hold(x, deviations).tolist(),
        })  # fmt: skip
        with file.open("a", encoding="utf-8") as out:
            out.write(line + "\n")
        lines.append(line)
    trials = [json.loads(line) for line in lines]
    print("| parameter | held | largest error % | deviation % |\n|---|---|---|---|")
    for k, name in enumerate(PARAMETERS):
        held = sum(one["held"][k] for one in trials)
        worst, deviation = (
            100.0 * max(abs(one[key][k]) for one in trials) for key in ("errors", "deviations")
        )
        print(f"| {name} | {held} of {len(trials)} | {worst:.2g} | {deviation:.2g} |")
    seconds = [one["seconds"] for one in trials]
    print(f"processor time a fit: median {np.median(seconds):.0f} s, at most {max(seconds):.0f} s")


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 100, sys.argv[3:] == ["step"])
