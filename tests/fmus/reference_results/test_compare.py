"""FMUs are run and compared with their references: what agrees is said to, what does not is named."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fmus.reference_results.apart import compare_in_process
from fmus.reference_results.compare import compare
from fmus.reference_results.files import ComparisonError, Options, csv_text, read_csv
from fmus.reference_results.inside import FOLDER
from fmus.reference_results.results import compute_results
from tests.archives import repack, replace_text
from tests.third_party.c_fmus import fmu as third_party

from ..names import REFERENCED, mark_long


@pytest.mark.parametrize("name", mark_long(REFERENCED, ["valve_spring", "flywheel"]))
def test_fmus_in_python_reproduce_their_references(name, referenced, record):
    """To the tolerance that ships with each: that of the component's own steps, as the FMU adds nothing."""
    found = compare(referenced[name])
    assert found.agrees, str(found)
    quantity, worst = "deviation of FMUs in Python, relative to the largest value", found.worst.relative
    record("FMUs", quantity, worst, 0.0, "reference results in the FMU", tolerance=found.tolerance)
    assert len(found.deviations) > 1
    assert str(found).count("\n") == len(found.deviations) + 2


def changed(fmu: Path, target: Path, file: str, change: Callable[[bytes], bytes]) -> Path:
    """The FMU with other content of a file of its reference."""
    place = f"{FOLDER}/{file}"
    return repack(fmu, target, lambda n, content: {n: change(content) if n == place else content})


def test_a_difference_is_found_in_the_variable_and_at_the_time_where_it_is(referenced, tmp_path):
    """One number is changed by 1e-7 of the variable's largest value, ten times the tolerance."""

    file = "quarter_car_chassis_ref.csv"

    def moved(content):
        table = read_csv(content.decode(), file)
        column = table.columns["velocity"]
        column[40] += 1e-7 * np.max(np.abs(column))
        rows = np.column_stack([table.times, *table.columns.values()])
        return csv_text(["time", *table.columns], rows.tolist(), 12).encode()

    found = compare(changed(referenced["quarter_car_chassis"], tmp_path / "moved.fmu", file, moved))
    assert not found.agrees
    assert found.worst.variable == "velocity"
    assert found.worst.relative == pytest.approx(1e-7, rel=0.02)
    times = read_csv(compute_results("quarter_car_chassis").files[file], "ref").times
    assert found.worst.time == times[40]
    assert "DIFFERS: velocity" in str(found)
    wider = compare(tmp_path / "moved.fmu", tolerance=1e-6)
    assert wider.agrees


def test_events_of_a_reference_are_left_out(referenced, tmp_path):
    """An instant that stands twice is one at which values jump; which side a host records is its matter."""

    def jumping(content):
        lines = content.decode().splitlines()
        lines.insert(41, lines[41].split(",")[0] + ",99,99,99")
        return "\n".join(lines).encode()

    file, fmu = "quarter_car_chassis_ref.csv", referenced["quarter_car_chassis"]
    found = compare(changed(fmu, tmp_path / "jumping.fmu", file, jumping))
    assert [d.variable for d in found.deviations if d.largest > 1e-3] == []
    assert len(found.deviations) == 3


def test_a_reference_beside_the_file_is_taken_first(referenced, tmp_path):
    """Without `OutputIntervalLength`."""
    folder = tmp_path
    fmu = repack(
        referenced["falling_mass"],
        folder / "hop.fmu",
        lambda n, c: {} if n.startswith(f"{FOLDER}/falling_mass_") else {n: c},
    )
    for suffix in ("_in.csv", "_ref.csv"):
        (folder / f"hop{suffix}").write_text(compute_results("falling_mass").files[f"falling_mass{suffix}"])
    (folder / "hop_ref.opt").write_text("StartTime,0\nStopTime,0.5\nStepSize,0.001\nRelTol,1e-6\n")
    found = compare(fmu)
    assert found.agrees
    assert found.place == "reference beside the file"
    assert found.options.step_size == 1e-3
    (folder / "hop_ref.opt").write_text("StartTime,0\nStopTime,0.5\nStepSize,0.001\nRelTol,0\n")
    with pytest.raises(ComparisonError, match="give tolerance"):
        compare(fmu)
    assert compare(fmu, 1e-6).agrees
    (folder / "hop_ref.opt").unlink()
    with pytest.raises(ComparisonError, match=r"hop_ref\.opt is missing"):
        compare(fmu)


