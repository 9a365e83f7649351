"""Stability of a master about a point over the macro step, and its largest stable step."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from models.core.quantities import Vector
from models.core.system import Port, System

from ...engine.coupling import Coupling
from ...engine.sweeps import GAUSS_SEIDEL
from ...errors import NonConvergenceError
from ...masters import Master
from ...masters.interface import bind_interface
from ...masters.parts import find_parts, step_in_parts
from ...masters.protocol import MasterStep
from .linear import compute_spectral_radius
from .linear_participants import HERMITE, LinearCoupling
from .linearisation import Point
from .macro_step import MacroStep, build_macro_step, find_growing_output, read_defect


class ConvergedMaster:
    """Implements `Master` for linear participants at one step: what an iteration of `master` converges to."""

    implicit: ClassVar[bool] = True

    def __init__(self, master: Master, coupling: LinearCoupling, step: float) -> None:
        self.extrapolation, self.degree, self._count = master.extrapolation, master.degree, coupling.count
        self.order, self.iterate, self.acceleration = master.order, master.iterate, master.acceleration
        e = coupling.coupling
        loops = [part for part in e.bind(find_parts, self.order, self.iterate) if len(part) > 1]
        self.sweeps = {part[0]: self._build_sweep_matrix(coupling, part, step) for part in loops}

    def _build_sweep_matrix(self, coupling: LinearCoupling, part: tuple[int, ...], step: float) -> Vector:
        """The matrix that maps assumed end values of a part's signals to those after one sweep."""
        e = coupling.coupling
        interface = bind_interface(e, part, step)
        size = interface.size // self._count
        matrix = np.empty((size, size))
        for first in range(0, size, self._count):
            columns = np.eye(size)[:, first : first + self._count]
            coupling.set_state(np.zeros((coupling.size, 0)), step)
            e.signals[:] = 0.0
            assumed = np.zeros((size, self._count))
            assumed[:, : columns.shape[1]] = columns
            interface.assume(assumed.ravel(), step)
            e.sweep(GAUSS_SEIDEL, part, 0.0, step)
            found = interface.gather().reshape(size, self._count)
            matrix[:, first : first + self._count] = found[:, : columns.shape[1]]
        return matrix

    def step(self, coupling: Coupling, time: float, step: float) -> MasterStep:
        def iterate(part: tuple[int, ...], predicted: Vector) -> int:
            matrix = self.sweeps[part[0]]
            interface = bind_interface(coupling, part, step)
            with coupling.points.rollback(part) as roll_back:
                zero: Vector = np.zeros(len(matrix) * self._count)
                interface.assume(zero, time + step)
                coupling.sweep(GAUSS_SEIDEL, part, time, step)
                rest = interface.gather().reshape(len(matrix), -1)
                roll_back()
                agreed: Any = np.linalg.solve(np.eye(len(matrix)) - matrix, rest)
                interface.assume(agreed.ravel(), time + step)
                coupling.sweep(GAUSS_SEIDEL, part, time, step)
            return 2

        return step_in_parts(coupling, self.order, self.iterate, time, step, iterate)


# Growth per macro step that rounding alone may cause: a double eigenvalue one (angle and speed of a free
# flywheel) splits by the root of 1e-16, and scaling adds a factor.
ROUNDING = 1e-6
# A system that grows by itself may grow faster by this factor when coupled: an error, not an instability.
FASTER = 1.1
# Spacing of the scan for the first unstable step: a share of the step, and radians of the fastest
# participant's own oscillation. The scan can miss a narrower island of instability.
SHARE, SPACING = 0.03, 0.03
# Oscillations that decay by exp(-this) within a step do not reduce the spacing.
DECAYED = 5.0
# Bisections of the first interval in which stability ends; ratio of the steps sampled beyond it.
BISECTIONS, RATIO = 6, math.sqrt(2.0)
# Sampling for the figure ends at this growth per step.
SEEN = 30.0
# Columns of a matrix that are computed together.
COPIES = 64
# The search for a stable step ends at the first step over this.
SHORTEST = 4096.0


@dataclass(frozen=True)
class StepBehaviour:
    """A master about a point at one macro step.

    `radius` is the spectral radius of the macro step over the system's own growth: stable up to 1, NaN if the
    iteration does not converge. `contraction` is that of one sweep of a plain iteration (NaN if explicit).
    """

    step: float
    radius: float
    contraction: float

    @property
    def stable(self) -> bool:
        return self.radius <= 1.0 + ROUNDING


class Couplings:
    """A system's `LinearCoupling`s, built on first use: many copies for matrices, one for single steps."""

    def __init__(self, system: System, watched: Mapping[str, Sequence[str]] | None = None) -> None:
        self._system, self._watched = system, watched or {}
        self._couplings: dict[tuple[int, int], LinearCoupling] = {}

    def get(self, point: Point, master: Master, count: int = COPIES) -> LinearCoupling:
        """The coupling of `count` copies about the point, for the master."""
        key = (master.degree, count)
        if key not in self._couplings:
            self._couplings[key] = LinearCoupling(self._system, master.degree, self._watched, count)
        self._couplings[key].configure(point.linears, master)
        return self._couplings[key]


