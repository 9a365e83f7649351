"""Power bonds between instances: the connections over which energy flows."""

from __future__ import annotations

from dataclasses import dataclass

from models.system import Port, System


@dataclass(frozen=True)
class Bond:
    """An effort that one instance gives and another takes, and the flow that goes the other way.

    Power into the effort's instance is `sign` times effort times flow.
    """

    effort: Port
    flow: Port
    sign: int

    def __str__(self) -> str:
        return f"{self.effort} * {self.flow}"


def bonds_of(system: System) -> list[Bond]:
    """The bonds whose effort and flow are both exchanged, in the order of the effort's instances."""
    driver = {connection.target: connection.source for connection in system.connections}
    found = []
    for name, instance in system.instances.items():
        for bond in instance.component.bonds:
            flow = driver.get(Port(name, bond.flow))
            if bond.effort in instance.component.outputs and flow is not None:
                found.append(Bond(Port(name, bond.effort), flow, bond.sign))
    return found
