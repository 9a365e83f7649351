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
VERSION, MADE, FAILED, ALL = "Version: ", "Made with ", "Where it failed:", "all"


@dataclass
class Section:
    """What a tool made of the FMUs: by component two cells for each kind; by words and kind for which
    components it failed with them. `made`: Python, system and processors where its numbers come from."""

    tool: str
    version: str
    made: str
    rows: dict[str, list[str]] = field(default_factory=dict)
    said: dict[tuple[str, str], list[str]] = field(default_factory=dict)

    def note(self, fmu: str, kind: str, difference: float | None, answer: Answer) -> list[str]:
        """Take in an answer, in the place of the one before; its cells."""
        place = 2 * list(KINDS).index(kind)
        row = self.rows.setdefault(fmu, [""] * 2 * len(KINDS))
        row[place : place + 2] = cells(difference, answer)
        title = KINDS[kind].title
        for (_, where), names in self.said.items():
            if where == title and fmu in names:
                names.remove(fmu)
        if answer.failed:
            self.said.setdefault((answer.failed.replace(fmu, "NAME"), title), []).append(fmu)
        self.said = {key: names for key, names in self.said.items() if names}
        self.version = answer.version or self.version
        return row[place : place + 2]

    def lines(self) -> list[str]:
        """The section."""
        this = host(self.tool)
        head = ["FMU", *(f"{kind.title}: {what}" for kind in KINDS.values() for what in (DIFFERENCE, RATE))]
        rows = [[f"`{name}`", *cells] for name, cells in self.rows.items()]
        said = [
            f"- {kind}, {ALL if len(names) == len(rows) else ', '.join(names)}: “{words}”"
            for (words, kind), names in self.said.items()
        ]
        findings = [f"- {finding}" for finding in getattr(this, "FINDINGS", ())]
        return [
            f"## {this.TITLE}",
            "",
            f"{VERSION}{self.version}",
            "",
            f"Its user needs {this.USE}. {MADE}{self.made}.",
            "",
            *table(head, rows),
            *(["", FAILED, "", *said] if said else []),
            *(["", *findings] if findings else []),
        ]

    @staticmethod
    def read(tool: str, lines: Sequence[str]) -> Section:
        """The section of which these are the lines."""
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
                    section.said[words.removesuffix("”"), kind.title] = known
        return section

    def summary(self) -> list[str]:
        """The tool's line of the first table."""
        found = []
        for k in range(len(KINDS)):
            pairs = [(row[2 * k], row[2 * k + 1]) for row in self.rows.values()]
            differences = [float(a) for a, _ in pairs if a[:1].isdigit()]
            rates = [int(b.replace(" ", "")) for _, b in pairs if b[:1].isdigit()]
            if not differences:
                found.append(", ".join(sorted({a for a, _ in pairs})))
                continue
            words = [f"{len(differences)} of {len(pairs)}", f"difference {shown(max(differences))}"]
            if rates:
                words.append(f"{thousands(min(rates))} to {thousands(max(rates))} steps/s")
            found.append(", ".join(words))
        return [host(self.tool).TITLE, self.version, *found]


def here() -> str:
    """Where numbers come from that are made now."""
    return f"Python {platform.python_version()} on {platform.system()}, {os.cpu_count()} cores"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    lines = [head, ["---"] * len(head), *rows]
    return [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines]


def written() -> dict[str, Section]:
    """The sections that the document has, by tool."""
    text = FILE.read_text("utf-8") if FILE.exists() else ""
    parts = [part.rstrip().split("\n") for part in text.split("\n## ")[1:]]
    titles = {host(name).TITLE: name for name in NAMES}
    return {titles[part[0]]: Section.read(titles[part[0]], part) for part in parts if part[0] in titles}


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


def text(sections: Mapping[str, Section]) -> str:
    """The whole document."""
    known = [sections[name] for name in NAMES if name in sections]
    head = ["tool", "version", *(kind.title for kind in KINDS.values())]
    words = PAGE.read_text("utf-8").replace("STEPS", str(STEPS))
    lines = [words, *table(head, [section.summary() for section in known])]
    if left := [name for name in NAMES if name not in sections]:
        lines += ["", f"Not run yet: `python -m interop {' '.join(left)} --install`."]
    for section in known:
        lines += ["", *section.lines()]
    return "\n".join(lines) + "\n"
