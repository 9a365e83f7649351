"""The process between a run and an FMU. Standard library only: run as a script it starts at once.

Usage: keeper.py SERVER MEMORY_MB, with the module whose `main` serves the FMU and its limit of memory (0:
none). An FMU that ends its parent ends this process and not the run. What the FMU has started goes with it:
its group of processes, and on Linux those that have left the group too.
"""

import contextlib
import ctypes
import importlib
import os
import signal
import sys
from pathlib import Path

DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG
ADOPT_ORPHANS = 36  # PR_SET_CHILD_SUBREAPER


def keep(server: str, memory_mb: str) -> None:
    """This process becomes the keeper, and a copy of it that of the FMU."""
    if hasattr(os, "fork"):
        tie_to_parent(signal.SIGTERM)
        _set_process(ADOPT_ORPHANS, 1)
        if kept := os.fork():
            _keep(kept)
        os.setpgid(0, 0)
        tie_to_parent(signal.SIGKILL)
    if limit := int(memory_mb) * 1_000_000:
        import resource  # which Windows lacks

        resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))
    importlib.import_module(server).main()


def tie_to_parent(number: int) -> None:
    """This process gets the signal when its parent ends (Linux)."""
    _set_process(DIE_WITH_PARENT, number)


def _set_process(option: int, value: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(option, value)


def _keep(kept: int) -> None:
    """Wait for the end of the FMU's process, end its group and end in the same way. SIGTERM ends both."""

    def end(number: int, frame: object) -> None:
        with contextlib.suppress(OSError):
            os.kill(kept, signal.SIGKILL)

    signal.signal(signal.SIGTERM, end)
    os.close(0)
    os.close(1)
    os.waitid(os.P_PID, kept, os.WEXITED | os.WNOWAIT)
    with contextlib.suppress(OSError):  # there is no group yet, or nothing in it
        os.killpg(kept, signal.SIGKILL)
    status = os.waitstatus_to_exitcode(os.waitpid(kept, 0)[1])
    _end_adopted()
    if status < 0:
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if -status not in (signal.SIGKILL, signal.SIGSTOP):
            signal.signal(-status, signal.SIG_DFL)
        os.kill(os.getpid(), -status)
    os._exit(status)


def _end_adopted() -> None:
    """End what the FMU's process has left behind (Linux); children of these come to this process in turn."""
    with contextlib.suppress(OSError):  # there is no such file, or no child
        while found := Path(f"/proc/self/task/{os.getpid()}/children").read_text("ascii").split():
            for child in map(int, found):
                os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)


if __name__ == "__main__":
    keep(*sys.argv[1:])
