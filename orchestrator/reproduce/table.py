"""The table of statements on the terminal, as CSV, JSON and Markdown."""

from __future__ import annotations

import csv
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from .statements import Statement, Verdict

STYLES = {Verdict.MET: "green", Verdict.NOT_MET: "yellow", Verdict.CANNOT: "red"}
HEADINGS = ("Place", "Statement", "Computed", "Verdict", "Reason")


def tally(statements: Sequence[Statement]) -> str:
    """How many statements have each verdict."""
    count = Counter(s.verdict for s in statements)
    parts = ", ".join(f"{count[verdict]} {verdict}" for verdict in Verdict)
    return f"{len(statements)} statements: {parts}"


def show(statements: Sequence[Statement], console: Console) -> None:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_lines=True)
    for name, ratio in zip(HEADINGS[:3], (2, 6, 9), strict=True):
        table.add_column(name.lower(), ratio=ratio, overflow="fold")
    table.add_column("verdict", ratio=2)
    for s in statements:
        reason = f"\n{s.reason}" if s.reason else ""
        computed = Text(s.computed).append(reason, style="dim")
        table.add_row(Text(s.place), Text(s.text), computed, Text(s.verdict, STYLES[s.verdict]))
    console.print(table)


def write_csv(statements: Sequence[Statement], path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["key", *(name.lower() for name in HEADINGS)])
        writer.writerows([s.key, s.place, s.text, s.computed, s.verdict, s.reason] for s in statements)


def write_json(statements: Sequence[Statement], path: Path) -> None:
    path.write_text(json.dumps([asdict(s) for s in statements], indent=2, ensure_ascii=False) + "\n", "utf-8")


def markdown(statements: Sequence[Statement]) -> str:
    rows = [HEADINGS, ("---",) * len(HEADINGS)]
    rows += [(s.place, s.text, s.computed, f"**{s.verdict}**", s.reason) for s in statements]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows)
