"""FMUs are run and compared with their references: what agrees is said to, what does not is named."""

import math
import zipfile
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fmus.build import build
from fmus.reference_results.compare import compare, compare_in_process, find_results, read_results
from fmus.reference_results.files import ComparisonError, Options, csv_text, read_csv, read_options
from fmus.reference_results.inside import FOLDER, MANIFEST
from fmus.reference_results.results import compute_results
from tests.archives import repack, replace_text
from tests.fmus.kinds import FAST, WITH_REFERENCES, every_fmu
from tests.fmus.layered import check_manifest
from tests.fmus.names import REFERENCED, mark_long
from tests.third_party.c_fmus import fmu
from tests.third_party.c_fmus import fmu as third_party
from tests.third_party.runs import public


@pytest.mark.parametrize(
    ("kind", "name"),
    every_fmu(REFERENCED, python=("valve_spring", "flywheel"), native=FAST, native3=FAST),
)
def test_fmus_reproduce_their_references(kind, name, record):
    """To the tolerance that ships with each: that of the component's own steps, as the FMU adds nothing.
    Elements of arrays have their names in every version."""
    found = compare(WITH_REFERENCES[kind][name])
    assert found.agrees, str(found)
    quantity, worst = f"deviation of FMUs ({kind}), relative to the largest value", found.worst.relative
    record("FMUs", quantity, worst, 0.0, "reference results in the FMU", tolerance=found.tolerance)
    assert len(found.deviations) > 1
    assert str(found).count("\n") == len(found.deviations) + 2
    if name == "valve_spring":
        assert "coil_position[2]" in {one.variable for one in found.deviations}


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


SHORT = MANIFEST.removeprefix(FOLDER + "/")
STATED = '<fmiReferences><Related type="text/csv" source="{}" role="result"/></fmiReferences>'
PUBLIC = ("BouncingBall", "Dahlquist", "Feedthrough", "Resource", "Stair", "StateSpace", "VanDerPol")


@pytest.mark.parametrize("name", mark_long(PUBLIC, ["Feedthrough", "StateSpace"]))
def test_a_public_fmu_does_what_its_own_results_say(name):
    """In co-simulation, of which its makers recorded them; arrays, truth values and texts among them."""
    found = compare(public(f"reference-fmus-3/{name}.fmu"))
    assert found.agrees
    assert found.worst.relative < 1e-12


@pytest.mark.parametrize(
    ("factor", "agrees", "place", "source"),
    [
        (1.0, True, f"{FOLDER}/decay.csv", "decay.csv"),
        (1.01, False, f"{FOLDER}/decay.csv", "./decay.csv"),
        (1.0, True, "resources/of one.csv", "../../resources/of%20one.csv"),
        (1.01, True, "resources/other_ref.csv", "../../resources/other_ref.csv"),
    ],
)
def test_results_are_compared_with_the_run(factor, agrees, place, source, tmp_path):
    """They lie where the manifest says, relative to itself; NAME_ref.csv beside it goes first."""
    path = fmu("dahlquist", 3, tmp_path)
    lines = [f"{t!r},{factor * math.exp(-t)!r}" for t in np.arange(0.0, 1.05, 0.1).tolist()]
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(MANIFEST, STATED.format(source))
        archive.writestr(place, "\n".join(["time,x", *lines]))
        if place.endswith("other_ref.csv"):
            lines = [f"{t!r},{math.exp(-t)!r}" for t in np.arange(0.0, 1.05, 0.1).tolist()]
            archive.writestr(f"{FOLDER}/decay_ref.csv", "\n".join(["time,x", *lines]))
            archive.writestr(
                f"{FOLDER}/decay_ref.opt", "StartTime,0\nStopTime,1\nStepSize,0.1\nRelTol,1e-3\n"
            )
    found = compare(path)
    assert found.agrees == agrees


NUMBERS = st.floats(-1e9, 1e9)


@given(st.lists(st.tuples(NUMBERS, NUMBERS, st.booleans()), min_size=1))
def test_numbers_arrays_and_truth_values_are_read(rows):
    lines = [f"{i},{a!r} {b!r},{str(c).lower()},text {i}" for i, (a, b, c) in enumerate(rows)]
    table = read_results("\n".join(["time,x,on,said", *lines]), "a.csv")
    assert list(table.columns) == ["x[1]", "x[2]", "on"]
    assert [tuple(row) for row in zip(*table.columns.values(), strict=True)] == rows


