"""docs/measurements.md: published numbers beside ours, from the tests in this folder, which record them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.validation import Blocks, named_test, page_blocks

PAGE = Path(__file__).parents[2] / "docs" / "measurements.md"
SUBJECTS = ("Mechanisms", "Springs and valve trains", "Contact and film", "Bearings", "Friction and wear")
MEASURED, COMPUTED = "measured", "computed"
INSIDE, OUTSIDE = "inside", "outside"
COLUMNS = ("quantity", "conditions", "kind", "published", "ours", "verdict", "why", "source", "test")
KIND, OURS, VERDICT, SOURCE = (COLUMNS.index(name) for name in ("kind", "ours", "verdict", "source"))
INTRODUCTION = """# Measurements and published cases

This page compares tribocosim with numbers that others have published: measurements, and reference solutions
of benchmarks. The [validation manual](validation.md) compares it with closed forms and with solutions of our
own.

{summary}

- *Published* is the source's value with its band in parentheses: the scatter or the digits that the source
  states, or else the range that *conditions* names.
- Inputs are those of the source. What a source leaves out has a typical value, which *conditions* names.
  Nothing is fitted to the published number. Of followers these are 8 mm of lift, a base circle of 42 mm,
  12 mm of contact length, 0.2 um Ra each, SAE 10W-30, boundary friction 0.1.
- *Why* says what the comparison shows, and of a number outside its band what causes the difference.

Each case is a test of a few lines, run from a clone with `pip install -e '.[dev]'`:
`python -m pytest tests/measurements` runs all, `python -m tests --validation measurements` also writes this
page. Numbers are in SI units unless a unit is named.
"""


@dataclass(frozen=True)
class Published:
    """A published number with its band: the source, what it says of the conditions, how it was found."""

    subject: str
    quantity: str
    conditions: str
    kind: str
    low: float
    high: float
    source: str
    value: float | None = None
    digits: int = 3

    def show(self, number: float) -> str:
        return f"{number:.{self.digits}g}"

    @property
    def band(self) -> str:
        limits = f"{self.show(self.low)} to {self.show(self.high)}"
        if math.isinf(self.high):
            limits = f"above {self.show(self.low)}"
        return limits if self.value is None else f"{self.show(self.value)} ({limits})"


def judge(case: Published, ours: float, why: str, inside: bool) -> list[str]:
    """The row of a case; AssertionError unless the verdict is the stated one."""
    if case.subject not in SUBJECTS or case.kind not in (MEASURED, COMPUTED) or not case.low <= case.high:
        raise ValueError(f"{case.quantity}: subject, kind or band is not as `Published` has it")
    found = case.low <= ours <= case.high
    verdict = INSIDE if found else OUTSIDE
    assert found == inside, f"{case.quantity}: {case.show(ours)} is {verdict} {case.band}"
    return [
        case.quantity, case.conditions, case.kind, case.band, case.show(ours), verdict, why, case.source
    ]  # fmt: skip


def check_current(row: Sequence[str], rows: Sequence[str]) -> None:
    """A row of the page is this one; our number may differ by two units of its last digit."""
    for cells in (line.strip("| ").split(" | ")[:-1] for line in rows):
        if cells[0] == row[0]:
            shown, digits = cells[OURS], len(row[OURS].partition("e")[0].strip("-0.").replace(".", ""))
            assert float(shown) == pytest.approx(float(row[OURS]), rel=2.0 * 10.0 ** (1 - max(digits, 2)))
            assert [*cells[:OURS], shown, *cells[VERDICT:]] == [*row[:OURS], shown, *row[VERDICT:]]
            return
    raise AssertionError(f"{row[0]}: not on {PAGE.name}; write it with python -m tests --validation")


def page_text(blocks: Blocks) -> str:
    """The page: its summary, and a table for each subject, sorted by test."""
    parts = [INTRODUCTION.format(summary=summarise(blocks))]
    for subject in SUBJECTS:
        rows = [row for key in sorted(blocks) if key[0] == subject for row in blocks[key]]
        table = [f"| {' | '.join(COLUMNS)} |", "|---" * len(COLUMNS) + "|", *rows]
        parts += ["\n".join([f"## {subject}", "", *table, ""])] if rows else []
    return "\n".join(parts)


@dataclass(frozen=True)
class Count:
    """Cases (a number is one), those measured, those inside their band; sources."""

    cases: int
    measured: int
    inside: int
    sources: int


def count(blocks: Blocks) -> Count:
    cases = [row.strip("| ").split(" | ") for rows in blocks.values() for row in rows]
    return Count(
        len(cases),
        sum(case[KIND] == MEASURED for case in cases),
        sum(case[VERDICT] == INSIDE for case in cases),
        len({case[SOURCE] for case in cases}),
    )


def summarise(blocks: Blocks) -> str:
    n = count(blocks)
    return (
        f"It has {n.cases} cases from {n.sources} sources, {n.measured} of them measured; {n.inside} are "
        "inside their band."
    )


@pytest.fixture
def published(request):
    """Compares our number with a published one, see `judge`, and records both for docs/measurements.md."""

    def record(case, ours, why="", *, inside=True):
        row = judge(case, float(ours), why, inside)
        if not request.config.pluginmanager.has_plugin("tests.manuals"):
            test = named_test(request.node.nodeid)
            check_current([*row], page_blocks(PAGE.read_text("utf-8")).get((case.subject, test), []))
        request.node.user_properties.append(("measurements", [case.subject, [], row]))

    return record
