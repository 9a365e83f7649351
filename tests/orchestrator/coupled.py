"""Short coupled runs in process, one participant by itself, and an observer that keeps everything."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from models.core.quantities import Vector
from orchestrator.engine.coupling import Coupling
from orchestrator.engine.observer import Observer
from orchestrator.engine.step import Step
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.participants.protocol import BoundVariables, Participant
from orchestrator.run.simulation import simulate


class Recorder(Observer):
    def begin(self, names: Sequence[str]) -> None:
        self.names = list(names)
        self._times: list[float] = []
        self._rows: list[Vector] = []
        self.iterations: list[int] = []
        self.steps: list[Step] = []
        self.ended: tuple[bool, str] | None = None

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        self._times.append(time)
        self._rows.append(outputs().copy())
        self.iterations.append(step.iterations)
        self.steps.append(step)

    def end(self, complete: bool, message: str) -> None:
        self.ended = (complete, message)

    @property
    def times(self) -> Vector:
        return np.array(self._times)

    @property
    def rows(self) -> Vector:
        """All outputs after every step."""
        return np.array(self._rows)

    def __getitem__(self, name: str) -> Vector:
        return self.rows[:, self.names.index(name)]


class Wrapper:
    """A participant in place of another one, to which it passes what it does not do itself."""

    def __init__(self, inner):
        self._inner = inner

    def __getattr__(self, name):
        return getattr(self._inner, name)


def build_participants(system):
    """All participants in this process."""
    return {name: in_process(name, instance) for name, instance in system.instances.items()}


def run_coupled(system, master, steps, stop, /, *observers, recorder=None, resumed=None, **participants):
    """The records of a run, with its `statistics`. `participants` replace those in this process, by name."""
    recorder = recorder or Recorder()
    units = build_participants(system) | participants
    try:
        recorder.statistics = simulate(
            system, units, master, steps, stop, [recorder, *observers], resumed=resumed
        )
    finally:
        for unit in units.values():
            unit.close()
    return recorder


def with_start(system, starts):
    """The system with these start values, by instance."""
    changed = {name: replace(system.instances[name], start=start) for name, start in starts.items()}
    return system.with_instances({**system.instances, **changed})


def start_from(system, x):
    """The system with the states x as its start."""
    named = {n: i.component.state.named(x[system.state.of(n)]) for n, i in system.instances.items()}
    return with_start(system, named)


def measure_growth(system, units, master, step, steps):
    """By how much a run's values grow from its first tenth to its last, without the runaway guard."""
    coupling = Coupling(system, units, master.degree)
    coupling.initialise(0.0, steps * step)
    seen = []
    for n in range(steps):
        master.step(coupling, n * step, step)
        coupling.accept((n + 1) * step)
        seen.append(np.abs(coupling.state.values / coupling.wiring.nominal).max())
    tenth = max(10, steps // 10)
    return max(seen[-tenth:]) / max(seen[:tenth])


def assert_growth_changes_at(limit, behaviour, system, open_participants):
    """Runs decay 4 % below the limit and grow 4 % above it, over steps enough for a factor of exp(10)."""
    for share in (0.96, 1.04):
        rate = np.log(behaviour.evaluate(share * limit).radius)
        units = open_participants()
        factor = measure_growth(system, units, behaviour.master, share * limit, int(10.0 / abs(rate)))
        for unit in units.values():
            unit.close()
        assert (factor > 1.0) == (share > 1.0)


class Alone:
    """A participant, its input and what it shows; `start` is the input's value at first."""

    def __init__(self, unit: Participant, name: str, outputs: Sequence[str], start: float) -> None:
        self.unit = unit
        self._inputs, self._outputs = np.zeros((2, 1)), np.zeros(len(outputs))
        unit.connect(BoundVariables([name], self._inputs, list(outputs), self._outputs, np.zeros(0)))
        self._inputs[0] = start
        unit.initialise(0.0, 1.0)
        unit.write()
        unit.finish_initialisation()

    def saved(self) -> bytes:
        kept = self.unit.save()
        try:
            return self.unit.to_bytes(kept)
        finally:
            self.unit.release(kept)

    def advance(self, time: float, step: float, value: float, rate: float = 0.0) -> list[float]:
        self._inputs[:, 0] = value, rate
        self.unit.write()
        self.unit.advance(time, step)
        self.unit.read()
        return self._outputs.tolist()
