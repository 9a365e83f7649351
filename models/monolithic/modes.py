"""Natural frequencies and dampings of a system's small motions about an instant of its motion."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig

from ..core.quantities import Vector
from ..core.system import System
from .problem import SystemProblem, find_central_jacobian

# Coordinates and their rates take nearly equal parts: of states that reach so much of the largest, the first.
ALIKE = 0.9
# An eigenvalue with less of an imaginary part, relative to its size, is a double real one with rounding.
LEAST_TURN = 1e-6


@dataclass(frozen=True)
class Mode:
    """A motion ~ exp(lambda t): its natural frequency |lambda| / (2 pi) (Hz), its damping ratio
    -Re(lambda) / |lambda| and the state that takes most part in it, as "instance.state"."""

    frequency: float
    damping: float
    state: str


def find_modes(system: System, t: float, x: Vector) -> list[Mode]:
    """The oscillations of small motions about the state x at time t (s), slowest first.

    They are eigenvectors v of the Jacobian of the state's rate, by central differences, with modes and counts
    held. A state k takes the part |w_k v_k| / |w^H v| in one with the left eigenvector w, whatever its unit
    (Perez-Arriaga, Verghese and Schweppe 1982, equation (9)). ModelError if a component is no ODE.
    """
    problem = SystemProblem(system, counts_energies=False)
    problem.take(system)
    moving = np.flatnonzero(~problem.whole)

    def rate(part: Vector) -> Vector:
        state = np.array(x)
        state[moving] = part
        return problem.rate(t, state)[moving].copy()

    jacobian = find_central_jacobian(rate, x[moving], problem.nominal[moving])
    values, left, right = eig(jacobian, left=True)
    parts = np.abs(left * right)
    found = [
        Mode(
            float(abs(value)) / (2.0 * math.pi),
            float(-value.real / abs(value)),
            system.state.names[moving[k]],
        )
        for value, k in zip(values, np.argmax(parts > ALIKE * parts.max(axis=0), axis=0), strict=True)
        if value.imag > LEAST_TURN * abs(value)
    ]
    return sorted(found, key=lambda mode: mode.frequency)
