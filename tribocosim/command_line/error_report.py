"""Exit statuses and error messages of all commands."""

import functools
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import typer

from models.core.interruption import came, deferred, is_asked

from ..messages import say
from .apart import state

# The last ones: 128 + 2, 13 and 15, as after SIGINT, SIGPIPE and SIGTERM.
MISTAKE, FAILED, INTERRUPTED, NO_READER, TERMINATED = 2, 3, 130, 141, 143


def report_errors(command: Callable[..., int | None]) -> Callable[..., None]:
    """Exit with the status that `command` returns. An error is one message on standard error, without a
    traceback (TRIBOCOSIM_DEBUG=1 shows it)."""

    @functools.wraps(command)
    def report(*arguments: Any, **options: Any) -> None:
        with _interrupt_on_termination(), deferred():
            status = _carry_out(command, arguments, options)
        state(status)
        raise typer.Exit(status)

    return report


@contextmanager
def _interrupt_on_termination() -> Iterator[None]:
    """In the block SIGTERM interrupts as Ctrl-C does."""
    own = threading.current_thread() is threading.main_thread()
    own = own and signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
    if own:
        signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        if own:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _carry_out(
    command: Callable[..., int | None], arguments: tuple[Any, ...], options: dict[str, Any]
) -> int:
    """Its exit status; an error is told."""
    try:
        from orchestrator.reporter import tell_compilation, unwritten  # with numba, as `--help` is not

        unwritten.clear()
        with tell_compilation():
            status = command(*arguments, **options)
        try:
            sys.stdout.flush()
            if unwritten:
                raise unwritten[0]
        except OSError as error:
            if isinstance(error, BrokenPipeError):
                raise
            _discard_output()
            say(f"standard output cannot be written: {error.strerror}; files are complete")
            return status or FAILED
        if status == INTERRUPTED:
            return _find_status()
        if is_asked():
            raise KeyboardInterrupt("interrupted at its end: what it writes is whole")
    except typer.Exit as ended:  # in a child process
        return ended.exit_code
    except KeyboardInterrupt as interruption:
        say(str(interruption) or "interrupted")
        return _find_status()
    except BrokenPipeError:  # the reader has ended, e.g. `| head -1`
        _discard_output()
        return NO_READER
    except Exception as error:
        if is_asked():
            say("interrupted")
            return _find_status()
        if os.environ.get("TRIBOCOSIM_DEBUG", "0").strip("0"):
            raise
        text, status = describe_error(error)
        say(text)
    return status or 0


def _find_status() -> int:
    """Of a command that the signals ended."""
    return TERMINATED if signal.SIGTERM in came else INTERRUPTED


def _discard_output() -> None:
    """Discard buffered output, which Python would fail to write at its end."""
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), sys.stdout.fileno())


def describe_error(error: Exception) -> tuple[str, int]:
    """The message for the user, and the exit status."""
    from models.core.remedies import ExplainedError, in_command_line
    from orchestrator.errors import MistakeError, RefusedError
    from orchestrator.store.atomic_write import NO_ROOM

    if isinstance(error, ExplainedError):
        return in_command_line(error), MISTAKE if isinstance(error, (MistakeError, RefusedError)) else FAILED
    if isinstance(error, OSError) and error.filename and error.strerror in NO_ROOM:
        remedy = "free some space and repeat the command (for a started run: tribocosim resume)"
        return f"{error.filename}: {error.strerror}; {remedy}", FAILED
    return f"unexpected {type(error).__name__}: {error} (TRIBOCOSIM_DEBUG=1 shows where)", FAILED
