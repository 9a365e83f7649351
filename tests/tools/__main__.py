"""`python -m tests.tools [TOOL ...] [--fmu NAME ...] [--install]` runs our FMUs in other tools.

Without names every tool that is here. With --install each of them gets an environment of its own first.
With --fmu only these FMUs, and nothing is written; else docs/tools.md is.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence

from fmus.build import NAMES as FMUS

from .document import FILE, Section, cells, text, written
from .plan import KINDS, compared
from .running import NAMES, host, install, missing

RUNS = 4  # of which the best is told


def main() -> int:
    """0 if every tool that was named could be run."""
    parser = argparse.ArgumentParser(prog="python -m tests.tools", description=__doc__)
    parser.add_argument("tools", nargs="*", metavar="TOOL", help=f"of {', '.join(NAMES)}")
    parser.add_argument("--fmu", nargs="+", choices=FMUS, metavar="NAME", help="only these FMUs")
    parser.add_argument("--install", action="store_true", help="into an environment of the tool's own")
    given = parser.parse_args()
    if unknown := [name for name in given.tools if name not in NAMES]:
        parser.error(f"no tool {unknown[0]!r}: there are {', '.join(NAMES)}")
    sections, absent = written(), []
    for name in given.tools or NAMES:
        if given.install:
            install(name)
        if why := missing(name):
            print(f"{name}: {why}")
            absent.append(name)
            continue
        section = of_tool(name, given.fmu or FMUS)
        if not given.fmu:
            lines = section.lines(host(name).USE, getattr(host(name), "FINDINGS", ()))
            sections[section.title] = lines
            FILE.write_text(text(sections), "utf-8")
    return 1 if given.tools and absent else 0


def of_tool(name: str, fmus: Sequence[str]) -> Section:
    """Every kind of these FMUs in one tool."""
    section = Section(host(name).TITLE, "")
    for fmu in fmus:
        row = []
        for kind in KINDS.values():
            began = time.perf_counter()
            difference, answer = compared(name, fmu, kind, RUNS)
            section.version = answer.version or section.version
            row += cells(difference, answer)
            if answer.failed:
                words = answer.failed.replace(fmu, "NAME")
                section.said.setdefault((words, kind.title), []).append(fmu)
            passed = time.perf_counter() - began
            print(
                f"{name}: {fmu}, {kind.title}: {' '.join(row[-2:])} {answer.failed} ({passed:.1f} s)",
                flush=True,
            )
        section.rows[fmu] = row
    return section


if __name__ == "__main__":
    sys.exit(main())
