"""`python -m tests.verification` writes docs/verification/coupled-run.md: every promise and what is measured.

A few minutes. Exit status 1 if the table names a test that does not exist.
"""

from __future__ import annotations

import importlib
import platform
import sys
import time

from .table import ROOT, Row, markdown, missing_tests

PAGE = ROOT / "docs" / "verification" / "coupled-run.md"
# Module with rows(), and heading.
SECTIONS = {
    "setting_up": "Two commands",
    "components": "Components",
    "kinematics": "Numbers of cam, spring, contact and film",
    "balance": "Energy and uncertainty",
    "motions": "Numbers of the slider-crank",
    "packages": "FMUs",
    "scenarios": "Orchestrator, scenarios, command line",
    "convergence": "Accuracy, order, stability",
    "reproduction": "Reproduction",
    "speed": "Speed and memory",
    "mistakes": "Bad input",
}


def main() -> int:
    """Write the page, or with names of sections print those only."""
    names = sys.argv[1:] or list(SECTIONS)
    found: dict[str, list[Row]] = {}
    for name in names:
        began = time.perf_counter()
        found[name] = list(importlib.import_module(f"tests.verification.{name}").rows())
        print(f"{SECTIONS[name]}: {len(found[name])} rows, {time.perf_counter() - began:.0f} s", flush=True)
    every = [row for rows in found.values() for row in rows]
    lines = page(found)
    if names == list(SECTIONS):
        PAGE.write_text("\n".join(lines) + "\n", "utf-8")
    else:
        print("\n".join(lines))
    missing = missing_tests(every)
    for test in missing:
        print(f"no such test: {test}")
    return 1 if missing else 0


def page(found: dict[str, list[Row]]) -> list[str]:
    """The whole document, as lines."""
    every = [row for rows in found.values() for row in rows]
    short = [row for row in every if row.short]
    lines = [
        "# The coupled run, promise by promise",
        "",
        "What the issue “The coupled valve train and engine run end to end” promises, how it is shown, and",
        "what is measured. Written by `python -m tests.verification`, which computes the numbers anew and",
        "checks that the tests it names exist (whether they pass, `python -m tests --all` says). Numbers in",
        "brackets after a computed one are the reference's. **Short** begins what falls short or is missing.",
        f"Made with Python {platform.python_version()} on {platform.system()}.",
        "",
        f"## What falls short ({len(short)} of {len(every)} lines)",
        "",
        *(f"- {row.promise}: {row.short}" for row in short),
    ]
    for name, rows in found.items():
        lines += ["", f"## {SECTIONS[name]}", "", *markdown(rows)]
    return lines


if __name__ == "__main__":
    sys.exit(main())
