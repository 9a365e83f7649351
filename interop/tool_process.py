"""Runs one tool on one case in its own process: `python -m interop.tool_process TOOL [CASE [RUNS]]`.

FMU and tool cannot import this repository's packages. The process writes lines of a word and JSON: VERSION;
LOADED; VALUES, the outputs after each step; RATE, steps per second, the best of RUNS; FAILED, the reason;
UNTRIED, what is missing.
"""

import importlib
import json
import sys
from pathlib import Path
from typing import Any

from tests.fmus.instance import Blocker

from .case import Case, NotTriedError, RefusedError

OURS = ("models", "fmus", "orchestrator", "pythonfmu")
# Steps of the first run; largest number of steps of a timed run, and its longest time (s).
FIRST, STEPS, LONG = 50, 2000, 0.3


def report(word: str, value: Any = None) -> None:
    print(word, json.dumps(value), flush=True)


def measure_rate(tool: Any, case: Case, runs: int) -> float:
    """Steps per second, the best of several runs."""
    with tool.timing(case) as seconds:
        count = min(STEPS, int(FIRST + LONG * FIRST / seconds(FIRST)))
        return count / min(seconds(count) for _ in range(runs))


def main(name: str, file: str = "", runs: str = "0") -> int:
    tool = importlib.import_module(f"interop.tools.{name}")
    sys.meta_path.insert(0, Blocker(OURS))
    try:
        report("VERSION", tool.version())
        if file:
            case = Case.read(Path(file))
            report("VALUES", tool.values(case))
            if int(runs):
                report("RATE", measure_rate(tool, case, int(runs)))
    except (RefusedError, NotTriedError) as error:
        report("FAILED" if isinstance(error, RefusedError) else "UNTRIED", str(error))
        return 1
    except Exception as error:
        report("FAILED", f"{type(error).__name__}: {error}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
