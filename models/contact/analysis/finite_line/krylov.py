"""GMRES (Saad and Schultz 1986) for a few iterations on a vector of ten thousand unknowns.

scipy's takes its products of vectors from BLAS, whose threads wait for each other for longer than such a
product takes where cores are busy (measured: 9 s for 0.5 s); compiled loops do not.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ....compile.kernel import kernel
from ....core.quantities import Vector


@kernel
def _orthogonalise(basis: Any, k: int, w: Any, h: Any) -> float:
    """Take the first k rows of `basis` out of w (modified Gram-Schmidt, shares in h) and return its norm."""
    for i in range(k):
        share = 0.0
        row = basis[i]
        for m in range(len(w)):
            share += row[m] * w[m]
        h[i] = share
        for m in range(len(w)):
            w[m] -= share * row[m]
    square = 0.0
    for m in range(len(w)):
        square += w[m] * w[m]
    return math.sqrt(square)


def gmres(product: Callable[[Vector], Vector], right: Vector, reduction: float, largest: int) -> Vector:
    """x with |product(x) - right| <= reduction |right|, or the best one in a space of `largest` vectors."""
    norm = math.sqrt(float(np.sum(right * right)))
    if norm == 0.0:
        return np.zeros_like(right)
    basis = np.empty((largest + 1, len(right)))
    basis[0] = right / norm
    h = np.zeros((largest + 1, largest))
    for k in range(largest):
        w = product(basis[k])
        h[k + 1, k] = _orthogonalise(basis, k + 1, w, h[:, k])
        target = np.zeros(k + 2)
        target[0] = norm
        shares, *_ = np.linalg.lstsq(h[: k + 2, : k + 1], target, rcond=None)
        left = float(np.linalg.norm(h[: k + 2, : k + 1] @ shares - target))
        if left <= reduction * norm or h[k + 1, k] == 0.0:
            break
        basis[k + 1] = w / h[k + 1, k]
    return np.einsum("k,kn->n", shares, basis[: len(shares)])
