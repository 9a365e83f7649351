"""A limit to the wall time of a participant's call.

Another process watches, because a call may hold this one's interpreter: compiled code does until it
returns. What it looks at is shared memory in which every call leaves a mark of two numbers; no clock is
read here.
When a call has taken too long, that process sends a signal, of which Python code, also where it sleeps,
makes a StalledError. If the call does not come back even so, it writes the summary and ends this process
with exit status 3; see `watchdog_process`.
The time in which kernels are compiled does not count: it is not the participant's, and numba must not be
broken off in it.
"""

from __future__ import annotations

import ctypes
import json
import mmap
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any, TypeVar

import numpy as np

from models.core.quantities import Vector

from ..c_output import find_descriptor
from ..compilation import PREPARING, announce_compilation
from ..engine.step import Step
from ..errors import MistakeError, StalledError
from ..participants import Participant
from ..participants.compiled import CompiledCalls
from ..participants.protocol import BoundVariables
from ..scenario import Scenario
from ..store.json_codec import Plain
from .record import FAILED
from .summary import Summary
from .watchdog_process import CELLS, FRESH, INTERRUPTED, MARK, STEPS, TIME, message, number_of

# How long an interrupted call may take to come back: Python code does at once, code that the signal does
# not reach never.
GRACE_SECONDS = 2.0

# The marks of calls that compiled code makes (see `participants.compiled`).
COMPILED = {
    "mark_set": "setting of inputs",
    "mark_step": "step",
    "mark_get": "reading of outputs",
    "mark_save": "saving of its state",
    "mark_release": "freeing of a saved state",
}

Made = TypeVar("Made")


class NoWatchdog:
    """Without a limit nothing lies between a run and its participants."""

    observers: tuple[Any, ...] = ()

    def made(self, name: str, make: Callable[[], Participant]) -> Participant:
        return make()


def watching(
    scenario: Scenario, path: Path, summary: Summary
) -> AbstractContextManager[Watchdog | NoWatchdog]:
    """The watchdog that the scenario asks for, to be entered."""
    if scenario.call_time_limit is None:
        return nullcontext(NoWatchdog())
    return Watchdog(scenario.call_time_limit, list(scenario.components), path, summary)


class Watchdog:
    """Watches the calls of the participants `made` by it, in its `with` block; the first of the observers.

    `limit` and `grace` in seconds; `names` those of all participants. `summary` is what goes to the file
    `path`, with the message, if this process has to be ended.
    """

    def __init__(
        self, limit: float, names: Sequence[str], path: Path, summary: Summary, grace: float = GRACE_SECONDS
    ) -> None:
        if not hasattr(signal, "SIGQUIT"):
            raise MistakeError("call_time_limit: needs the signals of a POSIX system; leave it out")
        self.observers = (self,)
        self._names, self._limit = list(names), limit
        content = summary.content() | {"exit_status": FAILED}
        setup = {"limit": limit, "grace": grace, "names": self._names, "path": str(path), "summary": content}
        self._setup = json.dumps(setup).encode() + b"\n"
        self._stalled: StalledError | None = None
        self._previous: Any = None
        self._kept = 0  # the mark of the call in which kernels are being compiled

    def __enter__(self) -> Watchdog:
        with tempfile.TemporaryFile() as file:
            file.truncate(8 * CELLS)
            memory = mmap.mmap(file.fileno(), 8 * CELLS)
            self._process = _start_process(file.fileno())
        self._cells, self._times = memoryview(memory).cast("q"), memoryview(memory).cast("d")
        self._cells[STEPS] = -1
        assert self._process.stdin
        self._process.stdin.write(self._setup)
        self._process.stdin.flush()
        if threading.current_thread() is threading.main_thread():
            self._previous = signal.signal(signal.SIGUSR1, self._interrupt)
        self._quit = _on_quit(ctypes.cast(ctypes.CDLL(None)._exit, ctypes.c_void_p).value)
        self._unraised, sys.unraisablehook = sys.unraisablehook, self._not_raised
        self._compiling = ExitStack()
        self._compiling.enter_context(announce_compilation(PREPARING, self._pause, self._go_on))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._compiling.close()
        self._cells[MARK] = 0
        sys.unraisablehook = self._unraised
        assert self._process.stdin
        self._process.stdin.close()
        self._process.wait()
        _on_quit(self._quit)
        if self._previous is not None:
            signal.signal(signal.SIGUSR1, self._previous)

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        if self._cells[MARK]:
            # Compiled code may have gone on to another call meanwhile.
            number = self._cells[INTERRUPTED]
            text = message(self._names, number, self._limit, self._cells[STEPS], self._times[TIME])
            self._stalled = StalledError(text)
            raise self._stalled

    def _not_raised(self, unraisable: Any) -> None:
        """A StalledError that C code cannot pass on is raised at the end of the step, and not printed."""
        if not isinstance(unraisable.exc_value, StalledError):
            self._unraised(unraisable)

    def _pause(self) -> None:
        self._kept, self._cells[MARK] = self._cells[MARK] % FRESH, 0

    def _go_on(self) -> None:
        if self._kept:
            self._cells[MARK] = FRESH + self._kept

    def made(self, name: str, make: Callable[[], Participant]) -> Participant:
        """What `make` gives, watched."""
        index = self._names.index(name)
        return Watched(self.guard_call(index, "instantiation", make)(), self, index)

    def guard_call(self, index: int, call: str, function: Callable[..., Made]) -> Callable[..., Made]:
        """`function`, watched; nothing is when it has returned."""
        call_marked, cells = self.mark_start(index, call, function), self._cells

        def guarded(*arguments: Any) -> Made:
            try:
                return call_marked(*arguments)
            finally:
                cells[MARK] = 0

        return guarded

    def mark_start(self, index: int, call: str, function: Callable[..., Made]) -> Callable[..., Made]:
        """`function`, watched until the next call or the end of the macro step: less to do in every step."""
        mark, cells, cause = FRESH + number_of(index, call), self._cells, self._cause

        def marked(*arguments: Any) -> Made:
            cells[MARK] = mark
            try:
                return function(*arguments)
            except Exception as error:
                raise cause(error)  # noqa: B904

        return marked

    def advancing(
        self, index: int, advance: Callable[[float, float], None]
    ) -> Callable[[float, float], None]:
        """As `mark_start`, for the steps: without the cost of any number of arguments."""
        mark, cells, cause = FRESH + number_of(index, "step"), self._cells, self._cause

        def advancing(time: float, step: float) -> None:
            cells[MARK] = mark
            try:
                advance(time, step)
            except Exception as error:
                raise cause(error)  # noqa: B904

        return advancing

    def exchanging(self, index: int, call: str, exchange: Callable[[], None]) -> Callable[[], None]:
        """As `mark_start`, for what passes values in every step."""
        mark, cells, cause = FRESH + number_of(index, call), self._cells, self._cause

        def exchanging() -> None:
            cells[MARK] = mark
            try:
                exchange()
            except Exception as error:
                raise cause(error)  # noqa: B904

        return exchanging

    def mark_compiled(self, index: int, calls: CompiledCalls) -> CompiledCalls:
        """The calls, with the marks that compiled code stores."""
        cells = np.frombuffer(self._cells, dtype=np.int64)

        def describe(record: Any) -> None:
            calls.describe(record)
            record["cell"] = cells[MARK:].ctypes.data
            for key, call in COMPILED.items():
                record[key] = FRESH + number_of(index, call)

        def fail(*arguments: Any) -> None:
            try:
                calls.fail(*arguments)
            except Exception as error:
                raise self._cause(error)  # noqa: B904

        return replace(calls, describe=describe, fail=fail)

    def _cause(self, error: Exception) -> Exception:
        """Of an interruption an FMU could only say that it failed."""
        return self._stalled or error

    def begin(self, names: Sequence[str]) -> None:
        pass

    def state(self) -> dict[str, Plain]:
        return {"steps": self._cells[STEPS], "time": self._times[TIME]}

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        self._cells[STEPS], self._times[TIME] = state["steps"], state["time"]

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        self._cells[MARK] = 0
        self._cells[STEPS] += 1
        self._times[TIME] = time
        if self._stalled:  # an FMU kept it to itself
            raise self._stalled

    def end(self, complete: bool, message: str) -> None:
        self._cells[MARK] = 0


