"""A pytest plugin (`-p tests.manuals`) that writes docs/validation.md and docs/measurements.md.

They have what tests record. Rows of tests that did not run stay as they are; a test that failed has no rows.
"""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from . import validation
from .measurements import page as measurements
from .validation import MACHINES, Blocks, Record, named_test, page_blocks, recorded_blocks, recording_tests


class Manual(NamedTuple):
    """A page, the fixture whose records are on it, and its text from their rows."""

    path: Path
    fixture: str
    text: Callable[[Blocks], str]

    def write(self, records: list[Record]) -> None:
        new, tests = recorded_blocks(records), recording_tests(self.fixture) - _failed
        old = page_blocks(self.path.read_text("utf-8")) if self.path.exists() else {}
        ran = {test for _, test in new}
        kept = {key: rows for key, rows in old.items() if key[0] == MACHINES or key[1] not in ran} | new
        rows = {key: rows for key, rows in kept.items() if key[1] in tests}
        self.path.write_text(self.text(rows), "utf-8")


# By the name of their records.
MANUALS = {
    "validation": Manual(validation.PAGE, "record", validation.page_text),
    "measurements": Manual(measurements.PAGE, "published", measurements.page_text),
}
_records: dict[str, list[Record]] = {name: [] for name in MANUALS}
_failed: set[str] = set()


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Keep what a test recorded. With pytest-xdist the workers' reports pass here too."""
    if report.failed:
        _failed.add(named_test(report.nodeid))
    elif report.when == "call":
        for page, records in _records.items():
            found = [value for name, value in report.user_properties if name == page]
            records.extend((report.nodeid, place, *row) for place, row in enumerate(found))


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Write the pages in the process that has all reports."""
    if not hasattr(session.config, "workerinput"):
        for name, manual in MANUALS.items():
            manual.write(_records[name])
