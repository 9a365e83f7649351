"""A coupled system that is stepped from Python, for controllers, optimisers and learning."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from orchestrator.engine.consistency import make_consistent
from orchestrator.errors import MistakeError, one_of
from orchestrator.run.plan import Plan, open_participants
from orchestrator.run.simulation import Session as RunSession
from orchestrator.scenario.units import UnitError, to_unit

from .arguments import checks_arguments
from .planning import plan
from .scenario import Scenario


@dataclass(frozen=True)
class Snapshot:
    """All that decides how a session goes on from `time` (s), as plain data."""

    time: float
    state: Mapping[str, Any]


class Session:
    """Macro steps of a scenario, one call each, from 0 to its `stop_time`.

    >>> with tribocosim.session(scenario) as s:
    ...     while s.time < s.stop_time:
    ...         s.step()
    ...         print(s.time, s["contact.load"])
    ...         s.set("spring.gas_force", 200.0)

    The steps are those of the run, to the bit. RunError where one cannot be made.
    """

    @checks_arguments
    def __init__(self, scenario: Scenario | Plan | str | Path) -> None:
        found = scenario if isinstance(scenario, Plan) else plan(scenario)
        self._system, self._outputs = found.system, found.system.outputs
        self._closed = False
        with ExitStack() as opened:
            participants = opened.enter_context(open_participants(found.system, found.participants))
            self._session = RunSession(
                found.system, participants, found.master, found.make_steps(), found.stop_time,
                lines=found.side_lines,
            )  # fmt: skip
            self._session.begin()
            self._opened = opened.pop_all()
        self._start: Snapshot | None = None
        self._before = self.time  # where the last step began

    @property
    def time(self) -> float:
        """The communication point (s) that has been reached."""
        return self._session.time

    @property
    def stop_time(self) -> float:
        """Where the session ends (s)."""
        return self._session.stop_time

    def __repr__(self) -> str:
        return f"Session at t = {self.time:g} s of {self.stop_time:g} s{', closed' * self._closed}"

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the FMUs."""
        if not self._closed:
            self._closed = True
            self._opened.close()

    def _check_open(self) -> None:
        """The library of an FMU that has ended would end this process."""
        if self._closed:
            raise MistakeError(
                "the session is closed, with its FMUs; open another: tribocosim.session(scenario)"
            )

    def step(self) -> float:
        """Make the next macro step; the time (s) at which it ends."""
        self._check_open()
        if self.time >= self.stop_time:
            raise MistakeError(f"the session has reached its stop_time = {self.stop_time:g} s")
        self._keep_start()
        self._before = self.time
        self._session.step()
        return self.time

    @checks_arguments
    def step_until(self, time: float | str) -> float:
        """Step to the first communication point that is not before `time`; that time (s).

        A number in seconds, or a text with its unit. MistakeError for one after `stop_time`, or before the
        last step.
        """
        time = self._parse_time(time)
        slack = 1e-12 * self.stop_time
        if not time >= self.time - slack and not time > self._before + slack:
            raise MistakeError(
                f"time = {time:g} s: must not be before the session's time = {self.time:g} s; reset() goes "
                "back to the start, restore() to a saved time"
            )
        if time > self.stop_time + slack:
            raise MistakeError(f"time = {time:g} s: is behind the session's stop_time = {self.stop_time:g} s")
        while self.time < min(time, self.stop_time) - slack:
            self.step()
        return self.time

    def _parse_time(self, time: float | str) -> float:
        self._check_open()
        try:
            return to_unit(time, "s") if isinstance(time, str) else float(time)
        except UnitError as error:
            raise MistakeError(f"time: {error}") from None

    def __getitem__(self, name: str) -> float:
        """The output "component.variable" now, in SI units."""
        self._check_open()
        if name not in self._outputs.names:
            raise MistakeError(f"{name}: {one_of(self._outputs.names, name)}")
        return float(self._session.read_outputs()[self._outputs.names.index(name)])

    @property
    def inputs(self) -> list[str]:
        """The inputs "component.input" that no connection drives: those that can be set."""
        driven = {str(connection.target) for connection in self._system.connections}
        return [name for name in self._system.inputs.names if name not in driven]

    @checks_arguments
    def set(self, name: str, value: float | str) -> None:
        """Set one of `inputs` from now on: a number in SI units, or a text with its unit.

        It jumps: outputs that follow it at once are computed anew, and the next step does not extrapolate
        from before. MistakeError for a name that is not free, and a value out of range.
        """
        self._check_open()
        if name not in (free := self.inputs):
            known = f"{one_of(free, name)} (inputs that no connection drives)"
            reason = self._explain_bound(name) or (
                known if free else "no input is free: connections drive all"
            )
            raise MistakeError(f"{name}: {reason}")
        number = self._check_input(name, value)
        self._keep_start()
        component, _, variable = name.partition(".")
        coupling, history = self._session.coupling, self._session.coupling.state.history
        self._session.participants[component].set_inputs({variable: number})
        for i in coupling.wiring.all:
            coupling.read(i)
        make_consistent(coupling, self.time)
        history.begin(self.time, coupling.state.values, coupling.state.rates)
        self._session.outdate()

    def _explain_bound(self, name: str) -> str:
        """Why something that there is cannot be set; empty if there is no such thing."""
        for connection in self._system.connections:
            if str(connection.target) == name:
                return f"is driven by {connection.source}; leave that connection out to set it"
        if name in self._system.parameters.names:
            component, _, variable = name.partition(".")
            path = f"components.{component}.parameters.{variable}"
            return f"is a parameter; take scenario.with_({{{path!r}: ...}}) and a new session"
        return ""

    def _check_input(self, name: str, value: float | str) -> float:
        component, _, variable = name.partition(".")
        layout = self._system.instances[component].component.inputs
        try:
            quantity = layout.field(variable).quantity
            number = (
                to_unit(value, quantity.unit, quantity.relative) if isinstance(value, str) else float(value)
            )
        except UnitError as error:
            raise MistakeError(f"{name}: {error}") from None
        faults = layout.faults(layout.vector({variable: number}))
        if not math.isfinite(number) or faults:
            raise MistakeError(
                "; ".join(f"{component}.{f}" for f in faults) or f"{name} = {number}: must be finite"
            )
        return number

    def _keep_start(self) -> None:
        """For `reset`, where all FMUs can save their state."""
        if self._start is None and self.time == 0.0 and self._session.coupling.restorable:
            self._start = self.save()

    def save(self) -> Snapshot:
        """The present state. RunError (CannotSerializeError) if an FMU cannot give its own."""
        self._check_open()
        return Snapshot(self.time, self._session.save())

    def restore(self, snapshot: Snapshot) -> None:
        """Go on from a snapshot of this session, with the same bits."""
        self._check_open()
        if not isinstance(snapshot, Snapshot):
            raise MistakeError(f"snapshot: must be what save() returned, not {type(snapshot).__name__}")
        self._session.restore(snapshot.state)
        self._before = self.time

    def reset(self) -> None:
        """Go back to the start."""
        self._check_open()
        if self._start is not None:
            self.restore(self._start)
        elif self.time > 0.0:
            raise MistakeError("an FMU cannot restore its state; make a new session instead of a reset")
