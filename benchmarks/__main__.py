"""`python -m benchmarks [NAME...]` measures and prints; `--write` also fills docs/reference/benchmarks.md.

With names, the page's other figures stay as they are.
"""

import argparse
import importlib
import os
import platform
from pathlib import Path

from models.core.system import suggestion

NAMES = ("commands", "stepping", "hindsight", "heated_film")
PAGE = Path(__file__).parent.parent / "docs" / "reference" / "benchmarks.md"


def main() -> None:
    """Run the named benchmarks, or all."""
    parser = argparse.ArgumentParser("python -m benchmarks", description="Measure and print tables.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(NAMES)}; default: all")
    parser.add_argument("--write", action="store_true", help=f"also write the figures to {PAGE}")
    options = parser.parse_args()
    named: list[str] = options.names
    if unknown := [name for name in named if name not in NAMES]:
        parser.error(f"no benchmark {unknown[0]!r}; {suggestion(unknown[0], NAMES)}")
    found = {}
    for name in named or NAMES:
        for figure, value in importlib.import_module(f"benchmarks.{name}").measure():
            found[figure] = value
            print(f"| {figure} | {value} |", flush=True)
    if options.write:
        before = read_page(PAGE.read_text("utf-8")) if named and PAGE.exists() else {}
        PAGE.write_text(build_page(before | found), encoding="utf-8")


def read_page(text: str) -> dict[str, str]:
    """The figures that a page has."""
    rows = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("| ")]
    return {cells[0]: cells[1] for cells in rows[1:]}


def build_page(figures: dict[str, str]) -> str:
    """The page with these figures."""
    lines = [
        "# Benchmarks",
        "",
        "Written by `python -m benchmarks --write`. Medians; candidates are measured in turn within one run.",
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
