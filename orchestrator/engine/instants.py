"""What happens at a communication point: events of participants, clocks that tick, texts that pass."""

import math
from dataclasses import dataclass

from models.core.system import Connection

from ..errors import RunError
from ..participants.clock_schedule import find_latest
from .exchange import Exchange
from .sweeps import propagate

# Events that follow each other at one instant; more of them are taken for a loop.
MOST_ROUNDS = 100


@dataclass(frozen=True)
class SideLines:
    """Connections of what is no number: of clocks, and of texts."""

    clocks: tuple[Connection, ...] = ()
    texts: tuple[Connection, ...] = ()


NO_SIDE_LINES = SideLines()


class Instants:
    """The side channels of a coupling's participants, and the connections of their clocks and texts.

    Steps end where events are known to come, if all participants take steps of any length (`ends_steps`).
    """

    def __init__(self, exchange: Exchange, lines: SideLines) -> None:
        self._exchange = exchange
        number = {name: i for i, name in enumerate(exchange.wiring.names)}
        abilities = [participant.abilities for participant in exchange.participants]
        self._sides = {i: can.side for i, can in enumerate(abilities) if can.side is not None}
        self._eventful = {i: side for i, side in self._sides.items() if side.has_events}
        self._clocks: dict[tuple[int, str], list[tuple[int, str]]] = {}
        for c in lines.clocks:
            ends = self._clocks.setdefault((number[c.source.instance], c.source.variable), [])
            ends.append((number[c.target.instance], c.target.variable))
        self._texts = [
            (number[c.source.instance], c.source.variable, number[c.target.instance], c.target.variable)
            for c in lines.texts
        ]
        self.ends_steps = bool(self._eventful) and all(can.variable_step for can in abilities)

    def next_event(self, time: float) -> float:
        """When the next known event after `time` is, at which steps end; infinite if none is known."""
        if not self.ends_steps:
            return math.inf
        latest = find_latest(time)
        due = (side.next_event() for side in self._eventful.values())
        return min((at for at in due if at > latest), default=math.inf)

    def settle(self, time: float) -> bool:
        """Handle what is due at `time`, the present; whether anything was."""
        if not self._eventful and not self._texts:
            return False
        changed, triggered = self._pass_texts(), dict[int, list[str]]()
        latest = find_latest(time)
        for _ in range(MOST_ROUNDS):
            pending, triggered, acted = triggered, {}, False
            for i, side in self._eventful.items():
                if i not in pending and side.next_event() > latest:
                    continue
                propagate(self._exchange, (i,), time)
                ticked = side.handle(time, pending.get(i, ()))
                self._exchange.read(i)
                acted |= ticked is not None
                for clock in ticked or ():
                    for j, name in self._clocks.get((i, clock), ()):
                        triggered.setdefault(j, []).append(name)
            if acted:
                propagate(self._exchange, self._exchange.wiring.all, time)
            acted |= self._pass_texts()
            changed |= acted
            if not acted and not triggered:
                return changed
        names = ", ".join(self._exchange.wiring.names[i] for i in self._eventful)
        raise RunError(
            f"{names}: more than {MOST_ROUNDS} events follow each other at t = {time:.9g} s; look for a loop "
            "of clocks, or of discrete values"
        )

    def _pass_texts(self) -> bool:
        """Pass texts on along chains; around a loop once."""
        changed = False
        for _ in range(len(self._texts)):
            moved = False
            for i, source, j, target in self._texts:
                (text,), (before,) = self._sides[i].get_texts([source]), self._sides[j].get_texts([target])
                if text != before:
                    self._sides[j].set_texts({target: text})
                    moved = True
            changed |= moved
            if not moved:
                break
        return changed
