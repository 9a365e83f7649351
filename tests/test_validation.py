"""The validation manual is well formed and has every test that records; a recorded number is checked."""

from __future__ import annotations

import numpy as np
import pytest

from .validation import (
    COLUMNS,
    PAGE,
    SUBJECTS,
    compare,
    page_blocks,
    page_text,
    recorded_blocks,
    recording_tests,
)


def test_the_page_has_every_recording_test_and_no_other() -> None:
    assert {test for _, test in page_blocks(PAGE.read_text("utf-8"))} == set(recording_tests())


def test_the_page_is_well_formed() -> None:
    text = PAGE.read_text("utf-8")
    blocks = page_blocks(text)
    assert {subject for subject, _ in blocks} == set(SUBJECTS)
    assert page_text(blocks) == text
    for row in (row for rows in blocks.values() for row in rows):
        assert len(row.replace("\\|", "").strip("| ").split(" | ")) == len(COLUMNS), row


@pytest.mark.parametrize("value", [1.02, np.nan, [1.0, 0.9]])
def test_a_number_outside_its_tolerance_fails(value) -> None:
    with pytest.raises(AssertionError, match="height"):
        compare("height", value, 1.0, "closed form", relative=0.01)


def test_rows_do_not_depend_on_the_order_of_reports() -> None:
    records = []
    for case in range(3):
        for place, name in enumerate(("height", "width")):
            row = compare(name, 1.0 + 1e-3 * case, 1.0, "closed form", relative=0.1)
            records.append((f"tests/a.py::test_b[{case}]", place, "Cam", *row))
    blocks = recorded_blocks(records)
    assert blocks == recorded_blocks(records[::-1])
    rows = blocks["Cam", "a.py::test_b"]
    assert [row.partition(" (worst of 3 cases) | 1.002 |")[0] for row in rows] == ["| height", "| width"]
    assert page_blocks(page_text(blocks)) == blocks
