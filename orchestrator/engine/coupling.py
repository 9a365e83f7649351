"""A coupling: participants that exchange values, from a consistent start on."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from models.core.system import System

from ..participants.compiled_calls import IN_PROCESS
from ..participants.protocol import Participant
from .consistency import make_consistent
from .effort import timed
from .exchange import Exchange
from .instants import NO_SIDE_LINES, Instants, SideLines
from .sweeps import propagate


class Coupling(Exchange):
    """An exchange with its events. `lines` are connections of what is no number."""

    def __init__(
        self,
        system: System,
        participants: Mapping[str, Participant],
        degree: int,
        watched: Mapping[str, Sequence[str]] | None = None,
        lines: SideLines = NO_SIDE_LINES,
    ) -> None:
        super().__init__(system, participants, degree, watched or {})
        self.without_rates: list[str] = []  # whose rates are no numbers at the start, and not used
        self.unproven: list[str] = []  # what participants say of themselves and does not hold
        self.instants = Instants(self, lines)

    def explain_python(self) -> dict[str, str]:
        """Why participants keep sweeps in Python; empty if none does, or if there is no FMU."""
        reasons = self.offers.reasons
        no_fmu = len(reasons) == len(self.participants) and set(reasons.values()) <= {IN_PROCESS}
        return {} if no_fmu else reasons

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Initialise all participants and make the outputs (and rates) consistent at the start."""
        for i, participant in enumerate(self.participants):
            with timed(self.effort.initialising, i):
                participant.initialise(start_time, stop_time)
        for i in self.wiring.all:
            self.read(i)
        make_consistent(self, start_time)
        for i, participant in enumerate(self.participants):
            with timed(self.effort.initialising, i):
                participant.finish_initialisation()
        # Rates that an FMU gives by the standard's call come only now, outputs of some FMUs too.
        before = self.state.arrived.copy()
        for i in self.wiring.all:
            self.participants[i].read()
            if not np.isfinite(self.state.rates[self.wiring.slices[i]]).all():
                self._ignore_rates(i)
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
        """At the start, after `initialise`: try whether participants restore their states, and depend on
        inputs as they say."""
        proofs = {i: prove for i, one in enumerate(self.participants) if (prove := one.abilities.prove)}
        self.unproven = []
        for i, prove in proofs.items():
            with timed(self.effort.initialising, i):
                self.unproven += prove(time).splitlines()
        if proofs:  # which may be other instances now
            self.rebind()

    def _ignore_rates(self, i: int) -> None:
        """Use no rates of participant i, whose signals are then quadratic.

        Rates that are no numbers at the start are differences over a step that has not been made, and of
        first order only when it has.
        """
        own = self.wiring.slices[i]
        self.without_rates.append(self.wiring.names[i])
        self.participants[i].connect(self.bind_variables(i, np.zeros(0)))
        self.state.history.rated[own], self.state.rates[own] = False, 0.0
        self.rebind()

    def settle(self, part: Sequence[int], time: float) -> None:
        """Make outputs of `part` with direct feedthrough consistent with the inputs at `time`, the present.

        After a step they are those of the inputs that the step assumed.
        """
        propagate(self, tuple(i for i in self.wiring.answering if i in part), time)

    def accept(self, time: float) -> None:
        """The present values are those of a communication point, whose events happen now."""
        happened = self.instants.settle(time)
        self.state.history.append(time, self.state.values, self.state.rates)
        if happened:
            self.points.present = None
            self.state.history.restart()

    def snapshot(self) -> dict[str, Any]:
        """All evolving data outside the participants, as plain numbers and arrays."""
        return self.state.snapshot() | {"calls": self.calls.tolist(), "effort": self.effort.state()}

    def resume(self, snapshot: Mapping[str, Any]) -> None:
        """Continue from a snapshot; the participants are put back by the caller."""
        self.state.resume(snapshot)
        self.calls[:] = [int(n) for n in snapshot["calls"]]
        self.effort.resume(snapshot["effort"])
        self.points.present = None
