"""Energy bookkeeping of a system: stored, dissipated, from sources, received over power bonds."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..compile.array_pointers import ArrayPointers, integer_table, integers, numbers
from ..compile.kernel import kernel
from ..core.component import DISSIPATED_POWER, IMPACT_LOSS, IMPACT_WORK, SOURCE_POWER, STORED
from ..core.composition import Composition, Tables
from ..core.quantities import Vector
from ..core.system import Port, System, alike, bounds

# Quadratures per instance, in the order of the integrated state.
DISSIPATED, SOURCED, RECEIVED = 0, 1, 2
QUADRATURES = 3


@dataclass(frozen=True)
class EnergyBalance:
    """Energies (J) of one component over time, each (n,); all but `stored` count from the first instant.

    stored - stored[0] + dissipated = sourced + received, up to what the component's description leaves
    out (see `residual`). `received` came in over the power bonds and, at impacts, with their impulses.
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


def make_powers(run: Any) -> Any:
    """powers(t, x, u, p, y, memory, rates): QUADRATURES powers of every instance into `rates`.

    `run` computes the instances' energies. A bond's variables are numbered through inputs, then outputs.
    """

    @kernel
    def powers(t: float, x: Any, u: Any, p: Any, y: Any, memory: Any, rates: Any) -> None:
        m = memory[0]
        energy, bonds, signs, none = (
            numbers(m.energy),
            integer_table(m.bonds),
            numbers(m.signs),
            integers(m.none),
        )
        run(t, x, u, p, energy, Tables(none, none, integer_table(m.bounds), integers(m.ends)), 0)
        for i in range(rates.shape[0] // QUADRATURES):
            rates[QUADRATURES * i + DISSIPATED] = energy[3 * i + DISSIPATED_POWER]
            rates[QUADRATURES * i + SOURCED] = energy[3 * i + SOURCE_POWER]
            rates[QUADRATURES * i + RECEIVED] = 0.0
        inputs = u.shape[0]
        for k in range(signs.shape[0]):
            effort, flow = bonds[k, 1], bonds[k, 2]
            force = u[effort] if effort < inputs else y[effort - inputs]
            speed = u[flow] if flow < inputs else y[flow - inputs]
            rates[QUADRATURES * bonds[k, 0] + RECEIVED] += signs[k] * force * speed

    return powers


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
        self._energy = np.zeros((len(self.instances), 3))
        self.memory = ArrayPointers(
            energy=self._energy.reshape(-1),
            bonds=np.array(bonds, dtype=np.int64).reshape(-1, 3),
            signs=np.array(signs, dtype=np.float64),
            bounds=self._evaluate.bounds,
            ends=self._evaluate.ends,
            none=self._evaluate.source,
        )
        self.flat_powers = make_powers(self._evaluate.run)

    def _variable(self, instance: str, variable: str) -> int:
        if variable in self.system.instances[instance].component.inputs:
            return self.system.inputs.index(Port(instance, variable))
        return self.system.inputs.size + self.system.outputs.index(Port(instance, variable))

    def stored(self, t: float, x: Vector, u: Vector) -> Vector:
        """Stored energy of every instance, (instances,)."""
        self._evaluate(t, x, u, self.system.p, self._energy.reshape(-1))
        return self._energy[:, STORED].copy()

    def along(self, times: Vector, states: Vector, inputs: Vector) -> Vector:
        """Stored energies (n, instances); each row begins with the system's state."""
        rows = zip(times, states, inputs, strict=True)
        return np.array([self.stored(float(t), x, u) for t, x, u in rows])

    def powers(self, t: float, x: Vector, u: Vector, y: Vector, rates: Vector) -> None:
        """Write dissipated, source and received power, (instances * QUADRATURES,), into `rates`."""
        self.flat_powers(t, x, u, self.system.p, y, self.memory.record, rates)

    def balances(self, stored: Vector, quadratures: Vector, states: Vector) -> dict[str, EnergyBalance]:
        """From stored energies (n, instances), integrals of powers (n, instances * QUADRATURES) and the
        system's states (n, size)."""
        quadratures = quadratures - quadratures[0]
        return {
            name: EnergyBalance(
                stored[:, i],
                quadratures[:, QUADRATURES * i + DISSIPATED] + self._of_impacts(name, IMPACT_LOSS, states),
                quadratures[:, QUADRATURES * i + SOURCED],
                quadratures[:, QUADRATURES * i + RECEIVED] + self._of_impacts(name, IMPACT_WORK, states),
            )
            for i, name in enumerate(self.instances)
        }

    def _of_impacts(self, name: str, energy: str, states: Vector) -> Any:
        """What the sum `energy` of an instance has grown by; zero if its component has none."""
        if energy not in self.system.instances[name].component.state:
            return 0.0
        sums = states[:, self.system.state.index(Port(name, energy))]
        return sums - sums[0]
