"""What least squares need: residuals over the noise, and their derivatives.

These are the tangents of steady cycles, or differences of predictions where a model has no tangents. A
derivative is corrected by Broyden's rule after a step that it predicted well, and found anew after others.
Where tangents predicted a step badly, as those of a train that rattles, differences over steps take their
place.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from models.core.quantities import Vector
from models.core.words import tally

from ...errors import RunError
from ...reporter import Reporter, show_share
from ...scenario.display import say
from .measured import Measured
from .models import Prediction, combine
from .parameters import Fitted
from .predictions import Predictions, Request
from .signals import Eliminated, eliminate_all

# Of a parameter: contacts' vibrations end in another phase at ten times of it, the noise of cycles is 1e-3 of
# a difference at a tenth.
SHARE = 1e-3
# Derivatives are found anew at the end of a fit that moved by more than this, and by part of a deviation.
FRESH = 0.02
# Of a parameter: the longest difference that takes the place of tangents.
WIDEST = 0.02
# Part of the change of the signals that a step's prediction may miss before the derivatives are found anew.
MISSED = 0.3
# Points whose predictions are held: a rejected step goes back to the last one.
HELD = 8


class Objective:
    """Over x, the parameters over their sizes. `noises` are the standard deviations of the signals."""

    def __init__(
        self, parameters: Sequence[Fitted], measured: Measured, predictions: Predictions, reporter: Reporter
    ) -> None:
        self.parameters, self.measured, self._reporter = parameters, measured, reporter
        self._predictions, self._shown = predictions, predictions.model.shown
        self.noises = [signal.noise or 1.0 for signal in measured.signals]
        self._held: dict[bytes, list[Prediction]] = {}
        self._x: Vector | None = None
        self._differenced: Vector | None = None
        self._slopes: list[Vector] = []
        # As they were found, without corrections: of signals, all outputs and last states, (..., parameters).
        self.derivatives: list[Prediction] = []
        self._exact, self._rounds = False, 0
        # Over which differences take the place of tangents that predicted a step badly, if any did.
        self._spans: Vector | None = None

    def values(self, x: Vector) -> dict[str, float]:
        return {one.name: float(one.size * part) for one, part in zip(self.parameters, x, strict=True)}

    @property
    def bounds(self) -> tuple[Vector, Vector]:
        """The lowest and the highest values over the parameters' sizes."""
        low, high = np.array([(one.low / one.size, one.high / one.size) for one in self.parameters]).T
        return low, high

    def predict(self, x: Vector) -> list[Prediction]:
        """Of all experiments, the nearest state before as start."""
        key = np.asarray(x).tobytes()
        if key not in self._held:
            self._hold(key, self._list_requests(x, next(reversed(self._held), None)))
        return self._held[key]

    def restart(self, x: Vector) -> bool:
        """Have the cycles at x begin as those of a sweep do: they then depend on x alone. False where some
        are not found so: those from before stay."""
        key = x.tobytes()
        before = self._held.pop(key, None)
        self._hold(key, self._list_requests(x, None))
        found = not self.find_failure(x)
        if before and not found:
            self._held[key] = before
        return found

    def _hold(self, key: bytes, requests: Sequence[Request]) -> None:
        show_share(0.0, ", predictions")
        self._held[key] = self._predictions.make(requests)
        for old in list(self._held)[:-HELD]:
            del self._held[old]

    def _list_requests(self, x: Vector, near: bytes | None) -> list[Request]:
        values = tuple(self.values(x).items())
        count = len(self.measured.experiments)
        starts: list[Vector | None] = [None] * count
        if near is not None:
            step = x - np.frombuffer(near)
            for k, one in enumerate(self._held[near]):
                starts[k] = one.state if one.state.size else None
                if one.state.size and self.derivatives:
                    moved = one.state + self.derivatives[k].state @ step
                    # Films stay positive.
                    starts[k] = np.where(moved * one.state > 0.0, moved, one.state)
        return [Request(k, values, starts[k]) for k in range(count)]

    def find_failure(self, x: Vector) -> str:
        """Where there is no prediction, and why; "" if there are all."""
        for experiment, one in zip(self.measured.experiments, self.predict(x), strict=True):
            if one.message:
                named = ", ".join(f"{name} = {value:.6g}" for name, value in self.values(x).items())
                return f"{experiment.place} with {named}: {one.message}".strip()
        return ""

    def eliminate(self, x: Vector, slopes: Sequence[Vector] | None = None) -> list[Eliminated]:
        models = [one.signals for one in self.predict(x)]
        given = slopes or [np.zeros((*one.shape, 0)) for one in models]
        return eliminate_all(self.measured, models, given, self.noises)

    def residual(self, x: Vector) -> Vector:
        """Over the noise, (n,); nan where an experiment has no prediction, from which a step goes back."""
        if failure := self.find_failure(x):
            self._reporter.line(f"a shorter step: {failure}")
            return np.full(self.measured.count, np.nan)
        return np.concatenate([one.residual for one in self.eliminate(x)])

    def jacobian(self, x: Vector) -> Vector:
        """Of the residual, (n, parameters)."""
        return self.jacobian_with(x, self.find_slopes(x))

    def jacobian_with(self, x: Vector, slopes: Sequence[Vector]) -> Vector:
        """Of the residual at x by these derivatives of the signals."""
        return np.concatenate([one.jacobian for one in self.eliminate(x, slopes)])

    def jacobian_found(self, x: Vector) -> Vector:
        """Of the residual at x by `derivatives`."""
        return self.jacobian_with(x, [one.signals for one in self.derivatives])

    @property
    def made(self) -> int:
        """Predictions that were made for it."""
        return self._predictions.made

    @property
    def outputs(self) -> Sequence[str]:
        """The rows of `Prediction.others`."""
        return self._predictions.model.outputs

    def is_fresh(self, x: Vector, deviations: Vector) -> bool:
        """Whether the derivatives were found so near to x that they hold there."""
        moved = np.abs(x - self._differenced) if self._differenced is not None else np.full(x.size, np.inf)
        near = np.minimum(0.3 * np.nan_to_num(deviations), FRESH * np.abs(x))
        return bool(np.all(moved <= np.maximum(SHARE * np.abs(x), near)))

    def refresh(self, deviations: Vector | None = None) -> None:
        """Have the next derivatives found anew: where tangents misled on the way, as differences over the
        `deviations`."""
        self._x = None
        self._spans = None if self._spans is None else deviations

    def find_slopes(self, x: Vector) -> list[Vector]:
        """Derivatives of the signals (signals, positions, parameters) by experiment."""
        now = [one.signals for one in self.predict(x)]
        if self._x is not None and np.array_equal(x, self._x):
            return self._slopes
        if self._x is None or not self._correct(x, now):
            self.derivatives = self._differentiate(x)
            self._slopes = [one.signals for one in self.derivatives]
            self._differenced = x.copy()
        self._x = x.copy()
        return self._slopes

    def _correct(self, x: Vector, now: Sequence[Vector]) -> bool:
        """Broyden's correction; False where the last step was not predicted well. Shorter steps than those of
        differences say nothing new."""
        assert self._x is not None
        step = x - self._x
        if np.linalg.norm(step) <= SHARE * np.linalg.norm(x):
            return True
        before = [one.signals for one in self.predict(self._x)]
        changed = [new - old for new, old in zip(now, before, strict=True)]
        missed = [one - slope @ step for one, slope in zip(changed, self._slopes, strict=True)]
        if self._norm(missed) > MISSED * self._norm(changed):
            if self._exact or self._spans is not None:
                self._spans = np.abs(step)
            return False
        rule = step / (step @ step)
        self._slopes = [s + one[..., None] * rule for s, one in zip(self._slopes, missed, strict=True)]
        return True

    def _norm(self, parts: Sequence[Vector]) -> float:
        weights = np.array(self.noises)[:, None]
        return float(np.sqrt(sum(np.sum((part / weights) ** 2) for part in parts)))

    @property
    def rattles(self) -> bool:
        """Whether differences took the place of tangents."""
        return self._spans is not None

    def centre(self, x: Vector) -> None:
        """Have `derivatives` by differences be of both sides."""
        if self._exact:
            return
        up, down = (self._difference(x, side) for side in (1.0, -1.0))
        pairs = zip(up, down, strict=True)
        self.derivatives = [combine(lambda a, b: 0.5 * (a + b), *pair) for pair in pairs]

    def _differentiate(self, x: Vector) -> list[Prediction]:
        """By tangents, or where these are not known by differences of one side."""
        self._rounds += 1
        self._reporter.line(f"round {self._rounds}: residuals: {self.describe(x)}")
        if self._spans is not None:
            self._exact = False
            return self._difference(x)
        requests = [replace(one, task="differentiate") for one in self._list_requests(x, x.tobytes())]
        found = self._make(f"tangents of {tally(len(requests), 'cycle')}", requests)
        why = next((one.message for one in found if one.message), "")
        self._exact = not why
        if why:
            return self._difference(x)
        sizes = np.array([one.size for one in self.parameters])
        return [combine(lambda part: part * sizes, one) for one in found]

    def _difference(self, x: Vector, side: float = 1.0) -> list[Prediction]:
        base = self.predict(x)
        columns = []
        steps = {k: self._choose_step(k, x, side) for k in range(x.size)}
        for k, found in enumerate(self._predict_beside(x, steps)):
            if any(one.message for one in found):
                steps[k] = self._choose_step(k, x, -float(np.sign(steps[k])))
                (found,) = self._predict_beside(x, {k: steps[k]})
            if message := next((one.message for one in found if one.message), ""):
                name = self.parameters[k].name
                raise RunError(f"{name}: no derivative beside {self.values(x)[name]:g}: {message}")
            columns.append(found)

        def divide(here: Vector, *beside: Vector) -> Vector:
            pairs = zip(beside, steps.values(), strict=True)
            return np.stack([(there - here) / step for there, step in pairs], axis=-1)

        return [combine(divide, here, *(found[e] for found in columns)) for e, here in enumerate(base)]

    def _choose_step(self, k: int, x: Vector, side: float) -> float:
        """To this `side` of a parameter, or to the other one where its bound is too near; never beyond."""
        one = self.parameters[k]
        length = SHARE * max(abs(float(x[k])), SHARE)
        if self._spans is not None:
            length = float(np.clip(self._spans[k], length, max(length, WIDEST * abs(x[k]))))
        rooms = {1.0: one.high / one.size - x[k], -1.0: x[k] - one.low / one.size}
        if rooms[side] < min(length, rooms[-side]):
            side = -side
        return side * min(length, rooms[side])

    def _predict_beside(self, x: Vector, steps: Mapping[int, float]) -> list[list[Prediction]]:
        """At x with one parameter changed by its step, for each of the `steps`."""
        requests: list[Request] = []
        for k, step in steps.items():
            moved = x.copy()
            moved[k] += step
            requests += self._list_requests(moved, x.tobytes())
        found = self._make(f"differences of {tally(len(requests), 'prediction')}", requests)
        count = len(self.measured.experiments)
        return [found[i * count : (i + 1) * count] for i in range(len(steps))]

    def _make(self, what: str, requests: Sequence[Request]) -> list[Prediction]:
        return self._predictions.make(requests, lambda share: show_share(share, f", {what}"))

    def estimate_noises(self, x: Vector) -> list[float]:
        """Given ones, and those that the residuals have, less the unknowns' share of freedom."""
        found, count = [], self.measured.count
        rows = zip(self.measured.signals, self.noises, self.eliminate(x), strict=True)
        for i, (signal, noise, one) in enumerate(rows):
            n = one.residual.size
            freedom = n - signal.offset - signal.gain - len(self.parameters) * n / count
            squares = float(noise**2 * (one.residual @ one.residual))
            least = 1e-9 * float(np.max(np.abs(self.measured.pool(i))))
            found.append(signal.noise or max(np.sqrt(squares / max(freedom, 1.0)), least))
        return found

    def sum_squares(self, x: Vector) -> Vector:
        """Of the residuals of each signal, in its unit."""
        rows = zip(self.noises, self.eliminate(x), strict=True)
        return np.array([noise**2 * float(one.residual @ one.residual) for noise, one in rows])

    def find_unlikelihood(self, squares: Vector) -> float:
        """The likelihood's negative logarithm for these sums of squares: residuals over a noise that is
        estimated from them say nothing."""
        total = 0.0
        for i, (signal, own) in enumerate(zip(self.measured.signals, squares, strict=True)):
            n = self.measured.pool(i).size
            total += 0.5 * (own / signal.noise**2 if signal.noise else n * np.log(max(own, 1e-300) / n))
        return float(total)

    def describe(self, x: Vector) -> str:
        """How far the signals are from the data (root mean square), in the units in which they are shown."""
        rows = zip(self.measured.signals, self.noises, self.eliminate(x), strict=True)
        return ", ".join(
            f"{signal.column} {say(noise * one.size, self._shown[signal.variable], 3)}"
            for signal, noise, one in rows
        )
