"""An FMU that says it can restore its state, which is tried before a run depends on it."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from models.core.component import Component
from models.core.quantities import Vector

from ..errors import EndedError, ParticipantError, RecoverableError
from .protocol import BoundVariables, Participant
from .reopened import Reopened
from .undeclared import describe_undeclared

# Relative to nominal + |value|, by which outputs of the same step may differ.
ROUNDING = 1e-12


@dataclass(frozen=True)
class Proof:
    """The length (s) of the step that is made twice. `required` says what has to go back, and the remedy;
    empty if the run can do without."""

    step: float
    required: str = ""


def pass_on(method: str) -> Any:
    """A method that calls that of the present unit, also where it was bound before the proof."""

    def call(proven: "Proven", *arguments: Any) -> Any:
        return getattr(proven._unit, method)(*arguments)

    return call


class Proven:
    """Implements `Participant` by `open_unit()` of the component.

    Its proof makes a step, takes it back and makes it again, with the inputs of the start and with others, as
    a state that follows inputs of zero stays as it is. If the outputs differ the FMU does not come back to
    the state it saved, as one that saves a part only. It is then opened afresh, and not restorable. Of one
    that does, what its outputs depend on at once is tried too.
    """

    def __init__(self, open_unit: Callable[[], Participant], component: Component, proof: Proof) -> None:
        self._first = Reopened(open_unit)
        self._unit: Participant = self._first
        self._component, self._outputs, self._proof = component, component.outputs, proof
        self._warned = 0
        unit = self._first.unit
        self.name, self.signal_degrees = unit.name, unit.signal_degrees
        self.abilities = replace(
            unit.abilities, derivatives=None, warnings=self._count_warnings, prove=self._prove
        )

    def _prove(self, time: float) -> str:
        self._unit = unit = self._first.unit
        before, self._warned = self._count_warnings()[0], 0
        for trial in (nullcontext(), self._displace_inputs()):
            try:
                with trial:
                    first, second = self._step_twice(unit, time)
            except (RecoverableError, EndedError):
                if not isinstance(trial, nullcontext):
                    self._reopen()
                return ""  # which the run meets too, if it was with the inputs of the start
            except ParticipantError:
                self._reopen()
                return ""
            differing = np.abs(second - first) > ROUNDING * (self._outputs.nominal + np.abs(first))
            if differing.any() or self.abilities.side is not None:
                break
        try:
            undeclared = "" if differing.any() else self._describe_undeclared(unit)
        except ParticipantError:  # of inputs that the run need not meet
            self._reopen()
            return ""
        self._warned = self._count_warnings()[0] - before
        if not differing.any():
            return undeclared
        i = int(np.argmax(differing))
        reason = (
            f"{self.name}: the FMU does not come back to the state that it saved, though it says so "
            f"(canGetAndSetFMUstate): {self._outputs.names[i]} is {second[i]:.9g} after a step of "
            f"{self._proof.step:g} s that was {first[i]:.9g} the first time"
        )
        if self._proof.required:
            raise ParticipantError(f"{reason}; {self._proof.required}, or give another file")
        self._reopen()
        self.abilities = replace(self.abilities, restorable=False)
        return f"{reason}: no step of it is taken back, and there are no checkpoints"

    def _step_twice(self, unit: Participant, time: float) -> list[Vector]:
        """The outputs after both; the FMU is then where it was."""
        found = [np.zeros(self._outputs.size) for _ in range(2)]
        saved = unit.save()
        try:
            for values in found:
                try:
                    unit.write()
                    unit.advance(time, self._proof.step)
                    unit.read_all(values)
                finally:
                    unit.restore(saved)
        finally:
            unit.release(saved)
        return found

    def _describe_undeclared(self, unit: Participant) -> str:
        """What outputs depend on at once, of connected inputs, and do not say; it is then where it was."""
        if self.abilities.side is not None:
            return ""
        saved, given = unit.save(), dict(zip(self._bound.input_names, self._bound.inputs[0], strict=True))
        try:
            found = list(describe_undeclared(unit, self._component, given))
        finally:
            unit.restore(saved)
            unit.release(saved)
            unit.write()
        return "\n".join(f"{self.name}: {said}" for said in found)

    @contextmanager
    def _displace_inputs(self) -> Iterator[None]:
        """Connected inputs by their nominal value, within their ranges, those of whole numbers not."""
        memory, kept = self._bound.inputs, self._bound.inputs.copy()
        for column, name in enumerate(self._bound.input_names):
            quantity = self._component.inputs.field(name).quantity
            if not quantity.jumps:
                memory[0, column] = quantity.displace(memory[0, column])
        try:
            yield
        finally:
            memory[:] = kept

    def _reopen(self) -> None:
        if self.abilities.side is not None:
            raise ParticipantError(
                f"{self.name}: the FMU cannot be taken back to the start, as it has events, clocks or texts; "
                "give a copy of it whose modelDescription.xml does not say canGetAndSetFMUstate"
            )
        self._first.reopen()
        self._unit = self._first.unit
        self._warned = 0

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        self._bound = bound
        return self._unit.connect(bound)

    compiled_calls = pass_on("compiled_calls")
    initialise = pass_on("initialise")
    finish_initialisation = pass_on("finish_initialisation")
    set_inputs = pass_on("set_inputs")
    write = pass_on("write")
    advance = pass_on("advance")
    read = pass_on("read")
    read_all = pass_on("read_all")
    save = pass_on("save")
    restore = pass_on("restore")
    to_bytes = pass_on("to_bytes")
    from_bytes = pass_on("from_bytes")
    release = pass_on("release")
    close = pass_on("close")

    def _count_warnings(self) -> tuple[int, str]:
        """Without those of the steps that were tried."""
        count, first = self._first.unit.abilities.warnings()
        return count - self._warned, first
