"""Intervals of ten parameters of a pushrod train, fitted to noisy lift and forces at four speeds."""

import re
import sqlite3
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from benchmarks.pushrod_fits import (
    ANGLES,
    NOISES,
    PARAMETERS,
    SIGNALS,
    STARTS,
    add_noise,
    hold,
    open_objective,
    predict_truth,
    step,
)  # fmt: skip
from orchestrator.scenario.display import show_unit
from orchestrator.study.calibration.doubts import find_doubt
from orchestrator.study.calibration.fit import fit, half_width
from orchestrator.study.calibration.measured import Measured, Signal
from orchestrator.study.calibration.models import Prediction
from orchestrator.study.calibration.objective import Objective
from orchestrator.study.calibration.parameters import Fitted
from tribocosim.reporting import SilentReporter

from .test_calibration import TIMES, Formula, objective_of


@dataclass(frozen=True)
class Linear:
    """Predictions by values and derivatives at the truth, where all parameters are 1."""

    base: Sequence[np.ndarray]
    slopes: Sequence[np.ndarray]
    shown = {one.variable: show_unit("1") for one in SIGNALS}  # noqa: RUF012
    outputs = tuple(one.variable for one in SIGNALS)

    @property
    def model(self) -> "Linear":
        return self

    def make(self, requests: Sequence[Any], show: Any = None) -> list[Prediction]:
        found = []
        for one in requests:
            beside = np.array([value for _, value in one.values]) - 1.0
            rows = self.base[one.experiment] + self.slopes[one.experiment] @ beside
            asked = rows if one.task == "predict" else self.slopes[one.experiment]
            found.append(Prediction(asked, asked[:, :1], asked[0, :0]))
        return found


@dataclass(frozen=True)
class Rattling(Linear):
    """With a ripple of a twentieth of the noise, whose derivative is five times that of the rest."""

    def make(self, requests: Sequence[Any], show: Any = None) -> list[Prediction]:
        wave, found = 100.0 * self.slopes[0][:, ::-1] / NOISES[:, None, None], []
        for one, smooth in zip(requests, super().make(requests), strict=True):
            phase = wave @ (np.array([value for _, value in one.values]) - 1.0)
            ripple = np.sin(phase) if one.task == "predict" else np.cos(phase)[..., None] * wave
            size = 0.05 * NOISES.reshape(-1, *[1] * (ripple.ndim - 1))
            found.append(replace(smooth, signals=smooth.signals + size * ripple))
        return found


# Without a part along the times.
WAVE = np.sin(40.0 * TIMES) - TIMES * (np.sin(40.0 * TIMES) @ TIMES) / (TIMES @ TIMES)
# Part of a change of 0.5 % that derivatives may miss: 0.01 to 0.13 at these speeds.
BENT = 0.2


def count_held(model: Linear, draw: Callable[[], Measured], trials: int) -> tuple[np.ndarray, np.ndarray]:
    """How often the interval of each parameter holds the truth, and the errors (trials, parameters)."""
    held, errors = 0, []
    for _ in range(trials):
        measured = draw()
        every = [Fitted(name, "1", 1.0) for name in PARAMETERS][: model.slopes[0].shape[-1]]
        objective = Objective(every, measured, model, SilentReporter())  # type: ignore[arg-type]
        found = fit(objective, STARTS[: len(every)])
        held = held + hold(found.x, found.deviations)
        errors.append(found.x - 1.0)
    return np.asarray(held), np.array(errors)


def count_of_three(kind: type[Linear], trials: int) -> tuple[np.ndarray, np.ndarray]:
    """`count_held` of three parameters in one experiment, with noises that are given."""
    generator, base = np.random.default_rng(8), [np.zeros((NOISES.size, 25))]
    slopes = NOISES[:, None, None] * generator.normal(0.0, 20.0, (NOISES.size, 25, 3))
    known = tuple(replace(one, noise=float(noise)) for one, noise in zip(SIGNALS, NOISES, strict=True))
    return count_held(
        kind(base, [slopes]), lambda: replace(add_noise(base, generator), signals=known), trials
    )


def test_intervals_of_95_per_cent_hold_in_so_many_trials():
    """Of two hundred trials at least 180: fewer have a probability of 0.1 % for one parameter. The noises are
    given here; the zero is eliminated."""
    held, _ = count_of_three(Linear, 200)
    assert (held >= 180).all(), held


def test_a_ripple_below_the_noise_does_not_mislead_a_fit():
    """Tangents alone lead up to 24 % away from the truth; with differences it is as near as without."""
    (_, smooth), (_, errors) = (count_of_three(kind, 30) for kind in (Linear, Rattling))
    assert np.sqrt(np.mean(errors**2)) < 1.2 * np.sqrt(np.mean(smooth**2))
    assert np.abs(errors).max() < 0.03


