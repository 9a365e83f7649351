"""What FMUs of others print goes to a file in the result, where it does not bury the lines of the command."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

from models.core.words import tally
from orchestrator.c_output import find_descriptor, flush, write_lines_at_once
from orchestrator.reporter import Reporter
from orchestrator.store.output_folder import format_path


class CommandReporter(Reporter):
    """Keeps what libraries print apart; of a `verbose` command it is shown where it falls."""

    @contextmanager
    def keep_prints(self, path: Path) -> Iterator[None]:
        if self.verbose or os.name != "posix":
            yield
            return
        with redirect_descriptors(path, self._tell):
            yield

    def _tell(self, path: Path, printed: bytes, failed: bool) -> None:
        if failed:  # the folder may be gone
            sys.stderr.write(printed.decode(errors="replace"))
        else:
            lines = tally(len(printed.splitlines()), "line")
            self.line(f"{lines} that FMUs printed: {format_path(path)}")


@contextmanager
def redirect_descriptors(path: Path, tell: Callable[[Path, bytes, bool], None]) -> Iterator[None]:
    """In the block, standard output and error of this process and of those that it starts go to the file.

    `sys.stdout` and `sys.stderr` are as before. Then `tell` gets what there is, and whether the block failed;
    of nothing there is no file. Descriptors are the whole process's, so this is for a command only.
    """
    begun = path.stat().st_size if path.exists() else 0
    with ExitStack() as stack:
        file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
        stack.callback(os.close, file)
        kept = stack.enter_context(_replace(file))
        failed = True
        try:
            yield
            failed = False
        finally:
            kept.close()
            printed = os.pread(file, os.fstat(file).st_size, begun)
            if printed:
                tell(path, printed, failed)
            elif not begun:
                with suppress(FileNotFoundError):
                    path.unlink()


@contextmanager
def _replace(file: int) -> Iterator[ExitStack]:
    """Descriptors 1 and 2 are those of the file until the stack is closed."""
    with ExitStack() as stack:
        write_lines_at_once()
        for number, name in ((1, "stdout"), (2, "stderr")):
            stream: Any = getattr(sys, name)
            stream.flush()
            before = os.dup(number)
            stack.callback(os.close, before)
            if find_descriptor(stream) == number:
                own = os.fdopen(os.dup(before), "w", 1, stream.encoding, stream.errors)
                setattr(sys, name, own)
                stack.callback(own.close)
                stack.callback(setattr, sys, name, stream)
            os.dup2(file, number)
            stack.callback(os.dup2, before, number)
        stack.callback(flush)
        yield stack
