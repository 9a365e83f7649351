"""Execute a plan: the coupled run with its participants and observers."""

import time as clock
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

from models.core.quantities import Vector

from ..assessment.contacts import ContactObserver
from ..engine.coupling import Coupling
from ..engine.effort import Spent
from ..engine.energy import Ledger, Trimmed
from ..engine.observer import Observer
from ..engine.step import Step
from ..errors import ParticipantError, RefusedError, RunError, StalledError
from ..participants.protocol import Participant
from ..reporter import COUPLED, Reporter
from ..store.journal import FLUSH_SECONDS
from ..store.json_codec import Plain
from ..store.output_folder import SCENARIO, SUMMARY, TEXTS, OutputFolder, format_path
from .checkpoint import Checkpoints, Identity
from .interruption import Interruption
from .plan import Lifetimes, Plan, open_participants
from .record import ResultRecorder, TextRecorder, list_texts
from .simulation import Statistics, simulate
from .summary import ENDS, Summary, Warnings, begin_summary

Checkpoint = tuple[Identity, Plain]


def execute(
    plan: Plan, folder: OutputFolder, reporter: Reporter, checkpoint: Checkpoint | None = None
) -> Summary:
    """Run from the start or from a checkpoint, to the end or to what stops it; its rows are in the journals.

    Raises RefusedError if a participant fails before the first values, and CheckpointError if the checkpoint
    is not of this plan; nothing of an earlier run is changed then.
    """
    identity = Identity.of(folder.path / SCENARIO, plan.sha256)
    summary = begin_summary(plan)
    if checkpoint:
        identity.check(checkpoint[0], format_path(folder.path))
        if differ := identity.compare_machines(checkpoint[0], format_path(folder.path)):
            reporter.line(differ)
        time = checkpoint[1]["session"]["time"]
        reporter.line(f"goes on from t = {time:.6g} s, {100.0 * time / plan.stop_time:.0f} %")
    else:  # this is left if a participant ends the process
        summary.write(folder.path / SUMMARY)
    observation = _Observation(plan, folder)
    try:
        statistics = _couple(plan, folder, reporter, observation, identity, checkpoint)
    except ENDS as error:
        refused = observation.counter.steps < 0 and not isinstance(error, StalledError)
        if refused and isinstance(error, ParticipantError):
            raise RefusedError(error) from None
        return observation.complete(summary.end_by(error, folder.path))
    return replace(
        observation.complete(summary),
        complete=True,
        do_steps=statistics.do_steps,
        coupled_time_s=statistics.coupled_time_s,
        python_sweeps=statistics.python_sweeps,
        without_rates=statistics.without_rates,
        unproven=statistics.unproven,
    )


class _Observation:
    """The observers of a run and what they have seen; `system` is the one to be run."""

    def __init__(self, plan: Plan, folder: OutputFolder) -> None:
        system, every, stop = plan.system, plan.scenario.record_every, plan.stop_time
        held_for = 0.0 if plan.scenario.exposed else FLUSH_SECONDS  # a process that ends takes no rows along
        self.contacts = ContactObserver(system)
        self.counter = _Counter(folder.backup.delete)
        self.warnings: dict[str, Warnings] = {}
        self.lifetimes: Lifetimes = defaultdict(float), defaultdict(float)
        self.recorder = ResultRecorder(folder.unfinished, plan.quantities, every, held_for, stop)
        recorders: list[Observer] = [self.recorder]
        texts = list_texts(plan.third_party)
        text_recorders = [TextRecorder(folder.path / TEXTS, texts)] if texts else []
        self._ledger = None
        if plan.counted is not None:
            system = plan.counted
            self._ledger = Ledger(system, every, folder.unfinished, stop)
            recorders = [Trimmed(self.recorder, system), self._ledger]
        self.system = system
        self.observers = [*recorders, *text_recorders, self.contacts, self.counter]

    def complete(self, summary: Summary) -> Summary:
        """The summary with what was observed."""
        if self.counter.steps < 0:
            return replace(summary, warnings=self.warnings)
        return replace(
            summary,
            macro_steps=self.counter.steps,
            iterations=self.counter.iterations,
            coupled_time_s=self.counter.time_s,
            contacts=self.contacts.summaries(),
            energy=self._ledger.account() if self._ledger else None,
            effort=self.counter.list_efforts(self.lifetimes),
            warnings=self.warnings,
            senseless=self.recorder.senseless,
        )


def _couple(
    plan: Plan,
    folder: OutputFolder,
    reporter: Reporter,
    observation: _Observation,
    identity: Identity,
    checkpoint: Checkpoint | None,
) -> Statistics:
    """Make the participants and step them."""
    system, stop = observation.system, plan.stop_time
    stage = reporter.stage(f"{COUPLED} {plan.scenario.master.name}", stop)
    with open_participants(system, plan.participants, observation.lifetimes) as participants:
        try:
            with stage as bar, Interruption() as interruption:
                observers = [*observation.observers]
                if every := plan.scenario.checkpoint_every:
                    path, say = folder.checkpoint, reporter.line
                    observers.append(
                        Checkpoints(path, identity, every, stop, lambda: interruption.asked, say)
                    )
                return simulate(
                    system,
                    participants,
                    plan.master,
                    plan.make_steps(),
                    stop,
                    [*observers, bar, interruption],
                    resumed=checkpoint[1] if checkpoint else None,
                    lines=plan.side_lines,
                )
        finally:
            observation.warnings = _collect_warnings(participants)


def _collect_warnings(units: Mapping[str, Participant]) -> dict[str, Warnings]:
    """The warnings of the FMUs that gave any."""
    found = {}
    for name, unit in units.items():
        with suppress(RunError):  # the run has ended, and the reason is known
            count, first = unit.abilities.warnings()
            if count:
                found[name] = Warnings(count, first)
    return found


class _Counter(Observer):
    """Counts steps, iterations and time (s) from the start values on, also of a run that ends early. Calls
    `begun` at the start values; until then `steps` is -1."""

    steps = -1
    iterations = 0
    time_s = 0.0

    def __init__(self, begun: Callable[[], None]) -> None:
        self._begun = begun

    def watch(self, coupling: Coupling) -> None:
        self._coupling = coupling

    def list_efforts(self, lifetimes: Lifetimes) -> dict[str, Spent]:
        """What each participant took, by its name."""
        calls, effort, (opening, closing) = self._coupling.calls, self._coupling.effort, lifetimes
        return {
            name: Spent(
                int(calls[i]), effort.restored[i], opening[name], effort.initialising[i],
                effort.stepping[i], effort.saving[i], closing[name], effort.own_steps[i], effort.failed[i],
            )
            for i, name in enumerate(self._coupling.wiring.names)
        }  # fmt: skip

    def begin(self, names: Sequence[str]) -> None:
        self._start = clock.perf_counter()

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        self.steps += 1
        if not self.steps:
            self._begun()
            self._start = clock.perf_counter()
        self.iterations += step.iterations

    def state(self) -> dict[str, Plain]:
        return {
            "steps": self.steps,
            "iterations": self.iterations,
            "time_s": clock.perf_counter() - self._start,
        }

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        self.steps, self.iterations = state["steps"], state["iterations"]
        self._start = clock.perf_counter() - state["time_s"]

    def end(self, complete: bool, message: str) -> None:
        self.time_s = clock.perf_counter() - self._start
