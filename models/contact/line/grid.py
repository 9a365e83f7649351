"""The grid of the line contact, in half widths of its core, and what pressure on it does to the surfaces.

Nodes X[i], i = 0..n-1, reach from -REACH to REACH: films much thicker than the flattening, and entrainment
that reverses, need the room on both sides. They stand closest about |X| = 1, where the pressure of a loaded
contact rises and ends steeply. x = scale X, with a scale that follows the contact.

Pressure is linear between nodes. The deflection that a distribution p causes on two half-planes is
(2 compliance / pi) integral of p(s) ln(L/|x - s|) ds; L, the length of the contact, makes it zero far enough
away and agrees with the approach of the finite line contact (Kushwaha et al. 2000, K 9).
"""

import math
from typing import Any

import numpy as np

from ...compile.kernel import kernel
from ...core.quantities import Vector

REACH = 10.0
# Fewer nodes do not resolve a contact, whatever its conditions.
FEWEST_NODES = 51
# The deflections of so many take 184 MB, 8 bytes for each pair of nodes, and films have long converged.
MOST_NODES = 4801
# Node density over |X|: level up to CORE, then falling so that steps grow by GROWTH of the distance, and
# EDGE times more nodes about |X| = 1, within EDGE_WIDTH. By measurement: 301 nodes have then the error of
# some 900 evenly spaced in the core.
CORE = 1.5
GROWTH = 5.0
EDGE = 2.0
EDGE_WIDTH = 0.2
# Share of nodes that crowd about |X| = 1 on a sharpened grid.
CROWD = 0.6
# Slices of the quadrature that sums up the density, to a unit of X.
SLICES = 400


def check_nodes(nodes: int) -> None:
    """ValueError for a number of nodes that a pressure field cannot have."""
    if nodes < FEWEST_NODES or nodes % 2 == 0:
        raise ValueError(f"nodes = {nodes}: must be odd and >= {FEWEST_NODES}")
    if nodes > MOST_NODES:
        raise ValueError(
            f"nodes = {nodes}: must be <= {MOST_NODES} (deflections take 8 bytes for each pair "
            f"of nodes, here {8e-9 * nodes**2:.2g} GB); take 301, which find the cam's films to 0.2 %"
        )


def node_positions(nodes: int) -> Vector:
    """X of so many nodes."""
    X = np.zeros(nodes)
    place_nodes(X)
    return X


@kernel
def density(X: float, sharpness: float) -> float:
    """Nodes per unit of X, but for a factor."""
    outside = 0.5 * (X - CORE + math.sqrt((X - CORE) ** 2 + 0.25))
    edge = EDGE * math.exp(-(((X - 1.0) / EDGE_WIDTH) ** 2))
    crowd = CROWD * sharpness / math.sqrt(1.0 + (sharpness * (X - 1.0)) ** 2)
    return (1.0 + edge + crowd) / (1.0 + GROWTH * outside)


@kernel
def place_nodes(X: Any, reach: float = REACH, sharpness: float = 0.0) -> None:
    """Fill X, ascending from -reach to reach and symmetric about 0.

    `sharpness`: the inverse of the width about |X| = 1 in which heavily loaded films form.
    """
    n = X.shape[0]
    slices = int(SLICES * reach)
    step = reach / slices
    total = 0.0
    for k in range(slices):
        total += density((k + 0.5) * step, sharpness) * step
    passed, k = 0.0, 0
    here = density(0.5 * step, sharpness) * step
    for i in range(n):
        # From the middle outwards: node i of the upper half, in units of the density's sum.
        upper = 2 * i - (n - 1)
        if upper < 0:
            continue
        wanted = total * upper / (n - 1)
        while k < slices - 1 and passed + here < wanted:
            passed += here
            k += 1
            here = density((k + 0.5) * step, sharpness) * step
        X[i] = step * (k + (wanted - passed) / here)
        X[n - 1 - i] = -X[i]
    X[0], X[n - 1] = -reach, reach


@kernel
def log_moment_0(z: float) -> float:
    """Integral of ln|z|."""
    return z * math.log(abs(z)) - z if z != 0.0 else 0.0


@kernel
def log_moment_1(z: float) -> float:
    """Integral of z ln|z|."""
    return 0.5 * z * z * (math.log(abs(z)) - 0.5) if z != 0.0 else 0.0


@kernel
def fill_kernel_matrix(X: Any, weight: Any, D: Any) -> None:
    """weight[j] = integral of node j's hat function, D[j, i] = -integral of it times ln|X[i] - S|."""
    n = X.shape[0]
    for j in range(n):
        weight[j] = 0.0
        for i in range(n):
            D[j, i] = 0.0
    for j in range(n - 1):
        length = X[j + 1] - X[j]
        weight[j] += 0.5 * length
        weight[j + 1] += 0.5 * length
        for i in range(n):
            left, right = X[j] - X[i], X[j + 1] - X[i]
            whole = log_moment_0(right) - log_moment_0(left)
            rising = (log_moment_1(right) - log_moment_1(left) - left * whole) / length
            D[j + 1, i] -= rising
            D[j, i] -= whole - rising