@pytest.mark.parametrize(
    ("bend", "shape", "doubted"),
    [(0.0, TIMES, False), (200.0, TIMES, True), (80.0, WAVE, False), (80.0, TIMES, True)],
)
def test_a_fit_whose_derivatives_mislead_it_over_a_deviation_is_doubted(bend, shape, doubted):
    """Of a slope known to 0.2/(200 x 4/3)^0.5 = 0.012. Beside it a bend of 80 along the slope moves the slope
    by 80 x 0.012 = 0.98 of a deviation; across the slope it changes the signal by more than half as much, and
    the slope not at all."""
    model = Formula(lambda t, a: {"y.y": t * a + bend * (a - 1.0) ** 2 * shape}, {"y.y": "1"})
    objective = objective_of(model, TIMES, [Fitted("a.a", "1", 1.0)], Signal("y", "y.y", noise=0.2))
    doubt = find_doubt(objective, fit(objective, np.ones(1)), [1.0])
    assert ("derivatives miss" in doubt) == doubted
    if (bend, doubted) == (80.0, True):  # the other side misses less by the 0.08 of one-sided differences
        (said,) = re.findall("derivatives miss (.*) of a standard deviation of a.a", doubt)
        assert 0.85 < float(said) < 1.2


def test_differences_stay_between_narrow_bounds():
    """Of a length of 2 %, where 0.1 % is allowed; those of a linear model are exact."""
    tried = []
    model = Formula(lambda t, a: tried.append(a) or {"y.y": t * a}, {"y.y": "1"})
    objective = objective_of(model, TIMES, [Fitted("a.a", "1", 1.0, low=0.9995, high=1.0005)])
    objective._spans = np.array([0.02])
    for x, side in ((x, side) for x in (0.9995, 1.0, 1.0005) for side in (-1.0, 1.0)):
        (found,) = objective._difference(np.array([x]), side)
        assert found.signals[0, :, 0] == pytest.approx(TIMES, abs=1e-9)
    assert 0.9995 <= min(tried) < max(tried) <= 1.0005


@pytest.fixture(scope="module")
def train() -> tuple[list[np.ndarray], Callable[[int], Objective]]:
    """The signals at the truth, and the objective of a trial; cycles at the truth are found once."""
    kept = sqlite3.connect(":memory:")
    base = predict_truth(SilentReporter(), kept)

    def open_trial(seed: int) -> Objective:
        return open_objective(add_noise(base, np.random.default_rng(seed)), SilentReporter(), kept)

    return base, open_trial


@pytest.mark.long
def test_a_measurement_is_planned_so_that_derivatives_say_how_signals_change(train):
    """Where the rod rings they miss up to eleven times the change, and no fit can follow. Ten parameters
    change together by 0.5 %, with signs of chance; signals are compared until the valve closes."""
    base, open_trial = train
    objective, ones = open_trial(0), np.ones(len(PARAMETERS))
    slopes, generator = objective.find_slopes(ones), np.random.default_rng(4)
    for _ in range(2):
        change = 0.005 * generator.choice([-1.0, 1.0], ones.size)
        for one, before, slope in zip(objective.predict(ones + change), base, slopes, strict=True):
            moved = ((one.signals - before) / NOISES[:, None])[:, ANGLES < 240.0]
            said = (slope @ change / NOISES[:, None])[:, ANGLES < 240.0]
            assert np.linalg.norm(moved - said) < BENT * np.linalg.norm(moved)


@pytest.mark.long
def test_intervals_of_a_pushrod_train_hold_in_90_of_100_trials_around_the_truth(train):
    """By the derivatives of its cycles at the truth, in 400 trials: of 100 alone one of ten parameters falls
    below 90 in one case of ten by chance. Errors stay below 2 %."""
    base, open_trial = train
    slopes = open_trial(0).find_slopes(np.ones(len(PARAMETERS)))
    generator = np.random.default_rng(5)
    held, errors = count_held(Linear(base, slopes), lambda: add_noise(base, generator), 400)
    assert (held >= 360).all(), held
    assert np.abs(errors).max() < 0.02


@pytest.mark.long
def test_residuals_of_cycles_near_the_truth_lead_where_derivatives_do(train):
    """A second step of Gauss and Newton, from the cycles where the first one ended, is part of a deviation:
    trials by derivatives are trials of the train."""
    _, open_trial = train
    for seed in range(3):
        x, deviations, left = step(open_trial(seed))
        assert left < 0.5
        assert (half_width(10**9) * deviations < 0.02).all()
        assert np.abs(x - 1.0).max() < 0.02


@pytest.mark.long
def test_a_fit_finds_ten_parameters_of_a_pushrod_train(train):
    """From 2 to 30 % off all come within 2 %, and to where steps from the truth lead within a
    deviation."""
    _, open_trial = train
    objective = open_trial(0)
    found = fit(objective, STARTS)
    assert np.abs(found.x - 1.0).max() < 0.02
    assert not find_doubt(objective, found, [found.misfit])
    x, deviations, _ = step(open_trial(0))
    assert (np.abs(found.x - x) < deviations).all()
