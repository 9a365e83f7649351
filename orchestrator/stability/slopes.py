"""Rates along a course: of the outputs as the participants give them, of anything by differences."""

from __future__ import annotations

import numpy as np

from models.core.quantities import Vector
from models.core.system import System
from models.monolithic.trajectory import Course

# Twelve times the derivatives at the first two of five points.
ENDS = np.array([[-25.0, 48.0, -36.0, 16.0, -3.0], [-3.0, -10.0, 18.0, -6.0, 1.0]])


def slopes(values: Vector) -> Vector:
    """Derivatives along the rows (at least five), a unit apart: differences of fourth order, to the ends."""
    found = np.empty_like(values)
    found[2:-2] = 8.0 * (values[3:-1] - values[1:-3]) - (values[4:] - values[:-4])
    found[:2] = ENDS @ values[:5]
    found[-2:] = -(ENDS @ values[:-6:-1])[::-1]
    return found / 12.0


def rates_along(course: Course, system: System) -> Vector:
    """Time derivatives of all outputs, as `course.outputs`.

    A signal has the rates that participants give. Differences of the values would smooth what has a corner,
    as the film where its entrainment reverses, and a cubic misses a corner of itself by much less.
    """
    found = _given(course, system) if course.rates is None else course.rates
    return np.asarray(np.nan_to_num(found))


def _given(course: Course, system: System) -> Vector:
    """By the components, from their states."""
    found = np.zeros_like(course.outputs)
    driven = np.zeros_like(course.inputs)
    # Loops through direct feedthrough are cut: once more gives what was assumed to be at rest.
    for name in system.order * (2 if system.torn else 1):
        driven[:, system.target_index] = found[:, system.source_index]
        instance, own = system.instances[name], system.outputs.of(name)
        c, inputs = instance.component, system.inputs.of(name)
        x, u, du = (
            np.ascontiguousarray(part)
            for part in (course.states[name], course.inputs[:, inputs], driven[:, inputs])
        )
        p, work = c.parameters.vector(instance.parameters), np.zeros(c.rates_work_size)
        rates = np.zeros((len(course.times), c.outputs.size))
        give = c.flat_rates
        for k, t in enumerate(course.times):
            give(t, x[k], u[k], du[k], p, work, rates[k])
        found[:, own] = np.nan_to_num(rates)
    return found
