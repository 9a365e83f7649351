"""`python -m benchmarks [NAME...]` measures and prints; `--write` also fills docs/benchmarks.md.

With names, the page's other figures stay as they are.
"""

from __future__ import annotations

import importlib
import os
import platform
import sys
from pathlib import Path

NAMES = (
    "macro_steps", "reference", "start_up", "memory", "checkpoint", "slider_crank", "exponent_map",
    "line_contact", "line_preconditioner", "native",
)  # fmt: skip
PAGE = Path(__file__).parent.parent / "docs" / "benchmarks.md"


def main() -> None:
    """Run the named benchmarks, or all."""
    named = [name for name in sys.argv[1:] if not name.startswith("-")]
    found = {}
    for name in named or NAMES:
        for figure, value in importlib.import_module(f"benchmarks.{name}").rows():
            found[figure] = value
            print(f"| {figure} | {value} |", flush=True)
    if "--write" in sys.argv[1:]:
        kept = written(PAGE.read_text("utf-8")) if named and PAGE.exists() else {}
        PAGE.write_text(page(kept | found), encoding="utf-8")


def written(text: str) -> dict[str, str]:
    """The figures that a page has."""
    rows = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("| ")]
    return {cells[0]: cells[1] for cells in rows[1:]}


def page(figures: dict[str, str]) -> str:
    """The page with these figures."""
    lines = [
        "# Benchmarks",
        "",
        "Written by `python -m benchmarks --write`; medians, all candidates side by side in one run.",
        f"Python {platform.python_version()}, {platform.system()} {platform.machine()}, "
        f"{os.cpu_count()} cores.",
        "",
        "| figure | value |",
        "|---|---|",
        *(f"| {figure} | {value} |" for figure, value in figures.items()),
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
