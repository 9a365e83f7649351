"""The slider-crank with clearance at constant speed, in F's dimensionless form (F 2.3).

A `Machine` is its parameters, a `Motion` one of its motions, advanced by whole revolutions. Angles in
radians of crank, rates per radian, lengths in rod lengths.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ...compile.kernel import kernel
from ...core.quantities import Vector
from ..equations import THESIS_ALPHA, THESIS_BETA, THESIS_XI, Mechanism, inertia
from ..flight import pendulum as pendulum_flight
from ..flight.bouncing import POSITION_SIZE, RATE_OF_Y, SCRATCH_ROWS, Walls, Y
from ..flight.flow import COLUMNS, Flow, UnresolvedError, tabulate_flow
from ..flight.samples import sample_flow, sample_pressing
from ..flight.series import TERMS
from ..forms import offset, offset_slope, wall_angle, wall_rate
from . import histories as h

FORMS = ("as_published", "corrected", "nonlinear")
# Rows of the table of events that one call of the recording kernel fills.
BATCH = 4096
# A start with a rod this many times faster than the crank is a mistake: it has too many impacts to compute.
FASTEST = 1e6
# Blocks of a motion from whose scatter the uncertainty of an exponent follows.
BLOCKS = 20


@dataclass(frozen=True)
class Machine:
    """F's dimensionless parameters; defaults: F section 4.1. ValueError if one is out of range."""

    damping: float = 0.05
    gap: float = 0.01
    restitution: float = 0.9
    form: str = "corrected"
    xi: float = THESIS_XI
    alpha: float = THESIS_ALPHA
    beta: float = THESIS_BETA
    sliding_threshold: float = 0.0

    def __post_init__(self) -> None:
        if faults := list(self.find_faults()):
            raise ValueError("; ".join(faults))

    def find_faults(self) -> Iterator[str]:
        if self.form not in FORMS:
            yield f"form = {self.form!r}: must be one of {', '.join(FORMS)}"
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name != "form" and not (math.isfinite(value) and value >= 0.0):
                yield f"{field.name} = {value}: must be a finite number, not negative"
        if self.restitution > 1.0:
            yield f"restitution = {self.restitution}: must be at most 1 (an impact cannot give energy)"
        if self.xi >= 1.0:
            yield f"xi = {self.xi}: must be less than 1 (crank radius less than rod length)"
        elif self.gap > 0.1 * math.sqrt(1.0 - self.xi**2) and self.form != "nonlinear":
            yield (
                f"gap = {self.gap}: must be at most {0.1 * math.sqrt(1.0 - self.xi**2):.4g}, so that psi "
                "stays below 0.1 rad; form 'nonlinear' has no such limit"
            )
        elif self.xi + self.gap >= 1.0:
            yield f"gap = {self.gap}: must be less than 1 - xi = {1.0 - self.xi:.4g}, or the rod turns over"

    @property
    def form_code(self) -> float:
        """The form as the kernels of `forms` take it."""
        return float(FORMS.index(self.form))

    @property
    def mechanism(self) -> Mechanism:
        """The numbers of the equation of motion."""
        sign = -1.0 if self.form == "as_published" else 1.0
        return Mechanism(self.xi, self.alpha, self.beta, sign * self.beta, self.damping)

    @property
    def start_range(self) -> tuple[float, float]:
        """psi at the lower and at the upper wall at crank angle zero."""
        lower, upper = (wall_angle(self.form_code, 0.0, y, self.mechanism) for y in (-self.gap, self.gap))
        return lower, upper

    @cached_property
    def walls(self) -> Walls:
        """The walls in y."""
        return Walls(self.gap, self.gap, self.restitution, self.sliding_threshold)

    @cached_property
    def flow(self) -> Flow | pendulum_flight.PendulumFlow:
        """The tabulated flow; of the nonlinear form only what presses to the walls is tabulated."""
        try:
            flow = tabulate_flow(self._sample, self.xi)
        except UnresolvedError as error:
            raise UnresolvedError(
                f"xi = {self.xi}, gap = {self.gap}, damping = {self.damping}: {error}; take xi (for form "
                "nonlinear xi + gap) further below 1, or less damping"
            ) from None
        if self.form == "nonlinear":
            return pendulum_flight.PendulumFlow(self.xi, self.mechanism, flow.pressing)
        return flow

    @property
    def histories(self) -> h.Histories:
        """The kernels for this form."""
        return h.NONLINEAR if self.form == "nonlinear" else h.LINEAR

    def _sample(self, cells: int) -> Vector:
        samples = np.zeros((cells, COLUMNS))
        if self.form != "nonlinear":
            sample_flow(self.mechanism, samples)
        sample_pressing(self.form_code, self.mechanism, self.gap, samples)
        return samples


