"""Energy bookkeeping of a system: stored, dissipated, from sources, received over power bonds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..component import DISSIPATED_POWER, SOURCE_POWER, STORED
from ..composition import Composition
from ..kernel import kernel
from ..quantities import Vector
from ..system import Port, System, alike, bounds

# Quadratures per instance, in the order of the integrated state.
DISSIPATED, SOURCED, RECEIVED = 0, 1, 2
QUADRATURES = 3


@dataclass(frozen=True)
class EnergyBalance:
    """Energies (J) of one component over time, each (n,); all but `stored` count from the first instant.

    stored - stored[0] + dissipated = sourced + received, up to what the component's description leaves
    out (see `residual`). `received` came in over the power bonds.
    """

    stored: Vector
    dissipated: Vector
    sourced: Vector
    received: Vector

    @property
    def residual(self) -> Vector:
        """stored - stored[0] + dissipated - sourced - received."""
        return np.asarray(
            self.stored - self.stored[0] + self.dissipated - self.sourced - self.received, dtype=np.float64
        )


@kernel
def _received(bonds: Any, signs: Any, u: Any, y: Any, power: Any) -> None:
    """Sum the bonds' powers; variables are numbered through inputs, then outputs."""
    inputs = u.shape[0]
    for i in range(power.shape[0]):
        power[i] = 0.0
    for k in range(bonds.shape[0]):
        effort, flow = bonds[k, 1], bonds[k, 2]
        force = u[effort] if effort < inputs else y[effort - inputs]
        speed = u[flow] if flow < inputs else y[flow - inputs]
        power[bonds[k, 0]] += signs[k] * force * speed


class Energies:
    """Stored energy and powers of `instances` (default: all) from a state and its inputs and outputs."""

    def __init__(self, system: System, instances: tuple[str, ...] | None = None) -> None:
        self.system = system
        self.instances = tuple(system.instances) if instances is None else instances
        bonds: list[tuple[int, int, int]] = []
        signs: list[float] = []
        for row, name in enumerate(self.instances):
            for bond in system.instances[name].component.bonds:
                bonds.append((row, self._variable(name, bond.effort), self._variable(name, bond.flow)))
                signs.append(float(bond.sign))
        rows = {name: (3 * row, 3 * row + 3) for row, name in enumerate(self.instances)}
        names = [name for name in alike(system.instances) if name in rows]
        self._evaluate = Composition(
            [system.instances[name].component.flat_energy for name in names],
            [(*bounds(name, system.state, system.inputs, system.parameters), *rows[name]) for name in names],
        )
        self._bonds = np.array(bonds, dtype=np.int64).reshape(-1, 3)
        self._signs = np.array(signs, dtype=np.float64)
        self._energy = np.zeros((len(self.instances), 3))
        self._power = np.zeros(len(self.instances))

    def _variable(self, instance: str, variable: str) -> int:
        if variable in self.system.instances[instance].component.inputs:
            return self.system.inputs.index(Port(instance, variable))
        return self.system.inputs.size + self.system.outputs.index(Port(instance, variable))

    def stored(self, t: float, x: Vector, u: Vector) -> Vector:
        """Stored energy of every instance, (instances,)."""
        self._evaluate(t, x, u, self.system.p, self._energy.reshape(-1))
        return self._energy[:, STORED].copy()

    def powers(self, t: float, x: Vector, u: Vector, y: Vector, rates: Vector) -> None:
        """Write dissipated, source and received power, (instances * QUADRATURES,), into `rates`."""
        self._evaluate(t, x, u, self.system.p, self._energy.reshape(-1))
        _received(self._bonds, self._signs, u, y, self._power)
        rates[DISSIPATED::QUADRATURES] = self._energy[:, DISSIPATED_POWER]
        rates[SOURCED::QUADRATURES] = self._energy[:, SOURCE_POWER]
        rates[RECEIVED::QUADRATURES] = self._power

    def balances(self, stored: Vector, quadratures: Vector) -> dict[str, EnergyBalance]:
        """From stored energies (n, instances) and integrated powers (n, instances * QUADRATURES)."""
        quadratures = quadratures - quadratures[0]
        return {
            name: EnergyBalance(
                stored[:, i],
                quadratures[:, QUADRATURES * i + DISSIPATED],
                quadratures[:, QUADRATURES * i + SOURCED],
                quadratures[:, QUADRATURES * i + RECEIVED],
            )
            for i, name in enumerate(self.instances)
        }
