"""Maps of the largest exponent over two parameters of the machine."""

import math
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from typing import Any, NamedTuple, cast

import numpy as np

from ...compile.parallel import each, no_progress
from ...core.quantities import Vector
from .machine import Machine, Motion

# Parameters that a map or a bifurcation diagram can vary.
VARIABLES = tuple(field.name for field in fields(Machine) if field.name != "form")
# Revolutions after which a motion that slides is recognised: chatter is the most expensive motion, and its
# exponent is known.
FIRST_LOOK = 20


class ExponentMap(NamedTuple):
    """Of every point, (rows of y, columns of x): the largest exponent per radian, -inf where the motion
    slides, its standard error, and impacts per cycle."""

    largest: Vector
    uncertainty: Vector
    impacts_per_cycle: Vector


def exponent_map(
    machine: Machine,
    x: tuple[str, Vector],
    y: tuple[str, Vector],
    cycles: int = 1000,
    transient: int = 200,
    workers: int | None = None,
    progress: Callable[[int, int], None] = no_progress,
) -> ExponentMap:
    """Largest exponent from psi = psi' = 0 over the values of two parameters of `machine`.

    ValueError if a parameter has no such name or a value that the machine refuses (before any is computed).
    """

    def point(at: Machine) -> tuple[float, float, float]:
        return largest_exponent(at, cycles, transient)

    found = np.array(each(point, build_grid(machine, x, y), workers, progress))
    return ExponentMap(*found.T.reshape(3, len(y[1]), len(x[1])))


def build_grid(machine: Machine, x: tuple[str, Vector], y: tuple[str, Vector]) -> list[Machine]:
    """The machines of a map, row by row."""
    if x[0] == y[0]:
        raise ValueError(f"x = y = {x[0]!r}: must be two different parameters")
    return [point for row in vary(machine, *y) for point in vary(row, *x)]


def vary(machine: Machine, name: str, values: Sequence[float] | Vector) -> list[Machine]:
    """The machine with other values of one parameter."""
    names = tuple(field.name for field in fields(machine) if field.name != "form")
    if name not in names:
        raise ValueError(f"no parameter {name!r}: must be one of {', '.join(names)}")
    return [replace(machine, **cast(Any, {name: float(value)})) for value in values]


def largest_exponent(machine: Machine, cycles: int, transient: int) -> tuple[float, float, float]:
    """Largest exponent, its standard error and impacts per cycle after a transient from psi = psi' = 0."""
    motion = Motion(machine)
    states = motion.strobe(min(FIRST_LOOK, transient))
    if not (states[:-1] == states[-1:]).all(axis=1).any():
        motion.skip(transient - len(states))
    first = motion.exponents(FIRST_LOOK)
    found = first if first.largest == -math.inf else motion.exponents(cycles)
    return found.largest, found.uncertainty, found.impacts_per_cycle
