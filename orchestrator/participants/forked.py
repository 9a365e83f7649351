"""Processes that are forked from one that has imported what they need (Linux): each starts at once."""

import contextlib
import errno
import os
import select
import signal
import socket
import subprocess
import sys
import threading
import weakref
from collections.abc import Mapping
from pathlib import Path

from .fork_server import NUMBER

_lock = threading.Lock()
_latest: list["_Origin"] = []  # at most one


class _Origin:
    """The process from which others are forked. It ends when nothing refers to it."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        self.of = _describe(environment)
        self._socket, given = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        file = str(Path(__file__).with_name("fork_server.py"))
        with contextlib.ExitStack() as failed, given:
            failed.callback(self._socket.close)
            process = subprocess.Popen(
                [sys.executable, "-P", file, str(given.fileno())],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                pass_fds=[given.fileno()],
                env=environment,
                start_new_session=True,
            )
            failed.pop_all()
        weakref.finalize(self, _end, self._socket, process)

    def ask(self, what: str, descriptors: list[int]) -> None:
        socket.send_fds(self._socket, [what.encode()], descriptors)


def _end(connection: socket.socket, process: subprocess.Popen[bytes]) -> None:
    connection.close()
    process.terminate()  # a copy of this process may have the socket too
    process.wait()


def _describe(environment: Mapping[str, str]) -> tuple[object, ...]:
    """What a process inherits. Where one of it has changed, another origin is started."""
    places = []
    for place in (".", 2):
        with contextlib.suppress(OSError):
            found = os.stat(place)
            places.append((found.st_dev, found.st_ino))
    return os.getpid(), dict(environment), places


def _open_pipes(count: int) -> list[int]:
    """Both ends of each; none of them is left where there are too few descriptors."""
    found: list[int] = []
    try:
        for _ in range(count):
            found += os.pipe()
    except OSError:
        for descriptor in found:
            os.close(descriptor)
        raise
    return found


class Forked:
    """As `subprocess.Popen`, of the keeper of a process that runs `main` of the module `server`.

    OSError where none starts.
    """

    returncode: int | None = None

    def __init__(self, server: str, memory_mb: str, environment: Mapping[str, str]) -> None:
        try:
            self._fork(server, memory_mb, environment)
        except ConnectionError:  # the origin was killed
            _latest.clear()
            self._fork(server, memory_mb, environment)

    def _fork(self, server: str, memory_mb: str, environment: Mapping[str, str]) -> None:
        asked, send, receive, answers, read, status = _open_pipes(3)
        self.stdin, self.stdout = os.fdopen(send, "wb", 0), os.fdopen(receive, "rb", 0)
        self._status = os.fdopen(read, "rb", 0)
        given = [asked, answers, status]
        try:
            with _lock:
                if not _latest or _latest[0].of != _describe(environment):
                    _latest[:] = [_Origin(environment)]
                self._origin = _latest[0]
                self._origin.ask(f"{server} {memory_mb}", given)
            while given:
                os.close(given.pop())
            self.pid = self._read_number()
            if self.pid < 0:
                raise OSError(-self.pid, os.strerror(-self.pid))
        except BaseException:
            for pipe in (self.stdin, self.stdout, self._status):
                pipe.close()
            raise
        finally:
            for descriptor in given:
                os.close(descriptor)

    def _read_number(self) -> int:
        if len(number := self._status.read(NUMBER.size)) < NUMBER.size:
            raise ConnectionResetError(errno.ECONNRESET, os.strerror(errno.ECONNRESET))
        return int(NUMBER.unpack(number)[0])

    def poll(self) -> int | None:
        """Its exit status as that of `Popen`, or None while it runs."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.wait(0.0)
        return self.returncode

    def wait(self, limit_s: float | None = None) -> None:
        """Until it has ended; TimeoutExpired if that takes longer."""
        if self.returncode is not None:
            return
        waiting = select.poll()
        waiting.register(self._status, select.POLLIN)
        if not waiting.poll(None if limit_s is None else 1e3 * limit_s):
            raise subprocess.TimeoutExpired("keeper", limit_s or 0.0)
        try:
            self.returncode = self._read_number()
        except OSError:  # its origin was killed, and this with it
            self.returncode = -signal.SIGKILL
        self._status.close()
        del self._origin

    def terminate(self) -> None:
        self._send(signal.SIGTERM)

    def kill(self) -> None:
        self._send(signal.SIGKILL)

    def _send(self, number: int) -> None:
        if self.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.pid, number)


def _forget() -> None:
    """A copy of this process has no children."""
    global _lock
    _lock = threading.Lock()
    _latest.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget)
