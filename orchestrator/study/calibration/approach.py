"""From afar to where least squares find the answer: the slow part of the signals first.

Where a vibration of the model is more than half a period out of phase, every small step makes the residual
larger. So signals and model are smoothed over a window that narrows, as seismic waveforms are inverted
(Bunks, Saleck, Zaleski and Chavent 1995). Each step takes the residual that is left as the noise, and holds
what the smoothed signals do not show by a wide prior around the start.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from models.core.quantities import Vector

from .measured import Experiment
from .objective import Objective
from .signals import Eliminated, eliminate_all

# Standard deviations of the window, of the span of the positions; rows stand in this part of it.
WINDOWS, APART = (1 / 8, 1 / 20), 0.5
# Of the prior, and the longest step, of the parameters' logarithms.
PRIOR, LONGEST = 0.3, 0.3
# A level ends after so many steps, or where one promises or takes less than this part of the sum.
STEPS, ENOUGH = 6, 0.1
SHORTER = (1.0, 0.5, 0.2)


def approach(objective: Objective, start: Vector) -> Vector:
    """The parameters over their sizes, near the least squares; `start` where it is."""
    x = start
    if objective.find_failure(start):
        return start
    for window in WINDOWS:
        x = _descend(_Smoothed(objective, window), start, x)
    return x


class _Smoothed:
    """An objective of smoothed signals."""

    def __init__(self, objective: Objective, window: float) -> None:
        self.objective = objective
        pairs = [_smooth(one, window) for one in objective.measured.experiments]
        self._rules = [rule for _, rule in pairs]
        self._measured = replace(objective.measured, experiments=tuple(one for one, _ in pairs))

    def eliminate(self, x: Vector, slopes: Sequence[Vector] | None = None) -> list[Eliminated]:
        models = [one.signals for one in self.objective.predict(x)]
        given = slopes or [np.zeros((*one.shape, 0)) for one in models]
        noises = np.ones(len(self._measured.signals))
        return eliminate_all(self._measured, self._apply(models), self._apply(given), list(noises))

    def _apply(self, values: Sequence[Vector]) -> list[Vector]:
        """The rules of each experiment to each signal."""
        pairs = zip(self._rules, values, strict=True)
        return [np.stack([r @ v for r, v in zip(rules, one, strict=True)]) for rules, one in pairs]

    def sum(self, x: Vector, noises: Sequence[float]) -> float:
        """Of squares over the noises; infinite without a motion."""
        if self.objective.find_failure(x):
            return np.inf
        parts = zip(self.eliminate(x), noises, strict=True)
        return float(sum(np.sum((one.residual / noise) ** 2) for one, noise in parts))


def _smooth(experiment: Experiment, window: float) -> tuple[Experiment, list[Vector]]:
    """Its signals at fewer positions, and the rule (rows, positions) of each signal."""
    at = experiment.positions
    width = window * float(np.ptp(at)) or 1.0
    places = np.arange(at.min(), at.max() + 0.5 * APART * width, APART * width)
    weights = np.exp(-0.5 * ((places[:, None] - at) / width) ** 2)
    rules, values = [], np.full((len(experiment.values), places.size), np.nan)
    for i, row in enumerate(experiment.values):
        seen = np.isfinite(row)
        total = weights @ seen
        near = total > 0.1 * total.max(initial=1e-300)
        rule = np.where(seen, weights, 0.0) / np.where(near, total, 1.0)[:, None]
        values[i, near] = (rule @ np.where(seen, row, 0.0))[near]
        rules.append(rule)
    return Experiment(experiment.speed, experiment.shaft, places, values), rules


def _descend(level: _Smoothed, start: Vector, x: Vector) -> Vector:
    """By Gauss-Newton steps in the logarithms of positive parameters."""
    objective = level.objective
    low, high = objective.bounds
    positive = (low >= 0.0) & (start > 0.0)

    def away(x: Vector) -> Vector:
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(np.where(positive, np.log(x / start), x - start) / PRIOR)

    for _ in range(STEPS):
        objective.refresh()  # far from the answer curvature misleads a step, and no vibration
        parts = level.eliminate(x, objective.find_slopes(x))
        noises = [float(np.sqrt(np.mean(one.residual**2))) or 1.0 for one in parts]
        residual = np.concatenate([one.residual / s for one, s in zip(parts, noises, strict=True)])
        jacobian = np.concatenate([one.jacobian / s for one, s in zip(parts, noises, strict=True)])
        jacobian = np.vstack([jacobian * np.where(positive, x, 1.0), np.eye(x.size) / PRIOR])
        residual = np.append(residual, away(x))
        step = _solve(jacobian, residual)
        before, promised = residual @ residual, np.sum((residual + jacobian @ step) ** 2)
        if before - promised < ENOUGH * before:
            break
        for share in SHORTER:
            moved = np.where(positive, x * np.exp(share * step), x + share * step).clip(low, high)
            after = level.sum(moved, noises) + away(moved) @ away(moved)
            if after < before - 0.1 * share * (before - promised):
                break
        else:
            break
        x = moved
        if after > (1.0 - ENOUGH) * before:
            break
    return x


def _solve(jacobian: Vector, residual: Vector) -> Vector:
    """The step of Levenberg and Marquardt that changes no parameter by more than LONGEST."""
    normal, right = jacobian.T @ jacobian, -jacobian.T @ residual
    held = 0.0
    while True:
        step = np.linalg.solve(normal + held * np.eye(right.size), right)
        if np.max(np.abs(step)) <= LONGEST:
            return np.asarray(step)
        held = 2.0 * held or 1.0
