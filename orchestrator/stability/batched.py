"""Many copies of linear participants side by side, so that a master steps them all in one pass.

A coupled run of linear participants is a linear map from one macro step to the next. `operator` reads that
out of the master, a copy for every column.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from models.core.quantities import Vector
from models.core.system import Connection, Instance, Port, System

from .linear import ROWS, Linear


def numbered(name: str, count: int) -> list[str]:
    """A variable's names in `count` copies; those of one copy are as they were."""
    return [name] if count == 1 else [f"{name}#{k}" for k in range(count)]


class Copies:
    """A system `count` times side by side, as far as an exchange looks at it: load#0, load#1, ..."""

    def __init__(self, system: System, count: int) -> None:
        self.instances: dict[str, Any] = {}
        self.nominal: list[float] = []
        self.order, self.torn = system.order, system.torn
        self.outputs = self
        self._numbers: dict[Port, int] = {}
        for name, instance in system.instances.items():
            layout = instance.component.outputs
            names = [copy for own in layout.names for copy in numbered(own, count)]
            # What answers at once is known to the matrices.
            component = SimpleNamespace(outputs=SimpleNamespace(names=names), feedthrough={})
            self.instances[name] = SimpleNamespace(component=component)
            for variable, nominal in zip(names, np.repeat(layout.nominal, count), strict=True):
                self._numbers[Port(name, variable)] = len(self.nominal)
                self.nominal.append(float(nominal))
        self.connections = tuple(
            Connection(Port(c.source.instance, out), Port(c.target.instance, into))
            for c in system.connections
            for out, into in zip(
                numbered(c.source.variable, count), numbered(c.target.variable, count), strict=True
            )
        )

    def index(self, port: Port) -> int:
        """The number of an output among all."""
        return self._numbers[port]


class LinearParticipant:
    """Implements `Participant` for the deviations, in `count` copies, of an instance from a course that it is
    linear about.

    The course is the point itself unless `follow` gives it inputs and outputs of its own in the next step.
    What comes in and goes out is course plus deviation; the states `x` (states x copies) are deviations.
    """

    restorable = True

    def __init__(self, name: str, instance: Instance, linear: Linear, count: int = 1) -> None:
        self.name, self.count = name, count
        self._component = instance.component
        inputs, outputs = linear.B.shape[1], linear.C.shape[0]
        self._U = np.zeros((ROWS, inputs, count))
        self.course = np.zeros((ROWS, inputs, count))
        self.course_end = np.zeros((2, outputs, count))
        # Deviation of the inputs at present, and its rate; the course's outputs and rates there.
        self._u = np.zeros((2, inputs, count))
        self._y = np.zeros((2, outputs, count))
        self.become(linear)

    def become(self, linear: Linear) -> None:
        """Be linear with these matrices, at rest."""
        self._linear = linear
        self.x = np.zeros((linear.A.shape[0], self.count))
        self.rest()

    def rest(self) -> None:
        """Onto the point, all deviations zero."""
        for memory in (self.x, self._U, self._u, self._y, self.course, self.course_end):
            memory[:] = 0.0

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        return [ROWS - 2] * len(input_names)

    def connect(
        self,
        input_names: Sequence[str],
        inputs: Vector,
        output_names: Sequence[str],
        outputs: Vector,
        rates: Vector,
    ) -> Sequence[bool]:
        c = self._component
        self._into = _places(c.inputs.names, input_names, self.count)
        self._out = _places(c.outputs.names, output_names, self.count)
        self._inputs, self._outputs, self._rates = inputs, outputs, rates
        return [True] * len(output_names)

    def initialise(self, start_time: float, stop_time: float) -> None:
        pass

    def finish_initialisation(self) -> None:
        pass

    def write(self) -> None:
        given = self._U.reshape(ROWS, -1)
        given[: len(self._inputs), self._into] = self._inputs
        if self._linear.taken is not None:
            self._U *= self._linear.taken[:, :, None]
        self._u[:] = self._U[:2] - self.course[:2]

    def advance(self, time: float, step: float) -> None:
        phi, gamma, ends = self._linear.step(step)
        deviation = (self._U - self.course).reshape(-1, self.count)
        self.x[:] = phi @ self.x + gamma @ deviation
        self._u[:] = (ends @ deviation).reshape(self._u.shape)
        self._y[:] = self.course_end

    def read(self) -> None:
        m = self._linear
        y = self._y[0] + m.C @ self.x + m.D @ self._u[0]
        np.take(y.ravel(), self._out, out=self._outputs)
        if self._rates.size:
            rate = self._y[1] + m.C @ (m.A @ self.x + m.B @ self._u[0]) + m.D @ self._u[1]
            np.take(rate.ravel(), self._out, out=self._rates)

    def read_all(self, values: Vector) -> None:
        values[:] = (self._y[0] + self._linear.C @ self.x + self._linear.D @ self._u[0]).ravel()

    def save(self) -> tuple[Vector, ...]:
        return self.x.copy(), self._u.copy(), self._y.copy()

    def restore(self, saved: tuple[Vector, ...]) -> None:
        self.x[:], self._u[:], self._y[:] = saved

    def release(self, saved: tuple[Vector, ...]) -> None:
        pass

    def to_bytes(self, saved: tuple[Vector, ...]) -> bytes:
        raise NotImplementedError("linear participants end with their process")

    def from_bytes(self, data: bytes) -> tuple[Vector, ...]:
        raise NotImplementedError("linear participants end with their process")

    def close(self) -> None:
        pass


def _places(known: Sequence[str], names: Sequence[str], count: int) -> Any:
    """Where variables, by their names in copies, lie in (variables x copies), row by row."""
    places = []
    for name in names:
        own, _, copy = name.partition("#")
        places.append(known.index(own) * count + int(copy or 0))
    return np.array(places, dtype=np.int64)
