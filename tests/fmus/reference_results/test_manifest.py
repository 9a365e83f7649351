"""Files of reference results and manifests of FMI-LS-REF: what others ship, and what breaks the rules."""

import math
import re
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fmus.build import build
from fmus.reference_results.compare import compare, find_results, read_results
from fmus.reference_results.files import ComparisonError, Options, csv_text, read_csv, read_options
from fmus.reference_results.inside import FOLDER, MANIFEST
from tests.fmus.names import REFERENCED, mark_long
from tests.third_party.c_fmus import fmu
from tests.third_party.public import public

SHORT = MANIFEST.removeprefix(FOLDER + "/")
STATED = '<fmiReferences><Related type="text/csv" source="{}" role="result"/></fmiReferences>'
PUBLIC = ("BouncingBall", "Dahlquist", "Feedthrough", "Resource", "Stair", "StateSpace", "VanDerPol")


@pytest.mark.parametrize("name", mark_long(PUBLIC, ["Feedthrough", "StateSpace"]))
def test_a_public_fmu_does_what_its_own_results_say(name):
    """In co-simulation, of which its makers recorded them; arrays, truth values and texts among them."""
    found = compare(public(f"reference-fmus-3/{name}.fmu"))
    assert found.agrees
    assert found.worst.relative < 1e-12


@pytest.mark.parametrize(("factor", "agrees"), [(1.0, True), (1.01, False)])
def test_results_are_compared_with_the_run(factor, agrees, tmp_path):
    path = fmu("dahlquist", 3, tmp_path)
    lines = [f"{t!r},{factor * math.exp(-t)!r}" for t in np.arange(0.0, 1.05, 0.1).tolist()]
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(MANIFEST, STATED.format("decay.csv"))
        archive.writestr(f"{FOLDER}/decay.csv", "\n".join(["time,x", *lines]))
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
        ('"time","a"\n0,x\n', "line 2 must be finite numbers"),
        ('"time","a"\n0,inf\n', "line 2 must be finite numbers"),
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
        ("StopTime, 2.0", "StopTime, -1", "StopTime = -1 s: must be later than StartTime = 0 s"),
        ("StepSize, 0.01", "StepSize, 5", "StepSize = 5 s: must be from 0 to 2 s"),
        ("RelTol, 1e-06", "RelTol, -1", "RelTol = -1: must not be negative"),
    ],
)
def test_bad_options_are_refused(old, new, message):
    assert old in GOOD.text()
    with pytest.raises(ComparisonError, match=f"x.opt: {message}"):
        read_options(GOOD.text().replace(old, new), "x.opt")


# The standard's roles, version 1.0.0-alpha.1, of those that are used.
ROLES = {"testcase", "result", "document"}
LAYERED = "{http://fmi-standard.org/fmi-ls-manifest}"


@pytest.mark.parametrize("name", mark_long(REFERENCED))
def test_the_manifest_tells_of_every_file_and_of_no_other(name, referenced):
    with zipfile.ZipFile(referenced[name]) as archive:
        root = ElementTree.fromstring(archive.read(MANIFEST))
        there = {n.removeprefix(FOLDER + "/") for n in archive.namelist() if n.startswith(FOLDER)}
    assert root.tag == "fmiReferences"
    assert root.get(f"{LAYERED}fmi-ls-name") == FOLDER.removeprefix("extra/")
    assert root.get(f"{LAYERED}fmi-ls-description")
    assert re.fullmatch(r"\d+\.\d+\.\d+(-.+)?", root.get(f"{LAYERED}fmi-ls-version", ""))
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
