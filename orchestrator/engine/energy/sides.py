"""Who counts what of a bond: the variables of its two sides."""

from dataclasses import dataclass

from models.core.bonds import CountingComponent, energy_through
from models.core.system import System

from .bonds import Bond, find_bonds
from .estimate import EstimatedComponent


@dataclass(frozen=True)
class Sides:
    """A bond between two instances, with the outputs that count what came in on the side that gives the
    effort and on the side that gives the flow; None where a side does not count it. Of the instances in
    `add_estimates` it is an estimate."""

    bond: Bond
    effort: str | None
    flow: str | None
    estimated: tuple[str, ...] = ()

    @property
    def both(self) -> bool:
        """The ledger can say what the coupling created."""
        return self.effort is not None and self.flow is not None


def find_sides(system: System) -> list[Sides]:
    """All bonds between instances."""

    def counts(instance: str, bond: Bond) -> str | None:
        own = bond.declared.get(instance)
        component = system.instances[instance].component
        counted = isinstance(component, CountingComponent | EstimatedComponent)
        found = energy_through(own) if own and counted else ""
        return f"{instance}.{found}" if found in component.outputs else None

    def sides(bond: Bond) -> Sides:
        ends = (bond.effort.instance, bond.flow.instance)
        found = {name: counts(name, bond) for name in ends}
        guessed = [
            name
            for name in ends
            if found[name] and isinstance(system.instances[name].component, EstimatedComponent)
        ]
        return Sides(bond, found[ends[0]], found[ends[1]], tuple(guessed))

    return [sides(bond) for bond in find_bonds(system)]


def list_received_energies(system: System, instance: str) -> list[str]:
    """The outputs that count what came into an instance that counts, over all its bonds."""
    return [f"{instance}.{energy_through(own)}" for own in system.instances[instance].component.bonds]
