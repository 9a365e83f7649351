"""Files that are not as the rules say are refused with the file, the place and what must be there."""

import numpy as np
import pytest

from fmus.reference_results.files import ComparisonError, Options, csv_text, read_csv, read_options

GOOD = Options(0.0, 2.0, 0.01, 1e-6, 0.1)


def test_what_is_written_is_read_back() -> None:
    rows = [[0.0, 1.0 / 3.0, -1e300], [0.5, 0.0, 5e-324], [0.5, 1.0, 2.0]]
    table = read_csv(csv_text(["time", "a[1]", "der(b)"], rows, 17), "x.csv")
    assert table.times.tolist() == [0.0, 0.5, 0.5]
    assert list(table.columns) == ["a[1]", "der(b)"]
    assert np.column_stack([*table.columns.values()]).tolist() == [row[1:] for row in rows]
    assert read_options(GOOD.text(), "x.opt") == GOOD


def test_options_as_others_write_them() -> None:
    """With comments and further elements, as in the rules' own example."""
    text = "StartTime, 0.0 // in seconds\nStopTime,1\nStepSize, 0\nRelTol, 0.0001\nSolverType, Fixed\n"
    assert read_options(text, "x.opt") == Options(0.0, 1.0, 0.0, 1e-4)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1 must have the names"),
        ('"time","a"\n', "has no numbers"),
        ('"time","a"\n0,x\n', "line 2 must be finite numbers"),
        ('"time","a"\n0,inf\n', "line 2 must be finite numbers"),
        ('"time","a"\n0,1,2\n', "line 2 has 3 numbers: must be 2"),
        ('"time","a"\n0,1\n2,1\n1,1\n', "line 4: time falls"),
    ],
)
def test_a_bad_table_is_refused(text: str, message: str) -> None:
    with pytest.raises(ComparisonError, match=f"x.csv: .*{message}"):
        read_csv(text, "x.csv")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("StopTime, 2.0\n", "", "StopTime is missing"),
        ("StopTime, 2.0", "StopTime, two", "StopTime = two: must be a number"),
        ("StopTime, 2.0", "StopTime, nan", "StopTime is missing: it must be a finite number"),
        ("StopTime, 2.0", "StopTime, -1", "StopTime = -1 s: must be later than StartTime = 0 s"),
        ("StepSize, 0.01", "StepSize, 5", "StepSize = 5 s: must be from 0 to 2 s"),
        ("RelTol, 1e-06", "RelTol, -1", "RelTol = -1: must not be negative"),
    ],
)
def test_bad_options_are_refused(old: str, new: str, message: str) -> None:
    assert old in GOOD.text()
    with pytest.raises(ComparisonError, match=f"x.opt: {message}"):
        read_options(GOOD.text().replace(old, new), "x.opt")
