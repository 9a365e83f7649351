"""A participant that is brought along a course, to be linearised at its instants."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator

import numpy as np

from models.core.quantities import Vector
from models.core.system import ModelError, System
from models.monolithic.trajectory import Course

from ..participants import Participant
from .linear import ROWS, Linear
from .slopes import slopes

# Instants of the course in a step in which a participant is brought along it.
STRIDE = 2


class NotLinearError(ModelError):
    """A participant that cannot be linearised at an instant."""


def fed(name: str, system: System) -> list[str]:
    """The inputs that connections drive."""
    targets = {c.target.variable for c in system.connections if c.target.instance == name}
    return [n for n in system.instances[name].component.inputs.names if n in targets]


def shown(name: str, system: System) -> list[str]:
    """The outputs that are no whole numbers."""
    outputs = system.instances[name].component.outputs
    return [f.name for f in outputs.fields if not f.quantity.discrete]


class Along(ABC):
    """`participant`, in the place of the instance `name`, with the inputs that it has along a course.

    To be completed to a `Linearisation` with `about`. Closing the participant is the caller's.
    """

    _beyond = 0.0  # how long (s) it is stepped on from an instant of the course

    def __init__(self, name: str, participant: Participant, system: System) -> None:
        component = system.instances[name].component
        self.name, self._participant = name, participant
        self._layouts = component.inputs, component.outputs
        self.fed, self.shown = fed(name, system), shown(name, system)
        self._columns = [component.inputs.index(n) for n in self.fed]
        self._rows = [component.outputs.index(n) for n in self.shown]
        self._slots = system.inputs.of(name)
        self._inputs, self._outputs = np.zeros((ROWS - 1, len(self.fed))), np.zeros(len(self.shown))
        participant.connect(self.fed, self._inputs, self.shown, self._outputs, np.zeros(0))
        self._at: int | None = None
        self.held: list[str] = []

    def _bring(self, course: Course, row: int) -> None:
        """Along the course to a row."""
        if self._at is None:
            self._values = course.inputs[:, self._slots][:, self._columns]
            self._slopes = slopes(self._values) / float(course.times[1] - course.times[0])
            self._participant.initialise(float(course.times[0]), float(course.times[-1]) + self._beyond)
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

    def _whole(self, found: Linear, taken: Vector, kinks: list[str], outputs: Collection[str]) -> Linear:
        """With all of the component's inputs and outputs; `taken` (ROWS x fed) as `Linear` has it."""
        n, m, p = len(found.A), self._layouts[0].size, self._layouts[1].size
        B, C, D, coefficients = np.zeros((n, m)), np.zeros((p, n)), np.zeros((p, m)), np.ones((ROWS, m))
        B[:, self._columns] = found.B
        wanted = [(k, row) for k, row in enumerate(self._rows) if self.shown[k] in outputs]
        for k, row in wanted:
            C[row] = found.C[k]
            D[row, self._columns] = found.D[k]
        coefficients[:, self._columns] = taken
        self.held = [name for name, rate in zip(self.fed, taken[1], strict=True) if not rate]
        return Linear(found.A, B, C, D, found.scale, tuple(kinks), coefficients)

    @property
    @abstractmethod
    def told(self) -> tuple[str, str]:
        """How it is linearised, and itself with what is to be said of it."""

    def doubts(self) -> Iterator[str]:
        """What is to be said of inputs that are held."""
        if self.held:
            yield (
                f"{self.name} holds its inputs {', '.join(self.held)} over a step (no _der1): values that go "
                "there are held with every signal, in these limits and errors too."
            )
