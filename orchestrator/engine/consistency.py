"""Outputs, and their rates, that agree with the inputs at an instant: at the start, and after an event.

Values pass along the connections from participant to participant. Without algebraic loops they settle in one
pass per participant; with a loop of small gain a few more do. Other loops are solved by Newton's method, on
what one pass makes of the values: v = G(v).
"""

from typing import Any

import numpy as np

from models.core.quantities import Vector
from models.core.system import Port

from ..errors import NotFiniteError, RunError
from .exchange import Exchange
from .sweeps import propagate

# Values agree when they are right to this share of their size (or nominal size, if that is larger).
AGREED = 1e-12
# Rates come from differences inside the participants, which are less exact.
RATES_AGREED = 1e-9
# A loop goes on by passes as long as each makes the change so much smaller.
CONTRACTING = 0.5
# Perturbation of a value, in its size: outputs may bend. They are linear in rates, which are less exact.
VALUE_PERTURBATION, RATE_PERTURBATION = 1e-6, 1e-2
# Loops of smaller gain have rates that agree after as many passes as there are participants.
SMALL_GAIN = 0.05
CORRECTIONS, HALVINGS = 30, 20
# Of 1 - dG/dv. Beyond it the loop's gain is 1 as far as differences tell.
SINGULAR = 1e9


def make_consistent(exchange: Exchange, time: float) -> None:
    """Make values, and with Hermite signals rates, agree with the inputs at the present time.

    RunError where an algebraic loop has no solution, or more than one.
    """
    start = exchange.state.values.copy()
    if not _pass_values(exchange, time):
        exchange.state.values[:] = start
        _value_loop(exchange, time).solve(AGREED)
    if exchange.wiring.degree == 3:
        for _ in exchange.participants:
            before = exchange.state.rates.copy()
            propagate(exchange, exchange.wiring.all, time)
        closed = _close(exchange, before, exchange.state.rates, RATES_AGREED)
        if not closed and _gain(exchange, time) > SMALL_GAIN:
            exchange.state.rates[:] = 0.0
            marked = exchange.wiring.passed_through & exchange.state.history.rated & ~_discrete(exchange)
            _Loop(exchange, exchange.state.rates, marked, time, RATE_PERTURBATION).solve(RATES_AGREED)


def _gain(exchange: Exchange, time: float) -> float:
    """The largest gain of an algebraic loop; zero without loops. All stays as it is."""
    kept = exchange.state.arrived.copy()
    gain = _value_loop(exchange, time).gain()
    exchange.state.arrived[:] = kept
    propagate(exchange, exchange.wiring.all, time)
    exchange.state.arrived[:] = kept
    return gain


def _pass_values(exchange: Exchange, time: float) -> bool:
    """Pass values on as long as that leads to an agreement; False where it doesn't."""
    fewest, last = len(exchange.participants) + 1, np.inf
    for count in range(10 * fewest):
        before = exchange.state.values.copy()
        try:
            propagate(exchange, exchange.wiring.all, time)
        except NotFiniteError:
            if count < 2:
                raise
            return False
        if _close(exchange, before, exchange.state.values, AGREED):
            return True
        now = exchange.state.values
        change = float(np.max(np.abs(now - before) / _sizes(exchange, now)))
        if count >= fewest and not change <= CONTRACTING * last:
            return False
        last = change
    return False


class _Loop:
    """What a pass makes of the `values` (the values or rates of the exchange) of the sources `marked`."""

    def __init__(
        self, exchange: Exchange, values: Vector, marked: Any, time: float, perturbation: float
    ) -> None:
        self._exchange, self._values, self._time = exchange, values, time
        self._loop = np.flatnonzero(marked)
        self._perturbation = perturbation

    def solve(self, agreed: float) -> None:
        """Newton's method; the values are then those of the last pass."""
        guess = self._pass(self._values[self._loop])
        result = self._pass(guess)
        for _ in range(CORRECTIONS):
            sizes = _sizes(self._exchange, self._values)[self._loop]
            correction = self._correction(guess, result, sizes)
            if np.all(np.abs(correction) <= agreed * sizes):
                self._pass(guess)
                return
            guess, result = self._descend(guess, result, correction, sizes)
        raise RunError(
            f"{self._worst(result - guess, sizes)}: the values at t = {self._time:.9g} s do not agree: "
            "Newton's method finds no solution of the algebraic loop; give other start values, break the "
            "loop, or change the parameters that close it"
        )

    def _pass(self, guess: Vector) -> Vector:
        self._values[self._loop] = guess
        propagate(self._exchange, self._exchange.wiring.all, self._time)
        return self._values[self._loop].copy()

    def _correction(self, guess: Vector, result: Vector, sizes: Vector) -> Vector:
        """(1 - dG/dv)^-1 (G(v) - v)."""
        matrix = np.eye(len(guess)) - self._derivatives(guess, result, sizes)
        _, singular, rows = np.linalg.svd(matrix)
        if not singular[0] < SINGULAR * singular[-1]:
            raise RunError(
                f"{self._worst(rows[-1], 1.0)}: the values at t = {self._time:.9g} s are not determined: its "
                "algebraic loop has a gain of 1, so that no values or many agree; break the loop, or change "
                "the parameters that close it"
            )
        return np.asarray(sizes * np.linalg.solve(matrix, (result - guess) / sizes))

    def _derivatives(self, guess: Vector, result: Vector, sizes: Vector) -> Vector:
        """dG/dv by differences, in sizes."""
        matrix = np.empty((len(guess), len(guess)))
        for j, size in enumerate(sizes):
            perturbed = guess.copy()
            perturbed[j] += self._perturbation * size
            matrix[:, j] = (self._pass(perturbed) - result) / sizes / self._perturbation
        return matrix

    def gain(self) -> float:
        """The spectral radius of dG/dv."""
        guess = self._values[self._loop].copy()
        sizes = _sizes(self._exchange, self._values)[self._loop]
        matrix = self._derivatives(guess, self._pass(guess), sizes)
        return float(np.max(np.abs(np.linalg.eigvals(matrix)), initial=0.0))

    def _descend(
        self, guess: Vector, result: Vector, correction: Vector, sizes: Vector
    ) -> tuple[Vector, Vector]:
        """The corrected guess and its result; of a correction that makes the residual larger, a part."""
        before = np.linalg.norm((result - guess) / sizes)
        for halving in range(HALVINGS):
            corrected = guess + 0.5**halving * correction
            result = self._pass(corrected)
            if np.linalg.norm((result - corrected) / sizes) < before:
                break
        return corrected, result

    def _worst(self, parts: Vector, sizes: Vector | float) -> Port:
        return self._exchange.wiring.sources[self._loop[int(np.argmax(np.abs(parts) / sizes))]]


def _value_loop(exchange: Exchange, time: float) -> _Loop:
    """The loop of the values that pass through participants."""
    marked = exchange.wiring.passed_through
    return _Loop(exchange, exchange.state.values, marked, time, VALUE_PERTURBATION)


def _close(exchange: Exchange, before: Vector, now: Vector, agreed: float) -> bool:
    return bool(np.all(np.abs(now - before) <= agreed * _sizes(exchange, now)))


def _sizes(exchange: Exchange, values: Vector) -> Vector:
    return np.asarray(exchange.wiring.nominal + np.abs(values))


def _discrete(exchange: Exchange) -> Any:
    """The sources that have no rate but zero."""
    fields = (
        exchange.wiring.system.instances[port.instance].component.outputs.field(port.variable)
        for port in exchange.wiring.sources
    )
    return np.array([field.quantity.discrete for field in fields], dtype=np.bool_)
