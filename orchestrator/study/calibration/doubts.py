"""Whether a fit looks trapped: residuals above the noise or alike, starts that disagree, and signals that do
not follow their derivatives."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
import scipy

from models.core.quantities import Vector

from .fit import Fit
from .measured import Measured
from .objective import SHARE, Objective
from .signals import Eliminated

# What is this far beyond chance is told: the size of a residual, by the chi-square distribution, and the
# correlation of its neighbours, in standard deviations of that of white noise.
CHANCE, ALIKE = 1e-3, 4.0
# Residuals below this part of a signal's range are of the solver, or of the digits of the data.
SMALL = 1e-4
# A parameter is misled by this part of its deviation: then its interval of 95 % holds in 92 %.
MISLED = 0.5
# A start that ends this much above the best one is at another answer.
OTHER = 1.05


def find_doubt(objective: Objective, found: Fit, ends: Sequence[float]) -> str:
    """What was seen and what to do, in a sentence; "" of a fit that leaves noise. `ends` are the residuals of
    the starts."""
    rows = enumerate(zip(objective.noises, objective.eliminate(found.x), strict=True))
    seen = [text for i, row in rows for text in _doubt_signal(objective.measured, i, *row)]
    seen += [] if found.unseen else _doubt_derivatives(objective, found)
    if len(ends) > 2 and sum(end < OTHER * min(ends) for end in ends) == 1:
        seen.append(f"only one of {len(ends)} starts came to this residual")
    if not seen:
        return ""
    return (
        f"doubtful: {'; '.join(seen)}. The model lacks something, the noise is not as assumed, or the fit "
        "was trapped: look at the residuals in the figure, fit from more starts, leave out where signals "
        "ring or bounce, or fit first what their slow part shows"
    )


def _doubt_signal(measured: Measured, i: int, noise: float, one: Eliminated) -> Iterator[str]:
    signal, count = measured.signals[i], one.residual.size
    parts = list(_split(measured, i, one.residual))
    if signal.noise and one.size**2 > scipy.stats.chi2.isf(CHANCE, count) / count:
        yield f"the residual of {signal.column} is {one.size:.3g} times the noise that was given"
    squares = sum(float(part @ part) for part in parts)
    alike = sum(float(part[1:] @ part[:-1]) for part in parts) / (squares or 1.0)
    large = noise * one.size > SMALL * np.ptp(measured.pool(i))
    if large and alike > (most := ALIKE / math.sqrt(count)):
        yield (
            f"neighbouring residuals of {signal.column} are alike (correlation {alike:.2g}, of white noise "
            f"{most:.2g} at most)"
        )


def _doubt_derivatives(objective: Objective, found: Fit) -> list[str]:
    """Where all parameters change by a deviation, or by no less than the step of differences, to either side:
    a step of least squares that comes back from there to another place than the fit."""
    values, vectors = np.linalg.eigh(found.covariance)
    # A library may give either sign of a vector.
    vectors = vectors * np.sign(vectors[np.abs(vectors).argmax(axis=0), range(len(values))])
    step = vectors @ np.sqrt(np.maximum(values, 0.0))
    wide = max(1.0, SHARE / np.max(np.abs(step) / np.maximum(np.abs(found.x), SHARE)))
    worst, told, residual = MISLED, "", objective.residual(found.x)
    for change in (wide * step, -wide * step):
        if objective.find_failure(found.x + change):
            continue
        changed = objective.residual(found.x + change) - residual
        rows = found.covariance @ found.jacobian.T * (changed - found.jacobian @ change)
        errors = np.abs(rows.sum(axis=1)) / (wide * found.deviations)
        k = int(errors.argmax())
        if errors[k] > worst:
            worst = errors[k]
            shares = np.bincount(objective.measured.list_owners(), np.abs(rows[k]))
            place = objective.measured.experiments[int(shares.argmax())].place
            told = (
                f"derivatives miss {worst:.2g} of a standard deviation of {objective.parameters[k].name} "
                f"where all parameters change by theirs{place and f', most of it {place}'}, and intervals do "
                "not hold"
            )
    return [told] if told else []


def _split(measured: Measured, i: int, residual: Vector) -> Iterator[Vector]:
    """The residual of a signal in each experiment, by position."""
    for one in measured.experiments:
        seen = np.isfinite(one.values[i])
        own, residual = np.split(residual, [int(seen.sum())])
        yield own[np.argsort(one.positions[seen], kind="stable")]
