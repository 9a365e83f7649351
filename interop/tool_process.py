"""Runs one tool on one case in its own process: `python -m interop.tool_process TOOL [CASE]`.

FMU and tool cannot import this repository's packages. The process writes lines of a word and JSON: VERSION;
LOADED; VALUES, the outputs after each step; FAILED, the reason; UNTRIED, what is missing.
"""

import importlib
import json
import sys
from pathlib import Path
from typing import Any

from tests.fmus.instance import Blocker

from .case import Case, NotTriedError, RefusedError

OURS = ("models", "fmus", "orchestrator", "pythonfmu")


def report(word: str, value: Any = None) -> None:
    print(word, json.dumps(value), flush=True)


def main(name: str, file: str = "") -> int:
    tool = importlib.import_module(f"interop.tools.{name}")
    sys.meta_path.insert(0, Blocker(OURS))
    try:
        report("VERSION", tool.version())
        if file:
            report("VALUES", tool.values(Case.read(Path(file))))
    except (RefusedError, NotTriedError) as error:
        report("FAILED" if isinstance(error, RefusedError) else "UNTRIED", str(error))
        return 1
    except Exception as error:
        report("FAILED", f"{type(error).__name__}: {error}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
