"""Eigenvalues of large matrices that fall into parts: of each part that drives itself in a circle alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.linalg import eig
from scipy.sparse.csgraph import connected_components

from models.core.quantities import Vector
from models.core.system import Port

from .operator import MacroStep


def circles(matrix: Vector) -> Iterator[Any]:
    """The numbers in each strongly connected part: what is left after ordering is block triangular."""
    count, labels = connected_components(matrix != 0.0, directed=True, connection="strong")
    order = np.argsort(labels, kind="stable")
    ends = np.searchsorted(labels[order], np.arange(count + 1))
    for first, last in pairwise(ends):
        yield order[first:last]


def eigenvalues(matrix: Vector) -> Vector:
    """All of them."""
    found = [
        np.linalg.eigvals(matrix[np.ix_(part, part)]) if len(part) > 1 else matrix[part, part]
        for part in circles(matrix)
    ]
    return np.concatenate(found) if found else np.zeros(0)


def spectral_radius(matrix: Vector) -> float:
    """The largest absolute value of an eigenvalue."""
    return float(np.max(np.abs(eigenvalues(matrix)), initial=0.0))


def runs_away(step: MacroStep, sources: Sequence[Port]) -> Port:
    """The exchanged value that takes the largest part in the fastest growth.

    Its participation: left times right eigenvector, which no scaling changes (Perez-Arriaga 1982); both
    are different from zero only in the circle that grows.
    """
    grows = max(circles(step.matrix), key=lambda part: spectral_radius(step.matrix[np.ix_(part, part)]))
    values, left, right = eig(step.matrix[np.ix_(grows, grows)], left=True, right=True)
    k = int(np.argmax(np.abs(values)))
    whole = np.zeros(len(step.matrix))
    whole[grows] = np.abs(left[:, k].conj() * right[:, k])
    return sources[int(np.argmax(whole[step.states :].reshape(-1, step.sources).sum(axis=0)))]
