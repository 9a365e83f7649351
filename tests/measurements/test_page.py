"""The page of measurements has every case, and as many as it promises; a wrong verdict fails."""

from dataclasses import replace

import pytest

from tests.validation import page_blocks, recording_tests

from .page import COLUMNS, MEASURED, PAGE, Published, check_current, count, judge, page_text

CASE = Published("Mechanisms", "angle", "at rest", MEASURED, 1.0, 2.0, "a book")


def test_the_page_has_every_case_and_is_as_written() -> None:
    text = PAGE.read_text("utf-8")
    blocks = page_blocks(text)
    assert {test for _, test in blocks} == recording_tests("published")
    assert page_text(blocks) == text
    for rows in blocks.values():
        assert all(len(row.strip("| ").split(" | ")) == len(COLUMNS) for row in rows)


def test_the_page_has_the_cases_that_it_should() -> None:
    """Twelve or more from eight sources, five measured, four of five inside their band."""
    n = count(page_blocks(PAGE.read_text("utf-8")))
    assert min(n.cases - 12, n.sources - 8, n.measured - 5, n.inside - 0.8 * n.cases) >= 0.0


def test_a_verdict_is_that_of_the_band() -> None:
    assert judge(CASE, 1.5, "as it should", True)[5] == "inside"
    assert judge(CASE, 2.5, "friction", False)[5] == "outside"
    for ours, inside in ((2.5, True), (1.5, False)):
        with pytest.raises(AssertionError, match="angle: "):
            judge(CASE, ours, "", inside)
    with pytest.raises(ValueError, match="band"):
        judge(replace(CASE, low=3.0), 3.5, "", True)


def test_a_row_that_is_not_on_the_page_fails() -> None:
    row = judge(CASE, 1.5, "because", True)
    line = f"| {' | '.join(row)} | [test_a](../tests/a.py) |"
    check_current(row, [line])
    check_current(judge(CASE, 1.51, "because", True), [line])
    for other in (judge(CASE, 1.9, "because", True), judge(CASE, 1.5, "", True)):
        with pytest.raises(AssertionError):
            check_current(other, [line])
    with pytest.raises(AssertionError, match="not on measurements"):
        check_current(row, [])
