"""The validation manual is well formed and has every test that records; a recorded number is checked."""

import numpy as np
import pytest

from .machines import find_spreads
from .validation import (
    COLUMNS,
    MACHINE_COLUMNS,
    MACHINES,
    PAGE,
    SUBJECTS,
    compare,
    page_blocks,
    page_text,
    recorded_blocks,
    recording_tests,
)


def test_the_page_has_every_recording_test_and_no_other() -> None:
    blocks = page_blocks(PAGE.read_text("utf-8"))
    assert {test for subject, test in blocks if subject != MACHINES} == set(recording_tests())
    assert {test for subject, test in blocks if subject == MACHINES} <= set(recording_tests())


def test_the_page_is_well_formed() -> None:
    text = PAGE.read_text("utf-8")
    blocks = page_blocks(text)
    assert {subject for subject, _ in blocks} - {MACHINES} == set(SUBJECTS)
    assert page_text(blocks) == text
    for subject, row in ((key[0], row) for key, rows in blocks.items() for row in rows):
        columns = MACHINE_COLUMNS if subject == MACHINES else COLUMNS
        assert len(row.replace("\\|", "").strip("| ").split(" | ")) == len(columns), row


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


@pytest.mark.parametrize(
    ("values", "margin"),
    # Room of the best value to the tolerance 0.1, over the spread.
    [((1.0, 1.05), 2.0), ((1.05, 1.06), 5.0), ((0.99, 1.01), 5.0), ((1.09, 1.09), np.inf)],
)
def test_margin_is_the_room_of_the_nearest_machine_over_the_spread(values, margin) -> None:
    sessions = {
        str(machine): [("tests/a.py::test_b", 0, "Cam", *compare("height", value, 1.0, "", tolerance=0.1))]
        for machine, value in enumerate(values)
    }
    (spread,) = find_spreads(sessions)
    assert spread.margin == pytest.approx(margin)
