"""The coupled run: macro steps from start to stop, watched by observers."""

import os
import time as clock
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np

from models.core.quantities import Vector
from models.core.system import System

from ..engine.coupling import Coupling
from ..engine.instants import NO_SIDE_LINES, SideLines
from ..engine.observer import Observer
from ..engine.step import STOP, Step
from ..errors import EndedError, RunError
from ..masters import Master
from ..participants.protocol import Participant
from ..stepping import FixedSteps, Stepper, list_event_outputs
from ..store.json_codec import Plain
from .checkpoint import fitting, restore_participants, serialise_participants

_process = os.getpid()


def _remember() -> None:
    """This process was made by Python."""
    global _process
    _process = os.getpid()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_remember)


def _end_copy() -> None:
    """End this process if an FMU in it has made it, by `fork`: it would carry out the rest a second time."""
    if os.getpid() != _process:
        os._exit(0)


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
        try:
            self.coupling.initialise(self.time, self.stop_time)
            self.coupling.prove(self.time)
            self._steps.begin(self.coupling, self._master, self.time, self.stop_time)
        finally:
            _end_copy()

    def step(self) -> Step:
        """Make the next macro step. RunError if it fails, EndedError where a participant ends the run."""
        try:
            step = self._steps.step(self.time)
        finally:
            _end_copy()
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


@dataclass(frozen=True)
class Statistics:
    """What a run took. `do_steps` counts the steps of single participants, rejected ones too.

    `python_sweeps`: the participants that keep sweeps in Python, which is slower than compiled code, and why.
    `without_rates`: those whose rates are no numbers at the start, and were not used. `unproven`: what some
    say of themselves and does not hold.
    """

    macro_steps: int
    rejected_steps: int
    iterations: int
    do_steps: int
    coupled_time_s: float
    python_sweeps: Mapping[str, str]
    without_rates: Sequence[str] = ()
    unproven: Sequence[str] = ()


class Run:
    """A run from `start_time` to `stop_time`: what it has come to, and what it took, also where it failed."""

    def __init__(self, session: Session, observers: Sequence[Observer]) -> None:
        self.session, self._observers = session, observers
        self._began = clock.perf_counter()
        self._made = self._rejected = self._iterations = 0
        self._elapsed = 0.0

    def make(self, resumed: Plain | None = None) -> Statistics:
        """Step to the stop, from the start or a state; see `simulate`."""
        session, message, complete = self.session, "", False
        for observer in self._observers:
            observer.watch(session.coupling)
            observer.attach(self.state)
        _begin(self._observers, session.coupling.wiring.system.outputs.names, resumed)
        try:
            if resumed is not None:
                self._made, self._rejected, self._iterations = (
                    resumed[key] for key in ("made", "rejected", "iterations")
                )
            session.begin()
            self._start(resumed)
            while session.time < session.stop_time:
                self._step()
            complete = True
        except KeyboardInterrupt:
            message = "interrupted"
            raise
        except Exception as error:
            message = str(error)
            raise
        finally:
            self._elapsed = clock.perf_counter() - self._began
            with ExitStack() as ends:  # all of them, whatever one raises
                for observer in reversed(self._observers):
                    ends.callback(observer.end, complete, message)
        return self.statistics()

    def _start(self, resumed: Plain | None) -> None:
        """Show the start, or go on from a state."""
        self._began = clock.perf_counter()
        if resumed is None:
            self._show(Step(self.session.time, 0.0, 0))
            return
        self._began -= resumed["elapsed"]
        self.session.restore(resumed["session"])

    def _step(self) -> None:
        """Make a macro step; EndedError where a participant ends the run."""
        session = self.session
        try:
            step = session.step()
        except EndedError as error:
            # The others may have made steps beyond the end of one.
            if len(session.participants) == 1 and error.inside(session.time):
                self._made += 1
                session.outdate()
                self._show(Step(error.reached, error.reached - session.time, 1, reason=STOP))
            raise
        self._made += 1
        self._rejected += step.rejected
        self._iterations += step.iterations
        self._show(step)

    def _show(self, step: Step) -> None:
        for observer in self._observers:
            observer.observe(step.end, self.session.read_outputs, step)

    def state(self) -> dict[str, Plain]:
        """All that `make` needs to go on from here."""
        return {
            "made": self._made,
            "rejected": self._rejected,
            "iterations": self._iterations,
            "elapsed": clock.perf_counter() - self._began,
            "session": self.session.save(),
            "observers": [each.state() for each in self._observers],
        }

    def statistics(self) -> Statistics:
        """What the run took until it ended."""
        coupling = self.session.coupling
        return Statistics(
            self._made, self._rejected, self._iterations, int(coupling.calls.sum()), self._elapsed,
            coupling.explain_python(), coupling.without_rates, coupling.unproven,
        )  # fmt: skip


def simulate(
    system: System,
    participants: Mapping[str, Participant],
    master: Master,
    steps: Stepper | float,
    stop_time: float,
    observers: Sequence[Observer] = (),
    start_time: float = 0.0,
    resumed: Plain | None = None,
    lines: SideLines = NO_SIDE_LINES,
) -> Statistics:
    """Step `participants` (by instance name) from `start_time` to `stop_time` with `master`.

    `steps` chooses the macro steps; a number is their length (s). The last step ends at `stop_time`.
    RunError says what went wrong; observers have then seen everything up to the last good step.
    Participants are not closed. `resumed` is the state (see `Observer.attach`) from which such a run goes on;
    CheckpointError if it does not fit. `lines` are connections of what is no number.
    """
    if isinstance(steps, (int, float)):
        if not steps > 0.0:
            raise RunError(f"macro_step = {steps:g} s: must be > 0")
        steps = FixedSteps(float(steps))
    if not stop_time > start_time:
        raise RunError(f"stop_time = {stop_time:g} s: must be after the start at {start_time:g} s")
    session = Session(system, participants, master, steps, stop_time, start_time, lines)
    return Run(session, observers).make(resumed)


def _begin(observers: Sequence[Observer], names: Sequence[str], resumed: Plain | None) -> None:
    """Begin with every observer, or have it go on from its own state; if one cannot, end the others."""
    begun: list[Observer] = []
    try:
        for observer in observers:
            if resumed is None:
                observer.begin(names)
            else:
                with fitting():
                    observer.resume(names, resumed["observers"][len(begun)])
            begun.append(observer)
    except Exception as error:
        for observer in begun:
            observer.end(False, str(error))
        raise
