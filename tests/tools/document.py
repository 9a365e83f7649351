"""docs/tools.md: a section for each tool, of those that were not run this time as it was."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from .plan import KINDS, STEPS
from .running import NAMES, ROOT, host

FILE = ROOT / "docs" / "tools.md"
LOADS_NOT, STOPS = "does not load", "stops"
DIFFERENCE, RATE = "difference", "steps/s"

# Tools that were tried and are not here, and why.
ABSENT: Mapping[str, str] = {}


@dataclass
class Section:
    """What a tool made of the FMUs: two cells for each kind of each, and what it said where it failed."""

    title: str
    version: str
    rows: dict[str, list[str]] = field(default_factory=dict)
    said: dict[str, list[str]] = field(default_factory=dict)

    def lines(self, use: str, findings: Sequence[str]) -> list[str]:
        """The section."""
        head = ["FMU", *(f"{kind.title}: {what}" for kind in KINDS.values() for what in (DIFFERENCE, RATE))]
        rows = [[f"`{name}`", *cells] for name, cells in self.rows.items()]
        said = [f"- “{words}” ({', '.join(where)})" for words, where in self.said.items()]
        return [
            f"## {self.title}",
            "",
            f"Version: {self.version}. Its user needs {use}.",
            "",
            *table(head, rows),
            *(["", "It said:", "", *said] if said else []),
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


def summary(lines: Sequence[str]) -> list[str]:
    """A tool's line of the first table, from its section."""
    cells = [
        [cell.strip() for cell in line.strip("| ").split(" | ")] for line in lines if line.startswith("| `")
    ]
    version = next(line for line in lines if line.startswith("Version: "))
    found = []
    for k in range(len(KINDS)):
        pairs = [(row[1 + 2 * k], row[2 + 2 * k]) for row in cells]
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


def shown(difference: float) -> str:
    return "0" if difference == 0.0 else f"{difference:.1e}"


def thousands(rate: float) -> str:
    """Three digits, as whole thousands apart: 81 700."""
    return f"{float(f'{rate:.3g}'):,.0f}".replace(",", " ")


HEAD = f"""\
# Tools that run the FMUs

```sh
.venv/bin/python -m tests.tools              # those that are here
.venv/bin/python -m tests.tools --install    # every tool into an environment of its own, in the cache folder
.venv/bin/python -m tests.tools fmpy ecos    # these; the others' sections stay
```

writes this page. Every FMU ([in Python](fmus.md), [native](native.md) for FMI 2.0 and 3.0) makes {STEPS}
steps in every tool, with inputs that change from step to step and are held in it, and in this process the
component makes the same steps. The step is the power of two next to the one that the FMU offers.

- *difference*: the largest one of any output (rates among them, arrays of FMI 3.0 not) after any step, in
  parts of that output's largest magnitude; 0 is equality to the last bit.
- *steps/s*: in the tool's own loop, with inputs held and as little recorded as the tool lets; the best of
  some short runs. Compare rates within one tool's table only: the machine was doing other work, at some times
  more than at others.
- *{LOADS_NOT}*, *{STOPS}*: before or after the tool had an instance.

A tool is a file in `tests/tools/hosts/`.
"""


def text(sections: Mapping[str, Sequence[str]]) -> str:
    """The whole document."""
    order = [host(name).TITLE for name in NAMES]
    known = {title: sections[title] for title in order if title in sections}
    head = ["tool", "version", *(kind.title for kind in KINDS.values())]
    made = f"Made with Python {platform.python_version()} on {platform.system()}, {os.cpu_count()} cores."
    lines = [HEAD + made, "", *table(head, [summary(section) for section in known.values()])]
    if left := [name for name in NAMES if host(name).TITLE not in known]:
        lines += ["", f"Not run yet: `python -m tests.tools {' '.join(left)} --install`."]
    if ABSENT:
        lines += ["", "Not here:", "", *(f"- {tool}: {why}" for tool, why in ABSENT.items())]
    for section in known.values():
        lines += ["", *section]
    return "\n".join(lines) + "\n"
