"""Points along a scenario's course at which it is linearised, and the coupled system about each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.core.quantities import Vector
from models.core.system import Port, System
from models.monolithic.trajectory import Course

from .linear import Linear
from .linearisation import Equations, Linearisation
from .spectra import eigenvalues
from .trajectory import NotLinearError


@dataclass(frozen=True, eq=False)
class Point:
    """All participants about one instant of the course."""

    time: float
    system: System
    linears: Mapping[str, Linear]

    @cached_property
    def growth(self) -> float:
        """The largest rate (1/s) at which the system itself grows, without splitting; not below zero.

        A system that grows is not to be blamed on its coupling.
        """
        values = eigenvalues(self.matrix)
        return max(0.0, float(np.max(values.real, initial=0.0)))

    @cached_property
    def _modes(self) -> Vector:
        """Eigenvalues (1/s) of the participants, each alone."""
        return np.concatenate([eigenvalues(linear.A) for linear in self.linears.values()])

    def fastest(self, decay: float) -> float:
        """The fastest oscillation (rad/s) of a lone participant that decays no faster than `decay` (1/s)."""
        lasting = self._modes[self._modes.real > -decay]
        return float(np.max(np.abs(lasting.imag), initial=0.0))

    @cached_property
    def matrix(self) -> Vector:
        """dx/dt = matrix x of the whole system: the connections closed exactly."""
        s = self.system
        A, B, C, D = (_blocks([getattr(self.linears[n], part) for n in s.instances]) for part in "ABCD")
        connect = np.zeros((s.inputs.size, s.outputs.size))
        connect[s.target_index, s.source_index] = 1.0
        loop = np.eye(s.outputs.size) - D @ connect
        outputs = np.linalg.solve(loop, C)
        return np.asarray(A + B @ connect @ outputs)

    @property
    def kinks(self) -> list[str]:
        """Variables with one-sided slopes here."""
        return [f"{name}.{item}" for name, linear in self.linears.items() for item in linear.kinks]


def _blocks(parts: Sequence[Vector]) -> Vector:
    rows, columns = (sum(part.shape[axis] for part in parts) for axis in (0, 1))
    whole = np.zeros((rows, columns))
    i = j = 0
    for part in parts:
        whole[i : i + part.shape[0], j : j + part.shape[1]] = part
        i, j = i + part.shape[0], j + part.shape[1]
    return whole


def point_at(
    system: System,
    course: Course,
    row: int,
    watched: Sequence[Port],
    made: Mapping[str, Linearisation] | None = None,
) -> Point:
    """The system about an instant of its course; `made` linearises its participants (by their equations)."""
    wanted = {c.source for c in system.connections} | set(watched)
    made = made or {name: Equations(system, name) for name in system.instances}
    linears = {}
    for name in system.instances:
        outputs = {port.variable for port in wanted if port.instance == name}
        linears[name] = made[name].about(course, row, outputs)
    return Point(float(course.times[row]), system, linears)


def points_at(
    system: System,
    course: Course,
    rows: Sequence[int],
    watched: Sequence[Port],
    made: Mapping[str, Linearisation] | None = None,
) -> tuple[list[Point], list[str]]:
    """The system about several instants, in ascending order; and of those left out, why.

    NotLinearError where all would be left out.
    """
    points, left = [], []
    for row in rows:
        try:
            points.append(point_at(system, course, row, watched, made))
        except NotLinearError as error:
            left.append(error)
    if not points:
        raise left[0]
    return points, [str(error) for error in left]
