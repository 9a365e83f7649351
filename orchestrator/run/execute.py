"""Execute a plan: the coupled run with its participants and observers."""

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

from models.core.interruption import deferred, is_asked
from models.core.quantities import Vector

from ..assessment.contacts import ContactObserver
from ..engine.effort import Spent
from ..engine.energy import Ledger
from ..engine.observer import Observer
from ..engine.step import Step
from ..errors import ParticipantError, RefusedError, RunError, StalledError
from ..participants.protocol import Participant
from ..reporter import COUPLED, Reporter, look_between_steps
from ..store.journal import FLUSH_SECONDS
from ..store.json_codec import Plain
from ..store.output_folder import SCENARIO, SUMMARY, TEXTS, OutputFolder, format_path
from .checkpoint import Checkpoints, Identity
from .plan import Lifetimes, Plan, open_participants
from .record import ResultRecorder, TextRecorder, list_texts
from .simulation import Run, Session, Statistics
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
        refused = not observation.start.seen and not isinstance(error, StalledError)
        if refused and isinstance(error, ParticipantError):
            raise RefusedError(error) from None
        return observation.complete(summary.end_by(error, folder.path))
    return replace(observation.complete(summary), complete=True, **vars(statistics))


class _Observation:
    """The observers of a run and what they have seen; `system` is the one to be run."""

    run: Run  # from its start on

    def __init__(self, plan: Plan, folder: OutputFolder) -> None:
        self.system, every, stop = plan.counted or plan.system, plan.scenario.record_every, plan.stop_time
        held_for = 0.0 if plan.scenario.exposed else FLUSH_SECONDS  # a process that ends takes no rows along
        self.contacts = ContactObserver(plan.system)
        self.start = _Start(folder.backup.delete)
        self.warnings: dict[str, Warnings] = {}
        self.lifetimes: Lifetimes = defaultdict(float), defaultdict(float)
        self.recorder = ResultRecorder(folder.unfinished, plan.quantities, every, held_for, stop)
        texts = list_texts(plan.third_party)
        self._ledger = Ledger(self.system, every, folder.unfinished, stop) if plan.counted else None
        ledgers = [self._ledger] if self._ledger else []
        text_recorders = [TextRecorder(folder.path / TEXTS, texts)] if texts else []
        self.observers: list[Observer] = [
            self.recorder, *ledgers, *text_recorders, self.contacts, self.start
        ]  # fmt: skip

    def complete(self, summary: Summary) -> Summary:
        """The summary with what was observed."""
        if not self.start.seen:
            return replace(summary, warnings=self.warnings)
        statistics = self.run.statistics()
        return replace(
            summary,
            macro_steps=statistics.macro_steps,
            iterations=statistics.iterations,
            coupled_time_s=statistics.coupled_time_s,
            contacts=self.contacts.summaries(),
            energy=self._ledger.account() if self._ledger else None,
            effort=self._list_efforts(),
            warnings=self.warnings,
            senseless=self.recorder.senseless,
        )

    def _list_efforts(self) -> dict[str, Spent]:
        """What each participant took, by its name."""
        coupling, (opening, closing) = self.run.session.coupling, self.lifetimes
        calls, effort = coupling.calls, coupling.effort
        return {
            name: Spent(
                int(calls[i]), effort.restored[i], opening[name], effort.initialising[i],
                effort.stepping[i], effort.saving[i], closing[name], effort.own_steps[i], effort.failed[i],
            )
            for i, name in enumerate(coupling.wiring.names)
        }  # fmt: skip


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
            with deferred(), stage as bar, look_between_steps():
                observers = [*observation.observers]
                if every := plan.scenario.checkpoint_every:
                    path, say = folder.checkpoint, reporter.line
                    observers.append(Checkpoints(path, identity, every, stop, is_asked, say))
                steps, lines = plan.make_steps(), plan.side_lines
                session = Session(system, participants, plan.master, steps, stop, lines=lines)
                observation.run = Run(session, [*observers, bar])
                return observation.run.make(checkpoint[1] if checkpoint else None)
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


class _Start(Observer):
    """Calls `begun` at the first values; `seen`: there were some."""

    seen = False

    def __init__(self, begun: Callable[[], None]) -> None:
        self._begun = begun

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if not self.seen:
            self.seen = True
            self._begun()

    def resume(self, names: Sequence[str], state: Plain) -> None:
        self.seen = True