class Watched:
    """Implements `Participant` by one whose calls are watched."""

    def __init__(self, participant: Participant, watchdog: Watchdog, index: int) -> None:
        self.name = participant.name
        self._participant, self._watchdog, self._index = participant, watchdog, index
        guard_call, mark_start = watchdog.guard_call, watchdog.mark_start
        self.signal_degrees = participant.signal_degrees
        self.initialise = guard_call(index, "initialisation", participant.initialise)
        self.finish_initialisation = guard_call(
            index, "end of initialisation", participant.finish_initialisation
        )
        self.set_inputs = guard_call(index, "setting of inputs", participant.set_inputs)
        self.advance = watchdog.advancing(index, participant.advance)
        self.read_all = guard_call(index, "reading of all outputs", participant.read_all)
        self.save = mark_start(index, "saving of its state", participant.save)
        self.restore = mark_start(index, "restoring of its state", participant.restore)
        # Enclosed: a checkpoint, which the disk may keep waiting, comes after it.
        self.release = guard_call(index, "freeing of a saved state", participant.release)
        self.close = guard_call(index, "end", participant.close)
        prove = getattr(participant, "prove", None)
        self.prove = partial(prove, guard=partial(guard_call, index, "step")) if prove else None

    @property
    def restorable(self) -> bool:
        return self._participant.restorable

    def to_bytes(self, saved: Any) -> bytes:
        call = "serialising of its state"
        return self._watchdog.guard_call(self._index, call, self._participant.to_bytes)(saved)

    def from_bytes(self, data: bytes) -> Any:
        call = "taking of a serialised state"
        return self._watchdog.guard_call(self._index, call, self._participant.from_bytes)(data)

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        rated = self._participant.connect(bound)
        # Only now: participants make these when they are connected.
        self.write = self._watchdog.exchanging(self._index, "setting of inputs", self._participant.write)
        self.read = self._watchdog.exchanging(self._index, "reading of outputs", self._participant.read)
        return rated

    def compiled_calls(self) -> CompiledCalls | str:
        calls = self._participant.compiled_calls()
        return calls if isinstance(calls, str) else self._watchdog.mark_compiled(self._index, calls)


def _start_process(shared: int) -> subprocess.Popen[bytes]:
    """The watching process. Ctrl-C, which the terminal sends to both, is not for it."""
    script = Path(__file__).with_name("watchdog_process.py")
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        return subprocess.Popen(
            [sys.executable, "-I", "-S", str(script), str(shared)],
            stdin=subprocess.PIPE,
            stderr=find_descriptor(sys.stderr),  # may be another than that of standard error
            pass_fds=[shared],
        )
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _on_quit(handler: int | None) -> int | None:
    """Let C call the function at this address on SIGQUIT; the address before.

    Python's own handlers wait for the interpreter. The C library's `_exit` does not, and takes the number
    of the signal, 3, as the exit status.
    """
    assert int(signal.SIGQUIT) == FAILED
    function = ctypes.CDLL(None).signal
    function.argtypes, function.restype = [ctypes.c_int, ctypes.c_void_p], ctypes.c_void_p
    previous: int | None = function(signal.SIGQUIT, handler)
    return previous
