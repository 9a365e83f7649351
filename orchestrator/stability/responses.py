"""Linearisation of any participant by its responses to pulses, from states that are saved and restored."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator

import numpy as np

from models.monolithic.course import Course
from models.quantities import Vector
from models.system import ModelError, System

from ..errors import RecoverableError
from ..participants import Participant
from .linear import ROWS, Linear
from .realisation import Realised, realised
from .slopes import slopes

# Samples of a response.
SAMPLES = 60
# Sizes of pulses, in nominal sizes of the input, the largest first: far above what a participant integrates
# to. The first that is answered alike to both sides, up to EVEN of the answer, is taken: a central difference
# then misses by the square of that. At a kink, where none is up to KINK, it is the larger answer.
SHARES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
EVEN, KINK = 1e-3, 1e-2
# Answers below this share of an output's nominal size tell nothing.
SILENT = 1e-13
# Effects of a Taylor coefficient below this, in nominal sizes, are lost in what a participant integrates to.
FAINT = 1e-10
# Instants of the course in a step in which a participant is brought along it.
STRIDE = 2
# What a linear system may miss of the responses before this is said, and before it is refused.
DOUBTFUL, USELESS = 1e-2, 0.5


class NotLinearError(ModelError):
    """A participant that cannot be linearised at an instant."""


class Responses:
    """Implements `Linearisation` for a participant that can save and restore its state.

    It is brought along the course with the inputs that it has there. At an instant its inputs are held, and
    each in turn gets a pulse that lasts one sample, up and down; what its outputs change by over SAMPLES
    samples of `spacing` seconds is realised by a linear system. Closing the participant is the caller's.
    """

    def __init__(self, name: str, participant: Participant, system: System, spacing: float) -> None:
        component = system.instances[name].component
        self.name, self._participant, self._spacing = name, participant, spacing
        self._layouts = component.inputs, component.outputs
        self._instead = ""
        if component.ode:
            self._instead = ", or analyse the component in its place (participant = 'in-process')"
        targets = {c.target.variable for c in system.connections if c.target.instance == name}
        self._fed = [n for n in component.inputs.names if n in targets]
        self._shown = [f.name for f in component.outputs.fields if not f.quantity.discrete]
        self._columns = [component.inputs.index(n) for n in self._fed]
        self._rows = [component.outputs.index(n) for n in self._shown]
        whole = [component.inputs.field(n).quantity.discrete for n in self._fed]
        self._perturbed = np.flatnonzero(~np.array(whole, dtype=bool))
        self._slots = system.inputs.of(name)
        self._inputs, self._outputs = np.zeros((ROWS - 1, len(self._fed))), np.zeros(len(self._shown))
        participant.connect(self._fed, self._inputs, self._shown, self._outputs, np.zeros(0))
        self._at: int | None = None
        self.residuals: dict[float, float] = {}
        self.held: list[str] = []

    def about(self, course: Course, row: int, outputs: Collection[str]) -> Linear:
        self._bring(course, row)
        t = float(course.times[row])
        held = course.inputs[row][self._slots][self._columns]
        saved = self._participant.save()
        try:
            found, kinks = self._measured(t, held, saved)
            taken = self._taken(t, held, saved, found.linear)
            self._participant.restore(saved)
        finally:
            self._participant.release(saved)
        if found.residual > USELESS:
            raise NotLinearError(
                f"{self.name}: its responses at t = {t:.6g} s are no linear system's (residual "
                f"{found.residual:.0%}); shorten macro_step, by which they are sampled{self._instead}"
            )
        self.residuals[t] = found.residual
        self.held = [n for n, rate in zip(self._fed, taken[1], strict=True) if not rate]
        return self._whole(found.linear, taken, kinks, outputs)

    def _bring(self, course: Course, row: int) -> None:
        """Along the course to a row."""
        if self._at is None:
            self._values = course.inputs[:, self._slots][:, self._columns]
            self._slopes = slopes(self._values) / float(course.times[1] - course.times[0])
            self._participant.initialise(float(course.times[0]), float(course.times[-1]))
            self._inputs[0], self._at = self._values[0], 0
            self._participant.write()
            self._participant.read()
            self._participant.finish_initialisation()
        while self._at < row:
            end = min(self._at + STRIDE, row)
            t, h = float(course.times[self._at]), float(course.times[end] - course.times[self._at])
            value, rate = self._values[[self._at, end]], self._slopes[[self._at, end]]
            mean = (value[1] - value[0]) / h
            self._inputs[:2] = value[0], rate[0]
            self._inputs[2] = 2.0 * (3.0 * mean - 2.0 * rate[0] - rate[1]) / h
            self._inputs[3] = 6.0 * (rate[0] + rate[1] - 2.0 * mean) / h**2
            self._participant.write()
            self._participant.advance(t, h)
            self._at = end

    def _answer(self, t: float, held: Vector, pulse: Vector, saved: object) -> Vector:
        """Outputs at once and after each sample, (1 + SAMPLES) x outputs."""
        unit, inputs, h = self._participant, self._inputs, self._spacing
        found = np.empty((1 + SAMPLES, len(self._outputs)))
        unit.restore(saved)
        inputs[:] = 0.0
        inputs[0] = held + pulse
        unit.write()
        unit.read()
        found[0] = self._outputs
        for k in range(SAMPLES):
            unit.advance(t + k * h, h)
            unit.read()
            found[1 + k] = self._outputs
            if k == 0:
                inputs[0] = held
                unit.write()
        return found

    def _measured(self, t: float, held: Vector, saved: object) -> tuple[Realised, list[str]]:
        rest = self._answer(t, held, np.zeros_like(held), saved)
        answers = np.zeros((*rest.shape, len(self._fed)))
        noise = np.zeros((len(self._rows), len(self._fed)))
        kinks = []
        for j in self._perturbed:
            answers[:, :, j], even, pulse = self._slope(t, held, saved, rest, int(j))
            noise[:, j] = SILENT * self._layouts[1].nominal[self._rows] / pulse
            if even > KINK:
                kinks.append(self._fed[j])
        sizes = self._layouts[0].nominal[self._columns]
        return realised(answers[1:], answers[0], self._spacing, sizes, noise), kinks

    def _slope(
        self, t: float, held: Vector, saved: object, rest: Vector, j: int
    ) -> tuple[Vector, float, float]:
        """The answer to a pulse in input j, per size of it; how different it is to both sides; that size."""
        nominal = self._layouts[0].nominal[self._columns[j]]
        size = self._layouts[1].nominal[self._rows]
        best: tuple[float, Vector, float] | None = None
        failed: RecoverableError | None = None
        for share in SHARES:
            pulse = np.zeros_like(held)
            pulse[j] = share * nominal
            try:
                up = (self._answer(t, held, pulse, saved) - rest) / pulse[j]
                down = (rest - self._answer(t, held, -pulse, saved)) / pulse[j]
            except RecoverableError as error:
                failed = error
                continue
            odd, even = np.max(np.abs(up + down), axis=0) / 2.0, np.max(np.abs(up - down), axis=0) / 2.0
            heard = odd * pulse[j] > SILENT * size
            uneven = float(np.max(even[heard] / odd[heard], initial=0.0))
            if not np.isfinite(uneven + odd.sum()):
                continue
            steeper = max(up, down, key=lambda side: float(np.max(np.abs(side) / size)))
            # At a kink the smallest pulse is nearest to it.
            if best is None or uneven < best[0] or min(uneven, best[0]) > KINK:
                best = uneven, steeper if uneven > KINK else 0.5 * (up + down), float(pulse[j])
            if uneven <= EVEN:
                break
        if best is None:
            said = f": {failed}" if failed else ""
            raise ModelError(
                f"{self.name}: no answer to small changes of {self._fed[j]} at t = {t:.6g} s{said}; shorten "
                f"macro_step, by which it is sampled{self._instead}"
            )
        return best[1], best[0], best[2]

    def _taken(self, t: float, held: Vector, saved: object, linear: Linear) -> Vector:
        """Which Taylor coefficients of its inputs it takes: whose answer is that of the linear system rather
        than none."""
        unit, h = self._participant, self._spacing
        taken = np.ones((ROWS, len(self._fed)))
        rest = self._answer(t, held, np.zeros_like(held), saved)[1]
        _, gamma, ends = linear.step(h)
        effect = linear.C @ gamma + linear.D @ ends[: len(self._fed)]
        size = self._layouts[1].nominal[self._rows]
        for k in range(1, ROWS - 1):
            for j in self._perturbed:
                # The value at the end changes by a small share.
                nominal = self._layouts[0].nominal[self._columns[j]]
                amount = SHARES[2] * nominal * math.factorial(k) / h**k
                expected = effect[:, k * len(self._fed) + j] * amount / size
                if np.linalg.norm(expected) < FAINT:
                    continue
                unit.restore(saved)
                self._inputs[:] = 0.0
                self._inputs[0] = held
                self._inputs[k, j] = amount
                unit.write()
                unit.advance(t, h)
                unit.read()
                seen = (self._outputs - rest) / size
                if np.linalg.norm(seen - expected) > np.linalg.norm(seen):
                    taken[k, j] = 0.0
        return taken

    def _whole(self, found: Linear, taken: Vector, kinks: list[str], outputs: Collection[str]) -> Linear:
        """With all of the component's inputs and outputs."""
        n, m, p = len(found.A), self._layouts[0].size, self._layouts[1].size
        B, C, D, coefficients = np.zeros((n, m)), np.zeros((p, n)), np.zeros((p, m)), np.ones((ROWS, m))
        B[:, self._columns] = found.B
        wanted = [(k, row) for k, row in enumerate(self._rows) if self._shown[k] in outputs]
        for k, row in wanted:
            C[row] = found.C[k]
            D[row, self._columns] = found.D[k]
        coefficients[:, self._columns] = taken
        return Linear(found.A, B, C, D, found.scale, tuple(kinks), coefficients)

    @property
    def residual(self) -> float:
        """The largest so far."""
        return max(self.residuals.values(), default=0.0)

    def doubts(self) -> Iterator[str]:
        """What is to be said of residuals that are large, and of inputs that are held."""
        if self.held:
            yield (
                f"{self.name} holds its inputs {', '.join(self.held)} over a step (no _der1): estimated "
                "errors leave that out."
            )
        t, worst = max(self.residuals.items(), key=lambda item: item[1], default=(0.0, 0.0))
        if worst > DOUBTFUL:
            yield (
                f"{self.name}: a linear system meets its responses at t = {t:.4g} s to {worst:.0%} only; "
                "take limits and errors with care, or sample it more finely (macro_step)."
            )
