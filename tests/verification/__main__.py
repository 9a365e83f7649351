"""`python -m tests.verification` writes docs/verification/: every promise and what is measured.

All pages, or only the sections named. Several minutes. Exit status 1 if a table names a test that does not
exist.
"""

from __future__ import annotations

import importlib
import os
import platform
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from .table import ROOT, SHORT, Row, markdown, missing_tests


@dataclass(frozen=True)
class Page:
    """One issue's page. `sections`: module with rows(), and heading."""

    title: str
    issue: str
    sections: dict[str, str]

    @property
    def file(self) -> Path:
        return ROOT / "docs" / "verification" / f"{self.title.partition(',')[0].lower().replace(' ', '-')}.md"


PAGES = (
    Page(
        "Coupled run, promise by promise",
        "The coupled valve train and engine run end to end",
        {
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
        },
    ),
    Page(
        "Slider-crank, promise by promise",
        "The slider-crank with clearance: the whole thesis, corrected, and faster than anything",
        {
            "forms": "Three forms",
            "flights": "Flights, impacts, chatter, sliding",
            "tangents": "Tangent dynamics",
            "piston": "Rectangular piston",
            "analyses": "Analyses",
            "thesis": "The thesis, figure by figure",
            "studies": "Studies",
            "bouncing_speed": "Speed",
            "slider_crank_fmu": "FMU",
            "slider_crank_mistakes": "Bad input",
        },
    ),
    Page(
        "Coupling, promise by promise",
        "The best co-simulation master there is",
        {
            "quarter_car": "Signals and orders: the quarter car",
            "coupling_masters": "Signals, masters, partitions, substeps",
            "estimates": "Estimated and true errors",
            "steps_for_accuracy": "Valve train: doStep calls for a millionth",
            "coupling_events": "Events",
            "ledger": "Energy",
            "stability_limits": "Before the run",
            "coupling_runs": "After the run, checkpoint and resume, other tools",
            "coupling_speed": "Size, overhead, memory",
            "faults": "Faults",
        },
    ),
    Page(
        "Elastohydrodynamics, promise by promise",
        "Numerical elastohydrodynamics inside the loop",
        {
            "line_steady": "Line contact, steady",
            "line_transient": "Line contact, transient",
            "finite_lines": "Finite line",
            "line_friction": "Mixed lubrication and friction",
            "line_in_loop": "In the loop",
            "line_sweep": "In the loop, idle to full speed",
            "films": "Judgement",
            "line_speed": "Speed and memory of the solved film",
            "line_hard_cases": "Bad input and hard cases",
        },
    ),
    Page(
        "Native FMUs and other tools, promise by promise",
        "FMUs that drop into any tool: native, FMI 3, SSP",
        {
            "native_files": "Native FMUs",
            "native_abilities": "What the C layer of FMUs in Python refuses",
            "fmus_in_hosts": "FMUs in Python: FMI 3, and hosts that are not Python",
            "ssp_packages": "SSP",
            "tool_matrix": "Other tools",
            "foreign_fmus": "FMUs from elsewhere",
            "reference_results": "Reference results",
            "native_numbers": "Equal, faster, and a million times",
            "native_mistakes": "Bad input",
        },
    ),
)


def main() -> int:
    """Write the pages, or only the sections named."""
    names = sys.argv[1:] or [name for page in PAGES for name in page.sections]
    every: list[Row] = []
    for name in names:
        page = next(page for page in PAGES if name in page.sections)
        began = time.perf_counter()
        rows = list(importlib.import_module(f"tests.verification.{name}").rows())
        every += rows
        page.file.write_text(text(page, _written(page) | {page.sections[name]: markdown(rows)}), "utf-8")
        print(f"{page.sections[name]}: {len(rows)} lines, {time.perf_counter() - began:.0f} s", flush=True)
    missing = missing_tests(every)
    for test in missing:
        print(f"no such test: {test}")
    return 1 if missing else 0


def _written(page: Page) -> dict[str, list[str]]:
    """The tables that the page has, by heading."""
    written = page.file.read_text("utf-8") if page.file.exists() else ""
    parts = (part.split("\n") for part in written.split("\n## ")[1:])
    return {part[0]: [line for line in part if line.startswith("|")] for part in parts}


def text(page: Page, sections: dict[str, list[str]]) -> str:
    """The whole document."""
    tables = {heading: sections[heading] for heading in page.sections.values() if heading in sections}
    lines = [line.strip("| ").split(" | ") for table in tables.values() for line in table[2:]]
    short = [(cells[0], cells[-1].partition(SHORT)[2]) for cells in lines if SHORT in cells[-1]]
    words = [
        f"# {page.title}",
        "",
        f"What the issue “{page.issue}” promises, how it is",
        "shown, and what is measured. Written by `python -m tests.verification`, which computes the numbers",
        "anew and checks that the tests it names exist (whether they pass, `python -m tests --all` says).",
        "Numbers in brackets after a computed one are the reference's. **Short** begins what falls short.",
        f"Made with Python {platform.python_version()} on {platform.system()}, {os.cpu_count()} cores.",
        "",
        f"## What falls short ({len(short)} of {len(lines)} lines)",
        "",
        *(f"- {promise}: {said.strip()}" for promise, said in short),
    ]
    if left := [name for name, heading in page.sections.items() if heading not in tables]:
        words += ["", f"Not computed yet: `python -m tests.verification {' '.join(left)}`."]
    for heading, table in tables.items():
        words += ["", f"## {heading}", "", *table]
    return "\n".join(words) + "\n"


if __name__ == "__main__":
    sys.exit(main())
