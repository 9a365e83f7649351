"""Iteration of a macro step: rollback and sweeps until the exchanged end values agree."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from models.compile.compiled import compiled
from models.core.quantities import Vector
from models.core.words import tally

from ..engine.coupling import Coupling
from ..engine.sweeps import SweepKind
from ..errors import NonConvergenceError
from .acceleration import Acceleration
from .interface import Interface, bind_interface
from .protocol import SignalOptions

# Contraction below which a single observation is not trusted.
CAUTION = 0.01
MARGIN = 2.0
# Residuals below this share of the tolerance are what participants integrate to: no smaller one is asked for.
FINEST = 1e-3
REMEMBERED = 25


@dataclass(frozen=True)
class Implicit(SignalOptions):
    """Options of a master that iterates the end values of a step."""

    implicit: ClassVar[bool] = True

    tolerance: float = 1e-9
    maximum_iterations: int = 30

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.tolerance > 0.0:
            raise ValueError(f"tolerance = {self.tolerance:g}: must be > 0")
        if self.maximum_iterations < 1:
            raise ValueError(f"maximum_iterations = {self.maximum_iterations}: must be at least 1")


@compiled
def _residuals(guess: Any, result: Any, found: Any) -> float:
    """Changes of the vector, relative where it is above nominal; the largest, or NaN where one is."""
    worst = 0.0
    for j in range(result.shape[0]):
        size = abs(result[j])
        found[j] = abs(result[j] - guess[j]) / (1.0 if size < 1.0 else size)
        if found[j] > worst or found[j] != found[j]:
            worst = found[j]
    return worst


class Converging:
    """Residuals of an iteration, and whether they are small enough.

    Relative to the value where that is larger than nominal: an angle grows without end. What a result is
    still wrong by is its residual times c / (1 - c), with the contraction c of a plain sweep. That is seen
    where one plain sweep follows another; until then it is the one seen in an earlier macro step, with a
    margin of MARGIN and in proportion to the square of the step (what an exchanged force does to a position),
    for REMEMBERED steps.
    """

    def __init__(self, tolerance: float, warm_start: Mapping[str, Any], step: float) -> None:
        self.tolerance = tolerance
        self._step = step
        self.residuals: list[Vector] = []
        self._largest = 0.0  # of the last ones
        self._age = int(warm_start.get("age", REMEMBERED)) + 1
        self._contraction = 1.0
        if self._age < REMEMBERED:
            self._contraction = MARGIN * warm_start["contraction"] * (step / warm_start["step"]) ** 2

    def add(self, guess: Vector, result: Vector, plain: bool) -> bool:
        """True if `result` is converged; `plain`: the guess was the last result."""
        residual = np.empty(len(result))
        before, last = self._largest, _residuals(guess, result, residual)
        self.residuals.append(residual)
        self._largest = last
        if plain and len(self.residuals) == 3:  # the first sweep is of another kind
            self._contraction, self._age = (last / before if before > 0.0 else 0.0), 0
        if last <= self.tolerance:
            return True
        c = max(CAUTION, self._contraction)
        return len(self.residuals) > 1 and c < 0.5 and last * c / (1.0 - c) <= self.tolerance

    def get_warm_start(self) -> dict[str, Any]:
        """The contraction for the next macro step, as plain numbers."""
        if self._age >= REMEMBERED:
            return {}
        margin = MARGIN if self._age else 1.0
        return {"contraction": self._contraction / margin, "step": self._step, "age": self._age}

    @property
    def worst(self) -> int:
        """The element with the largest last residual."""
        return int(np.argmax(self.residuals[-1]))

    def contraction(self) -> float:
        """Mean contraction of the worst element's residual per iteration."""
        first, last = float(self.residuals[0][self.worst]), float(self.residuals[-1][self.worst])
        if first <= 0.0:
            return np.inf
        return float((last / first) ** (1.0 / max(1, len(self.residuals) - 1)))


