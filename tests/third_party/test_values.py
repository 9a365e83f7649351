"""Values for third-party FMUs: numbers in the FMU's unit, enumerations, texts, arrays; what does not fit."""

import numpy as np
import pytest

from fmus.fmi.validate import info
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load
from orchestrator.scenario.values import find_place
from orchestrator.scenario.warnings import list_warnings

from .c_fmus import describe2, fmu, real2
from .models import MODELS, Model, V
from .runs import completed, ran, scenario

VERSIONS = (2, 3)
TAKEN = "components.one.start.length = 0.002 mm: numbers without a unit are in the FMU's"
MILLIMETRES = [(0.002, 0.002, True), ("2 um", 0.002, False), ("0.002 m", 2.0, False)]


@pytest.mark.parametrize(
    ("version", "value", "millimetres", "named"), [(2 + i % 2, *case) for i, case in enumerate(MILLIMETRES)]
)
def test_a_number_without_a_unit_is_in_the_fmus_and_named(version, value, millimetres, named, tmp_path):
    one = scenario({"one": {"participant": fmu("stretched", version, tmp_path), "start": {"length": value}}})
    (told,) = list_warnings(one) or [""]
    assert told.startswith(TAKEN) if named else not told
    _, found = ran(one, tmp_path / "out")
    assert found["one.length"][0] == pytest.approx(millimetres, rel=1e-15)
    assert load(tmp_path / "out" / "scenario.toml") == one


def test_numbers_in_si_units_and_zeros_are_not_named(tmp_path):
    """0 mm is 0 m; 0 degC is not 0 K."""
    tables = {
        "ball": {"participant": fmu("ball", 2, tmp_path), "start": {"body.h": 0.002}},
        "one": {"participant": fmu("stretched", 2, tmp_path), "start": {"length": 0.0}},
    }
    assert list_warnings(scenario(tables)) == []


def test_a_start_time_other_than_the_runs_is_named(tmp_path):
    file = describe2(tmp_path / "late.fmu", "", head='<DefaultExperiment startTime="5"/>')
    told = list_warnings(scenario({"one": {"participant": file}}))
    assert any("one: its default experiment begins at t = 5 s, the run at 0" in line for line in told)


@pytest.mark.parametrize(("version", "value", "number"), [(2, "other", 9), (3, "brass", 2), (3, 2, 2)])
def test_items_are_given_by_name_or_number(version, value, number, tmp_path):
    table = {"participant": fmu("stretched", version, tmp_path), "parameters": {"material": value}}
    found = completed(scenario({"one": table}, stop_time=0.02), tmp_path / "out")
    np.testing.assert_array_equal(found["one.number"], number)


@pytest.mark.parametrize("version", VERSIONS)
def test_what_is_told_of_a_file_has_ranges_and_items(version, tmp_path, monkeypatch):
    """And no word of what the file does not say."""
    ranged = V("length", "output", 1.0, unit="mm", initial="exact", more='min="0.5" max="20"')
    material = next(v for v in MODELS["stretched"].variables if v.name == "material")
    monkeypatch.setitem(MODELS, "ranged", Model((ranged, material)))
    shown = str(info(fmu("ranged", version, tmp_path))).splitlines()
    assert shown[1].split() == ["model", "ranged"]
    assert not [line for line in shown if line.startswith("by ") or "licence" in line]
    (length,) = (line for line in shown if line.startswith("length "))
    assert "0.5..20" in length.split()
    (at,) = (place for place, line in enumerate(shown) if line.startswith("material "))
    assert "(steel = 1, brass = 2, other = 9)" in " ".join(shown[at : at + 2])


KNOWN = r"must be one of steel, brass, other, or their numbers \(1, 2, 9\)"
# The FMU, the table and its values, and what is said.
REFUSED = [
    ("dahlquist", "parameters", {"K": 1.0}, r"\.K: no such parameter"),
    ("dahlquist", "parameters", {"k": "8 mm"}, "states no unit; write a plain number"),
    ("dahlquist", "structure", {"n": 3}, "structure.n: .*leave it out"),
    ("reading", "parameters", {"table file": 8.0}, r"file = 8\.0 \(String\): must be a string"),
    ("reading", "parameters", {"table file": "a\0b"}, "without null characters"),
    ("reading", "parameters", {"raw": "0ff"}, r"raw = .0ff. \(Binary\): must be pairs of hexadecimal digits"),
    ("reading", "parameters", {"scale": "much"}, "scale.*much"),
    ("sized", "structure", {"m": 3}, "structure.m: no such structural parameter; .*n"),
    ("sized", "structure", {"n": 5}, r"structure.n = 5 \(n\): must be at least 1 and at most 4"),
    ("sized", "structure", {"n": 3}, "parameters.x0: has 3 elements .* give all of them"),
    ("sized", "parameters", {"x0": [1.0]}, r"parameters.x0 = \[1.0\]: must have 2 values"),
    ("sized", "parameters", {"x0": [[1.0], [2.0]]}, "parameters.x0 = .*: must have 2 values"),
    ("sized", "parameters", {"n": 3}, "parameters.n: no such parameter; it belongs in structure"),
    (
        "stretched",
        "parameters",
        {"material": "stel"},
        rf"'stel' \(material\): did you mean steel\? It {KNOWN}",
    ),
    ("stretched", "parameters", {"material": 1.5}, rf"material = 1\.5 \(material\): {KNOWN}"),
    ("stretched", "parameters", {"material": True}, rf"material = True \(material\): {KNOWN}"),
    ("stretched", "start", {"material": 2}, "material: no such state; it belongs in parameters"),
    ("stretched", "inputs", {"length": 2}, "length: no such input; it belongs in start"),
    ("stretched", "inputs", {"force": 2}, "force: no such input; leave it out$"),
]


