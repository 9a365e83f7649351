"""Linearisation of a participant about an instant of a course: what every way of it offers."""

from __future__ import annotations

from collections.abc import Collection
from typing import Protocol

from models.core.system import ModelError, System
from models.monolithic.trajectory import Course

from .equations import linearised
from .linear import Linear


class Linearisation(Protocol):
    """One participant's."""

    def about(self, course: Course, row: int, outputs: Collection[str]) -> Linear:
        """The participant about an instant of the course, with zero rows for outputs other than `outputs`.

        Instants are asked for in ascending order.
        """
        ...


class Equations:
    """Implements `Linearisation` for a component, by differences of its equations.

    ModelError for one that has none of the form dx/dt = f (`Component.ode`).
    """

    def __init__(self, system: System, name: str) -> None:
        self._instance = system.instances[name]
        if not self._instance.component.ode:
            raise ModelError(
                f"{name}: {self._instance.component.name} has no form as ordinary differential equations to "
                "linearise; linearise it by its responses (--responses)"
            )
        self._name, self._inputs = name, system.inputs.of(name)

    def about(self, course: Course, row: int, outputs: Collection[str]) -> Linear:
        x, u = course.states[self._name][row], course.inputs[row][self._inputs]
        return linearised(self._instance, float(course.times[row]), x, u, outputs)
