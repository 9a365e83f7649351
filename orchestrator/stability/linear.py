"""What is exactly linear: x' = A x + B u, y = C x + D u about a point of a participant."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import expm

from models.core.quantities import Vector

# Coefficients of the inputs' polynomials: one more than a signal has (four), for its first error.
ROWS = 5


@dataclass(frozen=True, eq=False)
class Linear:
    """Matrices about a point, and the variables at which the point is a kink.

    At a kink the slope is that of the side where it is larger: the stiffer one. `scale` are the states'
    nominal sizes. `taken` (ROWS x inputs) says which Taylor coefficients of its inputs the participant
    makes use of; None: all.
    """

    A: Vector
    B: Vector
    C: Vector
    D: Vector
    scale: Vector
    kinks: tuple[str, ...] = ()
    taken: Vector | None = None
    _steps: dict[float, tuple[Vector, Vector, Vector]] = field(default_factory=dict, repr=False)

    def step(self, h: float) -> tuple[Vector, Vector, Vector]:
        """(Phi, Gamma, E) for inputs u(s) = sum over k of U[k] s^k/k!, with the rows of U one after another.

        x(h) = Phi x(0) + Gamma U, and E U are u(h) and u'(h). Exact: from the matrix exponential of the
        state with the inputs' derivatives as further states (Van Loan 1978).
        """
        if h not in self._steps:
            n, inputs = self.B.shape
            # Inputs without effect on the states would only make the exponential larger.
            moving = np.flatnonzero(np.any(self.B, axis=0))
            m = moving.size
            whole = np.zeros((n + ROWS * m, n + ROWS * m))
            whole[:n, :n] = h * self.A
            if m:
                whole[:n, n : n + m] = h * self.B[:, moving]
                # The chain of derivatives has U[k] h^k as states, which keeps it free of powers of h.
                whole[n:-m, n + m :] = np.eye((ROWS - 1) * m)
            made = expm(whole) if np.any(whole) else np.eye(len(whole))
            gamma = np.zeros((n, ROWS, inputs))
            gamma[:, :, moving] = made[:n, n:].reshape(n, ROWS, m) * (h ** np.arange(ROWS))[:, None]
            chain = [[h**k / math.factorial(k) for k in range(ROWS)]]
            chain.append([0.0, *chain[0][:-1]])
            ends = np.kron(np.array(chain), np.eye(inputs))
            self._steps[h] = made[:n, :n].copy(), gamma.reshape(n, ROWS * inputs), ends
        return self._steps[h]
