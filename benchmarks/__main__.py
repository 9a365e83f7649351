"""`python -m benchmarks [NAME...]` measures and prints; `--write` also fills docs/benchmarks.md."""

from __future__ import annotations

import importlib
import os
import platform
import sys
from pathlib import Path

NAMES = ("macro_steps", "reference", "start_up", "memory", "checkpoint", "slider_crank", "exponent_map")
PAGE = Path(__file__).parent.parent / "docs" / "benchmarks.md"


def main() -> None:
    """Run the named benchmarks, or all."""
    wanted = [name for name in sys.argv[1:] if not name.startswith("-")] or list(NAMES)
    lines = [
        "# Benchmarks",
        "",
        "Written by `python -m benchmarks --write`; medians, all candidates side by side in one run.",
        f"Python {platform.python_version()}, {platform.system()} {platform.machine()}, "
        f"{os.cpu_count()} cores.",
        "",
        "| figure | value |",
        "|---|---|",
    ]
    for name in wanted:
        for figure, value in importlib.import_module(f"benchmarks.{name}").rows():
            lines.append(f"| {figure} | {value} |")
            print(lines[-1], flush=True)
    if "--write" in sys.argv[1:]:
        PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