class LoopConverging(Converging):
    """Of a part with an algebraic loop, whose gain depends on no step and may be 1 or more.

    What a result is still wrong by is its residual times c / |1 - g|, with the slope g of a sweep along the
    last change of the guess and its size c. It is that of the last two sweeps of this macro step; before
    there are two, that of an earlier step with a margin of MARGIN. The first sweep is of another kind.
    """

    def __init__(self, tolerance: float, warm_start: Mapping[str, Any], step: float) -> None:
        super().__init__(tolerance, {}, step)
        self._share = MARGIN * float(warm_start.get("share", np.inf))
        self._last: tuple[Vector, Vector] | None = None

    def add(self, guess: Vector, result: Vector, plain: bool) -> bool:
        super().add(guess, result, plain)
        first = len(self.residuals) == 1
        if not first:
            self._learn(guess, result)
        share = max(self._share, CAUTION) if not first else 1.0 / CAUTION
        return self._largest * min(share, 1.0 / FINEST) <= self.tolerance

    def _learn(self, guess: Vector, result: Vector) -> None:
        if self._last is not None:
            change, answer = guess - self._last[0], result - self._last[1]
            square = float(change @ change)
            if square > 0.0:
                slope = float(change @ answer) / square
                size = float(np.linalg.norm(answer)) / math.sqrt(square)
                self._share = size / abs(1.0 - slope) if slope != 1.0 else np.inf
        self._last = guess.copy(), result.copy()

    def get_warm_start(self) -> dict[str, Any]:
        return {"share": self._share} if math.isfinite(self._share) else {}


def _has_algebraic_loop(coupling: Coupling, part: tuple[int, ...]) -> bool:
    names = {coupling.wiring.names[i] for i in part}
    return any(port.instance in names for port in coupling.wiring.system.torn)


def converge(
    coupling: Coupling,
    part: tuple[int, ...],
    time: float,
    step: float,
    first_sweep: SweepKind,
    next_sweep: SweepKind,
    accelerate: Callable[[dict[str, Any], float], Acceleration],
    options: Implicit,
    predicted: Vector,
) -> int:
    """Sweep over `part` until its end values agree with those that its signals assumed.

    The signals are the extrapolation, which the first sweep uses as it is; `predicted` gets the values that
    it arrived at. Returns the number of sweeps. Raises NonConvergenceError.
    """
    end = time + step
    interface = bind_interface(coupling, part, step)
    guess = interface.predict(step)
    key = f"interface {part[0]}"
    warm_start = coupling.state.warm_starts.get(key, {})
    acceleration = accelerate(warm_start.get("acceleration", {}), step)
    kind = LoopConverging if _has_algebraic_loop(coupling, part) else Converging
    progress = kind(options.tolerance, warm_start.get("convergence", {}), step)
    plain = True
    with coupling.points.rollback(part) as roll_back:
        for iteration in range(1, options.maximum_iterations + 1):
            if iteration == 1:
                coupling.sweep(first_sweep, part, time, step)
                coupling.settle(part, end)
                for own in interface.slices:
                    predicted[own] = coupling.state.values[own]
            else:
                roll_back()
                interface.assume(guess, end)
                coupling.sweep(next_sweep, part, time, step)
            result = interface.gather()
            if progress.add(guess, result, plain):
                coupling.state.warm_starts[key] = {
                    "acceleration": acceleration.get_warm_start(),
                    "convergence": progress.get_warm_start(),
                }
                return iteration
            # The first sweep answered other signals than the ones that follow: no difference to learn from.
            guess = result.copy() if iteration == 1 else acceleration.next(guess, result)
            plain = np.array_equal(guess, result)
    raise NonConvergenceError(_message(coupling, interface, progress, time, step))


def _message(coupling: Coupling, interface: Interface, seen: Converging, time: float, step: float) -> str:
    source = coupling.wiring.sources[interface.find_source(seen.worst)]
    targets = [str(c.target) for c in coupling.wiring.system.connections if c.source == source]
    return (
        f"{source} -> {', '.join(targets)}: no convergence at t = {time:.6g} s in "
        f"{tally(len(seen.residuals), 'iteration')} (change {seen.residuals[-1][seen.worst]:.2g} of nominal, "
        f"tolerance {seen.tolerance:g}, contraction {seen.contraction():.2f} per iteration, macro step "
        f"{step:g} s); reduce macro_step, raise maximum_iterations, use acceleration quasi_newton, or "
        "[step_control], which shortens such steps"
    )
