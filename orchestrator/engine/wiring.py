"""Which output goes to which input: participants, exchanged values and signals by their numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from models.core.quantities import Vector
from models.core.system import Connection, Port, System

from ..participants.capabilities import HIGHEST, find_highest_degrees
from ..participants.protocol import Participant
from .signals import STEPWISE


@dataclass(frozen=True, eq=False)
class Wiring:
    """The connections of a system, by numbers.

    Participants have the order of the system's instances, `all` numbers them, `names` are their names.
    `sources` are the connected outputs and those that are only watched, each once, participant by
    participant: `slices[i]` are those of participant i. `connected` are the numbers of the connected ones,
    `number` has them by port, `nominal` are their sizes. `passed_through` marks the sources that depend
    directly on a driven input. `answering` are the participants that have such connected sources, in the
    system's order.
    `targets[i]` are the driven inputs of participant i, `columns[i]` the numbers of their sources.
    Signals have the `degree`; `degrees` are the highest that each source may have, which are those that the
    participants follow that it goes to; STEPWISE of one that changes at events only. `held[i]`: participant
    i holds some driven input over a step.
    """

    system: System
    names: tuple[str, ...]
    sources: tuple[Port, ...]
    slices: tuple[slice, ...]
    connected: Any
    nominal: Vector
    passed_through: Any
    answering: tuple[int, ...]
    targets: tuple[tuple[str, ...], ...]
    columns: tuple[Any, ...]
    degree: int
    degrees: Any
    held: tuple[bool, ...]

    @cached_property
    def all(self) -> tuple[int, ...]:
        return tuple(range(len(self.names)))

    @cached_property
    def number(self) -> dict[Port, int]:
        return {port: i for i, port in enumerate(self.sources)}

    def output_number(self, source: int) -> int:
        """A source's number among all outputs of the system; -1 for none."""
        return self.system.outputs.index(self.sources[source]) if source >= 0 else -1


def wire(
    system: System, participants: Mapping[str, Participant], degree: int, watched: Mapping[str, Sequence[str]]
) -> Wiring:
    """The wiring for signals of `degree`, or of the highest that any participant follows if that is lower.

    `watched` names further outputs by instance.
    """
    names = tuple(system.instances)
    outputs = {name: instance.component.outputs for name, instance in system.instances.items()}
    connected = {c.source for c in system.connections}
    sources: list[Port] = []
    slices = []
    for name in names:
        start = len(sources)
        for variable in outputs[name].names:
            port = Port(name, variable)
            if port in connected or variable in watched.get(name, ()):
                sources.append(port)
        slices.append(slice(start, len(sources)))
    number = {port: i for i, port in enumerate(sources)}
    feeding = [[c for c in system.connections if c.target.instance == name] for name in names]
    followed = _followed_degrees([participants[name] for name in names], feeding)
    highest = find_highest_degrees(system.connections, followed)
    jumping = {port for port in sources if outputs[port.instance].field(port.variable).quantity.jumps}
    through = _find_feedthrough(system, sources)
    answering = {port.instance for i, port in enumerate(sources) if port in connected and through[i]}
    return Wiring(
        system=system,
        names=names,
        sources=tuple(sources),
        slices=tuple(slices),
        connected=np.array([i for i, port in enumerate(sources) if port in connected], dtype=int),
        nominal=np.array([system.outputs.nominal[system.outputs.index(port)] for port in sources]),
        passed_through=through,
        answering=tuple(names.index(name) for name in system.order if name in answering),
        targets=tuple(tuple(c.target.variable for c in fed) for fed in feeding),
        columns=tuple(np.array([number[c.source] for c in fed], dtype=np.int64) for fed in feeding),
        degree=min(degree, max(highest.values(), default=degree)),
        degrees=np.array(
            [STEPWISE if port in jumping else highest.get(port, HIGHEST) for port in sources], dtype=np.int64
        ),
        held=tuple(any(followed[c.target] == 0 for c in fed) for fed in feeding),
    )


def _followed_degrees(
    participants: Sequence[Participant], feeding: Sequence[Sequence[Connection]]
) -> dict[Port, int]:
    """The degree of the polynomial that its participant follows, for each driven input."""
    followed = {}
    for participant, fed in zip(participants, feeding, strict=True):
        degrees = participant.signal_degrees([c.target.variable for c in fed])
        followed.update({c.target: degree for c, degree in zip(fed, degrees, strict=True)})
    return followed


def _find_feedthrough(system: System, sources: Sequence[Port]) -> Any:
    """Whether each source depends directly on an input that another participant drives."""

    def depends(port: Port) -> bool:
        inputs = system.instances[port.instance].component.feedthrough.get(port.variable, ())
        return any(Port(port.instance, name) in system.drivers for name in inputs)

    return np.array([depends(port) for port in sources], dtype=np.bool_)
