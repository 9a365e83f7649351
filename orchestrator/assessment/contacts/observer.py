"""The observer that follows contacts through every macro step of a run."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from models.compile.kernel import COMPILED
from models.core.quantities import Vector
from models.core.system import System

from ...engine.coupling import Coupling
from ...engine.observer import Observer
from ...engine.step import Step
from ...participants.compiled_calls import CALLS, FINE, CompiledCalls
from ...participants.protocol import Participant
from ...store.json_codec import Plain
from ..trains import find_angle, find_degrees, find_train, find_turns
from .accumulation import INPUTS, LIFT, OUTPUTS, observe
from .contact_summary import Accumulator, ContactSummaries, contacts


class ContactObserver(Observer):
    """Accumulates the summaries of all contacts, whatever is recorded.

    Compiled code reads contacts that are FMUs of this process; others give all their outputs.
    """

    def __init__(self, system: System) -> None:
        self._system = system
        self._names = list(contacts(system))
        self._accumulator = Accumulator(system, self._names)

    def watch(self, coupling: Coupling) -> None:
        """Before `begin`: the coupling that the run goes through."""
        origins = {
            str(target): coupling.wiring.number[source]
            for target, source in self._system.drivers.items()
            if target.variable in INPUTS
        }
        self._accumulator = Accumulator(self._system, self._names, coupling.state.values, origins)
        units = dict(zip(coupling.wiring.names, coupling.participants, strict=True))
        self._calls: list[CompiledCalls] = []
        self._others: list[tuple[Participant, Vector, Any, Vector]] = []
        records, self._references = [], []
        for i, name in enumerate(self._names):
            row, train = self._accumulator.seen[i], find_train(self._system, name)
            wanted: list[tuple[str, Sequence[str], Vector]] = [(name, OUTPUTS, row[: len(OUTPUTS)])]
            wanted += [(train.cam, (LIFT,), row[-1:])] if train else []
            for part, variables, place in wanted:
                calls = coupling.offers.calls.get(coupling.wiring.names.index(part))
                reading = calls and COMPILED and calls.bind_reading(variables, place)
                if calls and reading:
                    self._calls.append(calls)
                    records.append(reading[0])
                    self._references.append(reading[1])
                    continue
                outputs = coupling.wiring.system.instances[part].component.outputs
                index = np.array([outputs.index(variable) for variable in variables])
                self._others.append((units[part], np.zeros(outputs.size), index, place))
        self._records = np.concatenate([np.zeros(0, dtype=CALLS), *records])

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if not self._names:
            return
        for unit, values, index, row in self._others:
            unit.read_all(values)
            np.take(values, index, out=row)
        a = self._accumulator
        failed, call, status = observe(self._records, a.memory.record, a.summaries, time)
        if call != FINE:
            self._calls[failed].fail(call, status, time, step.length)

    def summaries(self) -> ContactSummaries:
        """What is known so far."""
        return self._accumulator.found()

    def state(self) -> dict[str, Plain]:
        return self._accumulator.state()

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        self._accumulator.resume(state)


def with_angles(
    system: System, summaries: ContactSummaries, column: Callable[[str], Vector]
) -> ContactSummaries:
    """The summaries with the angles (deg) of their cams or cranks at the times of what they tell."""
    found = {}
    for name, summary in summaries.items():
        if angle := find_angle(system, name):
            times = summary.times()
            turned = find_degrees(angle, list(times.values()), column)
            angles = dict(zip(times, turned.tolist(), strict=True))
            turns = dict(zip(times, find_turns(angle, list(times.values()), column), strict=False))
            summary = replace(summary, angle_of=angle.name, angles=angles, turns=turns)
        found[name] = summary
    return found
