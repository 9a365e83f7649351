"""The validation manual: numbers that tests compare and record, gathered on docs/validation.md."""

import ast
import re
import tomllib
from collections import defaultdict
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

TESTS = Path(__file__).parent
PAGE = TESTS.parent / "docs" / "validation.md"
LIMITS = TESTS / "known_limits.toml"
SUBJECTS = (
    "Cam", "Spring", "Train", "Contact", "Film", "Field", "Slider-crank", "Multibody", "Coupling", "FMUs",
    "Tools",
)  # fmt: skip
COLUMNS = ("quantity", "computed", "reference", "difference", "tolerance", "source", "test")
INTRODUCTION = """# Validation manual

This page compares computed numbers with closed forms, independent solutions and published values. A test
computes each number, compares it with its reference within the tolerance shown, and records both; of a test
with several cases the page shows the worst. `python -m tests --validation` runs these tests, the long ones
too, and writes the page anew; `python -m tests --validation spring` does so for the tests that have `spring`
in their file or name.

Numbers are in SI units unless a unit is named; *rel.* is relative to the reference. A reference of 0 means
that the quantity is itself an error; a tolerance of 0, that all numbers are equal to the last bit.
"""

# The last section, see `machines`.
MACHINES = "What differs by machine"
MACHINE_COLUMNS = ("quantity", "spread", "from", "to", "tolerance", "test")
MACHINE_INTRODUCTION = """Numbers that the processor's linear algebra (BLAS), the kernels' machine code or a
second thread change by more than a tenth of their tolerance. *Spread*, *from* and *to* are shares of the
tolerance; the environment is in parentheses. `python -m tests --machines [--all] [WORD ...]` measures them,
and fails where three spreads would leave the tolerance.
"""

# Rows by subject and test.
Blocks = dict[tuple[str, str], list[str]]
# A test with its case, the place of a record in it, subject, signed shares of the tolerance that elements use
# up, cells.
Record = tuple[str, int, str, list[float], list[str]]


@pytest.fixture
def record(request: pytest.FixtureRequest) -> Callable[..., None]:
    """Compares a number with its reference, see `compare`, and records both for the validation manual."""

    def compare_and_record(subject: str, *comparison: Any, **tolerance: float) -> None:
        if subject not in SUBJECTS:
            raise ValueError(f"subject {subject!r}: must be one of {', '.join(SUBJECTS)}")
        request.node.user_properties.append(("validation", [subject, *compare(*comparison, **tolerance)]))

    return compare_and_record


def compare(
    quantity: str,
    value: Any,
    reference: Any,
    source: str,
    *,
    tolerance: float | None = None,
    relative: float | None = None,
) -> tuple[list[float], list[str]]:
    """Assert |value - reference| <= tolerance, or <= relative * |reference|, for every element of arrays.

    Returns the signed share of the tolerance that each element uses up, and the cells of the worst one's row.
    """
    if (tolerance is None) == (relative is None):
        raise ValueError(f"{quantity}: give either a tolerance or a relative one")
    values, references = np.broadcast_arrays(np.asarray(value, float), np.asarray(reference, float))
    scales = np.ones_like(references) if relative is None else np.abs(references)
    differences = np.nan_to_num((values - references) / scales, nan=np.inf)
    worst = np.unravel_index(np.argmax(np.abs(differences)), differences.shape)
    difference, allowed = (
        float(np.abs(differences[worst])),
        float(relative if tolerance is None else tolerance),
    )
    mark = " rel." if tolerance is None else ""
    numbers = (f"{values[worst]:.6g}", f"{references[worst]:.6g}", f"{difference:.2g}{mark}")
    cells = [quantity, *numbers, f"{allowed:.2g}{mark}", source]
    assert difference <= allowed, ", ".join(f"{n} {c}" for n, c in zip(COLUMNS, cells, strict=False))
    return (differences.ravel() / (allowed or 1.0)).tolist(), cells


def recording_tests(fixture: str = "record") -> set[str]:
    """The tests that take the fixture, as "file::test" with the file below tests/."""
    return {
        f"{file.relative_to(TESTS).as_posix()}::{node.name}"
        for file in TESTS.rglob("test_*.py")
        for node in ast.parse(file.read_text("utf-8")).body
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
        if fixture in {argument.arg for argument in node.args.args + node.args.kwonlyargs}
    }


def page_blocks(text: str) -> Blocks:
    """The rows of a page."""
    blocks: Blocks = defaultdict(list)
    for part in text.split("\n## ")[1:]:
        subject, *lines = part.split("\n")
        for line in lines:
            if test := re.search(r"\[(test_\w+)\]\(\.\./tests/(\S+)\) \|$", line):
                blocks[subject, f"{test[2]}::{test[1]}"].append(line)
    return blocks


def page_text(blocks: Blocks) -> str:
    """The page: a table for each subject, sorted by test, and what falls short."""
    limits = tomllib.loads(LIMITS.read_text("utf-8"))
    parts = [INTRODUCTION]
    for subject in (*SUBJECTS, MACHINES):
        columns, begin = (MACHINE_COLUMNS, [MACHINE_INTRODUCTION]) if subject == MACHINES else (COLUMNS, [])
        rows = [row for key in sorted(blocks) if key[0] == subject for row in blocks[key]]
        table = [f"| {' | '.join(columns)} |", "|---" * len(columns) + "|", *rows]
        known = ["", "Known limits:", "", *(f"- {limit}" for limit in limits.get(subject, []))]
        parts.append(
            "\n".join([f"## {subject}", "", *begin, *table, *(known if subject in limits else []), ""])
        )
    return "\n".join(parts)


def named_test(node: str) -> str:
    """The test of a node of pytest, without its case, as "file::test"."""
    return node.partition("[")[0].removeprefix("tests/")


def recorded_blocks(records: Iterable[Record]) -> Blocks:
    """The rows of new records, in the order of cases; what is recorded repeatedly has one row, the worst."""
    cases = defaultdict(list)
    for node, _, subject, share, cells in sorted(records):
        cases[subject, named_test(node), cells[0]].append((share, cells))
    blocks: Blocks = defaultdict(list)
    for (subject, test, quantity), found in cases.items():
        cells = max(found, key=lambda case: max(map(abs, case[0]), default=0.0))[1]
        more = f" (worst of {len(found)} cases)" if len(found) > 1 else ""
        row = [quantity + more, *cells[1:], link(test)]
        blocks[subject, test].append(f"| {' | '.join(map(escape, row))} |")
    return blocks


def link(test: str) -> str:
    """To the file of a test "file::test"."""
    file, _, name = test.partition("::")
    return f"[{name}](../tests/{file})"


def escape(cell: str) -> str:
    """The cell's text in a table."""
    return cell.replace("|", "\\|")
