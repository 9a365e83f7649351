"""Tables on the terminal, as CSV, JSON and Markdown."""

import csv
import json
import textwrap
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
HEADINGS = ["Place", "Statement", "Computed", "Verdict", "Reason"]
# Of a source whose own model and the corrected one are judged side by side.
TWO_FORMS = ["Place", "Statement", "As published", "Verdict", "Corrected", "Corrected verdict", "Reason"]


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


def tabulate(statements: Sequence[Statement]) -> list[list[str]]:
    """Headings and rows; with columns for the corrected form where a statement has it."""
    if any(s.corrected for s in statements):
        right = [[s.corrected, s.corrected_verdict or ""] for s in statements]
        headings = TWO_FORMS
    else:
        right, headings = [[] for _ in statements], HEADINGS
    pairs = zip(statements, right, strict=True)
    return [headings, *([s.place, s.text, s.computed, s.verdict, *more, s.reason] for s, more in pairs)]


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


def write_csv(rows: Iterable[Sequence[str]], path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows(rows)


def write_statements(statements: Sequence[Statement], csv_path: Path, json_path: Path) -> None:
    headings, *rows = tabulate(statements)
    keyed = ([s.key, *row] for s, row in zip(statements, rows, strict=True))
    write_csv([["key", *(name.lower() for name in headings)], *keyed], csv_path)
    plain = json.dumps([asdict(s) for s in statements], indent=2, ensure_ascii=False)
    json_path.write_text(plain + "\n", "utf-8")


def format_statements(statements: Sequence[Statement]) -> str:
    """The Markdown table, verdicts in bold."""
    headings, *rows = tabulate(statements)
    bold = ["erdict" in name for name in headings]
    return format_table(
        headings,
        *(
            [f"**{s}**" if b and s else s.replace("|", "\\|") for s, b in zip(r, bold, strict=True)]
            for r in rows
        ),
    )


def format_table(headings: Sequence[str], *rows: Sequence[str]) -> str:
    """A Markdown table."""
    return "\n".join("| " + " | ".join(row) + " |" for row in (headings, ["---"] * len(headings), *rows))


def format_bullets(sentences: Iterable[str]) -> str:
    """A Markdown list."""
    return "".join(
        textwrap.fill(text, 110, initial_indent="- ", subsequent_indent="  ") + "\n" for text in sentences
    )
