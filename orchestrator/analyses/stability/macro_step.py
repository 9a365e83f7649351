"""The macro step of any master as a matrix, and the errors that it predicts.

The matrix is read off the master itself, which steps linear participants in one copy for each element of the
evolving data: the participants' states, and the exchanged values (with Hermite signals also rates) at the
communication points that signals remember.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import eig
from scipy.sparse import csr_array

from models.compile.compiled import compiled
from models.core.difference import difference
from models.core.quantities import Vector
from models.core.system import Port, System
from models.monolithic.trajectory import Trajectory

from ...masters import Master
from .linear import compute_spectral_radius, find_strong_parts
from .linear_participants import LinearCoupling, build_shapes, compute_extrapolation_error, evaluate_ends
from .trajectory import compute_rates


@dataclass(frozen=True)
class MacroStep:
    """data(t + H) = matrix data(t) + defect amounts, all in nominal units, see `read_defect`.

    The data are the participants' states, then rows of exchanged values, newest first, and, with rates, as
    many rows of those times H. Signals have these `degrees`.
    """

    step: float
    degrees: Vector
    states: int
    sources: int
    matrix: Vector

    @property
    def newest(self) -> slice:
        """The exchanged values in the data."""
        return slice(self.states, self.states + self.sources)


def build_macro_step(coupling: LinearCoupling, master: Master, step: float) -> MacroStep:
    """Read the matrix off `master`; an implicit one is given as `ConvergedMaster`.

    Raises LinAlgError if the converged end values are not unique.
    """
    columns = np.empty((coupling.size, coupling.size))
    for part, data in _unit_columns(coupling.size, coupling.count):
        coupling.set_state(data, step)
        columns[:, part] = coupling.step(master, step)[:, : data.shape[1]]
    return MacroStep(step, coupling.degrees.copy(), coupling.states, coupling.sources, columns)


def read_defect(coupling: LinearCoupling, master: Master, step: float) -> Vector:
    """The defect of that macro step, (data x amounts).

    `amounts` are the changes of the true solution's values over the step, which count for held inputs, and
    their extrapolation errors (`compute_extrapolation_error`), shape after shape.
    """
    size, sources = coupling.size, coupling.sources
    kinds = 1 + len(build_shapes(step, coupling.degree))
    defect = np.empty((size, kinds * sources))
    for part, amounts in _unit_columns(kinds * sources, coupling.count):
        coupling.set_state(np.zeros((size, amounts.shape[1])), step)
        coupling.add_extrapolation_error(amounts, step)
        defect[:, part] = coupling.step(master, step)[:, : amounts.shape[1]]
    # The true solution deviates by `amounts` at the end; the rest is error.
    rates = coupling.states + coupling.rows * sources
    for source, degree in enumerate(coupling.degrees):
        for kind, (value, rate) in enumerate(evaluate_ends(step, int(degree)).T):
            defect[coupling.states + source, (1 + kind) * sources + source] -= value
            if coupling.rated:
                defect[rates + source, (1 + kind) * sources + source] -= rate * step
    return defect


def _unit_columns(size: int, count: int) -> Iterator[tuple[slice, Vector]]:
    """The columns of a unit matrix, at most `count` at a time."""
    for first in range(0, size, count):
        part = slice(first, min(first + count, size))
        yield part, np.eye(size)[:, part]


@dataclass(frozen=True)
class SampledTrajectory:
    """Exchanged values and their rates along a trajectory, (instants x sources), `interval` seconds apart."""

    interval: float
    values: Vector
    rates: Vector

    def compute_extrapolation_errors(self, count: int, degrees: Vector) -> Vector:
        """Changes over steps of `count` instants, and extrapolation errors, (steps x (1 + shapes) x sources).

        A signal of degree 0 has the change as its error.
        """
        middles = self.values[count // 2 :: count] if count % 2 == 0 else None
        step = count * self.interval
        found = {
            int(degree): compute_extrapolation_error(
                self.values[::count], self.rates[::count], step, int(degree), middles
            )
            for degree in np.unique(degrees)
        }
        shape = next(iter(found.values())).shape
        amounts = np.zeros((shape[0], 1 + max(one.shape[1] for one in found.values()), shape[2]))
        amounts[1:, 0] = np.diff(self.values[::count], axis=0) * (degrees > 0)
        for degree, one in found.items():
            amounts[:, 1 : 1 + one.shape[1], degrees == degree] = one[:, :, degrees == degree]
        return amounts


def sample_trajectory(trajectory: Trajectory, system: System, sources: Sequence[Port]) -> SampledTrajectory:
    """Values and rates of the sources along a trajectory."""
    columns = [system.outputs.index(port) for port in sources]
    interval = float(trajectory.times[1] - trajectory.times[0])
    return SampledTrajectory(
        interval, trajectory.outputs[:, columns], compute_rates(trajectory, system)[:, columns]
    )


@dataclass(frozen=True)
class ErrorCourse:
    """Errors along the `values` of a track (steps x sources), linear about one point.

    The errors obey e(n+1) = matrix e(n) + weights(n) added(n), in nominal units.
    """

    step: MacroStep
    values: Vector
    nominal: Vector
    added: Vector

    def predict(self, weights: Vector | float = 1.0) -> Vector:
        """Estimate the relative RMS error of each source: infinite if diverging."""
        driven, values, nominal = self.added * np.reshape(weights, (-1, 1)), self.values, self.nominal
        error, sparse = np.zeros_like(values), csr_array(self.step.matrix)
        with np.errstate(over="ignore", invalid="ignore"):
            propagate(sparse.data, sparse.indices, sparse.indptr, driven, self.step.newest.start, error)
            error = np.nan_to_num(error * nominal, nan=np.inf)
            found = [
                difference(error[:, i] + values[:, i], values[:, i], nominal[i]).relative_rms
                if np.all(np.abs(error[:, i]) < 1e150)
                else np.inf
                for i in range(len(nominal))
            ]
        return np.array(found)


def follow_errors(
    step: MacroStep, defect: Vector, track: SampledTrajectory, count: int, nominal: Vector
) -> ErrorCourse:
    """The errors of macro steps of `count` instants of the track."""
    values = track.values[::count]
    amounts = (track.compute_extrapolation_errors(count, step.degrees) / nominal).reshape(len(values), -1)
    return ErrorCourse(step, values, nominal, amounts @ defect[:, : amounts.shape[1]].T)


@compiled
def propagate(data: Any, columns: Any, rows: Any, driven: Any, first: int, found: Any) -> None:
    """Compute e(n) = matrix e(n - 1) + driven(n) from zero; store elements from `first` on in `found`."""
    size = driven.shape[1]
    e, before = np.zeros(size), np.zeros(size)
    for n in range(1, driven.shape[0]):
        before[:] = e
        for i in range(size):
            total = driven[n, i]
            for k in range(rows[i], rows[i + 1]):
                total += data[k] * before[columns[k]]
            e[i] = total
        for i in range(found.shape[1]):
            found[n, i] = e[first + i]


def find_growing_output(step: MacroStep, sources: Sequence[Port]) -> Port:
    """The exchanged value with the largest participation in the fastest growing mode.

    Participation is left times right eigenvector and does not depend on scaling (Perez-Arriaga 1982). Both
    vanish outside the strongly connected part that grows.
    """
    grows = max(
        find_strong_parts(step.matrix),
        key=lambda part: compute_spectral_radius(step.matrix[np.ix_(part, part)]),
    )
    values, left, right = eig(step.matrix[np.ix_(grows, grows)], left=True, right=True)
    k = int(np.argmax(np.abs(values)))
    whole = np.zeros(len(step.matrix))
    whole[grows] = np.abs(left[:, k].conj() * right[:, k])
    return sources[int(np.argmax(whole[step.states :].reshape(-1, step.sources).sum(axis=0)))]
