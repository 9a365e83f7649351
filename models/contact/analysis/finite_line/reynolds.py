"""Reynolds' equation of a steady film in two dimensions, as the balance of every cell and its tangents.

In units of a half width b, its pressure p0 = b/(2 R compliance) and b^2/R for the film,

    G = d(rho h)/dx - d(eps dp/dx)/dx - d(eps dp/dy)/dy,   eps = rho h^3 / (eta wedge),
    wedge = 12 eta0 u R^2 / (b^3 p0),

where rho and eta are relative to ambient pressure; a cell is full and G = 0, or cavitated with p = 0, G >= 0.

Three choices keep the error small where the grid is coarse. Through a face eta is the logarithmic mean of
both sides, exact for a viscosity exponential in p (the pressure rises in the inlet by 1/alpha from one node
to the next). h^3 is 2 a^2 b^2/(a + b) of both films a and b, exact for one that is linear between them:
pressure falls where the film is thin, and a mean of the cubes would let a thin film flow out of the contact
beside a wide gap, along x before its inlet and along y at its ends. And rho h on a face is Leonard's (1979)
quadratic interpolation, weighted upstream: of even nodes 3/8, 6/8, -1/8. It oscillates where the outlet of
a highly loaded end is not resolved; the line through both nodes upstream, which does not, is there to fall
back upon.
The first two columns of nodes and the last one have p = 0; so has the edge of the surface on both ends.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ....compile.kernel import kernel
from ....core.quantities import Vector
from ...fluid import Lubricant, density_ratio, density_slope, log_viscosity
from .grid import Grid

# Whose value a cell's balance depends on: the places of a stencil.
UPSTREAM_2, UPSTREAM, HERE, DOWNSTREAM, LEFT, RIGHT = range(6)
PLACES = 6

# Below this difference of logarithms the logarithmic mean is taken from its series (error 1e-13).
_CLOSE = 1e-3

# A face carries at least this share of the smaller flow rho h of its nodes: where the gap narrows tenfold
# within a node, the quadratic is negative.
_LEAST = 0.5

# What is kept of every node.
_LOG_FLUIDITY, _LOG_FLUIDITY_SLOPE, _RHO, _RHO_SLOPE, _FLOW, _FLOW_BY_P, _FLOW_BY_H = range(7)


@kernel
def logarithmic_mean(a: float, b: float) -> tuple[float, float, float]:
    """(e^b - e^a)/(b - a) and its derivatives by a and b."""
    x = b - a
    if abs(x) < _CLOSE:
        mean = math.exp(0.5 * (a + b)) * (1.0 + x * x / 24.0)
        return mean, mean * (0.5 - x / 12.0), mean * (0.5 + x / 12.0)
    mean = (math.exp(b) - math.exp(a)) / x
    return mean, (mean - math.exp(a)) / x, (math.exp(b) - mean) / x


@kernel
def _at_nodes(p: Any, h: Any, wedge: float, unit: float, fluid: Any, at: Any) -> None:
    for i in range(p.shape[0]):
        for j in range(p.shape[1]):
            pressure = unit * p[i, j]
            rho = density_ratio(pressure, fluid)
            slope = unit * density_slope(pressure, fluid)
            log_eta, by_pressure = log_viscosity(pressure, fluid)
            at[_LOG_FLUIDITY, i, j], at[_LOG_FLUIDITY_SLOPE, i, j] = -log_eta, -unit * by_pressure
            at[_RHO, i, j] = rho / wedge
            at[_RHO_SLOPE, i, j] = slope / wedge
            at[_FLOW, i, j] = rho * h[i, j]
            at[_FLOW_BY_P, i, j] = slope * h[i, j]
            at[_FLOW_BY_H, i, j] = rho


@kernel
def _poiseuille(
    p: Any, h: Any, at: Any, i: int, j: int, k: int, l: int, distance: float
) -> tuple[float, float, float, float, float]:
    """-eps dp/dn from node (i, j) to (k, l), its derivatives by both pressures and by both films."""
    mean, by_a, by_b = logarithmic_mean(at[_LOG_FLUIDITY, i, j], at[_LOG_FLUIDITY, k, l])
    a, b = h[i, j], h[k, l]
    half_cube = (a * b) ** 2 / (a + b)
    rho_a, rho_b = at[_RHO, i, j], at[_RHO, k, l]
    cube = (rho_a + rho_b) * half_cube
    slope = (p[k, l] - p[i, j]) / distance
    conductance = cube * mean / distance
    by_pa = half_cube * at[_RHO_SLOPE, i, j] * mean + cube * by_a * at[_LOG_FLUIDITY_SLOPE, i, j]
    by_pb = half_cube * at[_RHO_SLOPE, k, l] * mean + cube * by_b * at[_LOG_FLUIDITY_SLOPE, k, l]
    by_ha = conductance * distance * (2.0 / a - 1.0 / (a + b))
    by_hb = conductance * distance * (2.0 / b - 1.0 / (a + b))
    return (
        -conductance * (p[k, l] - p[i, j]),
        conductance - by_pa * slope,
        -conductance - by_pb * slope,
        -by_ha * slope,
        -by_hb * slope,
    )


@kernel
def upstream_weights(before: float, across: float, curved: float) -> tuple[float, float, float]:
    """Of the node ahead, the one at and the one behind, for the face halfway `across` the step between the
    first two; `before` is the step between the other two. `curved` 1: the parabola through all, 0: the line
    through the last two."""
    half = 0.5 * across / before
    ahead = 0.5 * (before + 0.5 * across) / (before + across)
    at = 1.0 + half - curved * (0.5 - 0.25 * across / before + half)
    return curved * ahead, at, 1.0 - curved * ahead - at


@kernel
def _balance(
    p: Any,
    h: Any,
    at: Any,
    x: Any,
    columns: Any,
    y: Any,
    widths: Any,
    curved: float,
    g: Any,
    by_p: Any,
    by_h: Any,
) -> None:
    nodes, lines = p.shape
    for i in range(1, nodes - 1):
        quadratic = upstream_weights(x[i] - x[i - 1], x[i + 1] - x[i], curved)
        left, right = columns[i], columns[i + 1]
        for j in range(lines):
            ahead, here, behind = quadratic
            carried = ahead * at[_FLOW, i + 1, j] + here * at[_FLOW, i, j] + behind * at[_FLOW, i - 1, j]
            if carried < _LEAST * at[_FLOW, i, j] <= _LEAST * at[_FLOW, i + 1, j]:
                ahead, here, behind = 0.0, _LEAST, 0.0
            elif carried < _LEAST * at[_FLOW, i + 1, j] < _LEAST * at[_FLOW, i, j]:
                ahead, here, behind = _LEAST, 0.0, 0.0
            flux, pa, pb, ha, hb = _poiseuille(p, h, at, i, j, i + 1, j, x[i + 1] - x[i])
            flux += ahead * at[_FLOW, i + 1, j] + here * at[_FLOW, i, j] + behind * at[_FLOW, i - 1, j]
            pa += here * at[_FLOW_BY_P, i, j]
            pb += ahead * at[_FLOW_BY_P, i + 1, j]
            pc = behind * at[_FLOW_BY_P, i - 1, j]
            ha += here * at[_FLOW_BY_H, i, j]
            hb += ahead * at[_FLOW_BY_H, i + 1, j]
            hc = behind * at[_FLOW_BY_H, i - 1, j]
            g[i, j] += flux / left
            g[i + 1, j] -= flux / right
            by_p[UPSTREAM, i, j] += pc / left
            by_p[HERE, i, j] += pa / left
            by_p[DOWNSTREAM, i, j] += pb / left
            by_p[UPSTREAM_2, i + 1, j] -= pc / right
            by_p[UPSTREAM, i + 1, j] -= pa / right
            by_p[HERE, i + 1, j] -= pb / right
            by_h[UPSTREAM, i, j] += hc / left
            by_h[HERE, i, j] += ha / left
            by_h[DOWNSTREAM, i, j] += hb / left
            by_h[UPSTREAM_2, i + 1, j] -= hc / right
            by_h[UPSTREAM, i + 1, j] -= ha / right
            by_h[HERE, i + 1, j] -= hb / right
    for i in range(nodes):
        for j in range(lines - 1):
            flux, pa, pb, ha, hb = _poiseuille(p, h, at, i, j, i, j + 1, y[j + 1] - y[j])
            left, right = widths[j], widths[j + 1]
            g[i, j] += flux / left
            g[i, j + 1] -= flux / right
            by_p[HERE, i, j] += pa / left
            by_p[RIGHT, i, j] += pb / left
            by_p[LEFT, i, j + 1] -= pa / right
            by_p[HERE, i, j + 1] -= pb / right
            by_h[HERE, i, j] += ha / left
            by_h[RIGHT, i, j] += hb / left
            by_h[LEFT, i, j + 1] -= ha / right
            by_h[HERE, i, j + 1] -= hb / right
        for j in (0, lines - 1):
            # Out of the end, where p = 0, half a cell away.
            out = 2.0 / widths[j] ** 2 * at[_RHO, i, j] * h[i, j] ** 3 * math.exp(at[_LOG_FLUIDITY, i, j])
            slope = at[_RHO_SLOPE, i, j] / at[_RHO, i, j] + at[_LOG_FLUIDITY_SLOPE, i, j]
            g[i, j] += out * p[i, j]
            by_p[HERE, i, j] += out * (1.0 + slope * p[i, j])
            by_h[HERE, i, j] += 3.0 * out / h[i, j] * p[i, j]


class Balance:
    """G of the cells for given p and h, with dG/dp and dG/dh as stencils (PLACES, nodes, lines)."""

    def __init__(self, grid: Grid, unit: float, fluid: Lubricant) -> None:
        """`grid` in half widths; `unit` is the pressure p0 (Pa)."""
        self._place = grid.x, grid.columns, grid.y, grid.widths
        self._unit = unit
        self._fluid = Lubricant(*map(float, fluid))

    def __call__(
        self, p: Vector, h: Vector, wedge: float, curved: float = 1.0
    ) -> tuple[Vector, Vector, Vector]:
        """`curved`: see `upstream_weights`."""
        at = np.empty((_FLOW_BY_H + 1, *p.shape))
        g, by_p, by_h = np.zeros(p.shape), np.zeros((PLACES, *p.shape)), np.zeros((PLACES, *p.shape))
        _at_nodes(p, h, wedge, self._unit, self._fluid, at)
        _balance(p, h, at, *self._place, curved, g, by_p, by_h)
        return g, by_p, by_h

    def mass(self, p: Vector, h: Vector) -> tuple[Vector, Vector, Vector]:
        """rho h of the cells and its derivatives by p and h."""
        at = np.empty((_FLOW_BY_H + 1, *p.shape))
        _at_nodes(p, h, 1.0, self._unit, self._fluid, at)
        return at[_FLOW], at[_FLOW_BY_P], at[_FLOW_BY_H]
