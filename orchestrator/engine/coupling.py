"""Participants that exchange values: the wiring, the state, and the sweeps that move them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import cached_property
from typing import Any, NoReturn, TypeVar

import numba
import numpy as np

from models.core.quantities import Vector
from models.core.system import System

from ..errors import NotFiniteError
from ..participants import Participant
from ..participants.compiled import IN_PROCESS, CompiledCalls
from ..participants.protocol import BoundVariables
from .consistency import make_consistent
from .coupling_state import CouplingState
from .instants import NO_SIDE_LINES, Instants, SideLines
from .saved_points import SavedPoints
from .signals import finite
from .sweeps import SweepKind, propagate
from .wiring import wire

Bound = TypeVar("Bound")


class Coupling:
    """The participants of a system and what goes between them.

    `signals` (degree + 1 x sources) are the input signals of a step: value and derivatives at its start.
    `inputs[i]` are those of participant i, views on `all_inputs`, where those of participant i begin at
    `offsets[i]`. `calls` counts the steps asked of each participant. `lines` are connections of what is no
    number.
    """

    def __init__(
        self,
        system: System,
        participants: Mapping[str, Participant],
        degree: int,
        watched: Mapping[str, Sequence[str]] | None = None,
        lines: SideLines = NO_SIDE_LINES,
    ) -> None:
        self.wiring = w = wire(system, participants, degree, watched or {})
        self.participants = [participants[name] for name in w.names]
        self.divisible = all(participant.abilities.divisible for participant in self.participants)
        self.calls = np.zeros(len(w.names), dtype=np.int64)
        rated = np.zeros(len(w.sources), dtype=np.bool_)
        self.state = CouplingState(len(w.sources), rated, w.degrees)
        self.points = SavedPoints(self.participants, self.state)
        rows = w.degree + 1
        self.signals: Vector = np.zeros((rows, len(w.sources)))
        self.offsets = np.cumsum([0, *(rows * len(targets) for targets in w.targets)])
        self.all_inputs: Vector = np.zeros(self.offsets[-1])
        self.inputs: list[Vector] = []
        self.unrated: list[str] = []  # whose rates are no numbers at the start, and not used
        self.unproven: list[str] = []  # why participants that say so cannot be restored
        self.ended = False  # whether a step that compiled code made was the last of its FMU
        self._bound: dict[Hashable, Any] = {}
        for i, participant in enumerate(self.participants):
            own, targets = w.slices[i], w.targets[i]
            memory = self.all_inputs[self.offsets[i] : self.offsets[i + 1]].reshape(rows, len(targets))
            self.inputs.append(memory)
            rates = self.state.rates[own] if w.degree == 3 else np.zeros(0)
            given = participant.connect(self._bind(i, rates))
            if w.degree == 3:
                rated[own] = given
                if w.held[i]:
                    # Rates of outputs that follow such an input at once lack its slope.
                    rated[own] &= ~w.passed_through[own]

        self.instants = Instants(self, lines)

    def _bind(self, i: int, rates: Vector) -> BoundVariables:
        """The exchanged variables of participant i."""
        own = self.wiring.slices[i]
        names = tuple(port.variable for port in self.wiring.sources[own])
        return BoundVariables(self.wiring.targets[i], self.inputs[i], names, self.state.values[own], rates)

    @cached_property
    def offers(self) -> list[CompiledCalls | str]:
        """The calls that each participant offers to compiled code, or why it offers none."""
        if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
            return ["NUMBA_DISABLE_JIT is set"] * len(self.participants)
        return [participant.compiled_calls() for participant in self.participants]

    def explain_python(self) -> dict[str, str]:
        """Why participants keep sweeps in Python; empty if none does, or if there is no FMU."""
        offers = zip(self.wiring.names, self.offers, strict=True)
        reasons = {name: offer for name, offer in offers if isinstance(offer, str)}
        no_fmu = len(reasons) == len(self.participants) and set(reasons.values()) <= {IN_PROCESS}
        return {} if no_fmu else reasons

    def bind(self, make: Callable[..., Bound], *key: Hashable) -> Bound:
        """The result of make(coupling, *key), made at its first use and bound to this coupling's memory."""
        found: Bound | None = self._bound.get((make, key))
        if found is None:
            found = self._bound[make, key] = make(self, *key)
        return found

    def sweep(self, kind: SweepKind, order: tuple[int, ...], time: float, step: float) -> None:
        """Make a sweep of that kind (see `sweeps`) over `order`."""
        self.points.present = None
        self.bind(kind, order)(time, step)

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Initialise all participants and make the outputs (and rates) consistent at the start."""
        for participant in self.participants:
            participant.initialise(start_time, stop_time)
        for i in self.wiring.all:
            self.read(i)
        make_consistent(self, start_time)
        for participant in self.participants:
            participant.finish_initialisation()
        # Rates that an FMU gives by the standard's call come only now, outputs of some FMUs too.
        before = self.state.arrived.copy()
        for i in self.wiring.all:
            self.participants[i].read()
            if not np.isfinite(self.state.rates[self.wiring.slices[i]]).all():
                self._forgo_rates(i)
            self.read(i)
        if not np.array_equal(before, self.state.arrived):
            make_consistent(self, start_time)
        self.instants.settle(start_time)
        self.state.history.begin(start_time, self.state.values, self.state.rates)

    @property
    def restorable(self) -> bool:
        """Whether all participants can restore their states."""
        return all(participant.abilities.restorable for participant in self.participants)

    def prove(self, time: float) -> None:
        """At the start, after `initialise`: try whether participants restore their states."""
        proofs = [prove for one in self.participants if (prove := one.abilities.prove)]
        self.unproven = [reason for prove in proofs if (reason := prove(time))]
        if proofs:  # which may be other instances now
            self._rebind()

    def _rebind(self) -> None:
        """Make sweeps anew."""
        self.__dict__.pop("offers", None)
        self._bound.clear()

    def _forgo_rates(self, i: int) -> None:
        """Use no rates of participant i, whose signals are then quadratic.

        Rates that are no numbers at the start are differences over a step that has not been made, and of
        first order only when it has.
        """
        own = self.wiring.slices[i]
        self.unrated.append(self.wiring.names[i])
        self.participants[i].connect(self._bind(i, np.zeros(0)))
        self.state.history.rated[own], self.state.rates[own] = False, 0.0
        self._rebind()

    def propagate(self, order: tuple[int, ...], time: float) -> None:
        """Give the present values, and rates, to each participant in turn and read its answer."""
        self.sweep(propagate, order, time, 0.0)

    def settle(self, part: Sequence[int], time: float) -> None:
        """Make outputs of `part` with direct feedthrough consistent with the inputs at `time`, the present.

        After a step they are those of the inputs that the step assumed.
        """
        self.propagate(tuple(i for i in self.wiring.answering if i in part), time)

    def accept(self, time: float) -> None:
        """The present values are those of a communication point, whose events happen now."""
        happened = self.instants.settle(time)
        self.state.history.append(time, self.state.values, self.state.rates)
        if happened:
            self.points.present = None
            self.state.history.restart()

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
            "the parameters and inputs of that participant, or reduce macro_step"
        )

    def snapshot(self) -> dict[str, Any]:
        """All evolving data outside the participants, as plain numbers and arrays."""
        return self.state.snapshot() | {"calls": self.calls.tolist()}

    def resume(self, snapshot: Mapping[str, Any]) -> None:
        """Continue from a snapshot; the participants are put back by the caller."""
        self.state.resume(snapshot)
        self.calls[:] = [int(n) for n in snapshot["calls"]]
        self.points.present = None
