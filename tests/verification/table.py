"""Rows of the verification table, and the check that the tests they name exist."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
SHORT = "**Short:**"


@dataclass(frozen=True)
class Row:
    """A promise, how it is shown, and what was measured.

    `tests` are written "folder/file.py::name" below tests/. `short` says what falls short of the promise.
    """

    promise: str
    value: str
    tests: tuple[str, ...] = ()
    command: str = ""
    short: str = ""

    def cells(self) -> tuple[str, str, str]:
        shown = [f"`{self.command}`"] if self.command else []
        shown += [f"{name} ({file})" for file, name in (test.split("::") for test in self.tests)]
        value = self.value + (f" {SHORT} {self.short}" if self.short else "")
        return self.promise, "; ".join(shown) or "computed here", value


def markdown(rows: Iterable[Row]) -> list[str]:
    """The table, as lines."""
    cells = ((cell.replace("|", "\\|") for cell in row.cells()) for row in rows)
    return ["| promise | how shown | measured |", "|---|---|---|", *(f"| {' | '.join(c)} |" for c in cells)]


def missing_tests(rows: Iterable[Row]) -> list[str]:
    """Names of tests in the table that pytest does not collect."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-m", "", "-p", "no:cacheprovider"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False).stdout
    found = {line.partition("[")[0].removeprefix("tests/") for line in listed.splitlines()}
    return sorted({test for row in rows for test in row.tests if test not in found})


def outcomes(rows: Iterable[Row]) -> dict[str, str]:
    """What running the rows' tests gives: by test, how many of its cases passed or failed."""
    names = sorted({f"tests/{test}" for row in rows for test in row.tests})
    command = [sys.executable, "-m", "pytest", "-q", "-rA", "--tb=no", "-m", "", "-p", "no:cacheprovider"]
    done = subprocess.run([*command, *names], cwd=ROOT, capture_output=True, text=True, check=False)
    found: dict[str, Counter[str]] = {}
    for line in done.stdout.splitlines():
        outcome, _, name = line.partition(" ")
        if outcome in ("PASSED", "FAILED", "ERROR") and name.startswith("tests/"):
            test = name.partition(" - ")[0].partition("[")[0].removeprefix("tests/")
            found.setdefault(test, Counter())[outcome.lower()] += 1
    return {
        test: ", ".join(f"{n} {outcome}" for outcome, n in count.items()) for test, count in found.items()
    }


def largest(values: Iterable[float]) -> str:
    """The largest magnitude, with two digits."""
    return f"{max(abs(float(v)) for v in values):.1e}"
