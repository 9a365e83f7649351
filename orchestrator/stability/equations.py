"""Linearisation of a component by differences of its equations."""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np

from models.core.quantities import Layout, Vector
from models.core.system import Instance

from .linear import Linear

# Differences reach this share of the nominal size (or of the value, if larger): the rounding of a double,
# 1e-16, over it and its square, the truncation of a central difference, are below 1e-9.
SHARE = 1e-6
# Slopes to both sides that differ by more than this share of the larger one are a kink: the truncation of
# one-sided differences is of the order of SHARE.
KINK = 1e-2
# What a kernel's result may be rounded by, of its size: a thousand roundings of a double.
ROUNDING = 1e-13


def linearised(instance: Instance, t: float, x: Vector, u: Vector, outputs: Collection[str]) -> Linear:
    """The instance about (t, x, u), with zero rows for outputs other than `outputs`.

    Whole numbers (modes, counts, flags) are parameters of the point.
    """
    c = instance.component
    p = c.parameters.vector(instance.parameters)
    x, u = np.array(x, dtype=np.float64), np.array(u, dtype=np.float64)

    def rates(x: Vector, u: Vector) -> Vector:
        rate, output = np.zeros(c.state.size), np.zeros(c.outputs.size)
        c.flat_derivative(t, x, u, p, rate)
        c.flat_output(t, x, u, p, output)
        return np.concatenate([rate, output])

    wanted = np.array([True] * c.state.size + [name in outputs for name in c.outputs.names])
    smooth = [not item.quantity.discrete for item in (*c.state.fields, *c.outputs.fields)]
    rows = wanted & np.array(smooth)
    by_state, kinks = _slopes(lambda v: np.where(rows, rates(v, u), 0.0), x, c.state)
    by_input, more = _slopes(lambda v: np.where(rows, rates(x, v), 0.0), u, c.inputs)
    n = c.state.size
    return Linear(by_state[:n], by_input[:n], by_state[n:], by_input[n:], c.state.nominal, (*kinks, *more))


def _slopes(function: Callable[[Vector], Vector], at: Vector, layout: Layout) -> tuple[Vector, list[str]]:
    """Derivatives by central differences, and the variables that have a kink at this point."""
    middle = function(at)
    slopes, kinks = np.zeros((middle.size, at.size)), []
    for j, item in enumerate(layout.fields):
        if item.quantity.discrete:
            continue
        reach = SHARE * max(item.quantity.nominal, abs(at[j]))
        up, down = at.copy(), at.copy()
        up[j] += reach
        down[j] -= reach
        forward = (function(up) - middle) / (up[j] - at[j])
        backward = (middle - function(down)) / (at[j] - down[j])
        # Where one side cannot be had (a film below zero), the other speaks for both.
        forward = np.where(np.isfinite(forward), forward, backward)
        backward = np.where(np.isfinite(backward), backward, forward)
        steeper = np.where(np.abs(forward) >= np.abs(backward), forward, backward)
        rounding = ROUNDING * np.abs(middle) / reach
        kinked = np.abs(forward - backward) > KINK * np.abs(steeper) + rounding
        slopes[:, j] = np.where(kinked, steeper, 0.5 * (forward + backward))
        if np.any(kinked):
            kinks.append(item.name)
    return np.nan_to_num(slopes), kinks
