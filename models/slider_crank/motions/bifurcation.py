"""Bifurcation diagrams over any parameter of the machine."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from ...compile.parallel import each, no_progress
from ...core.quantities import Vector
from .machine import Machine, Motion
from .maps import vary


class Diagram(NamedTuple):
    """Points of a diagram: the parameter's value and what was recorded at it, one element each."""

    value: Vector
    recorded: Vector


def strobe_psi(motion: Motion, cycles: int) -> Vector:
    """psi at crank angle zero."""
    return motion.strobe(cycles)[:, 0]


def impact_rate(motion: Motion, cycles: int) -> Vector:
    """psi' before the impacts on the upper wall."""
    impacts = motion.events(cycles).impacts
    return impacts.rate[impacts.side > 0.0]


def impact_angle(motion: Motion, cycles: int) -> Vector:
    """Crank angle of the impacts on the upper wall."""
    impacts = motion.events(cycles).impacts
    return impacts.theta[impacts.side > 0.0]


# Quantities that a diagram records, by name.
RECORDS: Mapping[str, Callable[[Motion, int], Vector]] = {
    "impact_rate": impact_rate,
    "impact_angle": impact_angle,
    "strobe_psi": strobe_psi,
}


def sweep_from_rest(
    machine: Machine,
    name: str,
    values: Vector,
    record: str = "impact_rate",
    cycles: int = 100,
    transient: int = 400,
    workers: int | None = None,
    progress: Callable[[int, int], None] = no_progress,
) -> Diagram:
    """Diagram whose every value starts from psi = psi' = 0.

    ValueError for a parameter or value that the machine refuses.
    """

    def point(at: Machine) -> Vector:
        return RECORDS[record](Motion(at).skip(transient), cycles)

    return _diagram(values, each(point, vary(machine, name, values), workers, progress))


def continue_sweep(
    machine: Machine,
    name: str,
    values: Vector,
    record: str = "impact_rate",
    cycles: int = 100,
    transient: int = 400,
    progress: Callable[[int, int], None] = no_progress,
) -> Diagram:
    """Diagram whose every value starts where the one before ended; ValueError as in `sweep_from_rest`.

    An attractor is followed as far as it is stable: the diagram of the reversed values shows hysteresis.
    """
    state, recorded = np.zeros(2), []
    for done, at in enumerate(vary(machine, name, values)):
        motion = Motion(at, *between_walls(at, state)).skip(transient)
        recorded.append(RECORDS[record](motion, cycles))
        state = motion.strobe(1)[-1, :2]
        progress(done + 1, len(values))
    return _diagram(values, recorded)


def between_walls(machine: Machine, state: Vector) -> tuple[float, float]:
    """(psi, psi') at crank angle zero, moved to the nearer wall if the gap has become too small for it."""
    least, most = machine.start_range
    return min(max(float(state[0]), least), most), float(state[1])


def _diagram(values: Vector, recorded: list[Vector]) -> Diagram:
    counts = [len(found) for found in recorded]
    return Diagram(np.repeat(values, counts), np.concatenate(recorded))
