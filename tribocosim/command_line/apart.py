"""Commands that call an FMU in their own process (`process = "shared"`) are carried out by a child process.

Such an FMU may end the process with any status, or never return. The child states its exit status as the last
thing it does; without that statement the command has failed.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time as clock
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from ..messages import say

if TYPE_CHECKING:
    from models.core.remedies import Words
    from orchestrator.scenario import Scenario

FAILED = 3
CHANNEL = "TRIBOCOSIM_CHANNEL"  # the descriptor to which a child states its status
PATIENCE_S = 2.0  # how long a child may take to end when it is asked to
_arguments: list[str] | None = None
_process = 0


def remember_arguments() -> None:
    """This process was started for the command. In others, as in tests, a command has no child."""
    global _arguments, _process
    _arguments, _process = sys.argv[1:], os.getpid()


def state(status: int) -> None:
    """The command has come to its end with this status."""
    if os.getpid() == _process and CHANNEL in os.environ:  # no copy, which an FMU has made by `fork`
        with os.fdopen(int(os.environ[CHANNEL]), "wb") as channel:
            channel.write(b"ended %d." % status)


def carry_out_apart(scenario: Scenario, out: Path | None) -> None:
    """Have a child carry out the command if the scenario needs that, and end with its status.

    `out` is the output folder of a run.
    """
    if not scenario.exposed or _arguments is None or os.name != "posix":
        return
    if CHANNEL in os.environ:
        from orchestrator.participants.keeper import tie_to_parent

        tie_to_parent(signal.SIGKILL)
        return
    reading, writing = os.pipe()
    child = subprocess.Popen(
        [sys.executable, "-m", "tribocosim", *_arguments],
        env=os.environ | {CHANNEL: str(writing)},
        pass_fds=[writing],
        start_new_session=True,
    )
    os.close(writing)
    status = _wait(child)
    with suppress(OSError):  # nothing that the FMU started is left in its session
        os.killpg(child.pid, signal.SIGKILL)
    stated = os.read(reading, 100)
    if stated.startswith(b"ended ") and stated.endswith(b"."):
        raise typer.Exit(int(stated[6:-1]))
    from models.core.remedies import Set, in_command_line

    if status:
        say(in_command_line(("interrupted", _describe_records(out))))
        raise typer.Exit(status)
    names = scenario.exposed
    who = names[0] if len(names) == 1 else f"one of {', '.join(names)}"
    fault = f"incomplete: {who}: the FMU ended the process of the whole command ({_describe_end(child)}); "
    apart = [(Set(f"components.{name}.process", "own"), " ") for name in names]
    say(in_command_line((fault, *apart, "keeps it apart", _describe_records(out))))
    raise typer.Exit(FAILED)


def _wait(child: subprocess.Popen[bytes]) -> int:
    """Until it has ended. Signals are passed on; what asks for its end, as the second Ctrl-C does, also ends
    it where an FMU heeds none. Returns the exit status after that, otherwise 0."""
    asked: list[int] = []
    ends: list[float] = []

    def pass_on(number: int, frame: Any) -> None:
        asked.append(number)
        child.send_signal(number)
        if number != signal.SIGINT or asked.count(number) > 1:
            ends.append(clock.monotonic() + PATIENCE_S)

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, pass_on)
    while True:
        try:
            child.wait(0.1)
            return 128 + asked[-1] if ends else 0
        except subprocess.TimeoutExpired:
            if ends and clock.monotonic() > ends[0]:
                child.kill()


def _describe_end(child: subprocess.Popen[bytes]) -> str:
    status = child.returncode
    return f"exit status {status}" if status >= 0 else signal.Signals(-status).name


def _describe_records(out: Path | None) -> Words:
    if out is None:
        return ""
    from orchestrator.store.journal import find_last_time
    from orchestrator.store.output_folder import find_run_state, format_path

    last = find_last_time(find_run_state(out))
    if last is None:
        return "; nothing was recorded"
    from models.core.remedies import Command, Option

    resume = Command("resume", (format_path(out),), (Option("keep", True),))
    return "; ", resume, f" makes the result of what was recorded, to t = {last:.9g} s"
