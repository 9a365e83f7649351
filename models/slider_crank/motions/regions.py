"""Where the walls can hold the slider: constraint forces over the crank angle, regions I-III of F 2.6.

A wall can only push. The upper one can hold a slider that rests on it where F's f_u is positive, the lower
one where f_l is. Both are affine in lambda, with a slope that has one sign, so that each crank angle has
one lambda at which a wall's force is zero there; its maximum over the revolution bounds the regions.
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from ...compile.kernel import kernel
from ...core.quantities import Vector
from ..equations import Crank, Mechanism
from ..flight.bouncing import LOWER, PAST_ZERO, UPPER
from ..flight.series import bounds_of_bend, first_fall, move_origin
from ..forms import constraint_force, wall_angle
from .machine import Machine

TURN = 2.0 * math.pi
# Crank angles between which the maximum over a revolution is bracketed; the functions have a handful of
# harmonics.
SAMPLES = 720
# Zeros closer than this (rad) are the rounding of one double zero.
ONE_ZERO = 1e-7


class Thresholds(NamedTuple):
    """lambda from which on the upper wall holds throughout, and the lower one nowhere."""

    upper: float
    lower: float


class Interval(NamedTuple):
    """Crank angles, start in [0, 2 pi); the end may be beyond 2 pi."""

    start: float
    end: float


@kernel
def wall_force(form: float, side: float, theta: float, gap: float, m: Mechanism) -> float:
    """F's f_u (side 1) or f_l (side -1) of (2.29): force of a wall on a slider that rests on it, over M l."""
    return side * constraint_force(form, Crank(theta, 1.0, 0.0), wall_angle(form, theta, side * gap, m), m)


def wall_forces(machine: Machine, side: float, theta: Vector) -> Vector:
    """`wall_force` at many crank angles."""
    form, m = machine.form_code, machine.mechanism
    return np.array([wall_force(form, side, angle, machine.gap, m) for angle in theta])


def force_zeros(machine: Machine, side: float) -> Vector:
    """Crank angles in [0, 2 pi), increasing, at which a wall's force is zero."""
    pressing: Vector = machine.flow.pressing[:, 0 if side == UPPER else 1]
    return series_zeros(pressing)


def series_zeros(series: Vector) -> Vector:
    """Zeros in [0, 2 pi) of a function given by its series (cells, TERMS) as in a `Flow`.

    Searched as by `bouncing.slide`: none is passed over, however close to the next. A double zero counts
    once, if rounding leaves it one. A function that is zero everywhere has none.
    """
    if not series.any():
        return np.zeros(0)
    width = TURN / len(series)
    found: list[float] = []
    sign = 1.0 if series[0, 0] >= 0.0 else -1.0
    for k, cell in enumerate(series):
        if sign * cell[0] < 0.0:
            found.append(k * width)
            sign = -sign
        c, u = cell.copy(), 0.0
        while (at := _find_next_zero(c, sign, 1.0 - u)) <= 1.0 - u:
            found.append((k + u + at) * width)
            move_origin(c, at + PAST_ZERO)
            u += at + PAST_ZERO
            if sign * c[0] < 0.0:
                sign = -sign
    return _merge_zeros(found)


def _find_next_zero(c: Vector, sign: float, length: float) -> float:
    """The first u in [0, length] at which sign c(u) falls to zero; above `length` if it does not."""
    if length <= 0.0:
        return math.inf
    low, high = bounds_of_bend(c, length)
    return first_fall(c, -sign, 0.0, low if sign > 0.0 else -high, length)


def _merge_zeros(zeros: list[float]) -> Vector:
    kept: list[float] = []
    for zero in zeros:
        if not kept or zero - kept[-1] > ONE_ZERO:
            kept.append(zero)
    if len(kept) > 1 and kept[0] + TURN - kept[-1] < ONE_ZERO:
        kept.pop()
    return np.array(kept)


def sign_changes(machine: Machine, side: float) -> int:
    """How often a wall's force changes its sign in a revolution: its zeros without the double ones."""
    holding = _find_holding(machine, side, force_zeros(machine, side))
    return int(np.count_nonzero(holding != np.roll(holding, 1)))


def holding_intervals(machine: Machine, side: float) -> list[Interval]:
    """Where the wall on that side can hold the slider, at most one revolution each."""
    zeros = force_zeros(machine, side)
    holding = _find_holding(machine, side, zeros)
    if len(zeros) == 0:
        return [Interval(0.0, TURN)] if holding[0] else []
    ends = np.append(zeros[1:], zeros[0] + TURN)
    return [Interval(float(a), float(b)) for a, b, holds in zip(zeros, ends, holding, strict=True) if holds]


def _find_holding(machine: Machine, side: float, zeros: Vector) -> NDArray[np.bool_]:
    """True for each interval between zeros in which the force is positive."""
    if len(zeros) == 0:
        return wall_forces(machine, side, np.zeros(1)) > 0.0
    middles = 0.5 * (zeros + np.append(zeros[1:], zeros[0] + TURN))
    return wall_forces(machine, side, middles) > 0.0


def critical_damping(machine: Machine, side: float, theta: Vector) -> Vector:
    """lambda at which the force of the wall on that side is zero, at each crank angle."""
    none, unit = (wall_forces(replace(machine, damping=damping), side, theta) for damping in (0.0, 1.0))
    lambdas: Vector = none / (none - unit)
    return lambdas


def thresholds(machine: Machine) -> Thresholds:
    """Of a machine with these parameters, whatever its damping; F: 0.2669 as rho -> 0."""
    return Thresholds(*(_find_greatest_damping(machine, side) for side in (UPPER, LOWER)))


def _find_greatest_damping(machine: Machine, side: float) -> float:
    """Maximum of `critical_damping` over the revolution."""
    theta = np.linspace(0.0, TURN, SAMPLES, endpoint=False)
    values = critical_damping(machine, side, theta)
    peaks = np.flatnonzero((values >= np.roll(values, 1)) & (values > np.roll(values, -1)))
    step = TURN / SAMPLES

    def fall(angle: float) -> float:
        return -float(critical_damping(machine, side, np.array([angle]))[0])

    refined = (
        minimize_scalar(
            fall, bounds=(theta[i] - step, theta[i] + step), method="bounded", options={"xatol": 1e-9}
        )
        for i in peaks
    )
    return max([float(values.max()), *(-float(found.fun) for found in refined)])


def region(machine: Machine) -> str:
    """F's region, by what the walls can do in a revolution: "I": both hold, each in a part of it; "II": the
    upper one throughout, the lower one in a part; "III": the upper one throughout, the lower one nowhere;
    "none": the upper one in a part, the lower one nowhere."""
    limits = thresholds(machine)
    throughout = machine.damping >= limits.upper
    lower = machine.damping < limits.lower
    return {(False, True): "I", (True, True): "II", (True, False): "III", (False, False): "none"}[
        throughout, lower
    ]
