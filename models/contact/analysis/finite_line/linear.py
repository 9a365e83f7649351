"""One Newton step of G(p, w(p) + h0) = 0 in the active cells, given p in the others, and a closing equation.

The matrix is full: every pressure moves every film. GMRES needs it only as a product (stencils and a
convolution). With `Lines` as its preconditioner 3 to 15 iterations are enough, measured at any load, profile
and grid; a dense matrix of 130 x 70 cells would take a thousand times as long to factorise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ....core.quantities import Vector
from .grid import Mask
from .half_space import HalfSpace
from .krylov import gmres
from .lines import Lines
from .reynolds import DOWNSTREAM, HERE, LEFT, RIGHT, UPSTREAM, UPSTREAM_2

# GMRES ends a step at this share of its residual: Newton still gains four digits a step.
_REDUCTION = 1e-5
_LARGEST_SPACE = 150


def along_stencil(stencil: Vector, v: Vector) -> Vector:
    """The product of a stencil with values at the nodes."""
    out = stencil[HERE] * v
    out[2:] += stencil[UPSTREAM_2, 2:] * v[:-2]
    out[1:] += stencil[UPSTREAM, 1:] * v[:-1]
    out[:-1] += stencil[DOWNSTREAM, :-1] * v[1:]
    out[:, 1:] += stencil[LEFT, :, 1:] * v[:, :-1]
    out[:, :-1] += stencil[RIGHT, :, :-1] * v[:, 1:]
    return out


@dataclass(frozen=True)
class Closing:
    """The equation that h0 needs: `by_p` . dp + `by_h0` dh0 = -`fault`."""

    by_p: Vector
    by_h0: float
    fault: float


def newton_step(
    space: HalfSpace, g: Vector, by_p: Vector, by_h: Vector, above: Vector, active: Mask, closing: Closing
) -> tuple[Vector, float]:
    """dp (nodes, lines) and dh0; `above`: by how much p is above what it is to be in the other cells.

    Active cells must lie two nodes from the first and one from the last. LinAlgError where a line's matrix is
    singular.
    """
    lines = Lines(by_p, by_h, space.own, active)
    lift = np.where(active, by_h.sum(axis=0), 0.0)
    lifted = lines.solve(lift)
    pivot = float((closing.by_p * lifted).sum()) - closing.by_h0

    def precondition(v: Vector) -> Vector:
        dp = lines.solve(v[:-1].reshape(g.shape))
        dh0 = (float((closing.by_p * dp).sum()) - v[-1]) / pivot
        return np.append((dp - dh0 * lifted).ravel(), dh0)

    def product(v: Vector) -> Vector:
        dp = v[:-1].reshape(g.shape)
        change = along_stencil(by_p, dp) + along_stencil(by_h, space.deflection(dp)) + v[-1] * lift
        last = float((closing.by_p * dp).sum()) + closing.by_h0 * v[-1]
        return np.append(np.where(active, change, dp).ravel(), last)

    right = np.append(-np.where(active, g, above).ravel(), -closing.fault)
    step = precondition(gmres(lambda v: product(precondition(v)), right, _REDUCTION, _LARGEST_SPACE))
    # Exactly what is given, or cells that are to have none would keep a trace of pressure.
    return np.where(active, step[:-1].reshape(g.shape), -above), float(step[-1])
