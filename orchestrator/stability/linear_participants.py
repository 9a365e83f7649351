"""Linear participants, exchanged by a master's signals, whose evolving data can be set and read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import cast

import numpy as np

from models.core.component import Component
from models.core.quantities import Vector
from models.core.system import Port, System

from ..engine.exchange import Exchange
from ..engine.signals import NEEDED, POINTS
from ..masters import Master
from ..participants.capabilities import HIGHEST
from ..participants.signal_degrees import find_highest_degrees
from .batched import Copies, LinearParticipant, numbered
from .extrapolation_error import HERMITE, ends, shapes
from .linear import Linear


class Bench:
    """`count` copies of a system for signals of one degree; `about` gives the participants their matrices.

    Of each exchanged value, the copies are next to each other.
    """

    def __init__(
        self,
        system: System,
        degree: int,
        watched: Mapping[str, Sequence[str]] | None = None,
        count: int = 1,
    ) -> None:
        self.system, self.degree, self.count = system, degree, count
        self._linears: Mapping[str, Linear] | None = None
        self._master: Master | None = None
        names = {
            name: [copy for variable in variables for copy in numbered(variable, count)]
            for name, variables in (watched or {}).items()
        }
        self.units = {
            name: LinearParticipant(name, instance, _nothing(instance.component), count)
            for name, instance in system.instances.items()
        }
        # Of the system an exchange looks at no more than its copies have.
        self.exchange = Exchange(cast(System, Copies(system, count)), self.units, degree, names)
        self.exchange.initialise(0.0, 1.0)
        self.sources = len(self.exchange.sources) // count
        self.nominal = self.exchange.nominal[::count]
        self.rated, self.rows = degree == HERMITE, NEEDED[degree]
        self.degrees = np.full(self.sources, degree)  # of the signals through the exchanged values

    def about(self, linears: Mapping[str, Linear], master: Master) -> None:
        """To be stepped by `master` with these matrices."""
        if self._linears is not linears:
            self._linears = linears
            for name, unit in self.units.items():
                unit.become(linears[name])
            self._limit(linears)
            self.scales = {name: linears[name].scale[:, None] for name in self.units}
            self.states = sum(len(scale) for scale in self.scales.values())
        if self._master is not master:
            self._master, self.exchange.parts = master, None

    def _limit(self, linears: Mapping[str, Linear]) -> None:
        """Let no signal have a higher degree than participants follow."""
        followed = {c.target: self._followed(linears, c.target) for c in self.system.connections}
        self.degrees[:] = self.degree
        degrees = find_highest_degrees(self.system.connections, followed)
        self.highest = max(degrees.values(), default=HIGHEST)
        for port, degree in degrees.items():
            first = Port(port.instance, numbered(port.variable, self.count)[0])
            source = self.exchange.number[first] // self.count
            self.degrees[source] = min(self.degree, degree)
        self.exchange.history.degrees[:] = np.repeat(self.degrees, self.count)

    def _followed(self, linears: Mapping[str, Linear], target: Port) -> int:
        taken = linears[target.instance].taken
        if taken is None:
            return HIGHEST
        column = self.system.instances[target.instance].component.inputs.index(target.variable)
        return int(np.argmin(np.append(taken[1 : HIGHEST + 1, column] > 0.0, False)))

    @property
    def size(self) -> int:
        """How many numbers evolve."""
        return self.states + self.rows * self.sources * (2 if self.rated else 1)

    def put(self, data: Vector, step: float) -> None:
        """The evolving data (size x copies) before a step from t = 0; zero in the copies that are left.

        The true solution is at rest.
        """
        e, given = self.exchange, data.shape[1]
        first = 0
        for name, unit in self.units.items():
            unit.rest()
            scale = self.scales[name]
            unit.x[:, :given] = data[first : first + len(scale)] * scale
            first += len(scale)
        h, block = e.history, self.rows * self.sources
        h.times[:] = -step * np.arange(POINTS)
        h.values[:], h.rates[:], h.count = 0.0, 0.0, POINTS
        shape = (self.rows, self.sources, given)
        values = h.values.reshape(POINTS, self.sources, self.count)
        values[: self.rows, :, :given] = data[first : first + block].reshape(shape) * self.nominal[:, None]
        if self.rated:
            rates = h.rates.reshape(POINTS, self.sources, self.count)
            ends = data[first + block :].reshape(shape) * self.nominal[:, None] / step
            rates[: self.rows, :, :given] = ends
        e.values[:], e.rates[:] = h.values[0], h.rates[0]
        e.carried = {}

    def after(self, master: Master, step: float) -> Vector:
        """The evolving data (size x copies) after a step of `master`; NonConvergenceError of an iteration."""
        e = self.exchange
        master.step(e, 0.0, step)
        e.accept(step)
        parts = [unit.x / self.scales[name] for name, unit in self.units.items()]
        shape = (POINTS * self.sources, self.count)
        block = self.rows * self.sources
        tiled = np.tile(self.nominal, self.rows)[:, None]
        parts.append(e.history.values.reshape(shape)[:block] / tiled)
        if self.rated:
            parts.append(e.history.rates.reshape(shape)[:block] * step / tiled)
        return np.concatenate(parts)

    def follow(self, amounts: Vector, step: float) -> None:
        """Let the true solution, from rest at the point, miss the signals by `amounts` in the next step.

        In nominal units, (shapes after shapes of exchanged values, x copies). To be called after `put`.
        """
        e, given = self.exchange, amounts.shape[1]
        for number in np.flatnonzero(np.any(amounts, axis=1)):
            kind, source = divmod(int(number), self.sources)
            missing, at_end = shapes(step, self.degrees[source]), ends(step, self.degrees[source])
            port = e.sources[source * self.count]
            variable = port.variable.partition("#")[0]
            if kind >= len(missing):  # of a signal of lower degree than others
                continue
            missed = self.nominal[source] * amounts[number]
            unit = self.units[port.instance]
            column = self.system.instances[port.instance].component.outputs.index(variable)
            unit.course_end[:, column, :given] += at_end[:, kind, None] * missed
            for c in self.system.connections:
                if c.source.instance == port.instance and c.source.variable == variable:
                    into = self.system.instances[c.target.instance].component.inputs.index(c.target.variable)
                    course = self.units[c.target.instance].course
                    course[:, into, :given] += missing[kind][:, None] * missed


def _nothing(component: Component) -> Linear:
    """Matrices of a participant that does not move."""
    n, m = component.outputs.size, component.inputs.size
    return Linear(np.zeros((0, 0)), np.zeros((0, m)), np.zeros((n, 0)), np.zeros((n, m)), np.zeros(0))