class Events(NamedTuple):
    """Events in their order; one element each.

    An impact's `rate` is psi' just before it, `approach` the slider's velocity towards the wall (y' over
    l, per radian). kind: BOUNCE, ONSET (the impact with which sliding begins) or LIFT (release).
    """

    cycle: Vector
    theta: Vector
    side: Vector
    rate: Vector
    approach: Vector
    kind: Vector

    @property
    def impacts(self) -> Events:
        """Without the releases."""
        return self.where(self.kind != h.LIFT)

    def where(self, mask: Any) -> Events:
        """The events that the mask selects."""
        return Events(*(column[mask] for column in self))


class Exponents(NamedTuple):
    """Lyapunov exponents per radian of crank, -inf for a motion that slides, the second also at e = 0.

    `uncertainty`: standard error of the largest, from the scatter of `BLOCKS` blocks. `exact_sum`: what
    both must add up to for the impacts that happened.
    """

    largest: float
    second: float
    uncertainty: float
    exact_sum: float
    impacts_per_cycle: float


class Motion:
    """One motion of a machine, from (psi, psi') at crank angle zero, in flight unless it starts on a wall."""

    def __init__(self, machine: Machine, psi: float = 0.0, psi_rate: float = 0.0) -> None:
        self.machine = machine
        self.cycle = 0
        self.impact_count = 0
        self._scratch = np.zeros((SCRATCH_ROWS, TERMS))
        self._position = np.zeros(POSITION_SIZE)
        form, m = machine.form_code, machine.mechanism
        least, most = machine.start_range
        if not least <= psi <= most:
            raise ValueError(f"psi = {psi}: must be between the walls, {least:.6g} to {most:.6g} rad")
        if not abs(psi_rate) <= FASTEST:
            raise ValueError(f"psi_rate = {psi_rate}: must be from {-FASTEST:g} to {FASTEST:g} per radian")
        self._position[Y] = offset(form, 0.0, psi, m)
        self._position[RATE_OF_Y] = offset_slope(form, 0.0, psi, m) * (
            psi_rate - wall_rate(form, 0.0, 1.0, psi, m)
        )
        if machine.gap == 0.0:
            self._position[RATE_OF_Y] = 0.0

    def skip(self, cycles: int) -> Motion:
        """Advance without keeping anything."""
        self.strobe(cycles)
        return self

    def strobe(self, cycles: int) -> Vector:
        """(cycles, 3): psi, psi' and the side on which it slides, at the end of every revolution."""
        states = np.zeros((cycles, h.STATE_SIZE))
        machine = self.machine
        self.impact_count += machine.histories.strobe(
            machine.flow, machine.walls, self._position, states, self._scratch
        )
        self.cycle += cycles
        return self._in_psi(np.zeros(cycles), states)

    def trace(self, cycles: int, points: int = 1000) -> tuple[Vector, Vector]:
        """Angles since the start (cycles * points) and states as `strobe`'s at equally spaced ones."""
        phases = 2.0 * math.pi / points * np.arange(points)
        states = np.zeros((cycles, points, h.STATE_SIZE))
        machine, first = self.machine, self.cycle
        for cycle in range(cycles):
            machine.histories.sample(
                machine.flow, machine.walls, self._position, phases, states[cycle], self._scratch
            )
        self.cycle += cycles
        theta = 2.0 * math.pi * (first + np.arange(cycles))[:, np.newaxis] + phases
        flat = states.reshape(-1, h.STATE_SIZE)
        return theta.ravel(), self._in_psi(np.tile(phases, cycles), flat)

    def events(self, cycles: int) -> Events:
        """All events of so many revolutions."""
        machine, end = self.machine, self.cycle + cycles
        batches = []
        while self.cycle < end:
            batch = np.zeros((BATCH, h.EVENT_SIZE))
            self.cycle, count = machine.histories.record_events(
                machine.flow, machine.walls, self._position, self.cycle, end, batch, self._scratch
            )
            batches.append(batch[:count])
        table = np.concatenate(batches) if batches else np.zeros((0, h.EVENT_SIZE))
        self.impact_count += int(np.count_nonzero(table[:, h.KIND] != h.LIFT))
        return self._events(table)

    def exponents(self, cycles: int, blocks: int = BLOCKS) -> Exponents:
        """Lyapunov exponents over so many revolutions (rounded up to whole blocks)."""
        growths, impacts, length = self.growths(cycles, blocks)
        return exponents_of(self.machine, growths, impacts, length)

    def growths(self, cycles: int, blocks: int) -> tuple[Vector, int, int]:
        """Logarithmic growths (blocks, 2) of two tangents that follow the motion, the number of impacts, and
        the revolutions of a block."""
        machine = self.machine
        v, length = np.eye(2), -(-cycles // blocks)
        growths, impacts = np.zeros((blocks, 2)), 0
        for block in range(blocks):
            growth = np.zeros(2 + POSITION_SIZE)
            impacts += machine.histories.follow_tangents(
                machine.flow, machine.walls, self._position, v, length, growth, self._scratch
            )
            growths[block] = growth[:2]
        self.cycle += blocks * length
        self.impact_count += impacts
        return growths, impacts, length

    def _in_psi(self, phases: Vector, states: Vector) -> Vector:
        result = np.empty_like(states)
        to_psi(self.machine.form_code, self.machine.mechanism, phases, states, result)
        return result

    def _events(self, table: Vector) -> Events:
        cycle, theta, side, rate, kind = table.T
        states = np.stack([side * self.machine.gap, rate, np.zeros_like(rate)], axis=1)
        psi_rate = self._in_psi(theta, states)[:, RATE]
        return Events(cycle, theta, side, psi_rate, np.where(kind == h.LIFT, 0.0, side * rate), kind)


def exponents_of(machine: Machine, growths: Vector, impacts: float, length: int) -> Exponents:
    """Exponents from the logarithmic growths (blocks, 2) over blocks of `length` revolutions."""
    blocks, m, e = len(growths), machine.mechanism, machine.restitution
    per_cycle = impacts / (blocks * length)
    lost = -math.log(e) if e > 0.0 else math.inf
    by_impacts = 2.0 * per_cycle * lost / (2.0 * math.pi) if per_cycle else 0.0
    exact_sum = -m.damping / inertia(m) - by_impacts
    if not np.isfinite(growths[:, 0]).all():
        return Exponents(-math.inf, -math.inf, 0.0, exact_sum, per_cycle)
    rates = growths / (2.0 * math.pi * length)
    scatter = float(rates[:, 0].std(ddof=1) / math.sqrt(blocks))
    return Exponents(float(rates[:, 0].mean()), float(rates[:, 1].mean()), scatter, exact_sum, per_cycle)


# Columns of a state.
RATE = 1


@kernel
def to_psi(form: float, m: Mechanism, phases: Vector, states: Vector, result: Vector) -> None:
    """psi and psi' for states of y and y'."""
    for i in range(states.shape[0]):
        psi = wall_angle(form, phases[i], states[i, 0], m)
        slope = offset_slope(form, phases[i], psi, m)
        result[i, 0] = psi
        result[i, RATE] = wall_rate(form, phases[i], 1.0, psi, m) + states[i, RATE] / slope
        result[i, 2] = states[i, 2]
