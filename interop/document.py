"""docs/reference/tools.md: a section for each tool; sections of tools that did not run stay as they are."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from .comparison import KINDS, STEPS
from .processes import NAMES, ROOT, Answer, load_tool

FILE = ROOT / "docs" / "reference" / "tools.md"
PAGE = Path(__file__).with_name("page.md")  # the text before the tables
LOADS_NOT, STOPS, NOT_TRIED = "does not load", "stops", "not tried"
DIFFERENCE, RATE = "difference", "steps/s"
VERSION, MADE, FAILED, ALL = "Version: ", "Made with ", "Where it failed:", "all"


@dataclass
class Section:
    """A tool's results. rows: by component, two cells for each kind. failures: by message and kind, the
    components that failed with it. machine: Python, system and processors that gave the numbers."""

    tool: str
    version: str
    machine: str
    rows: dict[str, list[str]] = field(default_factory=dict)
    failures: dict[tuple[str, str], list[str]] = field(default_factory=dict)

    def add(self, fmu: str, kind: str, difference: float | None, answer: Answer) -> list[str]:
        """Add an answer, or replace the one before; return its cells."""
        place = 2 * list(KINDS).index(kind)
        row = self.rows.setdefault(fmu, [""] * 2 * len(KINDS))
        row[place : place + 2] = format_cells(difference, answer)
        title = KINDS[kind].title
        for (_, where), names in self.failures.items():
            if where == title and fmu in names:
                names.remove(fmu)
        if answer.failed:
            self.failures.setdefault((answer.failed.replace(fmu, "NAME"), title), []).append(fmu)
        self.failures = {key: names for key, names in self.failures.items() if names}
        self.version = answer.version or self.version
        return row[place : place + 2]

    def lines(self) -> list[str]:
        """The section as lines of Markdown."""
        this = load_tool(self.tool)
        head = ["FMU", *(f"{kind.title}: {what}" for kind in KINDS.values() for what in (DIFFERENCE, RATE))]
        rows = [[f"`{name}`", *cells] for name, cells in self.rows.items()]
        said = [
            f"- {kind}, {ALL if len(names) == len(rows) else ', '.join(names)}: “{words}”"
            for (words, kind), names in self.failures.items()
        ]
        findings = [f"- {finding}" for finding in getattr(this, "FINDINGS", ())]
        return [
            f"## {this.TITLE}",
            "",
            f"{VERSION}{self.version}",
            "",
            f"Also needs: {this.USE}. {MADE}{self.machine}.",
            "",
            *format_table(head, rows),
            *(["", FAILED, "", *said] if said else []),
            *(["", *findings] if findings else []),
        ]

    @staticmethod
    def read(tool: str, lines: Sequence[str]) -> Section:
        """Read a section from its lines."""
        (version,) = (line for line in lines if line.startswith(VERSION))
        (made,) = (line.partition(MADE)[2] for line in lines if MADE in line)
        section = Section(tool, version.removeprefix(VERSION), made.removesuffix("."))
        for line in lines:
            if line.startswith("| `"):
                name, *cells = line.strip("| ").split(" | ")
                section.rows[name.strip("`")] = cells
        for line in lines[lines.index(FAILED) :] if FAILED in lines else ():
            for kind in KINDS.values():
                if line.startswith(f"- {kind.title}, ") and line.endswith("”"):
                    names, _, words = line.removeprefix(f"- {kind.title}, ").partition(": “")
                    known = list(section.rows) if names == ALL else names.split(", ")
                    section.failures[words.removesuffix("”"), kind.title] = known
        return section

    def summary(self) -> list[str]:
        """The tool's row of the first table."""
        found = []
        for k in range(len(KINDS)):
            pairs = [(row[2 * k], row[2 * k + 1]) for row in self.rows.values()]
            differences = [float(a) for a, _ in pairs if a[:1].isdigit()]
            rates = [int(b.replace(" ", "")) for _, b in pairs if b[:1].isdigit()]
            if not differences:
                found.append(", ".join(sorted({a for a, _ in pairs})))
                continue
            words = [
                f"{len(differences)} of {len(pairs)}",
                f"difference {format_difference(max(differences))}",
            ]
            if rates:
                words.append(f"{format_rate(min(rates))} to {format_rate(max(rates))} steps/s")
            found.append(", ".join(words))
        return [load_tool(self.tool).TITLE, self.version, *found]


def describe_machine() -> str:
    """Python, system and processors of this machine."""
    return f"Python {platform.python_version()} on {platform.system()}, {os.cpu_count()} cores"


def format_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    lines = [head, ["---"] * len(head), *rows]
    return [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines]


def read_sections() -> dict[str, Section]:
    """The sections of the document, by tool."""
    text = FILE.read_text("utf-8") if FILE.exists() else ""
    parts = [part.rstrip().split("\n") for part in text.split("\n## ")[1:]]
    titles = {load_tool(name).TITLE: name for name in NAMES}
    return {titles[part[0]]: Section.read(titles[part[0]], part) for part in parts if part[0] in titles}


def format_cells(difference: float | None, answer: Answer) -> list[str]:
    """The two cells of a result: difference and rate."""
    if difference is None:
        return [(STOPS if answer.loaded else LOADS_NOT) if answer.tried else NOT_TRIED, "–"]
    return [format_difference(difference), "–" if answer.rate is None else format_rate(answer.rate)]


def format_difference(difference: float) -> str:
    return "0" if difference == 0.0 else f"{difference:.1e}"


def format_rate(rate: float) -> str:
    """Three significant digits with spaced thousands: 81 700."""
    return f"{float(f'{rate:.3g}'):,.0f}".replace(",", " ")


def format_page(sections: Mapping[str, Section]) -> str:
    """The whole document."""
    known = [sections[name] for name in NAMES if name in sections]
    head = ["tool", "version", *(kind.title for kind in KINDS.values())]
    words = PAGE.read_text("utf-8").replace("STEPS", str(STEPS))
    lines = [words, *format_table(head, [section.summary() for section in known])]
    if left := [name for name in NAMES if name not in sections]:
        lines += ["", f"Not run yet: `python -m interop {' '.join(left)} --install`."]
    for section in known:
        lines += ["", *section.lines()]
    return "\n".join(lines) + "\n"
