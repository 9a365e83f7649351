"""Execute a plan: the coupled run with its participants and observers, its progress and Ctrl-C."""

from __future__ import annotations

import math
import shutil
import signal
import threading
import time as clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any, NamedTuple

from models.core.quantities import Vector

from ..assessment.contacts import ContactObserver
from ..compilation import PREPARING, announce_compilation
from ..engine.energy import Ledger, Trimmed
from ..engine.observer import Observer
from ..engine.step import Step
from ..errors import ParticipantError, RefusedError, RunError, StalledError
from ..participants.protocol import Participant
from ..reporter import Reporter
from ..scenario import Scenario
from ..store.journal import FLUSH_SECONDS
from ..store.json_codec import Plain
from ..store.output_folder import SCENARIO, SUMMARY, TEXTS, OutputFolder, format_path
from .checkpoint import Checkpoints, Identity
from .plan import Plan, open_participants
from .record import (
    ENDS,
    STEP_VARIABLES,
    Ending,
    NotFinite,
    Record,
    ResultRecorder,
    TextRecorder,
    Warnings,
    classify_ending,
    list_texts,
)
from .simulation import Statistics, simulate
from .summary import summarise


class Noticed:
    """Remembers that Ctrl-C came; it is raised as ever.

    Libraries make other errors of it: numba, broken off while it compiles, one about its half-made code.
    """

    def __init__(self) -> None:
        self.asked = False
        self._previous: Any = None

    def __enter__(self) -> Noticed:
        if threading.current_thread() is threading.main_thread():
            self._previous = signal.getsignal(signal.SIGINT)
            if callable(self._previous):  # not where the command was started without Ctrl-C
                signal.signal(signal.SIGINT, self._notice)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if callable(self._previous):
            signal.signal(signal.SIGINT, self._previous)

    def _notice(self, number: int, frame: FrameType | None) -> None:
        self.asked = True
        self._previous(number, frame)


@contextmanager
def tell_interruption(describe: Callable[[], str]) -> Iterator[None]:
    """Where Ctrl-C ends the block, KeyboardInterrupt says by `describe` what is kept and how to go on."""
    with Noticed() as noticed:
        try:
            yield
        except (Exception, KeyboardInterrupt) as error:
            interrupted = isinstance(error, KeyboardInterrupt)
            if not (interrupted or noticed.asked):
                raise
            text = str(error) if interrupted else ""
            raise KeyboardInterrupt(text or f"interrupted; {describe()}") from None


class Interruption:
    """An observer that raises KeyboardInterrupt after the macro step in which Ctrl-C came.

    Raised inside a Python FMU, it would come back as that FMU's error. A second Ctrl-C is raised at once.
    Outside the main thread, which alone gets signals, it does nothing.
    """

    def __init__(self) -> None:
        self.asked = False
        self._previous: Any = None

    def __enter__(self) -> Interruption:
        if threading.current_thread() is threading.main_thread():
            self._previous = signal.signal(signal.SIGINT, self._ask)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._previous is not None:
            signal.signal(signal.SIGINT, self._previous)
        if self.asked and kind is None:  # it came in the last step
            raise KeyboardInterrupt

    def _ask(self, number: int, frame: FrameType | None) -> None:
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True

    def begin(self, names: Sequence[str]) -> None:
        pass

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if self.asked:
            raise KeyboardInterrupt

    def end(self, complete: bool, message: str) -> None:
        pass


# A run with more steps, more bytes on the disk or more time is said to be long: about a minute here.
LONG_STEPS, LARGE, LONG_SECONDS = 1_000_000, 1e9, 60.0
# Rows stand in a journal, in the result file (as if nothing could be compressed) and, of the outputs, as text
# of 20 characters in the CSV file, all at once at the end.
STORED, AS_TEXT = 8 + 8, 20
# Bytes of a macro step in memory when the steps are diagnosed: 7 numbers as read and as kept.
IN_MEMORY = 100
# The speed is that of the first seconds, when all is compiled.
MEASURED_SECONDS = 2.0
# A stop time (s) as long as this may be one in ms without its unit.
DOUBTFUL = 10.0


