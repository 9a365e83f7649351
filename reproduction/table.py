"""The table of statements on the terminal, as CSV, JSON and Markdown."""

from __future__ import annotations

import csv
import json
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from .statement import Statement, Verdict

STYLES = {
    Verdict.MET: "green",
    Verdict.NOT_MET: "yellow",
    Verdict.CANNOT: "red",
    Verdict.UNCHECKED: "magenta",
}
HEADINGS = ("Place", "Statement", "Computed", "Verdict", "Reason")
# Of a source whose own model and the corrected one are judged side by side.
TWO_FORMS = ("Place", "Statement", "As published", "Verdict", "Corrected", "Corrected verdict", "Reason")


def count_verdicts(statements: Sequence[Statement]) -> str:
    """How many statements have each verdict."""
    text = f"{len(statements)} statements: {_count(s.verdict for s in statements)}"
    second = [s.corrected_verdict for s in statements if s.corrected_verdict]
    if second:
        text += f"; of the {len(second)} that depend on the form, corrected: {_count(second)}"
    return text


def _count(verdicts: Iterable[Verdict]) -> str:
    count = Counter(verdicts)
    return ", ".join(f"{count[verdict]} {verdict}" for verdict in Verdict if count[verdict])


def choose_columns(statements: Sequence[Statement]) -> tuple[str, ...]:
    """The columns that these statements need."""
    return TWO_FORMS if any(s.corrected for s in statements) else HEADINGS


def list_cells(s: Statement, columns: Sequence[str]) -> tuple[str, ...]:
    """A statement's row."""
    if columns is HEADINGS:
        return s.place, s.text, s.computed, s.verdict, s.reason
    return s.place, s.text, s.computed, s.verdict, s.corrected, s.corrected_verdict or "", s.reason


def print_table(statements: Sequence[Statement], console: Console) -> None:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_lines=True)
    for name, ratio in zip(HEADINGS[:3], (2, 6, 9), strict=True):
        table.add_column(name.lower(), ratio=ratio, overflow="fold")
    table.add_column("verdict", ratio=2)
    for s in statements:
        computed, verdict = Text(s.computed), Text(s.verdict, STYLES[s.verdict])
        if s.corrected:
            computed.append(f"\ncorrected: {s.corrected}")
        if s.corrected_verdict:
            verdict.append(f"\n{s.corrected_verdict}", STYLES[s.corrected_verdict])
        if s.reason:
            computed.append(f"\n{s.reason}", style="dim")
        table.add_row(Text(s.place), Text(s.text), computed, verdict)
    console.print(table)


def write_csv(statements: Sequence[Statement], path: Path) -> None:
    columns = choose_columns(statements)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["key", *(name.lower() for name in columns)])
        writer.writerows([s.key, *list_cells(s, columns)] for s in statements)


def write_json(statements: Sequence[Statement], path: Path) -> None:
    path.write_text(json.dumps([asdict(s) for s in statements], indent=2, ensure_ascii=False) + "\n", "utf-8")


def format_rows(statements: Sequence[Statement]) -> str:
    columns = choose_columns(statements)
    rows: list[Sequence[str]] = [columns, ("---",) * len(columns)]
    for s in statements:
        row = list_cells(s, columns)
        pairs = zip(columns, row, strict=True)
        rows.append([f"**{text}**" if "erdict" in name and text else text for name, text in pairs])
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows)
