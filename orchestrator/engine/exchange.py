"""Participants that exchange values: the wiring, and the memory of what is exchanged."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import cached_property, partial
from typing import Any, NamedTuple, NoReturn, TypeVar

import numba
import numpy as np

from models.core.quantities import Vector
from models.core.system import System

from ..errors import NotFiniteError
from ..participants.compiled_calls import CompiledCalls, NotCompiledError
from ..participants.protocol import BoundVariables, Participant
from .coupling_state import CouplingState, SavedPoints
from .effort import Effort
from .signals import finite
from .wiring import wire

Bound = TypeVar("Bound")
# Binds a sweep over participants, by their numbers, to the memory of an exchange.
Kind = Callable[["Exchange", tuple[int, ...]], Callable[[float, float], None]]


class Offers(NamedTuple):
    """What participants offer to compiled code, by number; by name, why others offer nothing."""

    calls: dict[int, CompiledCalls]
    reasons: dict[str, str]


class Exchange:
    """The participants of a system and what goes between them.

    `signals` (degree + 1 x sources) are the input signals of a step: value and derivatives at its start.
    `inputs[i]` are those of participant i, views on `all_inputs`, where those of participant i begin at
    `offsets[i]`. `calls` counts the steps asked of each participant, `effort` has what else each takes.
    """

    def __init__(
        self,
        system: System,
        participants: Mapping[str, Participant],
        degree: int,
        watched: Mapping[str, Sequence[str]],
    ) -> None:
        self.wiring = w = wire(system, participants, degree, watched)
        self.participants = [participants[name] for name in w.names]
        self.divisible = all(participant.abilities.divisible for participant in self.participants)
        self.calls = np.zeros(len(w.names), dtype=np.int64)
        self.effort = Effort(len(w.names))
        rated = np.zeros(len(w.sources), dtype=np.bool_)
        self.state = CouplingState(len(w.sources), rated, w.degrees)
        self.points = SavedPoints(self.participants, self.state, self.effort)
        rows = w.degree + 1
        self.signals: Vector = np.zeros((rows, len(w.sources)))
        self.offsets = np.cumsum([0, *(rows * len(targets) for targets in w.targets)])
        self.all_inputs: Vector = np.zeros(self.offsets[-1])
        self.inputs: list[Vector] = []
        self.ended = False  # whether a step that compiled code made was the last of its FMU
        self._bound: dict[Hashable, Any] = {}
        for i, participant in enumerate(self.participants):
            own, targets = w.slices[i], w.targets[i]
            memory = self.all_inputs[self.offsets[i] : self.offsets[i + 1]].reshape(rows, len(targets))
            self.inputs.append(memory)
            rates = self.state.rates[own] if w.degree == 3 else np.zeros(0)
            given = participant.connect(self.bind_variables(i, rates))
            if w.degree == 3:
                rated[own] = given
                if w.held[i]:
                    # Rates of outputs that follow such an input at once lack its slope.
                    rated[own] &= ~w.passed_through[own]

    def bind_variables(self, i: int, rates: Vector) -> BoundVariables:
        """The exchanged variables of participant i."""
        own = self.wiring.slices[i]
        names = tuple(port.variable for port in self.wiring.sources[own])
        values, count = self.state.values[own], partial(self.effort.count, i)
        return BoundVariables(self.wiring.targets[i], self.inputs[i], names, values, rates, count)

    def locate_inputs(self, part: Sequence[int]) -> tuple[Any, Any]:
        """Where each input of these participants lies in `signals`, row after row, and in `all_inputs`."""
        rows = len(self.wiring.sources) * np.arange(self.wiring.degree + 1)[:, None]
        none = np.zeros(0, dtype=np.int64)
        sources = [np.ravel(rows + self.wiring.columns[i]) for i in part]
        places = [np.arange(self.offsets[i], self.offsets[i + 1]) for i in part]
        return np.concatenate([none, *sources]), np.concatenate([none, *places])

    @cached_property
    def offers(self) -> Offers:
        """The calls that participants offer to compiled code."""
        found = Offers({}, {})
        for i, participant in enumerate(self.participants):
            try:
                if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
                    raise NotCompiledError("NUMBA_DISABLE_JIT is set")
                found.calls[i] = participant.compiled_calls()
            except NotCompiledError as reason:
                found.reasons[self.wiring.names[i]] = str(reason)
        return found

    def bind(self, make: Callable[..., Bound], *key: Hashable) -> Bound:
        """The result of make(self, *key), made at its first use and bound to this memory."""
        found: Bound | None = self._bound.get((make, key))
        if found is None:
            found = self._bound[make, key] = make(self, *key)
        return found

    def sweep(self, kind: Kind, order: tuple[int, ...], time: float, step: float) -> None:
        """Make a sweep of that kind (see `sweeps`) over `order`."""
        self.points.present = None
        self.bind(kind, order)(time, step)

    def rebind(self) -> None:
        """Make sweeps anew."""
        self.__dict__.pop("offers", None)
        self._bound.clear()

    def read(self, i: int) -> None:
        """Take the values of participant i; NotFiniteError if one is not finite."""
        self.participants[i].read()
        own = self.wiring.slices[i]
        if not finite(self.state.values, self.state.rates, own.start, own.stop):
            self.refuse(own)

    def read_all(self, values: Vector) -> None:
        """All outputs of all participants, in the system's order."""
        outputs = self.wiring.system.outputs
        for name, participant in zip(self.wiring.names, self.participants, strict=True):
            participant.read_all(values[outputs.of(name)])

    def refuse(self, own: slice) -> NoReturn:
        """NotFiniteError for what is not finite in these sources."""
        bad = ~np.isfinite(self.state.arrived[:, own]).all(axis=0)
        ports = ", ".join(str(self.wiring.sources[own.start + i]) for i in np.flatnonzero(bad))
        if np.isfinite(self.state.values[own]).all():
            raise NotFiniteError(
                f"{ports}: the FMU gives a rate of change that is not a finite number at "
                f"t = {self.state.history.times[0]:.6g} s; take signals that need none: "
                "master.extrapolation = 'linear'"
            )
        raise NotFiniteError(
            f"{ports}: not a finite number in the step from t = {self.state.history.times[0]:.6g} s; look at "
            f"the parameters and inputs of that participant, or reduce macro_step{self._describe_loops()}"
        )

    def _describe_loops(self) -> str:
        """What else may be the cause, where outputs depend on each other at the same instant."""
        if not (torn := self.wiring.system.torn):
            return ""
        return (
            f"; an explicit master may not hold the algebraic loop through {', '.join(map(str, torn))}, at "
            "any macro_step: take master.name = 'newton' or 'iterated'"
        )
