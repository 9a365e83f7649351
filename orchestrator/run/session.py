"""A coupling under way: participants that a master steps from a start to a stop time."""

from collections.abc import Mapping

import numpy as np

from models.core.quantities import Vector
from models.core.system import System

from ..engine.coupling import Coupling
from ..engine.instants import NO_SIDE_LINES, SideLines
from ..engine.step import Step
from ..masters import Master
from ..participants.protocol import Participant
from ..stepping import Stepper, list_event_outputs
from ..store.json_codec import Plain
from .checkpoint import fitting, restore_participants, serialise_participants


class Session:
    """`time` (s) is the communication point that has been reached; `lines` connect what is no number.

    Call `begin`, then `step` until `time` is `stop_time`. Participants are not closed.
    """

    def __init__(
        self,
        system: System,
        participants: Mapping[str, Participant],
        master: Master,
        steps: Stepper,
        stop_time: float,
        start_time: float = 0.0,
        lines: SideLines = NO_SIDE_LINES,
    ) -> None:
        events = list_event_outputs(system) if steps.locates else None
        self.coupling = Coupling(system, participants, master.degree, events, lines)
        self.time, self.stop_time = start_time, stop_time
        self.participants = participants
        self._master, self._steps = master, steps
        self._values = np.zeros(system.outputs.size)
        self._read = False

    def begin(self) -> None:
        """Initialise the participants at the start."""
        self.coupling.initialise(self.time, self.stop_time)
        self.coupling.prove(self.time)
        self._steps.begin(self.coupling, self._master, self.time, self.stop_time)

    def step(self) -> Step:
        """Make the next macro step. RunError if it fails, EndedError where a participant ends the run."""
        step = self._steps.step(self.time)
        self.time, self._read = step.end, False
        return step

    def read_outputs(self) -> Vector:
        """All outputs of all participants at `time`, read once."""
        if not self._read:
            self.coupling.read_all(self._values)
            self._read = True
        return self._values

    def outdate(self) -> None:
        """Something else than a step has changed the outputs."""
        self._read = False

    def save(self) -> dict[str, Plain]:
        """The evolving data, as plain data; CannotSerializeError if a participant cannot give its own."""
        return {
            "time": self.time,
            "coupling": self.coupling.snapshot(),
            "steps": self._steps.state(),
            "participants": serialise_participants(self.participants),
        }

    def restore(self, saved: Plain) -> None:
        """Go on from saved data, with the same bits; CheckpointError if it is not of such a session."""
        with fitting():
            self.coupling.resume(saved["coupling"])
            self._steps.resume(saved["steps"])
            restore_participants(self.participants, saved["participants"])
            self.time, self._read = saved["time"], False