FAULTS = [
    ("time,x\n0,1,2\n", "must have a line of names"),
    ("time,x\n1,1\n0,1\n", "a time that never falls"),
    ("time,x\n0,word\n", "a variable that is a number"),
]


@pytest.mark.parametrize(("text", "said"), FAULTS)
def test_what_is_no_result_is_named(text, said):
    with pytest.raises(ComparisonError, match=f"^a.csv: .*{said}"):
        read_results(text, "a.csv")


@pytest.mark.parametrize(
    ("manifest", "said"),
    [
        (STATED.format("b.csv"), "names b.csv, which is not in"),
        ("<fmiReferences>", "cannot be read"),
        ("<!DOCTYPE a>" + STATED.format("a.csv"), "has a document type"),
    ],
)
def test_what_is_wrong_with_a_manifest_is_named(manifest, said):
    with pytest.raises(ComparisonError, match=said):
        find_results({SHORT: manifest, "a.csv": ""})


GOOD = Options(0.0, 2.0, 0.01, 1e-6, 0.1)


def test_what_is_written_is_read_back():
    rows = [[0.0, 1.0 / 3.0, -1e300], [0.5, 0.0, 5e-324], [0.5, 1.0, 2.0]]
    table = read_csv(csv_text(["time", "a[1]", "der(b)"], rows, 17), "x.csv")
    assert table.times.tolist() == [0.0, 0.5, 0.5]
    assert list(table.columns) == ["a[1]", "der(b)"]
    assert np.column_stack([*table.columns.values()]).tolist() == [row[1:] for row in rows]
    assert read_options(GOOD.text(), "x.opt") == GOOD


def test_options_as_others_write_them():
    """With comments and further elements, as in the rules' own example."""
    text = "StartTime, 0.0 // in seconds\nStopTime,1\nStepSize, 0\nRelTol, 0.0001\nSolverType, Fixed\n"
    assert read_options(text, "x.opt") == Options(0.0, 1.0, 0.0, 1e-4)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1 must have the names"),
        ('"time","a"\n', "has no numbers"),
        ('"time","a"\n0,1,2\n', "line 2 has 3 numbers: must be 2"),
        ('"time","a"\n0,1\n2,1\n1,1\n', "line 4: time falls"),
    ],
)
def test_a_bad_table_is_refused(text, message):
    with pytest.raises(ComparisonError, match=f"x.csv: .*{message}"):
        read_csv(text, "x.csv")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("StopTime, 2.0\n", "", "StopTime is missing"),
        ("StopTime, 2.0", "StopTime, two", "StopTime = two: must be a number"),
        ("StopTime, 2.0", "StopTime, nan", "StopTime is missing: it must be a finite number"),
        ("StepSize, 0.01", "StepSize, 5", "StepSize = 5 s: must be from 0 to 2 s"),
        ("RelTol, 1e-06", "RelTol, -1", "RelTol = -1: must not be negative"),
    ],
)
def test_bad_options_are_refused(old, new, message):
    assert old in GOOD.text()
    with pytest.raises(ComparisonError, match=f"x.opt: {message}"):
        read_options(GOOD.text().replace(old, new), "x.opt")


# Of the roles of FMI-LS-REF those that are used.
ROLES = {"testcase", "result", "document"}


@pytest.mark.parametrize("name", mark_long(REFERENCED, ["falling_mass", "flywheel"]))
def test_the_manifest_tells_of_every_file_and_of_no_other(name, referenced):
    with zipfile.ZipFile(referenced[name]) as archive:
        root = ElementTree.fromstring(archive.read(MANIFEST))
        there = {n.removeprefix(FOLDER + "/") for n in archive.namelist() if n.startswith(FOLDER)}
    assert root.tag == "fmiReferences"
    check_manifest(
        root, FOLDER, "Layered Standard providing information on related files included in an FMU."
    )
    told = {related.get("source"): related.get("role") for related in root.iter("Related")}
    assert set(told) == there - {"fmi-ls-manifest.xml"}
    assert set(told) == {"README.md", f"{name}_in.csv", f"{name}_ref.csv", f"{name}_ref.opt"}
    assert set(told.values()) == ROLES
    assert told[f"{name}_ref.csv"] == "result"


def test_other_sizes_have_no_reference(tmp_path):
    """Eight coil masses move otherwise than two."""

    def ships(name, **structure):
        with zipfile.ZipFile(build(name, tmp_path, structure)) as archive:
            return MANIFEST in archive.namelist()

    assert ships("valve_spring", coil_masses=2)
    assert not ships("valve_spring", coil_masses=8)