@pytest.mark.parametrize(("name", "table", "values", "said"), REFUSED)
def test_a_value_that_does_not_fit_is_named(name, table, values, said, tmp_path):
    with pytest.raises(ScenarioError, match=said):
        scenario({"one": {"participant": fmu(name, 3, tmp_path), table: values}})


def test_a_state_that_a_parameter_starts_is_led_to_it():
    said = find_place("position", {"inputs": [], "parameters": ["position_start"]}, "leave it out")
    assert said == "did you mean position_start, in parameters?"


ODD = "µ/a \"b\" 'c' \\ #.csv"


@pytest.mark.parametrize(
    ("version", "process", "text"), [(3, "shared", ""), (2, "shared", "8 mm"), (3, "own", ODD)]
)
def test_a_text_arrives_in_utf_8(version, process, text, tmp_path):
    """Also one that would be a value with a unit elsewhere, and by the run's own scenario file."""
    path, raw = fmu("reading", version, tmp_path), text.encode()
    table = {"participant": path, "process": process, "parameters": {"table file": text, "scale": 2.0}}
    found = completed(scenario({"one": table}, stop_time=0.02), tmp_path / "out")
    assert set(found["one.length"]) == {2.0 * len(raw)}
    first, second = (raw + b"\0\0")[:2]
    assert (found["one.first"][0], found["one.second"][0]) == (first, second)
    _, again = ran(load(tmp_path / "out" / "scenario.toml"), tmp_path / "again")
    np.testing.assert_array_equal(again["one.length"], found["one.length"])


def test_structural_parameters_set_the_sizes_of_arrays(tmp_path):
    """dx/dt = u with three states in the place of two: x = x0 + u t. The written scenario is equal."""
    table = {
        "participant": fmu("sized", 3, tmp_path),
        "process": "own",
        "structure": {"n": 3},
        "parameters": {"x0": [1.0, -2.0, 0.5]},
        "inputs": {"u": [0.25, 0.5, -1.0]},
    }
    one = scenario({"one": table})
    found = completed(one, tmp_path / "out")
    assert "one.y[4]" not in found
    for i, (start, slope) in enumerate(((1.0, 0.25), (-2.0, 0.5), (0.5, -1.0)), 1):
        np.testing.assert_allclose(
            found[f"one.y[{i}]"], start + slope * found["time"], rtol=1e-13, atol=1e-13
        )
    assert load(tmp_path / "out" / "scenario.toml") == one


def test_connections_reach_elements_that_a_structural_parameter_added(tmp_path):
    """Of a chain of integrals the second is of order two in time; exact, as the means of a line are."""
    path = fmu("sized", 3, tmp_path)
    size = {"participant": path, "structure": {"n": 3}}
    tables = {
        "one": size | {"parameters": {"x0": [0.0, 0.0, 1.0]}, "inputs": {"u": [0.0, 0.0, 2.0]}},
        "two": size | {"parameters": {"x0": [0.0, 0.0, 0.0]}},
    }
    one = scenario(tables, connections=["one.y[3] -> two.u[3]"], master={"name": "gauss_seidel"})
    _, found = ran(one, tmp_path / "out")
    np.testing.assert_allclose(found["two.y[3]"], found["time"] + found["time"] ** 2, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("causality", "said"), [("local", 0), ("output", 1)])
def test_the_last_fmu_of_a_chain_is_no_fault(causality, said, tmp_path):
    """One without outputs records what arrives; the outputs of another are its result."""
    source = describe2(tmp_path / "a.fmu", real2("y", 0, "output"))
    sink = describe2(tmp_path / "b.fmu", real2("u", 0, "input", 'start="0"') + real2("seen", 1, causality))
    tables = {"a": {"participant": source}, "b": {"participant": sink}}
    found = list_warnings(scenario(tables, connections=["a.y -> b.u"]))
    assert [line for line in found if "nothing" in line] == said * [
        "components.b: drives nothing: no output is connected or has a tolerance; connect one of seen"
    ]