class Workload(NamedTuple):
    """Macro steps, records, and bytes at most on the disk and in memory."""

    steps: int
    records: int
    disk: int
    memory: int

    @classmethod
    def of(cls, scenario: Scenario, outputs: int) -> Workload:
        """Of a scenario without step control whose components have so many outputs."""
        steps = math.ceil(scenario.stop_time / scenario.macro_step * (1.0 - 1e-9))
        records = steps // scenario.record_every + 2  # the start and the end
        numbers = records * (outputs + 1) + steps * (len(STEP_VARIABLES) + 1)
        return cls(steps, records, numbers * STORED + records * (outputs + 1) * AS_TEXT, steps * IN_MEMORY)


def announce(scenario: Scenario, outputs: int, out: Path) -> str:
    """A line about a long run with so many outputs, before it starts; "" for a short one, and with step
    control, where the steps are not known."""
    if scenario.step_control is not None:
        return ""
    steps, records, disk, memory = Workload.of(scenario, outputs)
    if steps < LONG_STEPS and disk < LARGE:
        return ""
    stop, free = scenario.stop_time, shutil.disk_usage(out).free
    line = (
        f"long run: {stop:g} s in steps of {scenario.macro_step:g} s are {steps:,} macro steps "
        f"({_bytes(memory)} of memory); {records:,} records need up to {_bytes(disk)} on the disk "
        f"({_bytes(free)} are free)"
    )
    if disk > free:
        line += "; make output_step longer"
    if stop >= DOUBTFUL:
        line += f' (if {stop:g} ms were meant: stop_time = "{stop:g} ms")'
    return line


class Forecast:
    """An observer that says once how long the coupled run will take, if that is long."""

    def __init__(self, stop_time: float, tell: Callable[[str], None]) -> None:
        self._stop, self._tell = stop_time, tell
        self._began: tuple[float, float] | None = None
        self._told = False

    def begin(self, names: Sequence[str]) -> None:
        pass

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if self._told:
            return
        now = clock.monotonic()
        if self._began is None:
            self._began = time, now
        start, began = self._began
        if now - began < MEASURED_SECONDS or time <= start:
            return
        self._told = True
        left = (now - began) * (self._stop - time) / (time - start)
        if left > LONG_SECONDS:
            self._tell(f"the coupled run will take about {duration(left)} at this speed; Ctrl-C ends it")

    def restart(self) -> None:
        """Measure anew from the next step: kernels were compiled, which the other steps do not repeat."""
        self._began = None

    def end(self, complete: bool, message: str) -> None:
        pass


def duration(seconds: float) -> str:
    """In the longest unit of which it has two."""
    units = (("years", 365.25 * 86400.0), ("days", 86400.0), ("h", 3600.0), ("min", 60.0), ("s", 0.0))
    return next(f"{seconds / max(size, 1.0):.0f} {unit}" for unit, size in units if seconds >= 2.0 * size)


def _bytes(size: float) -> str:
    units = (("TB", 1e12), ("GB", 1e9), ("MB", 1e6), ("kB", 0.0))
    return next(f"{size / max(one, 1e3):.3g} {unit}" for unit, one in units if size >= one)


Checkpoint = tuple[Identity, Plain]


def execute(
    plan: Plan, folder: OutputFolder, reporter: Reporter, checkpoint: Checkpoint | None = None
) -> Record:
    """Run from the start or from a checkpoint, to the end or to what stops it.

    Raises RefusedError if a participant fails before the first values, and CheckpointError if the checkpoint
    is not of this plan; nothing of an earlier run is changed then.
    """
    identity = Identity.of(folder.path / SCENARIO, plan.sha256)
    if checkpoint:
        identity.check(checkpoint[0], format_path(folder.path))
        if differ := identity.compare_machines(checkpoint[0], format_path(folder.path)):
            reporter.line(differ)
    else:  # this is left if a participant ends the process
        summarise(plan, Ending(), Record()).write(folder.path / SUMMARY)
    observation = _Observation(plan, folder)
    try:
        statistics = _couple(plan, folder, reporter, observation, identity, checkpoint)
    except ENDS as error:
        refused = observation.counter.steps < 0 and not isinstance(error, StalledError)
        if refused and isinstance(error, ParticipantError):
            raise RefusedError(error) from None
        return observation.record(classify_ending(error, folder.path), None)
    return observation.record(Ending(complete=True), statistics)


