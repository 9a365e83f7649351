"""docs/tools.md: a section for each tool, of those that were not run this time as it was."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from .plan import KINDS, STEPS
from .running import NAMES, ROOT, Answer, host

FILE = ROOT / "docs" / "tools.md"
PAGE = Path(__file__).with_name("page.md")  # what stands before the tables
LOADS_NOT, STOPS, NOT_TRIED = "does not load", "stops", "not tried"
DIFFERENCE, RATE = "difference", "steps/s"


@dataclass
class Section:
    """What a tool made of the FMUs: two cells for each kind of each; what it said where it failed, by words
    and kind."""

    title: str
    version: str
    rows: dict[str, list[str]] = field(default_factory=dict)
    said: dict[tuple[str, str], list[str]] = field(default_factory=dict)

    def lines(self, use: str, findings: Sequence[str]) -> list[str]:
        """The section."""
        head = ["FMU", *(f"{kind.title}: {what}" for kind in KINDS.values() for what in (DIFFERENCE, RATE))]
        rows = [[f"`{name}`", *cells] for name, cells in self.rows.items()]
        said = [
            f"- {kind}, {', '.join(names) if len(names) < len(rows) else 'all'}: “{words}”"
            for (words, kind), names in self.said.items()
        ]
        return [
            f"## {self.title}",
            "",
            f"Version: {self.version}. Its user needs {use}.",
            f"Made with Python {platform.python_version()} on {platform.system()}, {os.cpu_count()} cores.",
            "",
            *table(head, rows),
            *(["", "Where it failed:", "", *said] if said else []),
            *(["", *(f"- {finding}" for finding in findings)] if findings else []),
        ]


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    lines = [head, ["---"] * len(head), *rows]
    return [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines]


def written() -> dict[str, list[str]]:
    """The lines of the sections that the document has, by title."""
    text = FILE.read_text("utf-8") if FILE.exists() else ""
    parts = (part.rstrip().split("\n") for part in text.split("\n## ")[1:])
    return {part[0]: [f"## {part[0]}", *part[1:]] for part in parts}


def cells_of(lines: Sequence[str]) -> dict[str, list[str]]:
    """The cells of a section's table, by component."""
    rows = [line.strip("| ").split(" | ") for line in lines if line.startswith("| `")]
    return {name.strip("`"): cells for name, *cells in rows}


def summary(lines: Sequence[str]) -> list[str]:
    """A tool's line of the first table, from its section."""
    version = next(line for line in lines if line.startswith("Version: "))
    found = []
    for k in range(len(KINDS)):
        pairs = [(row[2 * k], row[2 * k + 1]) for row in cells_of(lines).values()]
        differences = [float(a) for a, _ in pairs if a[:1].isdigit()]
        rates = [int(b.replace(" ", "")) for _, b in pairs if b[:1].isdigit()]
        if not differences:
            found.append(", ".join(sorted({a for a, _ in pairs})))
            continue
        words = [f"{len(differences)} of {len(pairs)}", f"difference {shown(max(differences))}"]
        if rates:
            words.append(f"{thousands(min(rates))} to {thousands(max(rates))} steps/s")
        found.append(", ".join(words))
    return [lines[0].removeprefix("## "), version.removeprefix("Version: ").partition(". ")[0], *found]


def cells(difference: float | None, answer: Answer) -> list[str]:
    """What the table says."""
    if difference is None:
        return [(STOPS if answer.loaded else LOADS_NOT) if answer.tried else NOT_TRIED, "–"]
    return [shown(difference), "–" if answer.rate is None else thousands(answer.rate)]


def shown(difference: float) -> str:
    return "0" if difference == 0.0 else f"{difference:.1e}"


def thousands(rate: float) -> str:
    """Three digits, as whole thousands apart: 81 700."""
    return f"{float(f'{rate:.3g}'):,.0f}".replace(",", " ")


def text(sections: Mapping[str, Sequence[str]]) -> str:
    """The whole document."""
    order = [host(name).TITLE for name in NAMES]
    known = {title: sections[title] for title in order if title in sections}
    head = ["tool", "version", *(kind.title for kind in KINDS.values())]
    words = PAGE.read_text("utf-8").replace("STEPS", str(STEPS))
    lines = [words, *table(head, [summary(section) for section in known.values()])]
    if left := [name for name in NAMES if host(name).TITLE not in known]:
        lines += ["", f"Not run yet: `python -m tests.tools {' '.join(left)} --install`."]
    for section in known.values():
        lines += ["", *section]
    return "\n".join(lines) + "\n"
