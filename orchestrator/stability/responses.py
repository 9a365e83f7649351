"""Linearisation of any participant by its responses to pulses, from states that are saved and restored."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator

import numpy as np

from models.core.quantities import Vector
from models.core.system import ModelError, System
from models.monolithic.trajectory import Course

from ..errors import RecoverableError
from ..participants import Participant
from .linear import ROWS, Linear
from .realisation import Realised, realised
from .trajectory import Along, NotLinearError

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
# What a linear system may miss of the responses before this is said, and before it is refused.
DOUBTFUL, USELESS = 1e-2, 0.5


class Responses(Along):
    """Implements `Linearisation` for a participant that can save and restore its state.

    It is brought along the course with the inputs that it has there. At an instant its inputs are held, and
    each in turn gets a pulse that lasts one sample, up and down; what its outputs change by over SAMPLES
    samples of `spacing` seconds is realised by a linear system.
    """

    def __init__(self, name: str, participant: Participant, system: System, spacing: float) -> None:
        super().__init__(name, participant, system)
        component = system.instances[name].component
        self._spacing, self._beyond = spacing, SAMPLES * spacing
        self._instead = ""
        if component.ode:
            self._instead = ", or analyse the component in its place (participant = 'in-process')"
        whole = [component.inputs.field(n).quantity.discrete for n in self.fed]
        self._perturbed = np.flatnonzero(~np.array(whole, dtype=bool))
        self.residuals: dict[float, float] = {}

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
        return self._whole(found.linear, taken, kinks, outputs)

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
        answers = np.zeros((*rest.shape, len(self.fed)))
        noise = np.zeros((len(self._rows), len(self.fed)))
        kinks = []
        for j in self._perturbed:
            answers[:, :, j], even, pulse = self._slope(t, held, saved, rest, int(j))
            noise[:, j] = SILENT * self._layouts[1].nominal[self._rows] / pulse
            if even > KINK:
                kinks.append(self.fed[j])
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
                f"{self.name}: no answer to small changes of {self.fed[j]} at t = {t:.6g} s{said}; shorten "
                f"macro_step, by which it is sampled{self._instead}"
            )
        return best[1], best[0], best[2]

    def _taken(self, t: float, held: Vector, saved: object, linear: Linear) -> Vector:
        """Which Taylor coefficients of its inputs it takes: whose answer is that of the linear system rather
        than none."""
        unit, h = self._participant, self._spacing
        taken = np.ones((ROWS, len(self.fed)))
        rest = self._answer(t, held, np.zeros_like(held), saved)[1]
        _, gamma, ends = linear.step(h)
        effect = linear.C @ gamma + linear.D @ ends[: len(self.fed)]
        size = self._layouts[1].nominal[self._rows]
        for k in range(1, ROWS - 1):
            for j in self._perturbed:
                # The value at the end changes by a small share.
                nominal = self._layouts[0].nominal[self._columns[j]]
                amount = SHARES[2] * nominal * math.factorial(k) / h**k
                expected = effect[:, k * len(self.fed) + j] * amount / size
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

    @property
    def residual(self) -> float:
        """The largest so far."""
        return max(self.residuals.values(), default=0.0)

    @property
    def told(self) -> tuple[str, str]:
        how = "By responses to pulses, from saved and restored states"
        return how, f"{self.name} (residual {self.residual:.1g})"

    def doubts(self) -> Iterator[str]:
        """What is to be said of residuals that are large, and of inputs that are held."""
        yield from super().doubts()
        t, worst = max(self.residuals.items(), key=lambda item: item[1], default=(0.0, 0.0))
        if worst > DOUBTFUL:
            yield (
                f"{self.name}: a linear system meets its responses at t = {t:.4g} s to {worst:.0%} only; "
                "take limits and errors with care, or sample it more finely (macro_step)."
            )
