"""An FMU in its own process: if it crashes, the run keeps its results. It is no sandbox.

A step is one message and one answer, with inputs and outputs as raw doubles; other calls are JSON. If the
process ends, by a signal or an exit, `LostParticipantError` is raised.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from models.core.quantities import Vector

from .. import errors
from ..errors import DiscardedStepError, EndedError, LostParticipantError, ParticipantError
from .capabilities import signal_degrees
from .description import read_description
from .fmu import FmuSettings
from .messages import ADVANCE, CALL, FAILED, READ, TIMES, receive, send
from .protocol import BoundVariables

# How long to wait for the process to end by itself (s).
PATIENCE_S = 5.0

Saved = int  # the process's number of a state


class InOwnProcess:
    """Implements `Participant` for the FMU at `path`, by a `FmuParticipant` in another process."""

    def __init__(self, name: str, path: Path, given: FmuSettings) -> None:
        self.name = name
        # Kept here, as a crashed process does not delete what it unpacked.
        self._folder = tempfile.mkdtemp(prefix="tribocosim-")
        self._process = _start_process()
        self._lost = self._made = self._stepped = False
        self._path = path
        self._doing = "start"
        self.restorable = read_description(path).restorable
        try:
            asked = asdict(given) | {"outputs": list(given.outputs)}
            self._call("instantiate", name=name, path=str(path), given=asked, folder=self._folder)
            self._made = True
        except BaseException:
            self.close()
            raise

    def _ask(self, kind: bytes, *parts: Any) -> bytes:
        """Send a message and return the answer; raise the error that it contains."""
        try:
            send(self._process.stdin, kind, *parts)
            answer, content = receive(self._process.stdout)
        except (OSError, EOFError):
            self._raise_lost()
        except BaseException:
            self._lost = True  # interrupted between a message and its answer
            raise
        if answer == FAILED:
            self._raise(json.loads(content))
        return content

    def _call(self, method: str, **arguments: Any) -> Any:
        self._doing = f"call {method}"
        return json.loads(self._ask(CALL, json.dumps({"method": method, **arguments}).encode()))

    def _raise(self, said: dict[str, Any]) -> NoReturn:
        kind = getattr(errors, said["kind"], ParticipantError)
        if issubclass(kind, (DiscardedStepError, EndedError)):
            raise kind(said["message"], said["reached"])
        raise kind(said["message"])

    def _raise_lost(self) -> NoReturn:
        """Raise the error of a process that has ended."""
        self._lost = True
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(PATIENCE_S)
        if self._stepped:
            remedy = "look at the FMU, its inputs and parameters; what was recorded before is kept"
        elif self._made:
            remedy = "look at the FMU, its inputs and parameters"
        else:
            remedy = (
                f"{self._path} may be damaged, or lack what it needs on this machine (tribocosim fmu "
                "validate looks at its library); give another file"
            )
        how = _describe_end(self._process.returncode)
        raise LostParticipantError(f"{self.name}: its process ended {how} in the {self._doing}; {remedy}")

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        return signal_degrees(read_description(self._path), input_names)

    def compiled_calls(self) -> str:
        return "it runs in its own process"

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        self._inputs, self._outputs, self._rates = bound.inputs, bound.outputs, bound.rates
        self._fresh = self._written = False
        rated: list[bool] = self._call(
            "connect",
            inputs=list(bound.input_names),
            rows=len(bound.inputs),
            outputs=list(bound.output_names),
            rated=bool(bound.rates.size),
        )
        self._rated = np.array(rated, dtype=bool)
        return rated

    def initialise(self, start_time: float, stop_time: float) -> None:
        self._call("initialise", times=[start_time, stop_time])
        self._fresh = False

    def finish_initialisation(self) -> None:
        self._call("finish_initialisation")
        self._fresh = False

    def set_inputs(self, values: Mapping[str, float]) -> None:
        self._deliver()
        self._call("set_inputs", values=dict(values))
        self._fresh = False

    def write(self) -> None:
        # The next step or reading sends them.
        self._written, self._fresh = True, False

    def advance(self, time: float, step: float) -> None:
        self._doing = f"step from t = {time:.9g} s by {step:g} s"
        self._fresh, self._stepped = False, True
        self._store_outputs(self._ask(ADVANCE, TIMES.pack(time, step), self._take_inputs()))

    def read(self) -> None:
        if not self._fresh:
            self._doing = "reading of outputs"
            self._store_outputs(self._ask(READ, self._take_inputs()))
        count = self._outputs.size
        self._outputs[:] = self._taken[:count]
        if self._rates.size:
            self._rates[self._rated] = self._taken[count:][self._rated]

    def _deliver(self) -> None:
        """Send inputs that were written, before a call that depends on them."""
        if self._written:
            self._doing = "setting of inputs"
            self._store_outputs(self._ask(READ, self._take_inputs()))

    def _take_inputs(self) -> bytes:
        """The inputs, if they were written since the last message."""
        written, self._written = self._written, False
        return self._inputs.tobytes() if written else b""

    def _store_outputs(self, content: bytes) -> None:
        self._taken = np.frombuffer(content)
        self._fresh = True

    def read_all(self, values: Vector) -> None:
        self._deliver()
        values[:] = self._call("read_all", size=len(values))

    def save(self) -> Saved:
        self._deliver()
        saved: Saved = self._call("save")
        return saved

    def restore(self, saved: Saved) -> None:
        self._call("restore", number=saved)
        self._fresh = self._written = False

    def release(self, saved: Saved) -> None:
        if not self._lost:  # else its states are gone too
            self._call("release", number=saved)

    def to_bytes(self, saved: Saved) -> bytes:
        return bytes.fromhex(self._call("to_bytes", number=saved))

    def from_bytes(self, data: bytes) -> Saved:
        saved: Saved = self._call("from_bytes", data=data.hex())
        return saved

    def warnings(self) -> tuple[int, str]:
        """As `FmuParticipant`; none from a process that has ended."""
        if self._lost:
            return 0, ""
        count, first = self._call("warnings")
        return count, first

    def close(self) -> None:
        process = self._process
        if process.poll() is None and not self._lost:
            with contextlib.suppress(errors.RunError, subprocess.TimeoutExpired):
                self._call("close")
                process.stdin.close()  # type: ignore[union-attr] # by which it ends
                process.wait(PATIENCE_S)
        self._lost = True
        if process.poll() is None:
            process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            with contextlib.suppress(OSError):
                pipe.close()  # type: ignore[union-attr]
        shutil.rmtree(self._folder, ignore_errors=True)


def _describe_end(status: int | None) -> str:
    if status is None:
        return "its connection"
    if status >= 0:
        return f"with exit status {status}"
    try:
        return f"by {signal.Signals(-status).name}"
    except ValueError:
        return f"by signal {-status}"


def _start_process() -> subprocess.Popen[bytes]:
    """Start it with SIGINT blocked: Ctrl-C is for the run only."""
    path = os.pathsep.join(filter(None, [*sys.path, os.environ.get("PYTHONPATH", "")]))
    with _block_interrupts():
        return subprocess.Popen(
            [sys.executable, "-P", "-c", f"from {__package__}.process import main; main()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
            env={**os.environ, "PYTHONPATH": path},
        )


@contextlib.contextmanager
def _block_interrupts() -> Iterator[None]:
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
