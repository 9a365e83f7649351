"""Small motions about a place: natural frequencies, and the place where a mechanism rests."""

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh, lstsq, null_space

from ..core.errors import ModelError
from ..core.quantities import Vector
from .equations import turn_coordinates
from .mechanism import Mechanism, Start

# Differences of coordinates (m, rad).
DIFFERENCE = 1e-7
# The slow motion through a place of rest is that over so short a time (s).
AHEAD = 1e-6
# Newton's steps to the place of rest, and the share of the largest force that may be left.
REST_STEPS = 30
AT_REST = 1e-8


class Stiffness(NamedTuple):
    """By small moves and turns of the bodies, (6 n, 6 n): of the forces, and with the joints' loads too."""

    elastic: Vector
    loaded: Vector


def move(q: Vector, change: Vector) -> Vector:
    """The coordinates after small moves (m) and turns (rad, axes of the ground) of the bodies."""
    rate = np.empty_like(q)
    turn_coordinates(q, change, rate)
    return q + rate


def find_stiffness(mechanism: Mechanism, t: float, q: Vector, multipliers: Vector) -> Stiffness:
    """The stiffness of the forces, and that of f - J^T lambda with the multipliers held."""
    size = q.size
    still = np.zeros(size)
    elastic, loaded = np.empty((size, size)), np.empty((size, size))
    for column in range(size):
        change = np.zeros(size)
        sides = []
        for step in (DIFFERENCE, -DIFFERENCE):
            change[column] = step
            e = mechanism.evaluate(t, move(q, change), still)
            sides.append((e.force.copy(), e.held.jacobian.T @ multipliers))
        elastic[:, column] = (sides[1][0] - sides[0][0]) / (2.0 * DIFFERENCE)
        loaded[:, column] = (sides[0][1] - sides[1][1]) / (2.0 * DIFFERENCE)
    return Stiffness(elastic, elastic + loaded)


def find_frequencies(mechanism: Mechanism, start: Start, t: float = 0.0, *, loaded: bool = True) -> Vector:
    """Natural frequencies (Hz, ascending) of M q'' + K q + J^T lambda = 0 with J q = 0, Q (4).

    `loaded` includes the stiffness that loads of joints make as they turn, such as W s'' of a cam. An
    unstable motion has a negative frequency.
    """
    both = find_stiffness(mechanism, t, start.q, start.multipliers)
    e = mechanism.evaluate(t, start.q, np.zeros_like(start.q))
    free = null_space(e.held.jacobian)
    left = free.T @ (both.loaded if loaded else both.elastic) @ free
    squares = eigh(0.5 * (left + left.T), free.T @ e.mass @ free, eigvals_only=True)
    return np.asarray(np.sign(squares) * np.sqrt(np.abs(squares)) / (2.0 * math.pi))


def find_rest(mechanism: Mechanism, t: float = 0.0) -> Start:
    """Where springs and loads balance at the instant t, with the velocities of a slow motion through it.

    Newton's method on f - J^T lambda = 0, C = 0 without velocities. Films stay as they are.
    """
    q, _ = _balance(mechanism, t, mechanism.start(t).q)
    later, _ = _balance(mechanism, t + AHEAD, q)
    v = mechanism.project_velocities(t, q, find_velocities(q, later, AHEAD))
    a, multipliers = mechanism.accelerate(t, q, v, mechanism.start_film)
    return Start(q, v, a, multipliers, mechanism.start_film.copy())


def find_velocities(q: Vector, later: Vector, duration: float) -> Vector:
    """The velocities of a short way between two places."""
    columns = np.empty((q.size, q.size))
    for i, unit in enumerate(np.eye(q.size)):
        turn_coordinates(q, unit, columns[:, i])
    return np.asarray(np.linalg.solve(columns, (later - q) / duration))


def _balance(mechanism: Mechanism, t: float, q: Vector) -> tuple[Vector, Vector]:
    size, still = q.size, np.zeros_like(q)
    e = mechanism.evaluate(t, q, still)
    multipliers = np.asarray(np.linalg.lstsq(e.held.jacobian.T, e.force, rcond=None)[0], float)
    for _ in range(REST_STEPS):
        e = mechanism.evaluate(t, q, still)
        jacobian, left = e.held.jacobian.copy(), e.force - e.held.jacobian.T @ multipliers
        right = np.concatenate([left, -e.held.value])
        if np.max(np.abs(right)) <= AT_REST * np.max(np.abs(e.force), initial=1.0):
            return q, multipliers
        matrix = np.zeros((right.size, right.size))
        matrix[:size, :size] = find_stiffness(mechanism, t, q, multipliers).loaded
        # Joints as stiff as the stiffest spring, so that what is free can be told from what is held.
        scale = max(1.0, float(np.max(np.abs(matrix))))
        matrix[:size, size:], matrix[size:, :size] = scale * jacobian.T, scale * jacobian
        right[size:] *= scale
        step = lstsq(matrix, right, cond=1e-13, lapack_driver="gelsy")[0]
        q, multipliers = move(q, step[:size]), multipliers + scale * step[size:]
    raise ModelError(
        f"no place of rest at t = {t:g} s: {np.max(np.abs(left)):.3g} N or N m are left without balance"
    )
