"""A process in which an FMU runs: if it crashes, the run keeps its results. It is no sandbox.

Messages and their answers go through pipes: JSON, or raw doubles where a call is made in every step. If the
process ends, by a signal or an exit, or answers with what is no message, `LostParticipantError` is raised.
"""

import contextlib
import errno
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NoReturn

from models.compile.temporary import TemporaryFolder

from .. import errors
from ..errors import (
    Command,
    DiscardedStepError,
    EndedError,
    LostParticipantError,
    ParticipantError,
    StalledError,
    Words,
)
from .forked import Forked
from .messages import CALL, FAILED, receive, send
from .opened_fmu import FmuSettings

# How long to wait for the process to end by itself (s).
PATIENCE_S = 5.0
# What the system says where it has no more.
LIMITS = errno.EAGAIN, errno.ENOMEM, errno.EMFILE, errno.ENFILE
FEWER = "use fewer FMUs", "raise the limits of processes, open files and memory"


@dataclass(frozen=True)
class Limits:
    """Of an FMU's own process: its memory (MB), and the wall time of a call (s). None: no limit."""

    memory_mb: int | None = None
    call_s: float | None = None


NO_LIMITS = Limits()


def ask(method: str, read: Callable[[Any], Any] = lambda found: found) -> Any:
    """A method of an `OwnProcess` that its process carries out; `read` makes the result of the answer."""
    return lambda unit, **arguments: read(unit._call(method, **arguments))


class OwnProcess:
    """The process of the FMU at `path`; `server` is the module whose `main` it runs, and the first message is
    the call `instantiate` with the settings and what else is given."""

    server: str

    def __init__(self, name: str, path: Path, settings: FmuSettings, limits: Limits, **given: Any) -> None:
        self.name, self._limits = name, limits
        # Kept here, as a crashed process does not delete what it unpacked.
        self._unpacked = TemporaryFolder()
        try:
            self._process = _start_process(self.server, limits.memory_mb)
        except OSError as error:
            self._unpacked.delete()
            remedies = () if error.errno in LIMITS else ("install tribocosim again",)
            fault = f"{name}: its process cannot start ({error.strerror})"
            raise ParticipantError(fault, *remedies, *FEWER) from None
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

    finish_initialisation, terminate = ask("finish_initialisation"), ask("terminate")

    def _ask(self, kind: bytes, *parts: Any) -> bytes:
        """Send a message and return the answer; raise the error that it contains."""
        try:
            send(self._process.stdin, kind, *parts)
            answer, content = receive(self._process.stdout, self._limits.call_s)
        except TimeoutError:
            self._lost = True
            raise StalledError(
                f"{self.name}: the {self._doing} did not return within {self._limits.call_s:g} s; look at "
                "what the FMU waits for, or raise call_time_limit"
            ) from None
        except (OSError, EOFError):
            self._raise_lost(self._describe_end())
        except ValueError:
            self._raise_garbled()
        except BaseException:
            self._lost = True  # interrupted between a message and its answer
            raise
        if answer == FAILED:
            self._raise(self._decode(content))
        return content

    def _call(self, method: str, **arguments: Any) -> Any:
        self._doing = f"call {method}"
        return self._decode(self._ask(CALL, json.dumps({"method": method, **arguments}).encode()))

    def _decode(self, content: bytes) -> Any:
        try:
            return json.loads(content)
        except ValueError:
            self._raise_garbled()

    def _raise_garbled(self) -> NoReturn:
        self._raise_lost(
            "gave an answer that cannot be read (the FMU may write to descriptors that are not its own)"
        )

    def _raise(self, said: dict[str, Any]) -> NoReturn:
        kind = getattr(errors, said["kind"], ParticipantError)
        if issubclass(kind, (DiscardedStepError, EndedError)):
            raise kind(said["message"], said["reached"])
        raise kind(said["message"])

    def _describe_end(self) -> str:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(PATIENCE_S)
        return f"ended {_describe_status(self._process.returncode)}"

    def _raise_lost(self, what: str) -> NoReturn:
        """Raise the error of a process that does not answer any more: what it did."""
        self._lost = True
        if self._stepped:
            remedy: Words = "look at the FMU, its inputs and parameters; what was recorded before is kept"
        elif self._made:
            remedy = "look at the FMU, its inputs and parameters"
        else:
            file = f"{self._path} may be damaged, or lack what it needs on this machine ("
            look = Command("fmu validate", (self._path,))
            remedy = file, look, " looks at its library); give another file"
        memory_mb = self._limits.memory_mb
        limit = memory_mb and f"; its memory is limited to {memory_mb} MB (memory_limit_mb)"
        fault = f"{self.name}: its process {what} in the {self._doing}"
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
            process.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(PATIENCE_S)
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            with contextlib.suppress(OSError):
                pipe.close()  # type: ignore[union-attr]
        self._unpacked.delete()


def _describe_status(status: int | None) -> str:
    if status is None:
        return "its connection"
    if status >= 0:
        return f"with exit status {status}"
    try:
        return f"by {signal.Signals(-status).name}"
    except ValueError:
        return f"by signal {-status}"


def _start_process(server: str, memory_mb: int | None) -> subprocess.Popen[bytes] | Forked:
    """Start it by its keeper, in a session of its own: Ctrl-C is for the run only."""
    path = os.pathsep.join(filter(None, [*sys.path, os.environ.get("PYTHONPATH", "")]))
    given, environment = (server, str(memory_mb or 0)), {**os.environ, "PYTHONPATH": path}
    if sys.platform == "linux":
        return Forked(*given, environment)
    return subprocess.Popen(
        [sys.executable, "-P", str(Path(__file__).with_name("keeper.py")), *given],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        bufsize=0,
        env=environment,
        start_new_session=True,
        creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
    )
