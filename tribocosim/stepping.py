"""A coupled system that is stepped from Python, for controllers, optimisers and learning."""

from __future__ import annotations

import io
from dataclasses import dataclass
from types import TracebackType
from typing import Any

import numpy as np
from rich.console import Console

from orchestrator.command_line.fmu import build_fmu
from orchestrator.engine.coupling import Coupling
from orchestrator.errors import MistakeError, one_of
from orchestrator.reporter import Reporter
from orchestrator.run.checkpoint import restore_participants, serialise_participants
from orchestrator.run.participants import build_participants
from orchestrator.run.plan import make_plan
from orchestrator.stepping import list_event_outputs

from .scenario import Scenario


@dataclass(frozen=True)
class Snapshot:
    """All that decides how a session goes on, as plain data."""

    time: float
    coupling: dict[str, Any]
    steps: dict[str, Any]
    participants: dict[str, bytes]


class Session:
    """Macro steps of a scenario, one call each, from 0 to its `stop_time`.

    >>> with tribocosim.session(scenario) as s:
    ...     while s.time < s.stop_time:
    ...         s.step()
    ...         print(s.time, s["contact.load"])

    The steps are those of the run, to the bit. RunError where one cannot be made.
    """

    def __init__(self, scenario: Scenario) -> None:
        checked = scenario.check()
        plan = make_plan(checked, build_fmu, Reporter(Console(file=io.StringIO())), figures=False)
        self.stop_time = checked.stop_time
        self._outputs = plan.system.outputs
        master, self._steps = checked.build_master(), checked.build_steps()
        self._participants = build_participants(checked, plan.system, plan.fmus, lambda name, make: make())
        try:
            events = list_event_outputs(plan.system) if self._steps.locates else None
            self._coupling = Coupling(plan.system, self._participants, master.degree, events)
            self._coupling.initialise(0.0, self.stop_time)
            self._steps.begin(self._coupling, master, 0.0, self.stop_time)
        except BaseException:
            self.close()
            raise
        self.time = 0.0
        self._start: Snapshot | None = None

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the FMUs."""
        for participant in self._participants.values():
            participant.close()

    def step(self) -> float:
        """Make the next macro step; the time (s) at which it ends."""
        if self.time >= self.stop_time:
            raise MistakeError(f"the session has reached its stop_time = {self.stop_time:g} s")
        if self._start is None and self.time == 0.0 and self._can_save:
            self._start = self.save()
        self.time = self._steps.step(self.time).end
        return self.time

    def step_until(self, time: float) -> float:
        """Step to the first communication point that is not before `time` (s); that time."""
        slack = 1e-12 * max(abs(time), self.stop_time)
        while self.time < min(time, self.stop_time) - slack:
            self.step()
        return self.time

    def __getitem__(self, name: str) -> float:
        """The output "component.variable" now, in SI units."""
        if name not in self._outputs.names:
            raise MistakeError(f"{name}: {one_of(self._outputs.names, name)}")
        values = np.zeros(self._outputs.size)
        self._coupling.read_all(values)
        return float(values[self._outputs.names.index(name)])

    @property
    def _can_save(self) -> bool:
        return all(participant.restorable for participant in self._participants.values())

    def save(self) -> Snapshot:
        """The present state. RunError (CannotSerializeError) if an FMU cannot give its own."""
        participants = serialise_participants(self._participants)
        return Snapshot(self.time, self._coupling.snapshot(), self._steps.state(), participants)

    def restore(self, snapshot: Snapshot) -> None:
        """Go on from a snapshot of this session, with the same bits."""
        self._coupling.resume(snapshot.coupling)
        self._steps.resume(snapshot.steps)
        restore_participants(self._participants, snapshot.participants)
        self.time = snapshot.time

    def reset(self) -> None:
        """Go back to the start."""
        if self._start is not None:
            self.restore(self._start)
        elif self.time > 0.0:
            raise MistakeError("an FMU cannot restore its state; make a new session instead of a reset")
