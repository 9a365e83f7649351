"""Intervals of ten parameters of a pushrod train, fitted to noisy lift and force at four speeds."""

import math
import sqlite3
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from models.core.quantities import Vector
from orchestrator.scenario.files import load
from orchestrator.scenario.system import list_parameters
from orchestrator.study.calibration.fit import fit, half_width
from orchestrator.study.calibration.measured import Experiment, Measured, Signal
from orchestrator.study.calibration.models import Prediction, make_model
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
# Trials begin at these multiples of the truth.
STARTS = [0.93, 1.3, 0.9, 1.08, 1.05, 0.98, 1.3, 1.05, 0.93, 0.85]


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


@dataclass(frozen=True)
class Linear:
    """Predictions by values and derivatives at the truth, where all parameters are 1."""

    base: Sequence[np.ndarray]
    slopes: Sequence[np.ndarray]
    units = {one.variable: "" for one in SIGNALS}  # noqa: RUF012
    outputs = tuple(one.variable for one in SIGNALS)

    @property
    def model(self) -> "Linear":
        return self

    def make(self, requests: Sequence[Any], show: Any = None) -> list[Prediction]:
        found = []
        for one in requests:
            beside = np.array([value for _, value in one.values]) - 1.0
            rows = self.base[one.experiment] + self.slopes[one.experiment] @ beside
            found.append(Prediction(rows, rows[:, :1], np.zeros(0)))
        return found


def count_held(model: Linear, draw: Callable[[], Measured], trials: int) -> tuple[np.ndarray, np.ndarray]:
    """How often the interval of each parameter holds the truth, and the errors (trials, parameters)."""
    held, errors = 0, []
    for _ in range(trials):
        measured = draw()
        every = [Fitted(name, "1", 1.0) for name in PARAMETERS][: model.slopes[0].shape[-1]]
        objective = Objective(every, measured, model, SilentReporter())  # type: ignore[arg-type]
        found = fit(objective, np.array(STARTS)[: len(every)])
        # Of so many numbers Student's t is normal; with given noises it is by itself.
        held = held + (np.abs(found.x - 1.0) <= half_width(10**9) * found.deviations)
        errors.append(found.x - 1.0)
    return np.asarray(held), np.array(errors)


def test_intervals_of_95_per_cent_hold_in_so_many_trials():
    """Of a hundred trials at least 90: fewer have a probability of 1 % for one parameter. The noises are
    given here; the zero is eliminated."""
    generator, base = np.random.default_rng(8), [np.zeros((2, 25))]
    slopes = NOISES[:, None, None] * generator.normal(0.0, 20.0, (2, 25, 3))
    known = tuple(replace(one, noise=float(noise)) for one, noise in zip(SIGNALS, NOISES, strict=True))
    held, _ = count_held(
        Linear(base, [slopes]), lambda: replace(measure(base, generator), signals=known), 100
    )
    assert (held >= 90).all(), held


@pytest.mark.long
def test_intervals_of_a_pushrod_train_hold_in_90_of_100_trials_around_the_truth():
    """By the derivatives of its cycles at the truth; errors stay below 2 %."""
    base = predict_truth()
    slopes = open_objective(measure(base, np.random.default_rng(0))).find_slopes(np.ones(len(PARAMETERS)))
    generator = np.random.default_rng(5)
    held, errors = count_held(Linear(base, slopes), lambda: measure(base, generator), 100)
    assert (held >= 90).all(), held
    assert np.abs(errors).max() < 0.02
