"""FMI 3.0: an instance of an FMU for co-simulation with event mode.

It is in step mode between calls, but for what sets discrete inputs: that enters event mode, and the next call
that needs step mode iterates and leaves it. Events inside a step are handled where they are; what is due at
the end of a step waits for `handle`, or for the next step.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Sequence
from ctypes import c_double, c_int, c_uint, c_void_p
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fmus.fmi.model_exchange import MOST_ITERATIONS
from models.core.quantities import Vector

from ..errors import EndedError, ParticipantError
from .clock_schedule import ClockSchedule, Pace
from .description import CLOCK, Description, Variable
from .fmi3 import EARLY, ENDED, EVENT, MAXIMUM_RETURNS, ROUNDING, Fmi3
from .fmi_instance import DISCARD, WARNING, Fail, FailStep, Step, Transfer

SMOOTH, DISCRETE, CLOCKED = range(3)


@dataclass
class EventMemory:
    """What the FMU's own state does not tell: when its next time event is (s), whether it asked for event
    mode, the paces of its clocks, the discrete inputs that it has, and whether it wants the end."""

    next_event: float = math.inf
    needed: bool = False
    paces: list[Pace] = field(default_factory=list)
    discrete: dict[int, list[float]] = field(default_factory=dict)
    ended: bool = False

    def copy(self) -> EventMemory:
        return replace(self, paces=self.paces.copy(), discrete=self.discrete.copy())


class Fmi3WithEvents(Fmi3):
    """Handles events (see `SideChannel`).

    `used`: the FMU has taken event mode; else it is as `Fmi3`. What is set of a clock is its interval.
    """

    def __init__(self, name: str, description: Description, folder: str) -> None:
        super().__init__(name, description, folder)
        assert description.events
        self._early = True
        self._variables = {(v.reference, v.type): v for v in description.variables.values() if v.place == 0}
        clocked = description.events.clocked
        self._clocked = {
            v.reference: clocked[whole]
            for v in description.variables.values()
            for whole in (v.name, v.name.rpartition("[")[0])
            if whole in clocked
        }
        self._clocks = ClockSchedule(description.events.clocks.values(), self)
        self._variable_step = description.variable_step
        self._memory_of_events = EventMemory()
        self._kept: dict[int, EventMemory] = {}
        self.used, self._ready, self._in_events = True, False, False
        self._time = 0.0
        self._intervals: dict[Variable, float] = {}  # that are given to settable clocks (s)
        self._ticking: list[str] = []  # in the present event
        self._waiting: dict[int, tuple[tuple[str, ...], Callable[[], None]]] = {}

    def instantiate(self, log: Callable[[int, bytes], None]) -> None:
        try:
            self.slave.instantiate(
                loggingOn=True,
                eventModeUsed=True,
                earlyReturnAllowed=True,
                logMessage=lambda environment, status, category, message: log(status, message),
            )
        except Exception:  # there are FMUs that declare event mode and refuse it
            self.used = False
            return super().instantiate(log)
        self._bind("fmi3GetFMUState", "fmi3SetFMUState", "fmi3FreeFMUState")

    def enter_initialization(self, start_time: float, stop_time: float) -> None:
        super().enter_initialization(start_time, stop_time)
        self._time = start_time
        if self._intervals and self.used:
            count = len(self._intervals)
            references = (c_uint * count)(*(v.reference for v in self._intervals))
            self.slave.fmi3SetIntervalDecimal(
                self.slave.component, references, count, (c_double * count)(*self._intervals.values())
            )

    def exit_initialization(self) -> None:
        if self.used:
            given = {clock.name: interval for clock, interval in self._intervals.items()}
            self._memory_of_events = EventMemory(paces=self._clocks.begin(self._time, given))
        super().exit_initialization()
        if self.used:
            self._ready = self._in_events = True
            self._leave_events()

    # What is set and read.

    def set(self, variables: Sequence[Variable], values: Iterable[float]) -> None:
        given, kind = list(values), self._classify(variables[0])
        if variables[0].type == CLOCK:
            self._intervals[variables[0]] = given[0]
        elif not self._ready or kind == SMOOTH:
            super().set(variables, given)
        elif kind == CLOCKED:
            clocks = self._clocked[variables[0].reference]
            self._waiting[variables[0].reference] = clocks, lambda: Fmi3.set(self, variables, given)
        else:
            self._set_discrete(variables[0].reference, given, lambda: Fmi3.set(self, variables, given))

    def set_text(self, variable: Variable, text: str) -> None:
        if self._ready:
            self._enter_events()
        super().set_text(variable, text)

    def get_text(self, variable: Variable) -> str:
        self._leave_events()
        return super().get_text(variable)

    def _set_discrete(self, key: int, values: list[float], send: Callable[[], None]) -> None:
        if self._memory_of_events.discrete.get(key) != values:
            self._enter_events()
            send()
            self._memory_of_events.discrete[key] = values

    def _classify(self, variable: Variable) -> int:
        if variable.reference in self._clocked:
            return CLOCKED
        smooth = variable.variability in ("", "continuous") and not variable.discrete
        return SMOOTH if smooth else DISCRETE

    def bind_setter(self, references: Any, values: Vector, fail: Fail) -> Transfer:
        whole = super().bind_setter(references, values, fail)
        wanted = [self._variables[int(reference), "Float64"] for reference in references]
        kinds = [self._classify(v) for v in wanted]
        if set(kinds) <= {SMOOTH}:
            return whole
        ends = np.cumsum([v.size for v in wanted])
        parts: list[tuple[int, int, slice, Vector, Callable[[], None]]] = []
        for v, kind, end in zip(wanted, kinds, ends, strict=True):
            memory = np.zeros(v.size)
            send = super().bind_setter(np.array([v.reference], dtype=np.uintc), memory, fail)
            parts.append((kind, v.reference, slice(int(end) - v.size, int(end)), memory, send))

        def transfer() -> None:
            if not self._ready:
                return whole()
            for kind, reference, own, memory, send in parts:
                if kind == DISCRETE:
                    given = values[own].tolist()
                    if self._memory_of_events.discrete.get(reference) != given:
                        memory[:] = values[own]
                        self._set_discrete(reference, given, send)
                    continue
                memory[:] = values[own]
                if kind == SMOOTH:
                    send()
                else:
                    self._waiting[reference] = self._clocked[reference], send

        return transfer

    def bind_getter(self, references: Any, values: Vector, fail: Fail) -> Transfer:
        return self._leave_events_before(super().bind_getter(references, values, fail))

    def bind_typed_getter(self, kind: str, references: Any, size: int, fail: Fail) -> tuple[Any, Transfer]:
        memory, get = super().bind_typed_getter(kind, references, size, fail)
        return memory, self._leave_events_before(get)

    def _leave_events_before(self, get: Transfer) -> Transfer:
        def transfer() -> None:
            self._leave_events()
            get()

        return transfer

    # Events.

    def next_event(self) -> float:
        """When something is due next (s): at the present if the FMU asks for event mode."""
        memory = self._memory_of_events
        if memory.ended:
            return math.inf
        return (
            self._time
            if memory.needed
            else min(memory.next_event, *(pace.next for pace in memory.paces), math.inf)
        )

    def handle(self, time: float, triggered: Sequence[str] = ()) -> list[str] | None:
        """Handle what is due at `time`, the present, with these input clocks active; the output clocks that
        tick then, or None if nothing is due."""
        slack = ROUNDING * max(abs(time), 1.0)
        if not triggered and self.next_event() > time + slack:
            return None
        self._time = time
        self._enter_events()
        self._tick(triggered)
        active = self._leave_events()
        if self._memory_of_events.next_event <= time + slack:  # which has been handled now
            self._memory_of_events.next_event = math.inf
        return active

    def _enter_events(self) -> None:
        if not self._in_events:
            self.slave.enterEventMode()
            self._in_events, self._ticking = True, []

    def _leave_events(self) -> list[str]:
        """Iterate, see when clocks tick next, and enter step mode; the output clocks that ticked."""
        if not (self._in_events and self._ready):
            return []
        active = self._iterate()
        self._in_events = False
        if not self._memory_of_events.ended:
            self._clocks.advance(self._memory_of_events.paces, self._ticking, self._time)
            self.slave.enterStepMode()
        return active

    def _tick(self, triggered: Sequence[str]) -> None:
        """In event mode: let clocks tick that are due, or triggered."""
        self._ticking = [*self._clocks.list_due(self._memory_of_events.paces, self._time), *triggered]
        self._memory_of_events.needed = False
        if self._ticking:
            references = self._clocks.get_references(self._ticking)
            self.slave.setClock(references, [True] * len(references))
            for clocks, send in self._waiting.values():
                if set(clocks) & set(self._ticking):
                    send()

    def _iterate(self) -> list[str]:
        """Event iterations until the FMU needs no more; the output clocks that ticked in them."""
        outputs, active = self._clocks.outputs, []
        for _ in range(MOST_ITERATIONS):
            if outputs:
                on = self.slave.getClock(self._clocks.get_references(outputs))
                active += [name for name, ticks in zip(outputs, on, strict=True) if ticks]
            again, ends, _, _, known, at = self.slave.updateDiscreteStates()
            if ends:  # the present is valid, and only the next step is refused
                self._memory_of_events.ended = True
                return active
            self._memory_of_events.next_event = float(at) if known else math.inf
            if not again:
                return active
        raise ParticipantError(
            f"{self._name}: its event at t = {self._time:.9g} s takes more than {MOST_ITERATIONS} "
            "iterations; look at its inputs and parameters, or ask who made it"
        )

    def ask_intervals(self, references: Sequence[int]) -> list[tuple[float, int]]:
        count = len(references)
        wanted, found, qualifiers = (c_uint * count)(*references), (c_double * count)(), (c_int * count)()
        self.slave.getIntervalDecimal(wanted, found, qualifiers)
        return list(zip(found, qualifiers, strict=True))

    def ask_shifts(self, references: Sequence[int]) -> list[float]:
        found = (c_double * len(references))()
        self.slave.getShiftDecimal((c_uint * len(references))(*references), found)
        return list(found)

    # Steps and states.

    def bind_step(self, fail: FailStep) -> Step:
        if not self.used:
            return super().bind_step(fail)
        do_step, marks = self._bind_do_step()

        def advance(time: float, step: float) -> None:
            if self.ended_in and time > self.ended_in.pop():
                return fail(DISCARD, time, step)
            self._time, end = time, time + step
            slack = ROUNDING * max(abs(end), 1.0)
            for _ in range(MAXIMUM_RETURNS):
                self.handle(self._time)
                self._leave_events()
                if self._memory_of_events.ended:
                    raise EndedError(
                        f"{self._name}: the FMU asks to end the simulation in an event at t = "
                        f"{self._time:.9g} s; set stop_time to that, or look at its parameters",
                        self._time,
                    )
                target = min(end, self.next_event()) if self._variable_step else end
                if target > end - slack:
                    target = end
                status = do_step(self._time, target - self._time)
                if status > WARNING or marks[ENDED]:
                    return fail(max(status, DISCARD), time, step)
                reached = float(self._outcome[1]) if marks[EARLY] else target
                if not self._time <= reached <= end + slack:
                    self.refuse_reached(self._time, end)
                self._time = end if reached > end - slack else reached
                self._memory_of_events.needed = bool(marks[EVENT])
                if self._time == end:
                    return
            self.refuse_returns(time, step)

        return advance

    def save(self, state: c_void_p) -> int:
        self._leave_events()
        status = super().save(state)
        self._kept[state.value or 0] = self._memory_of_events.copy()
        return status

    def restore(self, state: c_void_p) -> int:
        self._leave_events()
        status = super().restore(state)
        self._memory_of_events = self._kept[state.value or 0].copy()
        return status

    def release(self, state: c_void_p) -> int:
        self._kept.pop(state.value or 0, None)
        return super().release(state)

    def serialise(self, state: c_void_p) -> bytes:
        memory = self._kept[state.value or 0]
        own = [memory.next_event, memory.needed, memory.paces, list(memory.discrete.items())]
        return json.dumps(own).encode() + b"\n" + super().serialise(state)

    def deserialise(self, data: bytes) -> c_void_p:
        own, _, rest = data.partition(b"\n")
        next_event, needed, paces, discrete = json.loads(own)
        state = super().deserialise(rest)
        self._kept[state.value or 0] = EventMemory(
            next_event, needed, [Pace(*p) for p in paces], dict(discrete)
        )
        return state
