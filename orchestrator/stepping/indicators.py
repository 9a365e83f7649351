"""What a step that was made says about its error, without another way through it.

The review of Kyllingstad, Sadjina and Skjong 2024 (arXiv 2406.17353) names such indicators: they need no
more of a participant than its outputs. They see what a signal has missed, not what that did inside of it.
"""

from typing import Any, Protocol

import numpy as np

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.energy.bonds import find_exchanged_bonds
from ..masters import Master
from ..masters.gauss_seidel import GaussSeidel, resolve_order


class Indicator(Protocol):
    """Judges a step by the values `assumed` (sources) at its end, to which signals went on from the past."""

    def begin(self, coupling: Coupling, master: Master) -> None:
        """Before the first step; ValueError, with the remedy, for a system that it cannot judge."""
        ...

    def measure(self, assumed: Vector, absolute: float, relative: float) -> Vector:
        """The error at the end of the step over what is allowed, for each source; zero where it sees none."""
        ...


class Defect:
    """What the signals missed at the end of the step: |y - u|, of which `absolute` of the nominal size and
    `relative` of the value are allowed. Only signals that somebody followed into the unknown count."""

    def begin(self, coupling: Coupling, master: Master) -> None:
        self._coupling = coupling
        self._extrapolated = find_extrapolated(coupling, master)

    def measure(self, assumed: Vector, absolute: float, relative: float) -> Vector:
        values, nominal = self._coupling.state.values, self._coupling.wiring.nominal
        size = np.maximum(np.abs(values), np.abs(assumed))
        missed = np.abs(values - assumed) / (absolute * nominal + relative * size)
        return np.where(self._extrapolated, missed, 0.0)


class ResidualEnergy:
    """The power that the coupling creates at the end of the step, at every power bond: "ECCO" of Sadjina,
    Kyllingstad, Skjong and Pedersen 2017 (doi 10.1007/s00366-016-0492-8), equations (15) and (20).

    One side works with its effort e and the flow f' that it assumed, the other with e' and f: e f' - e' f, of
    which `absolute` of the nominal power and `relative` of the power are allowed. It counts for the effort.
    """

    def begin(self, coupling: Coupling, master: Master) -> None:
        self._coupling, number = coupling, coupling.wiring.number
        bonds = find_exchanged_bonds(coupling.wiring.system)
        if not bonds:
            raise ValueError(
                "estimator = 'residual_energy': no connections are known to be a power bond; use defect"
            )
        self._efforts = np.array([number[bond.effort] for bond in bonds])
        self._flows = np.array([number[bond.flow] for bond in bonds])
        self._extrapolated = find_extrapolated(coupling, master)

    def measure(self, assumed: Vector, absolute: float, relative: float) -> Vector:
        values, nominal = self._coupling.state.values, self._coupling.wiring.nominal
        # What is interpolated is known at the end.
        given = np.where(self._extrapolated, assumed, values)
        e, f = values[self._efforts], values[self._flows]
        residual = e * given[self._flows] - given[self._efforts] * f
        allowed = absolute * nominal[self._efforts] * nominal[self._flows] + relative * np.abs(e * f)
        found = np.zeros_like(values)
        np.maximum.at(found, self._efforts, np.abs(residual) / allowed)
        return found


INDICATORS: dict[str, type[Indicator]] = {"defect": Defect, "residual_energy": ResidualEnergy}


def find_extrapolated(coupling: Coupling, master: Master) -> Any:
    """The sources whose signals the master extrapolates for somebody: with Gauss-Seidel those that go to a
    participant before their own."""
    wiring = coupling.wiring
    if not isinstance(master, GaussSeidel):
        found = np.zeros(len(wiring.sources), dtype=np.bool_)
        found[wiring.connected] = True
        return found
    order = resolve_order(coupling, master.order)
    found = np.zeros(len(wiring.sources), dtype=np.bool_)
    for turn, i in enumerate(order):
        for later in order[turn:]:
            own = wiring.slices[later]
            found[[c for c in wiring.columns[i] if own.start <= c < own.stop]] = True
    return found