class _Observation:
    """The observers of a run and what they have seen; `system` is the one to be run."""

    def __init__(self, plan: Plan, folder: OutputFolder) -> None:
        system, every, stop = plan.system, plan.scenario.record_every, plan.stop_time
        held_for = 0.0 if plan.scenario.exposed else FLUSH_SECONDS  # a process that ends takes no rows along
        self.not_finite, self.contacts = NotFinite(every, stop), ContactObserver(system)
        self.counter = _Counter(folder.backup.delete)
        self.warnings: dict[str, Warnings] = {}
        recorder = ResultRecorder(folder.unfinished, plan.quantities, every, held_for, stop)
        recorders: list[Observer] = [recorder, self.not_finite]
        texts = list_texts(plan.third_party)
        text_recorders = [TextRecorder(folder.path / TEXTS, texts)] if texts else []
        self._ledger = None
        if plan.counted is not None:
            system = plan.counted
            self._ledger = Ledger(system, every, folder.unfinished, stop)
            recorders = [*(Trimmed(recorder, system) for recorder in recorders), self._ledger]
        self.system = system
        self.observers = [*recorders, *text_recorders, self.contacts, self.counter]

    def record(self, ending: Ending, statistics: Statistics | None) -> Record:
        if self.counter.steps < 0:
            return Record(ending, warnings=self.warnings)
        return Record(
            ending,
            macro_steps=self.counter.steps,
            iterations=self.counter.iterations,
            do_steps=statistics.do_steps if statistics else None,
            coupled_time_s=statistics.coupled_time_s if statistics else self.counter.time_s,
            contacts=self.contacts.summaries(),
            energy=self._ledger.account() if self._ledger else None,
            warnings=self.warnings,
            not_finite=self.not_finite.since,
            python_sweeps=statistics.python_sweeps if statistics else {},
            without_rates=statistics.without_rates if statistics else (),
            unproven=statistics.unproven if statistics else (),
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
    stage = reporter.stage(f"coupled run, master {plan.scenario.master.name}", stop)
    units: dict[str, Participant] = {}
    with open_participants(
        system, plan.participants, lambda name, make: units.setdefault(name, make())
    ) as participants:
        try:
            with stage as bar, Interruption() as interruption:
                observers = [*observation.observers]
                if every := plan.scenario.checkpoint_every:
                    path, say = folder.checkpoint, reporter.line
                    observers.append(
                        Checkpoints(path, identity, every, stop, lambda: interruption.asked, say)
                    )
                forecast = Forecast(stop, reporter.line)
                with announce_compilation(PREPARING, begin=lambda: None, end=forecast.restart):
                    return simulate(
                        system,
                        participants,
                        plan.master,
                        plan.make_steps(),
                        stop,
                        [*observers, bar, forecast, interruption],
                        resumed=checkpoint[1] if checkpoint else None,
                        lines=plan.side_lines,
                    )
        finally:
            observation.warnings = _collect_warnings(units)


def _collect_warnings(units: Mapping[str, Participant]) -> dict[str, Warnings]:
    """The warnings of the FMUs that gave any."""
    found = {}
    for name, unit in units.items():
        with suppress(RunError):  # the run has ended, and the reason is known
            count, first = unit.abilities.warnings()
            if count:
                found[name] = Warnings(count, first)
    return found


class _Counter:
    """Counts steps, iterations and time (s), also of a run that ends early. Calls `begun` at the start
    values; until then `steps` is -1."""

    steps = -1
    iterations = 0
    time_s = 0.0

    def __init__(self, begun: Callable[[], None]) -> None:
        self._begun = begun

    def begin(self, names: Sequence[str]) -> None:
        self._start = clock.perf_counter()

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        self.steps += 1
        if not self.steps:
            self._begun()
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
