"""Linear systems x' = A x + B u, y = C x + D u, and eigenvalues of large sparse matrices."""

import math
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from scipy.linalg import expm
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from models.core.quantities import Vector

# Coefficients of the inputs' polynomials: one more than a signal has (four), for its first error.
ROWS = 5


@dataclass(frozen=True, eq=False)
class Linear:
    """A participant's matrices about a point, and the variables that have a kink there.

    At a kink the matrices hold the steeper slope. `scale` are the states' nominal sizes. `followed`
    (ROWS x inputs) is 1 for the Taylor coefficients of its inputs that the participant uses; None: all.
    Where it uses the value only it holds the input, and gets the mean over the step.
    """

    A: Vector
    B: Vector
    C: Vector
    D: Vector
    scale: Vector
    kinks: tuple[str, ...] = ()
    followed: Vector | None = None
    _steps: dict[float, tuple[Vector, Vector, Vector]] = field(default_factory=dict, repr=False)

    @cached_property
    def held(self) -> Any:
        """Which inputs it holds."""
        inputs = self.B.shape[1]
        return np.zeros(inputs, dtype=bool) if self.followed is None else self.followed[1] == 0.0

    def step(self, h: float) -> tuple[Vector, Vector, Vector]:
        """(Phi, Gamma, E) for inputs u(s) = sum over k of U[k] s^k/k!, the rows of U one after another.

        x(h) = Phi x(0) + Gamma U, and E U are u(h) and u'(h). Exact: the matrix exponential takes the inputs'
        derivatives as further states (Van Loan 1978).
        """
        if h not in self._steps:
            n, inputs = self.B.shape
            # The chain drives the states by B, or each by itself where they are fewer than the inputs.
            moving = np.flatnonzero(np.any(self.B, axis=0))
            acting = self.B[:, moving]
            drive = acting if moving.size <= n else np.eye(n)
            m = drive.shape[1]
            whole = np.zeros((n + ROWS * m, n + ROWS * m))
            whole[:n, :n] = h * self.A
            if m:
                whole[:n, n : n + m] = h * drive
                # The states of the chain are U[k] h^k, so that it needs no powers of h.
                whole[n:-m, n + m :] = np.eye((ROWS - 1) * m)
            exponential = expm(whole) if np.any(whole) else np.eye(len(whole))
            gamma = np.zeros((n, ROWS, inputs))
            driven = exponential[:n, n:].reshape(n, ROWS, m) * (h ** np.arange(ROWS))[:, None]
            gamma[:, :, moving] = driven if drive is acting else driven @ acting
            chain = [[h**k / math.factorial(k) for k in range(ROWS)]]
            chain.append([0.0, *chain[0][:-1]])
            ends = np.kron(np.array(chain), np.eye(inputs))
            self._steps[h] = exponential[:n, :n].copy(), gamma.reshape(n, ROWS * inputs), ends
        return self._steps[h]


@lru_cache(maxsize=16)
def _find_strong_parts(size: int, linked: bytes) -> tuple[Any, ...]:
    graph = csr_array(np.frombuffer(linked, dtype=bool).reshape(size, size))
    count, labels = connected_components(graph, directed=True, connection="strong")
    order = np.argsort(labels, kind="stable")
    return tuple(np.split(order, np.searchsorted(labels[order], np.arange(1, count))))


def find_strong_parts(matrix: Vector) -> tuple[Any, ...]:
    """Indices of each strongly connected part; ordered by parts, the matrix is block triangular."""
    return _find_strong_parts(len(matrix), (matrix != 0.0).tobytes())  # the same of many steps


def compute_eigenvalues(matrix: Vector) -> Vector:
    """All eigenvalues, part by part."""
    found = [
        np.linalg.eigvals(matrix[np.ix_(part, part)]) if len(part) > 1 else matrix[part, part]
        for part in find_strong_parts(matrix)
    ]
    return np.concatenate(found) if found else np.zeros(0)


def compute_spectral_radius(matrix: Vector) -> float:
    """The largest absolute value of an eigenvalue."""
    return float(np.max(np.abs(compute_eigenvalues(matrix)), initial=0.0))