@pytest.mark.parametrize("version", [2, 3])
def test_a_third_party_fmu_against_its_closed_form(version, tmp_path):
    """x' = -x in C, exact in its steps; a reference without inputs, at instants between its steps too."""
    path = Path(third_party("dahlquist", version, tmp_path))
    times = np.arange(21) * 0.05
    rows = np.column_stack([times, np.exp(-times)]).tolist()
    (path.parent / f"{path.stem}_ref.csv").write_text(csv_text(["time", "x"], rows))
    options = path.parent / f"{path.stem}_ref.opt"
    options.write_text("StartTime, 0\nStopTime, 1\nStepSize, 0.05\nRelTol, 1e-12\n")
    found = compare(path)
    assert found.agrees
    options.write_text("StartTime, 0\nStopTime, 1\nStepSize, 0.1\nRelTol, 1e-3\n")
    between = compare(path)
    assert not between.agrees  # a straight line between e^0 and e^-0.1 is up to 1.2e-3 off
    assert between.worst.relative == pytest.approx(1.2e-3, rel=0.1)


def test_a_crash_is_an_answer_and_the_next_file_is_run(referenced, tmp_path):
    paths = [Path(third_party("crashing", 2, tmp_path)), referenced["falling_mass"], tmp_path / "none.fmu"]
    (tmp_path / f"{paths[0].stem}_ref.csv").write_text('"time","x"\n0,1\n1,0\n')
    (tmp_path / f"{paths[0].stem}_ref.opt").write_text(
        "StartTime, 0\nStopTime, 1\nStepSize, 0.1\nRelTol, 1e-3\n"
    )
    (_, crashed), (_, found), (_, absent) = compare_in_process(paths, None)
    assert isinstance(crashed, ComparisonError)
    assert "the FMU crashed: it ended the process" in str(crashed)
    assert not isinstance(found, ComparisonError)
    assert found.agrees
    assert "no such file" in str(absent)


@pytest.mark.parametrize(
    ("file", "old", "new", "message"),
    [
        ("falling_mass_ref.csv", None, None, "names falling_mass_ref.csv, which is not in"),
        ("falling_mass_ref.opt", None, None, "falling_mass_ref.opt is missing"),
        ("falling_mass_ref.csv", '"velocity"', '"speed"', "has no variable speed"),
        ("falling_mass_in.csv", '"force"', '"push"', "has no variable push"),
        ("falling_mass_in.csv", "0.1,0,0", "0.1,a,0", "line 3 must be finite numbers"),
        ("falling_mass_in.csv", "0.3,30,", "0.3,1e999,", "must be finite numbers"),
        ("falling_mass_ref.opt", "StopTime, 0.5", "StopTime, -1", "must be later than StartTime"),
        ("falling_mass_ref.opt", "StartTime, 0.0", "StartTime, 0.498", "must have two instants"),
    ],
)
def test_what_cannot_be_compared_is_said_in_one_line(file, old, new, message, referenced, tmp_path):
    whole, fmu, place = referenced["falling_mass"], tmp_path / "broken.fmu", f"{FOLDER}/{file}"
    if old is None:
        repack(whole, fmu, lambda n, content: {} if n == place else {n: content})
    else:
        replace_text(whole, fmu, old, new, place)
    with pytest.raises(ComparisonError) as raised:
        compare(fmu)
    assert message in str(raised.value)
    assert "\n" not in str(raised.value)
    assert str(raised.value).startswith(str(fmu))


def test_what_is_no_number_is_not_compared(tmp_path):
    """An array of FMI 3.0."""
    path = Path(third_party("vector", 3, tmp_path))
    (path.parent / f"{path.stem}_ref.csv").write_text('"time","y"\n0,1\n1,0\n')
    (path.parent / f"{path.stem}_ref.opt").write_text(Options(0.0, 1.0, 0.1, 1e-3).text())
    with pytest.raises(ComparisonError, match="y, which its reference files name, is no single number"):
        compare(path)
