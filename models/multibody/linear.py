"""Small motions about a place: natural frequencies."""

import math

import numpy as np
from scipy.linalg import eigh, null_space

from ..core.quantities import Vector
from .equations import turn_coordinates
from .mechanism import Mechanism, Start

# Differences of coordinates (m, rad).
DIFFERENCE = 1e-7


def move(q: Vector, change: Vector) -> Vector:
    """The coordinates after small moves (m) and turns (rad, axes of the ground) of the bodies."""
    rate = np.empty_like(q)
    turn_coordinates(q, change, rate)
    return q + rate


def find_stiffness(mechanism: Mechanism, start: Start) -> Vector:
    """That of f - J^T lambda with lambda held, by small moves and turns of the bodies, (6 n, 6 n)."""
    size = start.q.size
    still, columns = np.zeros(size), []
    for change in DIFFERENCE * np.eye(size):
        left = []
        for sign in (1.0, -1.0):
            e = mechanism.evaluate(0.0, move(start.q, sign * change), still)
            left.append(e.force - e.held.jacobian.T @ start.multipliers)
        columns.append((left[1] - left[0]) / (2.0 * DIFFERENCE))
    return np.array(columns).T


def find_frequencies(mechanism: Mechanism, start: Start) -> Vector:
    """Natural frequencies (Hz, ascending) of M q'' + K q + J^T lambda = 0 with J q = 0, Q (4).

    K includes the stiffness that loads of joints make as they turn, such as W s'' of a cam. An unstable
    motion has a negative frequency.
    """
    stiffness = find_stiffness(mechanism, start)
    e = mechanism.evaluate(0.0, start.q, np.zeros_like(start.q))
    free = null_space(e.held.jacobian)
    left = free.T @ stiffness @ free
    squares = eigh(0.5 * (left + left.T), free.T @ e.mass @ free, eigvals_only=True)
    return np.asarray(np.sign(squares) * np.sqrt(np.abs(squares)) / (2.0 * math.pi))
