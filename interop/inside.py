"""Runs one tool with one case, in a process of its own: `python -m interop.inside HOST [CASE [RUNS]]`.

Nothing of this repository's can be imported by the FMU or the tool. Tells on standard output, each as a
line of JSON after its word: VERSION; LOADED; VALUES, those of the outputs after every step; RATE, steps per
second, the best of RUNS; FAILED, what went wrong; UNTRIED, what is missing.
"""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path
from typing import Any

from tests.fmus.instance import Blocker

from .case import Case, NotTriedError, RefusedError

OURS = ("models", "fmus", "orchestrator", "pythonfmu")
# Steps before the first timed run; of each at most; and how long each should take at most (s).
FIRST, STEPS, LONG = 50, 2000, 0.3


def tell(word: str, value: Any = None) -> None:
    print(word, json.dumps(value), flush=True)


def rate(host: Any, case: Case, runs: int) -> float:
    """Steps per second, the best of several runs."""
    with host.timing(case) as seconds:
        count = min(STEPS, int(FIRST + LONG * FIRST / seconds(FIRST)))
        return count / min(seconds(count) for _ in range(runs))


def main(name: str, file: str = "", runs: str = "0") -> int:
    host = importlib.import_module(f"interop.hosts.{name}")
    sys.meta_path.insert(0, Blocker(OURS))
    try:
        tell("VERSION", host.version())
        if file:
            case = Case.read(Path(file))
            tell("VALUES", host.values(case))
            if int(runs):
                tell("RATE", rate(host, case, int(runs)))
    except (RefusedError, NotTriedError) as error:
        tell("FAILED" if isinstance(error, RefusedError) else "UNTRIED", str(error))
        return 1
    except Exception as error:
        tell("FAILED", f"{type(error).__name__}: {error}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
