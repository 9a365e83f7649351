"""Reynolds' equation of a steady film in two dimensions, as the balance of every cell and its tangents.

In units of a half width b, its pressure p0 = b/(2 R compliance) and b^2/R for the film,

    G = d(rho h)/dx - d(eps dp/dx)/dx - d(eps dp/dy)/dy,   eps = rho h^3 / (eta wedge),
    wedge = 12 eta0 u R^2 / (b^3 p0),

where rho and eta are relative to ambient pressure; a cell is full and G = 0, or cavitated with p = 0, G >= 0.

Two choices halve the error each, at equal nodes. Through a face eta is the logarithmic mean of both sides,
which is exact for a viscosity exponential in p (the pressure rises in the inlet by 1/alpha from one node to
the next). And rho h on a face is Leonard's (1979) quadratic interpolation, weighted upstream: 3/8, 6/8, -1/8.
The first two columns of nodes and the last one have p = 0; so has the edge of the surface on both ends.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...kernel import kernel
from ...quantities import Vector
from ..fluid import Lubricant, density_ratio, density_slope, log_viscosity_ratio, log_viscosity_slope

# Whose value a cell's balance depends on: the places of a stencil.
UPSTREAM_2, UPSTREAM, HERE, DOWNSTREAM, LEFT, RIGHT = range(6)
PLACES = 6

AHEAD, AT, BEHIND = 3.0 / 8.0, 6.0 / 8.0, -1.0 / 8.0

# Below this difference of logarithms the logarithmic mean is taken from its series (error 1e-13).
_CLOSE = 1e-3

# What is kept of every node.
_LOG_FLUIDITY, _LOG_FLUIDITY_SLOPE, _CUBE, _CUBE_SLOPE, _FLOW, _FLOW_BY_P, _FLOW_BY_H = range(7)


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
            at[_LOG_FLUIDITY, i, j] = -log_viscosity_ratio(pressure, fluid)
            at[_LOG_FLUIDITY_SLOPE, i, j] = -unit * log_viscosity_slope(pressure, fluid)
            at[_CUBE, i, j] = rho * h[i, j] ** 3 / wedge
            at[_CUBE_SLOPE, i, j] = slope / rho
            at[_FLOW, i, j] = rho * h[i, j]
            at[_FLOW_BY_P, i, j] = slope * h[i, j]
            at[_FLOW_BY_H, i, j] = rho


@kernel
def _poiseuille(
    p: Any, h: Any, at: Any, i: int, j: int, k: int, l: int, distance: float
) -> tuple[float, float, float, float, float]:
    """-eps dp/dn from node (i, j) to (k, l), its derivatives by both pressures and by both films."""
    mean, by_a, by_b = logarithmic_mean(at[_LOG_FLUIDITY, i, j], at[_LOG_FLUIDITY, k, l])
    a, b = at[_CUBE, i, j], at[_CUBE, k, l]
    cube = 0.5 * (a + b)
    slope = (p[k, l] - p[i, j]) / distance
    conductance = cube * mean / distance
    by_pa = 0.5 * a * at[_CUBE_SLOPE, i, j] * mean + cube * by_a * at[_LOG_FLUIDITY_SLOPE, i, j]
    by_pb = 0.5 * b * at[_CUBE_SLOPE, k, l] * mean + cube * by_b * at[_LOG_FLUIDITY_SLOPE, k, l]
    by_ha, by_hb = 1.5 * a / h[i, j] * mean, 1.5 * b / h[k, l] * mean
    return (
        -conductance * (p[k, l] - p[i, j]),
        conductance - by_pa * slope,
        -conductance - by_pb * slope,
        -by_ha * slope,
        -by_hb * slope,
    )


@kernel
def _balance(
    p: Any, h: Any, at: Any, spacing: float, y: Any, widths: Any, g: Any, by_p: Any, by_h: Any
) -> None:
    nodes, lines = p.shape
    d = spacing
    for j in range(lines):
        for i in range(1, nodes - 1):
            flux, pa, pb, ha, hb = _poiseuille(p, h, at, i, j, i + 1, j, d)
            flux += AHEAD * at[_FLOW, i + 1, j] + AT * at[_FLOW, i, j] + BEHIND * at[_FLOW, i - 1, j]
            pa += AT * at[_FLOW_BY_P, i, j]
            pb += AHEAD * at[_FLOW_BY_P, i + 1, j]
            pc = BEHIND * at[_FLOW_BY_P, i - 1, j]
            ha += AT * at[_FLOW_BY_H, i, j]
            hb += AHEAD * at[_FLOW_BY_H, i + 1, j]
            hc = BEHIND * at[_FLOW_BY_H, i - 1, j]
            g[i, j] += flux / d
            g[i + 1, j] -= flux / d
            by_p[UPSTREAM, i, j] += pc / d
            by_p[HERE, i, j] += pa / d
            by_p[DOWNSTREAM, i, j] += pb / d
            by_p[UPSTREAM_2, i + 1, j] -= pc / d
            by_p[UPSTREAM, i + 1, j] -= pa / d
            by_p[HERE, i + 1, j] -= pb / d
            by_h[UPSTREAM, i, j] += hc / d
            by_h[HERE, i, j] += ha / d
            by_h[DOWNSTREAM, i, j] += hb / d
            by_h[UPSTREAM_2, i + 1, j] -= hc / d
            by_h[UPSTREAM, i + 1, j] -= ha / d
            by_h[HERE, i + 1, j] -= hb / d
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
            out = 2.0 / widths[j] ** 2 * at[_CUBE, i, j] * math.exp(at[_LOG_FLUIDITY, i, j])
            slope = at[_CUBE_SLOPE, i, j] + at[_LOG_FLUIDITY_SLOPE, i, j]
            g[i, j] += out * p[i, j]
            by_p[HERE, i, j] += out * (1.0 + slope * p[i, j])
            by_h[HERE, i, j] += 3.0 * out / h[i, j] * p[i, j]


class Balance:
    """G of the cells for given p and h, with dG/dp and dG/dh as stencils (PLACES, nodes, lines)."""

    def __init__(self, spacing: float, y: Vector, widths: Vector, unit: float, fluid: Lubricant) -> None:
        """Lengths in half widths; `unit` is the pressure p0 (Pa)."""
        self._place = spacing, y, widths
        self._unit = unit
        self._fluid = Lubricant(*map(float, fluid))

    def __call__(self, p: Vector, h: Vector, wedge: float) -> tuple[Vector, Vector, Vector]:
        at = np.empty((_FLOW_BY_H + 1, *p.shape))
        g, by_p, by_h = np.zeros(p.shape), np.zeros((PLACES, *p.shape)), np.zeros((PLACES, *p.shape))
        _at_nodes(p, h, wedge, self._unit, self._fluid, at)
        _balance(p, h, at, *self._place, g, by_p, by_h)
        return g, by_p, by_h
