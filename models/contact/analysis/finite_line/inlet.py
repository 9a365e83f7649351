"""The inlet before the grid: what it adds to the pressure at the grid's first nodes.

There the film is far from the contact: incompressible, at ambient viscosity, with a gap that grows by a
parabola, so that p = wedge times the integral of (h - h*)/h^3 from -infinity. Without this start the grid
would have to begin three times as far away for the same film.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ....compile.kernel import kernel
from ....core.quantities import Vector

# Intervals of Simpson's rule in 1/x; 1e-6 of the integral.
_INTERVALS = 40


@kernel
def rise(first: float, film: float, curvature: float, flow: float) -> float:
    """Integral of (h - h*)/h^3 dx from -infinity to x = -first, h = film + curvature (x^2 - first^2)/2.

    `flow` is h*, the film of the same flow without a pressure gradient.
    """
    total = 0.0
    for n in range(1, _INTERVALS + 1):
        inverse = n / (_INTERVALS * first)
        x = 1.0 / inverse
        h = film + 0.5 * curvature * (x * x - first * first)
        weight = 1.0 if n == _INTERVALS else (4.0 if n % 2 == 1 else 2.0)
        total += weight * x * x * (h - flow) / h**3
    return total / (3.0 * _INTERVALS * first)


@kernel
def _fill(h: Any, x: Any, wedge: float, middle: int, p: Any) -> None:
    step = x[1] - x[0]
    for j in range(h.shape[1]):
        flow = h[middle, j]
        between = 0.5 * (h[0, j] + h[1, j])
        if between <= flow:
            continue
        curvature = max((h[0, j] - h[1, j]) / (-0.5 * (x[0] + x[1]) * step), 0.0)
        if curvature == 0.0:
            continue
        p[0, j] = wedge * rise(-x[0], h[0, j], curvature, flow)
        p[1, j] = p[0, j] + wedge * step * (between - flow) / between**3


def before_grid(h: Vector, x: Vector, wedge: float) -> Vector:
    """Pressure that the nodes which bear no equation have: from the inlet in two columns, 0 elsewhere."""
    p = np.zeros(h.shape)
    _fill(h, x, wedge, int(np.argmin(np.abs(x))), p)
    return p


@kernel
def share_before(half_width: float, film: float, first: float) -> float:
    """Integral of dx/h^2 from -infinity to x = -first outside a Hertzian contact, infinite inside it.

    h is the film and b^2 [X sqrt(X^2 - 1) - ln(X + sqrt(X^2 - 1))]/2, X = x/b.
    """
    if first <= half_width:
        return math.inf
    total = 0.0
    for n in range(1, 4 * _INTERVALS + 1):
        x = 4 * _INTERVALS * first / n
        X = x / half_width
        root = math.sqrt(max(X * X - 1.0, 0.0))
        h = film + 0.5 * half_width**2 * (X * root - math.log(X + root))
        weight = 1.0 if n == 4 * _INTERVALS else (4.0 if n % 2 == 1 else 2.0)
        total += weight * x * x / h**2
    return total / (12.0 * _INTERVALS * first)
