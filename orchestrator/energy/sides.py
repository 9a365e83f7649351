"""Who counts what of a bond: the variables of its two sides."""

from __future__ import annotations

from dataclasses import dataclass

from models.bonds import CountingComponent, energy_through
from models.component import PowerBond
from models.system import System

from ..bonds import Bond, bonds_of


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


def sides_of(system: System) -> list[Sides]:
    """All bonds between instances."""

    def counts(instance: str, bond: Bond) -> str | None:
        own = bond.declared.get(instance)
        component = system.instances[instance].component
        return _variable(instance, own) if own and isinstance(component, CountingComponent) else None

    return [
        Sides(bond, counts(bond.effort.instance, bond), counts(bond.flow.instance, bond))
        for bond in bonds_of(system)
    ]


def received_by(system: System, instance: str) -> list[str]:
    """The outputs that count what came into an instance that counts, over all its bonds."""
    return [_variable(instance, own) for own in system.instances[instance].component.bonds]


def _variable(instance: str, bond: PowerBond) -> str:
    return f"{instance}.{energy_through(bond)}"
