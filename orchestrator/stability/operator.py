"""The macro step of any master as a matrix, read out of the master itself.

The master steps participants that are exactly linear, once for every element of the run's evolving data:
the participants' states, and values (with Hermite signals also rates) at the communication points that are
remembered. No master is described a second time here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.linalg import eig

from models.quantities import Vector
from models.system import Port, System

from ..exchange import Exchange
from ..masters import Master
from ..masters.gauss_seidel import sweep
from ..masters.iteration import Interface
from ..signals import DEGREES, NEEDED, POINTS
from .linear import ROWS, Linear, LinearParticipant

HERMITE = DEGREES["hermite"]


@dataclass(frozen=True)
class MacroStep:
    """data(t + H) = matrix data(t) + defect missed, all in nominal units.

    The data are the participants' states, then `rows` rows of exchanged values, newest first, and, with
    rates, as many rows of those times H. `missed`, for each exchanged value of the true solution, is by
    how much it misses the signal's own extrapolation over the step (`missed_by`).
    """

    step: float
    degree: int
    states: int
    sources: int
    matrix: Vector
    defect: Vector

    @property
    def newest(self) -> slice:
        """The exchanged values in the data."""
        return slice(self.states, self.states + self.sources)


def missed_by(values: Vector, rates: Vector, step: float, degree: int) -> Vector:
    """What the values (instants x sources, a macro step apart) miss their extrapolation by.

    Row n is for the step that ends at instant n; rows without a full past are zero.
    """
    missed = np.zeros_like(values)
    if degree == HERMITE:
        # The cubic through the last two values and rates, one step on.
        guess = 5.0 * values[:-2] - 4.0 * values[1:-1] + step * (2.0 * rates[:-2] + 4.0 * rates[1:-1])
        missed[2:] = values[2:] - guess
    else:
        missed[degree + 1 :] = np.diff(values, degree + 1, axis=0)
    return missed


@cache
def missing(step: float, degree: int) -> Vector:
    """Taylor coefficients, at the start of a step, of the polynomial that a signal of `degree` misses.

    It vanishes at all that the signal knows and is one at the end of the step.
    """
    if degree == HERMITE:
        s = np.polynomial.Polynomial([0.0, 1.0 / step])
        shape = s**2 * (s + 1.0) ** 2 / 4.0
    else:
        shape = np.polynomial.Polynomial([1.0])
        for k in range(degree + 1):
            shape = shape * np.polynomial.Polynomial([float(k), 1.0 / step]) / (k + 1.0)
    coefficients = np.zeros(ROWS)
    coefficients[: len(shape.coef)] = shape.coef
    coefficients *= [math.factorial(k) for k in range(ROWS)]
    coefficients.flags.writeable = False
    return coefficients


class Bench:
    """Linear participants, exchanged by a master's signals, whose evolving data can be set and read."""

    def __init__(
        self,
        system: System,
        linears: Mapping[str, Linear],
        degree: int,
        watched: Mapping[str, Sequence[str]] | None = None,
    ) -> None:
        """For one master alone: an iterated one leaves its parts in the exchange."""
        self.system, self.degree = system, degree
        self.units = {n: LinearParticipant(n, i, linears[n]) for n, i in system.instances.items()}
        self.exchange = Exchange(system, self.units, degree, watched)
        self.exchange.initialise(0.0, 1.0)
        self.states, self.sources = system.state.size, len(self.exchange.sources)
        self.rated, self.rows = degree == HERMITE, NEEDED[degree]

    @property
    def size(self) -> int:
        return self.states + self.rows * self.sources * (2 if self.rated else 1)

    def put(self, data: Vector, step: float) -> None:
        """The evolving data before a step from t = 0."""
        e, n = self.exchange, self.states
        for name, unit in self.units.items():
            unit.rest()
            part = self.system.state.of(name)
            unit.x[:] = data[part] * self.system.state.nominal[part]
        h, block = e.history, self.rows * self.sources
        h.times[:] = -step * np.arange(POINTS)
        h.values[:], h.rates[:] = 0.0, 0.0
        h.values[: self.rows] = data[n : n + block].reshape(self.rows, -1) * e.nominal
        if self.rated:
            h.rates[: self.rows] = data[n + block :].reshape(self.rows, -1) * e.nominal / step
        h.count = POINTS
        e.values[:], e.rates[:] = h.values[0], h.rates[0]
        e.carried = {}

    def after(self, master: Master, step: float) -> Vector:
        """The evolving data after a step of `master`; NonConvergenceError of an iteration."""
        e = self.exchange
        master.step(e, 0.0, step)
        e.accept(step)
        x = np.concatenate([unit.x for unit in self.units.values()]) / self.system.state.nominal
        parts = [x, (e.history.values[: self.rows] / e.nominal).ravel()]
        if self.rated:
            parts.append((e.history.rates[: self.rows] * step / e.nominal).ravel())
        return np.concatenate(parts)

    def follow(self, amounts: Vector, step: float) -> None:
        """Let the true solution, from rest at the point, miss the signals by `amounts` in the next step.

        In nominal units, for each exchanged value; zero is rest.
        """
        e = self.exchange
        for unit in self.units.values():
            unit.follow(*unit.standstill())
        for source in np.flatnonzero(amounts):
            port = e.sources[source]
            coefficients = missing(step, self.degree) * e.nominal[source] * amounts[source]
            unit = self.units[port.instance]
            column = self.system.instances[port.instance].component.outputs.index(port.variable)
            powers = _powers(step)
            unit.course_end[0, column] = powers @ coefficients
            unit.course_end[1, column] = powers[:-1] @ coefficients[1:]
            for connection in self.system.connections:
                if connection.source == port:
                    target = connection.target
                    layout = self.system.instances[target.instance].component.inputs
                    self.units[target.instance].course[:, layout.index(target.variable)] = coefficients


