"""Tangent vectors (dy, dy') of a bouncing motion across its events; `v` holds two, one in each row.

An impact maps them by its saltation matrix (phase fixed):

    dy -> -e dy,    dy' -> -e dy' + (e A_before + A_after) dy / y'_before,

A the acceleration y'' just before and after it; determinant e^2. Hence the exponents' exact sum
-lambda/a + 2 N ln e/(2 pi) for N impacts a cycle. At the onset of sliding every deviation ends, and none
begins at the release, whose phase does not depend on the past: both vectors become zero, and the
exponents are -infinity.
"""

from __future__ import annotations

import math
from typing import Any

from ...compile.kernel import kernel


@kernel
def across_impact(restitution: float, kick: float, rate: float, v: Any) -> None:
    """The saltation matrix; `kick` is e A_before + A_after, `rate` y' before the impact."""
    for row in range(2):
        v[row, 1] = -restitution * v[row, 1] + kick / rate * v[row, 0]
        v[row, 0] = -restitution * v[row, 0]


@kernel
def orthonormalize(v: Any, growth: Any) -> None:
    """Gram and Schmidt; adds the logarithms of the lengths to growth. Zero vectors stay zero."""
    growth[0] += normalize(v[0])
    along = v[0, 0] * v[1, 0] + v[0, 1] * v[1, 1]
    v[1, 0] -= along * v[0, 0]
    v[1, 1] -= along * v[0, 1]
    growth[1] += normalize(v[1])


@kernel
def normalize(v: Any) -> float:
    """Divide a vector by its length; returns the logarithm of that."""
    length = math.hypot(v[0], v[1])
    if length == 0.0:
        return -math.inf
    v[0] /= length
    v[1] /= length
    return math.log(length)
