"""docs/reference/tools.csv has the result of every FMU in every tool, docs/reference/tools.md sums it up."""

import csv
import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path

from fmus.native.fmu import NAMES as FMUS

from .comparison import KINDS, STEPS, TRAINS
from .processes import NAMES, ROOT, Answer, load_tool

PAGE = ROOT / "docs" / "reference" / "tools.md"
TABLE = PAGE.with_suffix(".csv")
INTRODUCTION = Path(__file__).with_name("page.md")
KEY = ("tool", "fmu", "kind")
WHOLE = """One FMU of all components (`tribocosim fmu build --scenario NAME --whole`) of {}. Differences
are those from the same steps of its equations without FMI; the tests compare these with the reference."""


@dataclass(frozen=True)
class Result:
    """One FMU in one tool. `difference` says why there is none if the tool gave no values."""

    version: str
    machine: str
    difference: str
    message: str

    @property
    def ran(self) -> bool:
        return self.difference[0].isdigit()


Results = dict[tuple[str, str, str], Result]  # by tool, FMU and kind


def make_result(fmu: str, difference: float | None, answer: Answer) -> Result:
    """The difference has two digits."""
    if difference is None:
        stage = "stops" if answer.loaded else "does not load"
        shown = stage if answer.tried else "not tried"
    else:
        shown = f"{difference:.1e}" if difference else "0"
    machine = f"Python {platform.python_version()} on {platform.system()}, {os.cpu_count()} cores"
    return Result(answer.version, machine, shown, answer.failed.replace(fmu, "NAME"))


def read_results() -> Results:
    with TABLE.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {(row.pop("tool"), row.pop("fmu"), row.pop("kind")): Result(**row) for row in rows}


def write_results(results: Results) -> None:
    """Write the table and the page."""
    results = {key: results[key] for key in product(NAMES, [*FMUS, *TRAINS], KINDS) if key in results}
    with TABLE.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, [*KEY, *Result.__annotations__], lineterminator="\n")
        writer.writeheader()
        for key, result in results.items():
            writer.writerow(dict(zip(KEY, key, strict=True)) | asdict(result))
    PAGE.write_text(format_page(results), "utf-8")


def format_page(results: Results) -> str:
    """The text, a table of all tools, and what each tool needs and where it fails."""
    by_tool: dict[str, dict[tuple[str, str], Result]] = {}
    trains: dict[str, dict[tuple[str, str], Result]] = {}
    for (tool, fmu, kind), result in results.items():
        (trains if fmu in TRAINS else by_tool).setdefault(tool, {})[fmu, kind] = result
    head = ["tool", "version", *(kind.title for kind in KINDS.values())]
    rows = [summarise(tool, found) for tool, found in by_tool.items()]
    lines = [INTRODUCTION.read_text("utf-8").replace("STEPS", str(STEPS)), *format_table(head, rows)]
    if left := [name for name in NAMES if name not in by_tool]:
        lines += ["", f"Not run yet: `python -m interop {' '.join(left)} --install`."]
    if trains:
        rows = [summarise(tool, found) for tool, found in trains.items()]
        lines += ["", "## Whole trains", "", WHOLE.format(", ".join(f"`{train}`" for train in TRAINS)), ""]
        lines += format_table(head, rows)
    for tool, found in by_tool.items():
        if findings := list_findings(tool, found):
            lines += ["", f"## {load_tool(tool).TITLE}", "", *findings]
    return "\n".join(lines) + "\n"


def summarise(tool: str, results: Mapping[tuple[str, str], Result]) -> list[str]:
    """The tool's row: how many FMUs of each kind run, and the largest difference."""
    cells = []
    for kind in KINDS:
        found = [result for (_, which), result in results.items() if which == kind]
        ran = [result for result in found if result.ran]
        if not ran:
            cells.append(", ".join(sorted({result.difference for result in found})))
            continue
        largest = max((result.difference for result in ran), key=float)
        cells.append(f"{len(ran)} of {len(found)}, {largest}")
    version = max(result.version for result in results.values())
    return [load_tool(tool).TITLE, version, *cells]


def list_findings(tool: str, results: Mapping[tuple[str, str], Result]) -> list[str]:
    """What the tool needs, the FMUs that failed by message, and what else was found."""
    use = load_tool(tool).USE
    lines = [f"- Also needs {use}."] if use != "nothing" else []
    for kind in KINDS:
        failed: dict[str, list[str]] = {}
        for (fmu, which), result in results.items():
            if which == kind and result.message:
                failed.setdefault(result.message, []).append(fmu)
        for message, names in failed.items():
            fmus = "all" if len(names) == len({fmu for fmu, _ in results}) else ", ".join(names)
            lines.append(f"- {KINDS[kind].title}, {fmus}: “{message}”")
    return lines + [f"- {finding}" for finding in getattr(load_tool(tool), "FINDINGS", ())]


def format_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    lines = [head, ["---"] * len(head), *rows]
    return [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines]
