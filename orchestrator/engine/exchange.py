"""The exchange between participants: which output goes to which input, through one vector of values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NoReturn, TypeVar

import numba
import numpy as np

from models.core.quantities import Vector
from models.core.system import Connection, Port, System

from ..errors import NotFiniteError
from ..participants import Participant
from ..participants.capabilities import HIGHEST
from ..participants.compiled import IN_PROCESS, CompiledCalls
from ..participants.signal_degrees import find_highest_degrees
from .consistency import agree
from .signals import History, finite
from .sweeps import Sweep, propagate

Bound = TypeVar("Bound")


@dataclass(frozen=True)
class Saved:
    """All evolving data of a coupled run at a communication point; the participants' parts by number."""

    states: Mapping[int, Any]
    values: Vector
    rates: Vector
    history: History
    carried: dict[str, Any]


class Exchange:
    """All evolving data of a coupled run outside the participants.

    `values` are the connected outputs ("sources") and those that are only `watched`, each once,
    participant by participant; `rates` their time derivatives, for signals of degree 3 and where `rated`;
    `arrived` both.
    `columns[i]` are the sources that feed participant i, in the order of its bound inputs `inputs[i]`.
    `signals` have `degree` + 1 coefficients: value and derivatives at the start of the step. No signal has a
    higher degree than the participants follow that it goes to. `calls` counts the steps asked of each
    participant, `carried` is what masters remember from step to step (plain arrays and numbers).
    """

    def __init__(
        self,
        system: System,
        participants: Mapping[str, Participant],
        degree: int,
        watched: Mapping[str, Sequence[str]] | None = None,
    ) -> None:
        self.system = system
        self.names = tuple(system.instances)
        self.listed = list(range(len(self.names)))
        self.participants = [participants[name] for name in self.names]
        self.restorable = all(participant.restorable for participant in self.participants)
        self.calls = np.zeros(len(self.names), dtype=np.int64)
        self.carried: dict[str, Any] = {}
        self.predicted: Vector | None = None  # what iterated masters arrive at first, for estimators
        self.parts: list[list[int]] | None = None  # of iterated masters, made at their first step
        self.sources: list[Port] = []
        self.slices: list[slice] = []
        connected = {c.source for c in system.connections}
        for name in self.names:
            own = set((watched or {}).get(name, ()))
            start = len(self.sources)
            for variable in system.instances[name].component.outputs.names:
                if Port(name, variable) in connected or variable in own:
                    self.sources.append(Port(name, variable))
            self.slices.append(slice(start, len(self.sources)))
        self.number = {port: i for i, port in enumerate(self.sources)}
        self.connected = np.array([i for i, port in enumerate(self.sources) if port in connected], dtype=int)
        self.arrived: Vector = np.zeros((2, len(self.sources)))
        self.values, self.rates = self.arrived
        self.rated = np.zeros(len(self.sources), dtype=np.bool_)
        self.nominal: Vector = np.array(
            [system.outputs.nominal[system.outputs.index(port)] for port in self.sources]
        )
        fed = {name: [c for c in system.connections if c.target.instance == name] for name in self.names}
        followed = self._followed(fed)
        highest = find_highest_degrees(system.connections, followed)
        self.degree = degree = min(degree, max(highest.values(), default=degree))
        self.through = _with_feedthrough(system, self.sources)
        self.signals: Vector = np.zeros((degree + 1, len(self.sources)))
        self.columns: list[Vector] = []
        self.inputs: list[Vector] = []
        # All inputs in one memory, participant by participant.
        self.offsets = np.cumsum([0, *((degree + 1) * len(feeding) for feeding in fed.values())])
        self.all_inputs: Vector = np.zeros(self.offsets[-1])
        for i, feeding in enumerate(fed.values()):
            self.columns.append(np.array([self.number[c.source] for c in feeding], dtype=np.int64))
            own_inputs = self.all_inputs[self.offsets[i] : self.offsets[i + 1]]
            self.inputs.append(own_inputs.reshape(degree + 1, len(feeding)))
            own_part = self.slices[i]
            given = self.participants[i].connect(
                [c.target.variable for c in feeding],
                self.inputs[i],
                [port.variable for port in self.sources[own_part]],
                self.values[own_part],
                self.rates[own_part] if degree == 3 else np.zeros(0),
            )
            if degree == 3:
                self.rated[own_part] = given
                if any(followed[c.target] == 0 for c in feeding):
                    # Rates of outputs that follow such an input at once lack its slope.
                    self.rated[own_part] &= ~self.through[own_part]
        self.history = History(0.0, self.values, self.rates, self.rated)
        self.history.degrees[:] = [highest.get(port, HIGHEST) for port in self.sources]
        self._bound: dict[tuple[Any, ...], Any] = {}
        answering = {self.sources[i].instance for i in self.connected if self.through[i]}
        self._through = [self.names.index(name) for name in system.order if name in answering]
        self.ended = False  # whether a step that compiled code made was the last of its FMU
        self.held: Saved | None = None  # the present point, as long as nobody has moved

    def _followed(self, fed: Mapping[str, Sequence[Connection]]) -> dict[Port, int]:
        """The degree of the polynomial that its participant follows, for each input that is driven."""
        followed = {}
        for participant, feeding in zip(self.participants, fed.values(), strict=True):
            names = [c.target.variable for c in feeding]
            own = participant.signal_degrees(names)
            followed.update({c.target: degree for c, degree in zip(feeding, own, strict=True)})
        return followed

    @cached_property
    def offers(self) -> list[CompiledCalls | str]:
        """The calls that each participant offers to compiled code, or why it offers none."""
        if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
            return ["NUMBA_DISABLE_JIT is set"] * len(self.names)
        return [participant.compiled_calls() for participant in self.participants]

    def explain_python(self) -> dict[str, str]:
        """Why participants keep sweeps in Python; empty if none does, or if there is no FMU."""
        reasons = {
            n: offer for n, offer in zip(self.names, self.offers, strict=True) if isinstance(offer, str)
        }
        no_fmu = len(reasons) == len(self.names) and set(reasons.values()) <= {IN_PROCESS}
        return {} if no_fmu else reasons

    def read(self, i: int) -> None:
        """Take the values of participant i; NotFiniteError if one is not finite."""
        self.participants[i].read()
        own = self.slices[i]
        if not finite(self.values, self.rates, own.start, own.stop):
            self.refuse(own)

    def bound(self, kind: Callable[[Exchange, Sequence[int]], Bound], order: Sequence[int]) -> Bound:
        """What is bound to the memory of the participants in `order`, made at its first use."""
        key = (kind, *order)
        found: Bound | None = self._bound.get(key)
        if found is None:
            found = self._bound[key] = kind(self, order)
        return found

    def make(self, kind: Callable[[Exchange, Sequence[int]], Sweep], order: Sequence[int]) -> Sweep:
        """A sweep of that kind over `order` (see `sweeps`); to be run at once."""
        self.held = None
        return self.bound(kind, order)

    def refuse(self, own: slice) -> NoReturn:
        """NotFiniteError for what is not finite in these sources."""
        finite = np.isfinite(self.values[own]) & np.isfinite(self.rates[own])
        bad = ", ".join(str(port) for port, fine in zip(self.sources[own], finite, strict=True) if not fine)
        raise NotFiniteError(
            f"{bad}: not a finite number in the step from t = {self.history.times[0]:.6g} s; look at the "
            "parameters and inputs of that participant, or reduce macro_step"
        )

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Initialise all participants and make the outputs (and rates) consistent at the start."""
        for participant in self.participants:
            participant.initialise(start_time, stop_time)
        for i in self.listed:
            self.read(i)
        agree(self, start_time)
        for participant in self.participants:
            participant.finish_initialisation()
        # Rates that an FMU gives by the standard's call come only now, outputs of some FMUs too.
        before = self.arrived.copy()
        for i in self.listed:
            self.read(i)
        if not np.array_equal(before, self.arrived):
            agree(self, start_time)
        self.history.begin(start_time, self.values, self.rates)

    def settle(self, part: Sequence[int], time: float) -> None:
        """Make outputs of `part` with direct feedthrough consistent with the inputs at `time`, the present.

        After a step they are those of the inputs that the step assumed.
        """
        self.propagate([i for i in self._through if i in part], time)

    def propagate(self, order: Sequence[int], time: float) -> None:
        """Give the present values, and rates, to each participant in turn and read its answer."""
        self.make(propagate, order)(time, 0.0)

    def accept(self, time: float) -> None:
        """The present values are those of a communication point."""
        self.history.append(time, self.values, self.rates)

    def save(self) -> Saved:
        """All evolving data; to be released."""
        if self.held is None:
            states = {i: participant.save() for i, participant in enumerate(self.participants)}
            self.held = self._with(states)
        return self.held

    def _with(self, states: Mapping[int, Any]) -> Saved:
        return Saved(states, self.values.copy(), self.rates.copy(), self.history.copy(), dict(self.carried))

    def restore(self, saved: Saved) -> None:
        """Back to what was saved, bit for bit; of the participants those that it has."""
        for i, state in saved.states.items():
            self.participants[i].restore(state)
        self.values[:] = saved.values
        self.rates[:] = saved.rates
        self.history.put(saved.history)
        self.carried = dict(saved.carried)
        self.held = saved if len(saved.states) == len(self.participants) else None

    def snapshot(self) -> dict[str, Any]:
        """All evolving data outside the participants, as plain numbers and arrays."""
        h = self.history
        return {
            "values": self.values.copy(),
            "rates": self.rates.copy(),
            "times": h.times.copy(),
            "past_values": h.values.copy(),
            "past_rates": h.rates.copy(),
            "known": h.count,
            "smooth": h.smooth.copy(),
            "calls": self.calls.tolist(),
            "carried": dict(self.carried),
        }

    def resume(self, state: Mapping[str, Any]) -> None:
        """Go on from a snapshot; the participants are put back by the caller."""
        self.values[:], self.rates[:] = state["values"], state["rates"]
        h = self.history
        h.times[:], h.values[:], h.rates[:] = state["times"], state["past_values"], state["past_rates"]
        h.count = int(state["known"])
        h.smooth[:] = state["smooth"]
        self.calls[:] = [int(n) for n in state["calls"]]
        self.carried = dict(state["carried"])
        self.held = None

    def release(self, saved: Saved) -> None:
        """The saved data is no longer needed."""
        for i, state in saved.states.items():
            self.participants[i].release(state)
        if self.held is saved:
            self.held = None

    @contextmanager
    def point(self) -> Iterator[Saved]:
        """The present point, saved as long as the block lasts; within another such block at no cost."""
        held = self.held
        saved = self.save()
        try:
            yield saved
        finally:
            if held is None:
                self.release(saved)

    def rollback(self, part: Sequence[int]) -> Rollback:
        """Inside the block, a function that brings the participants in `part` back to where they are now."""
        return Rollback(self, part)

    def output_number(self, source: int) -> int:
        """A source's number among all outputs of the system; -1 for none."""
        return self.system.outputs.index(self.sources[source]) if source >= 0 else -1

    def read_all(self, values: Vector) -> None:
        """All outputs of all participants, in the system's order."""
        for name, participant in zip(self.names, self.participants, strict=True):
            participant.read_all(values[self.system.outputs.of(name)])


class Rollback:
    """`with` it, calling the function that it gives brings participants back to where they were.

    Values, rates and history are left alone.
    """

    def __init__(self, exchange: Exchange, part: Sequence[int]) -> None:
        self._exchange, self._part = exchange, part

    def __enter__(self) -> Callable[[], None]:
        participants, part = self._exchange.participants, self._part
        held = self._exchange.held
        self._own = {} if held else {i: participants[i].save() for i in part}
        states = held.states if held else self._own

        def roll_back() -> None:
            for i in part:
                participants[i].restore(states[i])

        return roll_back

    def __exit__(self, *error: object) -> None:
        for i, state in self._own.items():
            self._exchange.participants[i].release(state)


def _with_feedthrough(system: System, sources: Sequence[Port]) -> Any:
    """Whether each source depends directly on an input that another participant drives."""
    driven = {connection.target for connection in system.connections}

    def depends(port: Port) -> bool:
        inputs = system.instances[port.instance].component.feedthrough.get(port.variable, ())
        return any(Port(port.instance, name) in driven for name in inputs)

    return np.array([depends(port) for port in sources], dtype=np.bool_)
