"""Iteration of a macro step: rollback and sweeps until the exchanged end values agree."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from models.quantities import Vector

from ..errors import NonConvergenceError
from ..exchange import Exchange
from ..signals import evaluate, interpolate_part
from .acceleration import Acceleration
from .restart import Sweep

# A wrong end rate bends a cubic signal by 4/27 of it times the step at most.
BEND = 4.0 / 27.0
# Contraction below which a single observation is not trusted.
CAUTION = 0.01
MARGIN = 2.0
REMEMBERED = 25


def check_limits(tolerance: float, maximum_iterations: int) -> None:
    """ValueError unless an iteration can end by its tolerance or its limit."""
    if not tolerance > 0.0:
        raise ValueError(f"tolerance = {tolerance:g}: must be > 0")
    if maximum_iterations < 1:
        raise ValueError(f"maximum_iterations = {maximum_iterations}: must be at least 1")


class Interface:
    """The end values, and for Hermite signals the end rates, of a part's sources as one vector.

    In nominal units; a rate counts as what it bends its signal by.
    """

    def __init__(self, exchange: Exchange, part: Sequence[int], step: float) -> None:
        self._exchange = exchange
        self.slices = [exchange.slices[i] for i in part]
        own = np.concatenate([np.arange(s.start, s.stop) for s in self.slices])
        self.sources = own[np.isin(own, exchange.connected)]
        self.rated = self.sources[exchange.rated[self.sources]]
        self._values, self._rates = exchange.values.copy(), exchange.rates.copy()
        self._scale = np.concatenate(
            [exchange.nominal[self.sources], exchange.nominal[self.rated] / (BEND * step)]
        )

    def vector(self, values: Vector, rates: Vector) -> Vector:
        """The vector made of all sources' values and rates."""
        return np.asarray(np.concatenate([values[self.sources], rates[self.rated]]) / self._scale)

    def predicted(self, step: float) -> Vector:
        """The vector at the end of the signals as they are."""
        evaluate(self._exchange.signals, step, self._values, self._rates)
        return self.vector(self._values, self._rates)

    def assume(self, vector: Vector, end: float) -> None:
        """Let the part's signals go to the vector's content at the time `end`."""
        given = vector * self._scale
        self._values[self.sources] = given[: len(self.sources)]
        self._rates[self.rated] = given[len(self.sources) :]
        e, h = self._exchange, self._exchange.history
        for own in self.slices:
            interpolate_part(
                h.times, h.values, h.rates, h.rated, h.smooth, h.end_smooth, h.count,
                e.degree, end, self._values, self._rates, e.signals, own.start, own.stop,
            )  # fmt: skip

    def source(self, element: int) -> int:
        """The source that an element of the vector belongs to."""
        n = len(self.sources)
        return int(self.sources[element] if element < n else self.rated[element - n])


class Converging:
    """Residuals of an iteration, and whether they are small enough.

    Relative to the value where that is larger than nominal: an angle grows without end. What a result is
    still wrong by is its residual times c / (1 - c), with the contraction c of a plain sweep. That is seen
    where one plain sweep follows another; until then it is the one seen in an earlier macro step, with a
    margin of MARGIN and in proportion to the square of the step (what an exchanged force does to a position),
    for REMEMBERED steps.
    """

    def __init__(self, tolerance: float, carried: Mapping[str, Any], step: float) -> None:
        self.tolerance = tolerance
        self._step = step
        self.residuals: list[Vector] = []
        self._age = int(carried.get("age", REMEMBERED)) + 1
        self._contraction = 1.0
        if self._age < REMEMBERED:
            self._contraction = MARGIN * carried["contraction"] * (step / carried["step"]) ** 2

    def add(self, guess: Vector, result: Vector, plain: bool) -> bool:
        """True if `result` is converged; `plain`: the guess was the last result."""
        self.residuals.append(np.abs(result - guess) / np.maximum(1.0, np.abs(result)))
        last = float(self.residuals[-1].max(initial=0.0))
        if plain and len(self.residuals) == 3:  # the first sweep is of another kind
            before = float(self.residuals[-2].max())
            self._contraction, self._age = (last / before if before > 0.0 else 0.0), 0
        if last <= self.tolerance:
            return True
        c = max(CAUTION, self._contraction)
        return len(self.residuals) > 1 and c < 0.5 and last * c / (1.0 - c) <= self.tolerance

    def carried(self) -> dict[str, Any]:
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


def converge(
    exchange: Exchange,
    part: Sequence[int],
    time: float,
    step: float,
    first_sweep: Sweep,
    next_sweep: Sweep,
    accelerate: Callable[[dict[str, Any], float], Acceleration],
    tolerance: float,
    maximum_iterations: int,
) -> int:
    """Sweep over `part` until its end values agree with those that its signals assumed.

    The exchange's signals hold the extrapolation, which the first sweep uses as it is; if an estimator wants
    it, `exchange.predicted` gets what that sweep arrived at. Returns the number of sweeps. Raises
    NonConvergenceError.
    """
    end = time + step
    interface = Interface(exchange, part, step)
    guess = interface.predicted(step)
    key = f"interface {part[0]}"
    carried = exchange.carried.get(key, {})
    acceleration = accelerate(carried.get("acceleration", {}), step)
    progress = Converging(tolerance, carried.get("convergence", {}), step)
    plain = True
    with exchange.rollback(part) as roll_back:
        for iteration in range(1, maximum_iterations + 1):
            if iteration == 1:
                first_sweep(exchange, part, time, step)
                exchange.settle(part)
                if exchange.predicted is not None:
                    for own in interface.slices:
                        exchange.predicted[own] = exchange.values[own]
            else:
                roll_back()
                interface.assume(guess, end)
                next_sweep(exchange, part, time, step)
            result = interface.vector(exchange.values, exchange.rates)
            if progress.add(guess, result, plain):
                exchange.carried[key] = {
                    "acceleration": acceleration.carried(),
                    "convergence": progress.carried(),
                }
                return iteration
            # The first sweep answered other signals than the ones that follow: no difference to learn from.
            guess = result.copy() if iteration == 1 else acceleration.next(guess, result)
            plain = np.array_equal(guess, result)
    raise NonConvergenceError(_message(exchange, interface, progress, time, step))


def _message(exchange: Exchange, interface: Interface, seen: Converging, time: float, step: float) -> str:
    source = exchange.sources[interface.source(seen.worst)]
    targets = [str(c.target) for c in exchange.system.connections if c.source == source]
    return (
        f"{source} -> {', '.join(targets)}: no convergence at t = {time:.6g} s in "
        f"{len(seen.residuals)} iterations (change {seen.residuals[-1][seen.worst]:.2g} of nominal, "
        f"tolerance {seen.tolerance:g}, contraction {seen.contraction():.2f} per iteration, macro step "
        f"{step:g} s); reduce macro_step, raise maximum_iterations, use acceleration quasi_newton, or "
        "[step_control], which shortens such steps"
    )
