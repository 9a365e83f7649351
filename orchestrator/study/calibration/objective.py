"""What least squares need: residuals over the noise, and their derivatives by differences of predictions.

A derivative is corrected by Broyden's rule after a step that it predicted well, and found anew after others.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from models.core.quantities import Vector

from ...errors import RunError
from ...reporter import Reporter, show_share
from ...scenario.display import format_number
from .measured import Measured
from .models import Prediction
from .parameters import Fitted
from .predictions import Predictions, Request
from .signals import Eliminated, eliminate_all

# Of a parameter: contacts' vibrations end in another phase at ten times of it, the noise of cycles is 1e-3 of
# a difference at a tenth.
SHARE = 1e-3
# Derivatives are found anew at the end of a fit that moved by more than this, and by part of a deviation.
FRESH = 0.02
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
        self._predictions, self.units = predictions, predictions.model.units
        self.noises = [signal.noise or 1.0 for signal in measured.signals]
        self._held: dict[bytes, list[Prediction]] = {}
        self._x: Vector | None = None
        self._differenced: Vector | None = None
        self._slopes: list[Vector] = []
        # Of the last states of cycles (states, parameters), where a cycle beside begins.
        self._state_slopes: list[Vector] = []
        # As they were found by differences, without corrections.
        self.differences: list[Vector] = []
        # All outputs (outputs, some positions) and their derivatives by the parameters, of each experiment.
        self.other_values: list[Vector] = []
        self.other_slopes: list[Vector] = []

    def values(self, x: Vector) -> dict[str, float]:
        return {one.name: float(one.size * part) for one, part in zip(self.parameters, x, strict=True)}

    def predict(self, x: Vector) -> list[Prediction]:
        """Of all experiments, the nearest state before as start."""
        key = np.asarray(x).tobytes()
        if key not in self._held:
            near = next(reversed(self._held), None)
            show_share(0.0, ", predictions")
            self._held[key] = self._predictions.make(self._list_requests(x, near))
            for old in list(self._held)[:-HELD]:
                del self._held[old]
        return self._held[key]

    def _list_requests(self, x: Vector, near: bytes | None) -> list[Request]:
        values = tuple(self.values(x).items())
        count = len(self.measured.experiments)
        starts: list[Vector | None] = [None] * count
        if near is not None:
            step = x - np.frombuffer(near)
            for k, one in enumerate(self._held[near]):
                starts[k] = one.state if one.state.size else None
                if one.state.size and self._state_slopes:
                    moved = one.state + self._state_slopes[k] @ step
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

    @property
    def outputs(self) -> Sequence[str]:
        """The rows of `other_values` and `other_slopes`."""
        return self._predictions.model.outputs

    def is_fresh(self, x: Vector, deviations: Vector) -> bool:
        """Whether the derivatives were found by differences so near to x that they hold there."""
        moved = np.abs(x - self._differenced) if self._differenced is not None else np.full(x.size, np.inf)
        near = np.minimum(0.3 * np.nan_to_num(deviations), FRESH * np.abs(x))
        return bool(np.all(moved <= np.maximum(SHARE * np.abs(x), near)))

    def refresh(self) -> None:
        """Have the next derivatives found by differences."""
        self._x = None

    def find_slopes(self, x: Vector) -> list[Vector]:
        """Derivatives of the signals (signals, positions, parameters) by experiment."""
        now = [one.signals for one in self.predict(x)]
        if self._x is not None and np.array_equal(x, self._x):
            return self._slopes
        if self._x is None or not self._correct(x, now):
            self.differences, self.other_slopes = self._difference(x)
            self._slopes = self.differences
            self.other_values = [one.others for one in self.predict(x)]
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
            return False
        rule = step / (step @ step)
        self._slopes = [s + one[..., None] * rule for s, one in zip(self._slopes, missed, strict=True)]
        return True

    def _norm(self, parts: Sequence[Vector]) -> float:
        weights = np.array(self.noises)[:, None]
        return float(np.sqrt(sum(np.sum((part / weights) ** 2) for part in parts)))

    def centre(self, x: Vector) -> None:
        """Have `differences` and those of the other outputs be of both sides."""
        sides = [self._difference(x, side) for side in (1.0, -1.0)]
        self.differences, self.other_slopes = (
            [0.5 * (up + down) for up, down in zip(*pair, strict=True)] for pair in zip(*sides, strict=True)
        )

    def _difference(self, x: Vector, side: float = 1.0) -> tuple[list[Vector], list[Vector]]:
        base = self.predict(x)
        columns = []
        steps = {k: side * self._choose_step(k, x) for k in range(x.size)}
        for k, found in enumerate(self._predict_beside(x, steps)):
            if any(one.message for one in found):
                steps[k] = -steps[k]
                (found,) = self._predict_beside(x, {k: steps[k]})
            if message := next((one.message for one in found if one.message), ""):
                name = self.parameters[k].name
                raise RunError(f"{name}: no derivative beside {self.values(x)[name]:g}: {message}")
            columns.append(found)
        slopes, others, states = list[Vector](), list[Vector](), list[Vector]()
        for e, there in enumerate(base):
            beside = [(found[e], step) for found, step in zip(columns, steps.values(), strict=True)]
            for name, into in (("state", states), ("signals", slopes), ("others", others)):
                here = getattr(there, name)
                into.append(np.stack([(getattr(one, name) - here) / step for one, step in beside], axis=-1))
        self._state_slopes = states
        return slopes, others

    def _choose_step(self, k: int, x: Vector) -> float:
        """Away from the nearer bound."""
        one = self.parameters[k]
        step = SHARE * max(abs(float(x[k])), SHARE)
        return -step if x[k] + step > one.high / one.size else step

    def _predict_beside(self, x: Vector, steps: Mapping[int, float]) -> list[list[Prediction]]:
        """At x with one parameter changed by its step, for each of the `steps`."""
        requests: list[Request] = []
        for k, step in steps.items():
            moved = x.copy()
            moved[k] += step
            requests += self._list_requests(moved, x.tobytes())
        self._reporter.line(f"residuals over noise: {self.describe(x)}")
        said = f", derivatives by {len(requests)} predictions"
        found = self._predictions.make(requests, lambda share: show_share(share, said))
        count = len(self.measured.experiments)
        return [found[i * count : (i + 1) * count] for i in range(len(steps))]

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
        """How far the signals are from the data, over the noise."""
        pairs = zip(self.measured.signals, self.eliminate(x), strict=True)
        return ", ".join(f"{signal.column} {format_number(one.size, 3)}" for signal, one in pairs)
