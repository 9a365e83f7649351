"""`python -m tests.verification` writes docs/verification/coupled-run.md: every promise and what is measured.

A few minutes. Exit status 1 if the table names a test that does not exist.
"""

from __future__ import annotations

import importlib
import os
import platform
import sys
import time

from .table import ROOT, SHORT, Row, markdown, missing_tests

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
    """Write the page, or only the sections named."""
    names = sys.argv[1:] or list(SECTIONS)
    every: list[Row] = []
    for name in names:
        began = time.perf_counter()
        rows = list(importlib.import_module(f"tests.verification.{name}").rows())
        every += rows
        PAGE.write_text(page(_written() | {SECTIONS[name]: markdown(rows)}), "utf-8")
        print(f"{SECTIONS[name]}: {len(rows)} lines, {time.perf_counter() - began:.0f} s", flush=True)
    missing = missing_tests(every)
    for test in missing:
        print(f"no such test: {test}")
    return 1 if missing else 0


def _written() -> dict[str, list[str]]:
    """The tables that the page has, by heading."""
    text = PAGE.read_text("utf-8") if PAGE.exists() else ""
    parts = (part.split("\n") for part in text.split("\n## ")[1:])
    return {part[0]: [line for line in part if line.startswith("|")] for part in parts}


def page(sections: dict[str, list[str]]) -> str:
    """The whole document."""
    tables = {heading: sections[heading] for heading in SECTIONS.values() if heading in sections}
    lines = [line.strip("| ").split(" | ") for table in tables.values() for line in table[2:]]
    short = [(cells[0], cells[-1].partition(SHORT)[2]) for cells in lines if SHORT in cells[-1]]
    text = [
        "# The coupled run, promise by promise",
        "",
        "What the issue “The coupled valve train and engine run end to end” promises, how it is shown, and",
        "what is measured. Written by `python -m tests.verification`, which computes the numbers anew and",
        "checks that the tests it names exist (whether they pass, `python -m tests --all` says). Numbers in",
        "brackets after a computed one are the reference's. **Short** begins what falls short or is missing.",
        f"Made with Python {platform.python_version()} on {platform.system()}, {os.cpu_count()} cores.",
        "",
        f"## What falls short ({len(short)} of {len(lines)} lines)",
        "",
        *(f"- {promise}: {words.strip()}" for promise, words in short),
    ]
    for heading, table in tables.items():
        text += ["", f"## {heading}", "", *table]
    return "\n".join(text) + "\n"


if __name__ == "__main__":
    sys.exit(main())
