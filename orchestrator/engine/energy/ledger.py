"""Instances that count their energies, and the ledger: an observer that books them of every record."""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from models.core.bonds import (
    DISSIPATED_ENERGY,
    GAINED_ENERGY,
    SOURCED_ENERGY,
    STORED_ENERGY,
    CountingComponent,
    counting,
    energy_through,
)
from models.core.quantities import Quantity, Vector
from models.core.system import System

from ...store.journal import SUFFIX, Journal, Mark
from ..observer import Observer, is_recorded
from ..step import Step
from .account import Account, BondAccount, ComponentAccount
from .bonds import Bond, find_bonds


def add_counting(system: System, names: Collection[str]) -> System:
    """The system with the instances `names` counting their energies."""
    return system.with_instances(
        {
            name: replace(i, component=counting(i.component)) if name in names else i
            for name, i in system.instances.items()
        }
    )


def counting_structure(structure: Mapping[str, int]) -> dict[str, int]:
    """The structure of the FMU that counts."""
    return {**structure, "energies": 1}


@dataclass(frozen=True)
class Sides:
    """A bond between two instances, with the outputs that count what came in on the side that gives the
    effort and on the side that gives the flow; None where a side does not count it."""

    bond: Bond
    effort: str | None
    flow: str | None

    @property
    def both(self) -> bool:
        """The ledger can say what the coupling created."""
        return self.effort is not None and self.flow is not None


def find_sides(system: System) -> list[Sides]:
    """All bonds between instances."""

    def counts(instance: str, bond: Bond) -> str | None:
        own = bond.declared.get(instance)
        component = system.instances[instance].component
        found = energy_through(own) if own and isinstance(component, CountingComponent) else ""
        return f"{instance}.{found}" if found in component.outputs else None

    return [
        Sides(bond, counts(bond.effort.instance, bond), counts(bond.flow.instance, bond))
        for bond in find_bonds(system)
    ]


def list_received_energies(system: System, instance: str) -> list[str]:
    """The outputs that count what came into an instance that counts, over all its bonds."""
    return [f"{instance}.{energy_through(own)}" for own in system.instances[instance].component.bonds]


GROUP = "energy"


