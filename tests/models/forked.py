"""Code in a process that has imported numba and nothing of ours: a fresh one that need not wait for it."""

import contextlib
import io
import multiprocessing
import os
import sys
import traceback
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

_context: Any = multiprocessing.get_context("forkserver")
_context.set_forkserver_preload(["numba"])


class Forked:
    """A process that has begun to run `code` in `folder`, with modules from there and from `paths`."""

    def __init__(self, folder: Path, paths: list[Path], code: str, environment: dict[str, str]) -> None:
        self._end, there = _context.Pipe(duplex=False)
        places = [str(path) for path in (folder, *paths)]
        self._process = _context.Process(target=_run, args=(there, str(folder), places, code, environment))
        self._process.start()
        there.close()

    def said(self) -> str:
        """What it printed; AssertionError with the traceback if it failed."""
        with self._end:
            printed, error = self._end.recv()
        self._process.join()
        assert not error, error
        return str(printed)


def _run(there: Connection, folder: str, paths: list[str], code: str, environment: dict[str, str]) -> None:
    os.chdir(folder)
    os.environ.update(environment)
    sys.path[:0] = paths
    sys.dont_write_bytecode = True  # of a file that is edited within a second
    printed, error = io.StringIO(), ""
    with contextlib.redirect_stdout(printed):
        try:
            exec(compile(code, "test", "exec"), {})
        except Exception:
            error = traceback.format_exc()
    there.send((printed.getvalue(), error))
