"""Power bonds between instances: the connections over which energy flows."""

from dataclasses import dataclass, field

from models.core.component import PowerBond
from models.core.system import Port, System


@dataclass(frozen=True)
class Bond:
    """An effort that one instance gives and another takes, and the flow that goes the other way.

    `effort` and `flow` are the outputs that give them. Power into the effort's instance is `sign` times
    effort times flow. `declared` is the bond as the components of these instances declare it: both, or one.
    """

    effort: Port
    flow: Port
    sign: int
    declared: dict[str, PowerBond] = field(default_factory=dict, compare=False)

    def __str__(self) -> str:
        return f"{self.effort} * {self.flow}"


def find_bonds(system: System) -> list[Bond]:
    """The bonds between two instances, each once: both may declare it, or one of them."""
    found: dict[tuple[Port, Port], Bond] = {}
    for name, instance in system.instances.items():
        for own in instance.component.bonds:
            effort, flow = (
                Port(name, v) if v in instance.component.outputs else system.drivers.get(Port(name, v))
                for v in (own.effort, own.flow)
            )
            if effort is None or flow is None or effort.instance == flow.instance:
                continue
            sign = own.sign if effort.instance == name else -own.sign
            found.setdefault((effort, flow), Bond(effort, flow, sign)).declared.setdefault(name, own)
    return list(found.values())