class Ledger(Observer):
    """Books every n-th macro step, and `stop` (s); with `folder` in the journal that becomes the
    result's group /energy.

    Everything it knows are sums of counted energies, with signs +1 and -1: a row for each channel.
    """

    def __init__(
        self, system: System, every: int = 1, folder: Path | None = None, stop: float = math.inf
    ) -> None:
        self._every, self._folder, self._stop = every, folder, stop
        self.sides = [sides for sides in find_sides(system) if sides.both]
        self.not_counted = [str(sides.bond) for sides in find_sides(system) if not sides.both]
        self.instances = [
            name for name, i in system.instances.items() if isinstance(i.component, CountingComponent)
        ]
        self._rows: dict[str, dict[str, float]] = {}
        self.quantities: dict[str, Quantity] = {}
        for sides in self.sides:
            assert sides.effort
            assert sides.flow
            bond = sides.bond
            giver, taker = bond.effort.instance, bond.flow.instance
            self._row(f"given {bond}", {sides.effort: -1.0}, f"energy from {giver}")
            self._row(f"taken {bond}", {sides.flow: 1.0}, f"energy into {taker}")
            both = {sides.effort: 1.0, sides.flow: 1.0}
            self._row(f"created {bond}", both, "energy created by the coupling")
        for name in self.instances:
            self._component_rows(system, name)
        self._total_rows()
        numbers = {name: i for i, name in enumerate(system.outputs.names)}
        used = sorted({variable for row in self._rows.values() for variable in row})
        self._columns = np.array([numbers[variable] for variable in used], dtype=int)
        self._matrix = np.array(
            [[row.get(variable, 0.0) for variable in used] for row in self._rows.values()]
        )
        self.channels = tuple(self._rows)
        size = len(self.channels)
        self._start, self._last, self._largest, self._moved = (
            np.zeros(n) for n in (len(used), size, size, size)
        )
        self._count, self._until = 0, 0.0
        self._journal: Journal | None = None

    def _row(self, channel: str, signs: dict[str, float], text: str) -> None:
        self._rows[channel] = signs
        self.quantities[channel] = Quantity("J", f"{text} since the start")

    def _component_rows(self, system: System, name: str) -> None:
        stored, gained, dissipated, sourced = (
            f"{name}.{v}" for v in (STORED_ENERGY, GAINED_ENERGY, DISSIPATED_ENERGY, SOURCED_ENERGY)
        )
        received = dict.fromkeys(list_received_energies(system, name), 1.0)
        self._row(f"stored {name}", {stored: 1.0}, "change of the stored energy")
        self._row(f"dissipated {name}", {dissipated: 1.0}, "energy dissipated")
        self._row(f"sourced {name}", {sourced: 1.0}, "energy from sources inside")
        self._row(f"received {name}", received, "energy in over all power bonds")
        self._row(f"jumped {name}", {stored: 1.0, gained: -1.0}, "energy by jumps of inputs")
        left = {gained: 1.0, dissipated: 1.0, sourced: -1.0, **dict.fromkeys(received, -1.0)}
        self._row(f"unaccounted {name}", left, "energy within steps from elsewhere")
        whole = {stored: 1.0, dissipated: 1.0, sourced: -1.0, **dict.fromkeys(received, -1.0)}
        self._row(f"outside_bonds {name}", whole, "energy otherwise than over power bonds")

    def _total_rows(self) -> None:
        """Sums of all channels of a kind."""
        for kind, text in (
            ("created", "created by the coupling"),
            ("outside_bonds", "otherwise than over power bonds"),
        ):
            total: dict[str, float] = {}
            for row in [row for channel, row in self._rows.items() if channel.startswith(f"{kind} ")]:
                for variable, sign in row.items():
                    total[variable] = total.get(variable, 0.0) + sign
            self._row(kind, total, f"energy {text}, all together")

    def begin(self, names: Sequence[str]) -> None:
        self._open(None)

    def _open(self, mark: Mark | None) -> None:
        if self._folder is not None:
            self._journal = Journal(self._folder / f"{GROUP}{SUFFIX}", self.quantities, mark)

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if is_recorded(self._count, time, self._every, self._stop):
            values = outputs()[self._columns]
            if self._count == 0:
                self._start[:] = values
            self._book(time, self._matrix @ (values - self._start))
        self._count += 1

    def _book(self, time: float, now: Vector) -> None:
        self._moved += np.abs(now - self._last)
        np.maximum(self._largest, np.abs(now), out=self._largest)
        self._last[:] = now
        self._until = time
        if self._journal:
            self._journal.append(time, now)
            if self._journal.due:
                self._journal.flush()

    def end(self, complete: bool, message: str) -> None:
        if self._journal:
            self._journal.close()

    def state(self) -> dict[str, Any]:
        return {
            "count": self._count,
            "until": self._until,
            "start": self._start.copy(),
            "last": self._last.copy(),
            "largest": self._largest.copy(),
            "moved": self._moved.copy(),
            "journal": self._journal.mark() if self._journal else {},
        }

    def resume(self, names: Sequence[str], state: Mapping[str, Any]) -> None:
        self._count, self._until = state["count"], state["until"]
        self._start[:], self._last[:] = state["start"], state["last"]
        self._largest[:], self._moved[:] = state["largest"], state["moved"]
        self._open(state["journal"])

    def __getitem__(self, channel: str) -> float:
        """The channel at the last record (J)."""
        return float(self._last[self.channels.index(channel)])

    def account(self) -> Account:
        """What it comes to up to the last record."""
        bonds = {}
        for sides in self.sides:
            given, created = (self.channels.index(f"{what} {sides.bond}") for what in ("given", "created"))
            largest, exchanged = float(self._largest[created]), float(self._moved[given])
            bonds[str(sides.bond)] = BondAccount(
                self[f"given {sides.bond}"],
                self[f"taken {sides.bond}"],
                self[f"created {sides.bond}"],
                largest,
                exchanged,
                largest / exchanged if exchanged else 0.0,
            )
        columns = [column.name for column in fields(ComponentAccount)]
        components = {
            name: ComponentAccount(*(self[f"{column} {name}"] for column in columns))
            for name in self.instances
        }
        return Account(
            self._until, self["created"], self["outside_bonds"], bonds, components, self.not_counted
        )