class Behaviour:
    """A master with the linear participants about a point."""

    def __init__(self, point: Point, master: Master, couplings: Couplings | None = None) -> None:
        self.point, self.master = point, master
        self._couplings = couplings or Couplings(point.system)
        self._last: tuple[float, MacroStep | None, float] | None = None

    @property
    def single(self) -> LinearCoupling:
        """The coupling of one copy, with this master about this point."""
        return self._couplings.get(self.point, self.master, 1)

    @property
    def sources(self) -> Sequence[Port]:
        """The exchanged values."""
        return self.single.coupling.wiring.sources

    @property
    def order(self) -> int:
        """Order of the error of the signals: the second at most where a participant holds inputs."""
        lowest = int(min(self.single.degrees))
        order = 4 if lowest == HERMITE else lowest + 1
        return min(order, 2) if self.single.holds else order

    def macro_step(self, step: float) -> MacroStep | None:
        """The macro step; None if the master's iteration does not converge."""
        return self._evaluate(step)[0]

    def find_defect(self, step: float) -> Vector:
        """The defect of the macro step, see `read_defect`."""
        coupling, master = self._couplings.get(self.point, self.master), self.master
        return read_defect(
            coupling, ConvergedMaster(master, coupling, step) if master.implicit else master, step
        )

    def _evaluate(self, step: float) -> tuple[MacroStep | None, float]:
        """The macro step and its `StepBehaviour.contraction`; the last one is remembered."""
        if self._last is None or self._last[0] != step:
            self._last = (step, *self._build_macro_step(step))
        return self._last[1:]

    def _build_macro_step(self, step: float) -> tuple[MacroStep | None, float]:
        coupling, contraction = self._couplings.get(self.point, self.master), math.nan
        stepping: Master = self.master
        if self.master.implicit:
            converged = ConvergedMaster(self.master, coupling, step)
            stepping = converged
            radii = [compute_spectral_radius(matrix) for matrix in converged.sweeps.values()]
            contraction = max(radii, default=0.0)
            if not self._converges(step):
                return None, contraction
        try:
            return build_macro_step(coupling, stepping, step), contraction
        except np.linalg.LinAlgError:
            return None, contraction

    def _converges(self, step: float) -> bool:
        """Whether the master's own iteration converges from random data."""
        single = self.single
        single.set_state(np.random.default_rng(1).standard_normal((single.size, 1)), step)
        try:
            single.step(self.master, step)
        except NonConvergenceError:
            return False
        return True

    def evaluate(self, step: float) -> StepBehaviour:
        operator, contraction = self._evaluate(step)
        if operator is None:
            return StepBehaviour(step, math.nan, contraction)
        radius = compute_spectral_radius(operator.matrix) * math.exp(
            -min(FASTER * self.point.growth * step, 700.0)
        )
        return StepBehaviour(step, radius, contraction)

    def count_participant_steps(self, step: float, amounts: Vector) -> float:
        """Count the participants' steps in one macro step with these extrapolation errors."""
        single = self.single
        before = sum(single.coupling.calls)
        single.set_state(np.zeros((single.size, 1)), step)
        single.add_extrapolation_error(amounts[:, None], step)
        try:
            self.master.step(single.coupling, 0.0, step)
        except NonConvergenceError:
            return math.inf
        return float(sum(single.coupling.calls) - before)

    def find_growing_output(self, step: float) -> Port | None:
        """The exchanged value that grows fastest at an unstable step."""
        operator = self.macro_step(step)
        return None if operator is None else find_growing_output(operator, self.sources)


def find_stability_limit(
    behaviour: Behaviour, first: float, longest: float, samples: list[StepBehaviour], share: float = SHARE
) -> float:
    """Find the step at which stability first ends; infinite if all scanned steps up to `longest` are stable.

    Steps are scanned upwards by `share` and `SPACING` from `first`, or from a stable step below it, because
    stability can end and return within a few per cent. Returns zero if no step is stable. Fills `samples`,
    ascending.
    """
    samples.append(behaviour.evaluate(first))
    while not samples[0].stable:
        if samples[0].step <= first / SHORTEST:
            return 0.0
        samples.insert(0, behaviour.evaluate(samples[0].step / 4.0))
    del samples[1:]
    while samples[-1].stable:
        good = samples[-1].step
        if good >= longest:
            return math.inf
        slowest = 1.0 / max(behaviour.point.fastest(DECAYED / good), 1e-300)
        samples.append(behaviour.evaluate(min(good + min(share * good, SPACING * slowest), longest)))
    limit = _bisect(behaviour, good, samples[-1].step)
    while samples[-1].step * RATIO <= longest and not samples[-1].radius > SEEN:
        samples.append(behaviour.evaluate(samples[-1].step * RATIO))
    return limit


def _bisect(behaviour: Behaviour, good: float, bad: float) -> float:
    """Bisect between a stable and an unstable step."""
    for _ in range(BISECTIONS):
        middle = math.sqrt(good * bad)
        good, bad = (middle, bad) if behaviour.evaluate(middle).stable else (good, middle)
    return good


def find_hardest_point(
    points: Iterable[Point],
    master: Master,
    first: float,
    longest: float,
    couplings: Couplings | None = None,
    share: float = SHARE,
) -> tuple[Point, float]:
    """Find the point at which `master` has its smallest stability limit, and that limit."""
    worst: Point | None = None
    limit = math.inf
    for point in points:
        if limit == 0.0:
            break  # no step is stable
        behaviour = Behaviour(point, master, couplings)
        if worst is None or not behaviour.evaluate(min(limit, longest)).stable:
            found = find_stability_limit(behaviour, first, longest, [], share)
            if worst is None or found < limit:
                worst, limit = point, found
    assert worst is not None
    return worst, limit
