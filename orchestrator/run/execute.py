"""The coupled run of a job: its participants, and those who watch it."""

from __future__ import annotations

import sys
import time as clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial

from models.core.quantities import Vector
from models.core.system import System

from ..assessment.contacts import ContactObserver
from ..assessment.summary import Summary, Warnings
from ..energy import Ledger, Trimmed, counted, estimated
from ..engine.observer import Observer
from ..engine.step import Step
from ..errors import MistakeError, ParticipantError, RefusedError, RunError, StalledError
from ..participants import FmuParticipant, InOwnProcess, Participant
from ..store.journal import FLUSH_SECONDS, SUFFIX, Recorded
from ..store.json_codec import Plain
from ..store.run_state import shown
from . import assembly
from .checkpoint import NAME as CHECKPOINT
from .checkpoint import Checkpoints, Identity
from .exit_guard import guarding
from .interruption import Interruption
from .job import Job
from .nan_monitor import NotNumbers
from .output_folder import SUMMARY
from .recording import ResultRecorder
from .simulation import simulate
from .watchdog import watching
from .workload import Forecast


def run_coupled(
    job: Job, system: System, fmus: dict[str, assembly.FmuFile], identity: Identity, summary: Summary
) -> None:
    """Make it, and put what it came to into the summary, also where it fails.

    RefusedError if a participant fails before the first values.
    """
    scenario, every, stop = job.scenario, job.scenario.record_every, job.scenario.stop_time
    quantities = assembly.output_quantities(system)
    # An FMU that may end this process at any moment must not take records along.
    exposed = [
        name for name, table in scenario.components.items() if table.untrusted and not table.own_process
    ]
    held_for = 0.0 if exposed else FLUSH_SECONDS
    not_numbers, contacts = NotNumbers(every, stop), ContactObserver(system)
    recorders: list[Observer] = [ResultRecorder(job.folder, quantities, every, held_for, stop), not_numbers]
    ledger = None
    if scenario.energy.ledger:
        system = estimated(counted(system, assembly.counting_instances(scenario, system)))
        ledger = Ledger(system, every, job.folder, stop)
        recorders = [*(Trimmed(recorder, system) for recorder in recorders), ledger]
    recorders.append(contacts)
    counter = _Counter(job.begun)
    stage = job.reporter.stage(f"coupled run, master {scenario.master.name}", scenario.stop_time)
    told = partial(_tell_of_exit, exposed, job, summary, contacts) if exposed else None
    with _refusing(counter), guarding(told), watching(scenario, job.out / SUMMARY, summary) as watchdog:
        units: dict[str, Participant] = {}

        def made(name: str, make: Callable[[], Participant]) -> Participant:
            return watchdog.made(name, lambda: units.setdefault(name, make()))

        participants = assembly.participants_of(scenario, system, fmus, made)
        try:
            with stage as bar, Interruption() as interruption:
                forecast = Forecast(stop, job.reporter.line)
                keeper = [_checkpoints(job, identity, interruption)] if scenario.checkpoint_every else []
                statistics = simulate(
                    system,
                    participants,
                    scenario.build_master(),
                    scenario.build_steps(),
                    scenario.stop_time,
                    [*watchdog.observers, *recorders, counter, *keeper, bar, forecast, interruption],
                    resumed=job.resumed[1] if job.resumed else None,
                )
        finally:
            summary.macro_steps, summary.iterations = max(0, counter.steps), counter.iterations
            summary.coupled_time_s = counter.time_s
            summary.energy = ledger.account() if ledger else None
            summary.warnings = _warnings(units)
            summary.not_numbers, summary.contacts = not_numbers.since, contacts.courses()
            for participant in participants.values():
                participant.close()
    summary.do_steps, summary.python_sweeps = statistics.do_steps, dict(statistics.python_sweeps)
    summary.iterations = statistics.iterations
    summary.coupled_time_s = statistics.coupled_time_s


@contextmanager
def _refusing(counter: _Counter) -> Iterator[None]:
    """A participant that fails before the first values, by its parameters or its file, is refused; one that
    does not come back may do so another time."""
    try:
        yield
    except StalledError:
        raise
    except ParticipantError as error:
        if counter.steps < 0:
            raise RefusedError(str(error)) from None
        raise


def _tell_of_exit(names: Sequence[str], job: Job, summary: Summary, contacts: ContactObserver) -> None:
    """One of these FMUs has called `exit`: say so, also in the summary."""
    last = None
    with suppress(RunError, MistakeError):
        last = Recorded(job.folder / f"coupled{SUFFIX}").last_time()
    after = "before the first step" if last is None else f"after t = {last:.9g} s"
    who = names[0] if len(names) == 1 else f"one of {', '.join(names)}"
    apart = " and ".join(f"components.{name}.process = 'own'" for name in names)
    summary.message = (
        f"incomplete: {who}: the FMU ended the process of the whole command by calling exit, {after}; "
        f"set {apart}, which keeps it apart; tribocosim resume {shown(job.out)} makes the result of what was "
        "recorded"
    )
    summary.contacts = contacts.courses()
    print(f"tribocosim: {summary.message}", file=sys.stderr)
    with suppress(OSError):
        summary.write(job.out / SUMMARY)


def _warnings(units: Mapping[str, Participant]) -> dict[str, Warnings]:
    """Of the FMUs that gave any."""
    found = {}
    for name, unit in units.items():
        if isinstance(unit, (FmuParticipant, InOwnProcess)):
            with suppress(RunError):  # why the run ended is said already
                count, first = unit.warnings()
                if count:
                    found[name] = Warnings(count, first)
    return found


def _checkpoints(job: Job, identity: Identity, interruption: Interruption) -> Checkpoints:
    every, stop = job.scenario.checkpoint_every, job.scenario.stop_time
    path = job.folder / CHECKPOINT
    return Checkpoints(path, identity, every, stop, lambda: interruption.asked, job.reporter.line)


class _Counter:
    """What a run came to that did not live to return its statistics."""

    steps = -1
    iterations = 0
    time_s = 0.0

    def __init__(self, begun: Callable[[], None]) -> None:
        self._first = begun

    def begin(self, names: Sequence[str]) -> None:
        self._began = clock.perf_counter()

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        self.steps += 1
        if not self.steps:
            self._first()
        self.iterations += step.iterations

    def state(self) -> dict[str, Plain]:
        return {
            "steps": self.steps,
            "iterations": self.iterations,
            "time_s": clock.perf_counter() - self._began,
        }

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        self.steps, self.iterations = state["steps"], state["iterations"]
        self._began = clock.perf_counter() - state["time_s"]

    def end(self, complete: bool, message: str) -> None:
        self.time_s = clock.perf_counter() - self._began
