"""`tribocosim reproduce kushwaha2000`."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from pathlib import Path

from .shell import tribocosim
from .table import ROOT, Row


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as folder:
        done = tribocosim("reproduce", "kushwaha2000", "--out", folder)
        figures = len(list(Path(folder).glob("figures/*.png")))
        statements = json.loads((Path(folder) / "statements.json").read_text("utf-8"))
        page = (Path(folder) / "kushwaha2000.md").read_text("utf-8")
    current = page == (ROOT / "docs" / "kushwaha2000.md").read_text("utf-8")
    line = next(text for text in reversed(done.output.splitlines()) if " statements: " in text)
    yield Row(
        "draws the source's Figs 2-8 and prints a table of every quantitative statement with verdict and "
        "reason",
        f"{figures} figures; {line}; {len(statements)} in statements.json; docs/kushwaha2000.md is "
        f"{'what the command writes' if current else 'not what the command writes now'}",
        (
            "orchestrator/test_reproduce_kushwaha.py::test_values_that_need_no_run",
            "orchestrator/test_reproduce_kushwaha.py::test_the_page_is_current",
            "orchestrator/test_reproduce_kushwaha.py::test_what_cannot_be_met_is_not_met_by_chance",
        ),
        command="tribocosim reproduce kushwaha2000",
        short="" if current else "docs/kushwaha2000.md is out of date.",
    )