def macro_step(bench: Bench, master: Master, step: float) -> MacroStep:
    """The matrices of a macro step by `master`, column by column; NonConvergenceError of an iteration."""
    rest, alone = np.zeros(bench.sources), np.eye(bench.sources)
    bench.follow(rest, step)
    columns = np.empty((bench.size, bench.size))
    for j in range(bench.size):
        data = np.zeros(bench.size)
        data[j] = 1.0
        bench.put(data, step)
        columns[:, j] = bench.after(master, step)
    defect = np.empty((bench.size, bench.sources))
    newest = bench.states + np.arange(bench.sources)
    for j in range(bench.sources):
        bench.follow(alone[j], step)
        bench.put(np.zeros(bench.size), step)
        defect[:, j] = bench.after(master, step)
        # The true solution has moved by what was missed; the rest is error.
        defect[newest[j], j] -= 1.0
        if bench.rated:
            end_rate = (missing(step, bench.degree)[1:] * _powers(step)[:-1]).sum() * step
            defect[newest[j] + bench.rows * bench.sources, j] -= end_rate
    bench.follow(rest, step)
    return MacroStep(step, bench.degree, bench.states, bench.sources, columns, defect)


def _powers(step: float) -> Vector:
    return np.array([step**k / math.factorial(k) for k in range(ROWS)])


def contraction(bench: Bench, step: float) -> float:
    """Spectral radius of what a sweep makes of assumed end values: how a plain iteration contracts.

    Of the parts that the master iterates; it must have stepped before. Zero without such parts.
    """
    e, worst = bench.exchange, 0.0
    bench.follow(np.zeros(bench.sources), step)
    for part in e.parts or []:
        if len(part) == 1:
            continue
        interface = Interface(e, part, step)
        size = len(interface.sources) + len(interface.rated)
        matrix = np.empty((size, size))
        for j, assumed in enumerate(np.eye(size)):
            bench.put(np.zeros(bench.size), step)
            e.signals[:] = 0.0
            interface.assume(assumed, step)
            sweep(e, part, 0.0, step)
            matrix[:, j] = interface.vector(e.values, e.rates)
        worst = max(worst, spectral_radius(matrix))
    return worst


def spectral_radius(matrix: Vector) -> float:
    """The largest absolute value of an eigenvalue."""
    return float(np.max(np.abs(np.linalg.eigvals(matrix)), initial=0.0))


def runs_away(step: MacroStep, sources: Sequence[Port]) -> Port:
    """The exchanged value that takes the largest part in the fastest growth.

    Its participation: left times right eigenvector, which no scaling changes (Perez-Arriaga 1982).
    """
    values, left, right = eig(step.matrix, left=True, right=True)
    k = int(np.argmax(np.abs(values)))
    part = np.abs(left[:, k].conj() * right[:, k])[step.states :]
    return sources[int(np.argmax(part.reshape(-1, step.sources).sum(axis=0)))]
