"""The process from which those of FMUs are forked (Linux). It has imported what they need, and runs no FMU.

Usage: fork_server.py DESCRIPTOR, of the socket by which a run asks for processes (`forked`). It ends with the
run's process.
"""

import contextlib
import errno
import gc
import importlib
import os
import select
import signal
import socket
import struct
import sys

from orchestrator.participants import keeper

NUMBER = struct.Struct("=q")  # that of a process, or -errno where none starts; later its status
LONGEST = 1000  # bytes of a request
WATCH_S = 1.0  # how often it looks whether the run's process is there


def main() -> None:
    run, statuses = os.getppid(), dict[int, int]()
    connection = socket.socket(fileno=int(sys.argv[1]))
    asking = connection.fileno()
    woken, waker = os.pipe()
    os.set_blocking(waker, False)
    signal.set_wakeup_fd(waker)
    signal.signal(signal.SIGCHLD, lambda number, frame: None)
    while os.getppid() == run:
        ready = select.select([asking, woken], [], [], WATCH_S)[0]
        if woken in ready:
            os.read(woken, select.PIPE_BUF)
            _report_ends(statuses)
        if asking in ready:
            asked, given, *_ = socket.recv_fds(connection, LONGEST, 3)
            if not asked:
                break
            server, memory_mb = asked.decode().split()
            reports = given.pop()
            try:
                importlib.import_module(server)
                gc.freeze()
                if not (number := os.fork()):
                    _become(server, memory_mb, [*given, reports], [asking, woken, waker, *statuses.values()])
                statuses[number] = reports
            except Exception as error:  # the processes that run go on
                lacking = errno.ENOMEM if isinstance(error, MemoryError) else errno.ENOPKG
                number = -(getattr(error, "errno", None) or lacking)
                given.append(reports)
            _report(reports, number)
            for descriptor in given:
                os.close(descriptor)
    os._exit(0)


def _become(server: str, memory_mb: str, given: list[int], others: list[int]) -> None:
    """A copy becomes the keeper of an FMU with these pipes as standard input and output."""
    try:
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        for number, descriptor in enumerate(given[:2]):
            os.dup2(descriptor, number)
        for descriptor in (*given, *others):
            os.close(descriptor)
        os.setsid()
        keeper.keep(server, memory_mb)
    finally:
        os._exit(1)


def _report_ends(statuses: dict[int, int]) -> None:
    """Tell the run the status of each process that has ended."""
    with contextlib.suppress(ChildProcessError):
        while (found := os.waitpid(-1, os.WNOHANG))[0]:
            reports = statuses.pop(found[0])
            _report(reports, os.waitstatus_to_exitcode(found[1]))
            os.close(reports)


def _report(reports: int, number: int) -> None:
    with contextlib.suppress(OSError):  # nobody waits for it
        os.write(reports, NUMBER.pack(number))


if __name__ == "__main__":
    main()
