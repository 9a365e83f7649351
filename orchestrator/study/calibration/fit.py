"""Least squares of measured signals: lmfit's trust region, covariance, profiles of the likelihood."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import lmfit
import numpy as np
import scipy

from models.core.quantities import Vector

from ...errors import RunError
from .approach import approach
from .objective import Objective
from .unseen import Unseen, acts_alike, find_unseen, invert, is_doubtful

CONFIDENCE = 0.95
# A fit ends where a step changes the sum of squares by this part of it (some hundredth of a deviation), or
# the parameters by as much of themselves.
LEAST_GAIN, LEAST_STEP = 1e-6, 1e-5
# Of least squares; of fits with derivatives found anew; of estimates of the noise, until they change less.
MOST_STEPS, MOST_FITS, MOST_ESTIMATES, SETTLED = 40, 4, 4, 0.03
# The last step of a fit is below this of a deviation: the next would be a hundredth of it.
LAST = 2e-3
PREFIX = "p"


@dataclass(frozen=True)
class Fit:
    """The parameters `x` over their sizes at the least squares, their covariance, and the sum of squares."""

    x: Vector
    covariance: Vector
    squares: float
    jacobian: Vector
    unseen: Sequence[Unseen]

    @property
    def misfit(self) -> float:
        """Root mean square of the residual over the noise."""
        return math.sqrt(self.squares / max(len(self.jacobian), 1))

    @property
    def deviations(self) -> Vector:
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self) -> Vector:
        deviations = self.deviations
        return np.asarray(self.covariance / np.outer(deviations, deviations))


def fit(objective: Objective, start: Vector) -> Fit:
    """From `start`, with the noises that are not given estimated; RunError where it has no prediction."""
    if failure := objective.find_failure(start):
        raise RunError(
            f"the start has no motion to compare {failure}", "choose another start, or leave the speed out"
        )
    given = all(signal.noise for signal in objective.measured.signals)
    x = approach(objective, start)
    objective.noises = objective.estimate_noises(x)
    for _ in range(1 if given else MOST_ESTIMATES):
        x = _minimise(objective, x)
        before, objective.noises = objective.noises, objective.estimate_noises(x)
        if np.allclose(objective.noises, before, rtol=SETTLED, atol=0.0):
            break
    x = _end(objective, x)
    # Corrections of derivatives would part what acts alike.
    jacobian, residual = objective.jacobian_found(x), objective.residual(x)
    if objective.rattles or is_doubtful(jacobian):
        objective.centre(x)
        jacobian = objective.jacobian_found(x)
    return Fit(x, invert(jacobian), float(residual @ residual), jacobian, find_unseen(objective, x, jacobian))


def _minimise(objective: Objective, start: Vector) -> Vector:
    """With derivatives that are right at the end."""
    x = start
    for _ in range(MOST_FITS):
        with np.errstate(invalid="ignore"):  # lmfit's own errors of what is not identified
            found = _open(objective, x).minimize(
                method="least_squares", jac=lambda p: objective.jacobian(_numbers(p)), x_scale="jac",
                ftol=LEAST_GAIN, xtol=LEAST_STEP, gtol=None, max_nfev=MOST_STEPS,
            )  # fmt: skip
        x = _numbers(found.params)
        deviations = np.sqrt(np.diag(invert(objective.jacobian(x))))
        if objective.is_fresh(x, deviations):
            break
        objective.refresh(deviations)
    return x


def _end(objective: Objective, x: Vector) -> Vector:
    """Steps of Gauss and Newton to where the fit ends whatever its path was: noises, cycles and derivatives
    are those of each x alone. Where signals rattle, or do not show all parameters, there is no such point. It
    stays where cycles are not found from their own start."""
    low, high = objective.bounds
    for _ in range(0 if objective.rattles else MOST_FITS):
        if not objective.restart(x):
            break
        objective.noises = objective.estimate_noises(x)
        objective.refresh()
        jacobian, residual = objective.jacobian(x), objective.residual(x)
        lengths = np.linalg.norm(jacobian, axis=0)
        if acts_alike(jacobian):
            break
        room = lengths * np.minimum(low - x, 0.0), lengths * np.maximum(high - x, 0.0)
        step = scipy.optimize.lsq_linear(jacobian / lengths, -residual, room, "bvls").x / lengths
        if not objective.restart(x + step):
            break
        after = objective.residual(x + step)
        if not after @ after <= (1.0 + LEAST_GAIN) * (residual @ residual):
            break
        x = x + step
        if np.all(np.abs(step) <= LAST * np.sqrt(np.diag(invert(jacobian)))):
            break
    objective.noises = objective.estimate_noises(x)
    return x


def _open(objective: Objective, x: Vector, **options: Any) -> lmfit.Minimizer:
    parameters = lmfit.Parameters()
    for k, (one, value) in enumerate(zip(objective.parameters, x, strict=True)):
        parameters.add(f"{PREFIX}{k}", value=float(value), min=one.low / one.size, max=one.high / one.size)
    return lmfit.Minimizer(
        lambda p: objective.residual(_numbers(p)),
        parameters,
        nan_policy="propagate",
        scale_covar=False,
        **options,
    )


def _numbers(parameters: lmfit.Parameters) -> Vector:
    return np.array([parameters[f"{PREFIX}{k}"].value for k in range(len(parameters))])


def _list_free(parameters: lmfit.Parameters) -> list[int]:
    return [k for k in range(len(parameters)) if parameters[f"{PREFIX}{k}"].vary]


def profile(objective: Objective, found: Fit, which: Sequence[int]) -> dict[str, tuple[float, float]]:
    """Ends of the intervals of parameters by the profile of the likelihood (lmfit's `conf_interval`).

    Fits with one parameter held use the derivatives of the fit. nan where an end is not found.
    """
    if found.x.size == 1:  # lmfit asks for two
        return {objective.parameters[0].name: _find_ends(objective, found)} if which else {}
    slopes = objective.find_slopes(found.x)
    minimizer = _open(
        objective,
        found.x,
        Dfun=lambda p: objective.jacobian_with(_numbers(p), slopes)[:, _list_free(p)],
        ftol=1e-5,
    )
    with np.errstate(invalid="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of an end that is not found
        best = minimizer.leastsq()
        for k, name in enumerate(best.params):
            best.params[name].stderr = float(found.deviations[k])
        intervals = lmfit.conf_interval(
            minimizer, best, p_names=[f"{PREFIX}{k}" for k in which], sigmas=[CONFIDENCE]
        )
    ends = {}
    for k in which:
        low, *_, high = (value for _, value in intervals[f"{PREFIX}{k}"])
        one = objective.parameters[k]
        ends[one.name] = one.size * _finite(low), one.size * _finite(high)
    return ends


def _find_ends(objective: Objective, found: Fit) -> tuple[float, float]:
    """Of the only parameter, where the sum of squares is that of lmfit's test, by the F distribution."""
    (one,), (best,), (deviation,) = objective.parameters, found.x, found.deviations
    freedom = max(len(found.jacobian) - 1, 1)
    allowed = found.squares * (1.0 + float(scipy.stats.f.ppf(CONFIDENCE, 1, freedom)) / freedom)

    def excess(x: float) -> float:
        residual = objective.residual(np.array([x]))
        return float(np.nan_to_num(residual @ residual, nan=1e9 * allowed)) - allowed

    ends = []
    for side, bound in ((-1.0, one.low), (1.0, one.high)):
        far = (best + side * reach * deviation for reach in (2.5, 5.0, 10.0, 20.0))
        inside = (x for x in far if side * (bound / one.size - x) > 0.0)
        end = next((x for x in inside if excess(x) > 0.0), None)
        ends.append(
            math.nan if end is None else scipy.optimize.brentq(excess, best, end, xtol=1e-3 * deviation)
        )
    return one.size * ends[0], one.size * ends[1]


def _finite(value: float) -> float:
    return value if math.isfinite(value) else math.nan


def half_width(freedom: int) -> float:
    """Of an interval in deviations, by Student's distribution."""
    return float(scipy.stats.t.ppf(0.5 + 0.5 * CONFIDENCE, max(freedom, 1)))
