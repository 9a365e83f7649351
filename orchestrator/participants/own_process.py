"""A process in which an FMU runs: if it crashes, the run keeps its results. It is no sandbox.

Messages and their answers go through pipes: JSON, or raw doubles where a call is made in every step. If the
process ends, by a signal or an exit, `LostParticipantError` is raised.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any, NoReturn

from .. import errors
from ..errors import Command, DiscardedStepError, EndedError, LostParticipantError, ParticipantError, Words
from .messages import CALL, FAILED, receive, send
from .opened_fmu import FmuSettings
from .unpacked import UnpackedFolder

# How long to wait for the process to end by itself (s).
PATIENCE_S = 5.0


class OwnProcess:
    """The process of the FMU at `path`; `server` is the module whose `main` it runs, and the first message is
    the call `instantiate` with the settings and what else is given."""

    server: str

    def __init__(self, name: str, path: Path, settings: FmuSettings, **given: Any) -> None:
        self.name = name
        # Kept here, as a crashed process does not delete what it unpacked.
        self._unpacked = UnpackedFolder()
        self._process = _start_process(self.server)
        self._memory_mb = settings.memory_mb
        if settings.memory_mb is not None:
            limit_memory(self._process.pid, settings.memory_mb)
        self._lost = self._made = self._stepped = False
        self._path = path
        self._doing = "start"
        asked = asdict(settings) | {"outputs": list(settings.outputs)}
        self._wanted = {
            "name": name,
            "path": str(path),
            "given": asked,
            "folder": str(self._unpacked.path),
            **given,
        }
        try:
            self.renew()
            self._made = True
        except BaseException:
            self.close()
            raise

    def renew(self) -> None:
        """A fresh instance, in the place of the one before; it has to be connected and initialised."""
        self._call("instantiate", **self._wanted)

    @property
    def lost(self) -> bool:
        """Whether the process has ended, or may be anywhere in a call."""
        return self._lost

    def initialise(self, start_time: float, stop_time: float) -> None:
        self._call("initialise", start_time=start_time, stop_time=stop_time)

    def finish_initialisation(self) -> None:
        self._call("finish_initialisation")

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
            remedy: Words = "look at the FMU, its inputs and parameters; what was recorded before is kept"
        elif self._made:
            remedy = "look at the FMU, its inputs and parameters"
        else:
            what = f"{self._path} may be damaged, or lack what it needs on this machine ("
            look = Command("fmu validate", (self._path,))
            remedy = what, look, " looks at its library); give another file"
        limit = self._memory_mb and f"; its memory is limited to {self._memory_mb} MB (memory_limit_mb)"
        how = _describe_end(self._process.returncode)
        fault = f"{self.name}: its process ended {how} in the {self._doing}"
        raise LostParticipantError(fault, (remedy, limit or ""))

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
        self._unpacked.delete()


def limit_memory(pid: int, memory_mb: int) -> None:
    """Have the allocations of a process fail beyond this limit (Linux)."""
    import resource  # which Windows lacks

    limit = memory_mb * 1_000_000
    resource.prlimit(pid, resource.RLIMIT_DATA, (limit, limit))


def _describe_end(status: int | None) -> str:
    if status is None:
        return "its connection"
    if status >= 0:
        return f"with exit status {status}"
    try:
        return f"by {signal.Signals(-status).name}"
    except ValueError:
        return f"by signal {-status}"


def _start_process(server: str) -> subprocess.Popen[bytes]:
    """Start it with SIGINT blocked: Ctrl-C is for the run only."""
    path = os.pathsep.join(filter(None, [*sys.path, os.environ.get("PYTHONPATH", "")]))
    with _block_interrupts():
        return subprocess.Popen(
            [sys.executable, "-P", "-c", f"from {server} import main; main()"],
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
