"""FMUs of others for co-simulation as participants, those of FMI 1.0 too."""

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import simulate_fmu

from orchestrator.engine.compiled_sweeps import CompiledSweep
from orchestrator.participants.description import read_description
from orchestrator.participants.fmu import FmuParticipant, FmuSettings
from orchestrator.participants.in_own_process import InOwnProcess
from orchestrator.participants.protocol import BoundVariables
from orchestrator.participants.third_party import read_component
from orchestrator.store.result_file import open_result

from .c_fmus import fmu, library
from .runs import CASES, completed, ran, scenario

VERSIONS, PROCESSES = (2, 3), ("shared", "own")
EPSILON = 2.0**-52


@pytest.mark.parametrize(("version", "process"), CASES)
def test_decay_is_the_closed_form(version, process, tmp_path, record):
    """Of a given rate from a given start: a rounding for each of 100 steps, of product and exponential."""
    path = fmu("dahlquist", version, tmp_path)
    table = {"participant": path, "process": process, "parameters": {"k": 3.0}, "start": {"x": 0.5}}
    summary, found = ran(scenario({"decay": table}), tmp_path / "out")
    assert summary.complete
    assert summary.exit_status == 0
    quantity, exact = f"third-party FMU, FMI {version}: decay", 0.5 * np.exp(-3.0 * found["time"])
    record("FMUs", quantity, found["decay.x"], exact, "x0 exp(-k t)", relative=200 * EPSILON)


@pytest.mark.parametrize("version", VERSIONS)
def test_an_fmu_alone_does_what_it_does_in_another_master(version, tmp_path):
    """Names with dots and brackets; to the last bit."""
    path = fmu("ball", version, tmp_path)
    changed = {"e": 0.8, "body.h": 2.0}
    table = {"participant": path, "parameters": {"e": 0.8}, "start": {"body.h": 2.0}}
    _, found = ran(scenario({"ball": table}), tmp_path / "out")
    expected = simulate_fmu(
        path, stop_time=1.0, output_interval=0.01, start_values=changed, fmi_type="CoSimulation"
    )
    for name in ("body.h", "body.v"):
        np.testing.assert_array_equal(found[f"ball.{name}"], expected[name])


def coupled(version: int, process: str, tmp_path: Path, **changes: Any) -> dict[str, np.ndarray]:
    """A driven oscillator and a ball whose velocity drives it."""
    files = {name: fmu(name, version, tmp_path) for name in ("vanderpol", "ball")}
    tables = {name: {"participant": path, "process": process} for name, path in files.items()}
    out = tmp_path / f"{process}{len(list(tmp_path.iterdir()))}"
    lines = ["ball.body.v * 1 -> vanderpol.force"]
    return completed(scenario(tables, connections=lines, **changes), out)


MASTERS: dict[str, dict[str, Any]] = {
    "jacobi": {"master": {"name": "jacobi", "extrapolation": "linear"}},
    "gauss_seidel": {"master": {"name": "gauss_seidel", "extrapolation": "quadratic"}},
    "iterated": {"master": {"name": "iterated", "extrapolation": "hermite"}},
    "control": {
        "master": {"name": "jacobi", "extrapolation": "linear"},
        "step_control": {"estimator": "step_doubling", "relative": 1e-2, "minimum_step": 1e-9},
        "stop_time": 0.3,
    },
}


# Each starts two processes.
@pytest.mark.parametrize(
    ("version", "master"),
    [(3, "iterated"), *(pytest.param(2, master, marks=pytest.mark.long) for master in MASTERS)],
)
def test_a_process_of_its_own_changes_no_bit(version, master, tmp_path):
    """Whatever the master saves, restores and exchanges."""
    shared, own = (coupled(version, process, tmp_path, **MASTERS[master]) for process in PROCESSES)
    assert shared.keys() == own.keys()
    for name in shared:
        np.testing.assert_array_equal(own[name], shared[name])


@pytest.mark.parametrize("version", VERSIONS)
def test_outputs_that_are_right_after_initialisation_are_exchanged(version, tmp_path):
    """The first record is consistent, the first step has the input of that time: exactly, for it stays."""
    tables = {
        "late": {"participant": fmu("late", version, tmp_path), "parameters": {"x0": 0.25}},
        "through": {"participant": fmu("feedthrough", version, tmp_path), "parameters": {"offset": 2.0}},
    }
    for master in (
        {"name": "jacobi", "extrapolation": "hold"},
        {"name": "iterated", "extrapolation": "hermite"},
    ):
        one = scenario(tables, connections=["late.x -> through.real in"], master=master, stop_time=0.02)
        found = completed(one, tmp_path / master["name"])
        assert found["late.x"].tolist() == [0.25] * 3
        assert found["through.real out"].tolist() == [2.25] * 3


def test_a_serialised_state_goes_on_in_another_process(tmp_path):
    """As a resumed run has it."""
    path, rows = fmu("vanderpol", 3, tmp_path), []
    units = [InOwnProcess("one", path, FmuSettings(["x", "v"], {"mu": 2.0})) for _ in range(2)]
    try:
        for unit in units:
            outputs = np.zeros(2)
            unit.connect(BoundVariables(["force"], np.ones((1, 1)), ["x", "v"], outputs, np.zeros(0)))
            unit.initialise(0.0, 1.0)
            unit.finish_initialisation()
            unit.write()
        units[0].advance(0.0, 0.25)
        data = units[0].to_bytes(units[0].save())
        units[1].restore(units[1].from_bytes(data))
        for unit in units:
            unit.write()
            unit.advance(0.25, 0.25)
            unit.read_all(outputs)
            rows.append(outputs.tolist())
    finally:
        for unit in units:
            unit.close()
    assert rows[0] == rows[1]
    # By themselves, and so with their own status: nobody has to wait and end them.
    assert [unit._process.returncode for unit in units] == [0, 0]


@pytest.mark.parametrize("kind", [InOwnProcess, FmuParticipant])
def test_a_saved_state_has_the_inputs_that_were_written(kind, tmp_path):
    unit = kind("one", fmu("feedthrough", 3, tmp_path), FmuSettings(["real out"]))
    inputs, outputs = np.zeros((1, 1)), np.zeros(1)
    try:
        unit.connect(BoundVariables(["real in"], inputs, ["real out"], outputs, np.zeros(0)))
        unit.initialise(0.0, 1.0)
        unit.finish_initialisation()
        inputs[:] = 3.0
        unit.write()
        saved = unit.save()
        inputs[:] = 5.0
        unit.write()
        unit.restore(saved)
        unit.read()
        unit.release(saved)
    finally:
        unit.close()
    assert outputs[0] == 3.0


def test_both_versions_of_fmi_give_the_same(tmp_path, monkeypatch):
    """The models are the same C; compiled code makes the calls of both."""
    made = []
    run_pass = CompiledSweep.__call__
    monkeypatch.setattr(
        CompiledSweep, "__call__", lambda *arguments: (made.append(1), run_pass(*arguments))[1]
    )
    one, other = (coupled(version, "shared", tmp_path, **MASTERS["gauss_seidel"]) for version in VERSIONS)
    assert len(made) >= 200
    for name in one:
        np.testing.assert_array_equal(one[name], other[name])


@pytest.mark.parametrize(("version", "process"), CASES)
def test_whole_numbers_and_truth_values_are_exchanged(version, process, tmp_path):
    stair, through = fmu("stair", version, tmp_path), fmu("feedthrough", version, tmp_path)
    tables = {
        "stair": {"participant": stair},
        "first": {
            "participant": through,
            "process": process,
            "parameters": {"count": 3, "negate": True, "offset": 0.5},
            "inputs": {"real in": 2.0},
        },
        "second": {"participant": through},
    }
    lines = [
        "stair.counter -> first.whole_in",
        "first.whole_out -> second.whole_in",
        "first.truth_out -> second.truth_in",
        "first.real out -> second.real in",
    ]
    one = scenario(tables, connections=lines, stop_time=3.0, macro_step=0.25, master={"name": "jacobi"})
    _, found = ran(one, tmp_path / "out")
    counted = np.floor(found["time"] + 1e-9)
    np.testing.assert_array_equal(found["stair.counter"], counted)
    # Held inputs: what comes in over two connections is two steps old.
    np.testing.assert_array_equal(found["first.whole_out"][1:], 3 + counted[:-1])
    np.testing.assert_array_equal(found["second.whole_out"][2:], 3 + counted[:-2])
    np.testing.assert_array_equal(found["second.truth_out"], 1.0)
    np.testing.assert_array_equal(found["second.real out"], 2.5)


def test_variables_have_any_names(tmp_path):
    """In both result files. NetCDF has no slash in a name; a division slash stands for it."""
    odd = 'a/b "c", [µ] <->'
    table = {"participant": fmu("named", 3, tmp_path), "start": {odd: 3.0}}
    found = completed(scenario({"one": table}), tmp_path / "out")
    assert set(found) == {"time", f"one.{odd}", "one.der(x)"}
    np.testing.assert_array_equal(found[f"one.{odd}"], 3.0)
    with open_result(tmp_path / "out") as result:
        assert np.all(result["coupled"][f"one.{odd.replace('/', '∕')}"] == 3.0)


def test_arrays_are_their_elements(tmp_path):
    """y = A x with dx/dt = u, set and connected element by element; the others start as they do."""
    tables = {
        "vector": {
            "participant": fmu("vector", 3, tmp_path),
            "parameters": {"x0[2]": 5.0, "A[1,2]": 10.0},
            "inputs": {"u[1]": 1.0},
        },
        "decay": {"participant": fmu("dahlquist", 3, tmp_path), "parameters": {"k": 0.0}},
    }
    one = scenario(tables, connections=["decay.x * 2 -> vector.u[2]"])
    _, found = ran(one, tmp_path / "out")
    t = found["time"]
    # A hundred additions of h u.
    np.testing.assert_allclose(found["vector.y[1]"], (1.0 + t) + 10.0 * (5.0 + 2.0 * t), rtol=200 * EPSILON)
    np.testing.assert_allclose(found["vector.y[2]"], 5.0 + 2.0 * t, rtol=200 * EPSILON)


def test_units_are_converted_where_both_ends_state_them(tmp_path):
    """m to mm, degC to K; an input that states none takes the number as it is, and so does a factor."""
    shaft, through = fmu("shaft", 2, tmp_path), fmu("feedthrough", 3, tmp_path)
    tables = {
        "meter": {"participant": through, "inputs": {"real in": 0.25}},
        "one": {"participant": shaft},
        "other": {"participant": shaft},
    }
    lines = ["meter.real out -> one.height", "one.air -> other.wall", "one.speed -> other.bare"]
    one = scenario(tables, connections=lines, master={"name": "jacobi", "extrapolation": "hold"})
    _, found = ran(one, tmp_path / "out")
    np.testing.assert_allclose(found["one.reached"], 250.0, rtol=2 * EPSILON)
    np.testing.assert_allclose(found["other.felt"], 293.15, rtol=2 * EPSILON)
    np.testing.assert_array_equal(found["other.given"][1:], found["one.speed"][:-1])
    one = scenario(
        {"one": {"participant": shaft}, "other": {"participant": shaft}},
        connections=["one.air * 0.5 - 3 -> other.height"],
    )
    assert one.connections == ["one.air * 0.5 - 3.0 -> other.height"]
    np.testing.assert_array_equal(ran(one, tmp_path / "factor")[1]["other.reached"], 7.0)


def test_a_step_that_returns_early_is_gone_on_with(tmp_path):
    early, whole = (
        ran(scenario({"decay": {"participant": fmu(name, 3, tmp_path)}}), tmp_path / name)[1]["decay.x"]
        for name in ("early", "dahlquist")
    )
    np.testing.assert_allclose(early, whole, rtol=400 * EPSILON)


def test_the_shortest_scenario_is_a_file(tmp_path):
    component = read_component(fmu("feedthrough", 3, tmp_path))
    assert component.parameters.names == ("offset", "count", "negate")
    assert component.feedthrough["real out"] == ("real in",)
    assert component.inputs.field("real in").quantity.unit == "m"
    one = scenario(
        {"through": {"participant": fmu("feedthrough", 3, tmp_path), "inputs": {"real in": "8 mm"}}}
    )
    assert one.components["through"].inputs == {"real in": 8e-3}


SHELL = Path(__file__).with_name("shell1.c")
DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="1.0" modelName="decay1" modelIdentifier="decay1"
 guid="{1e0f7c2a-1111-4b6e-9d50-5d1c0fa3c0de}" numberOfContinuousStates="0" numberOfEventIndicators="0">
<DefaultExperiment startTime="0" stopTime="1"/>
<ModelVariables>
<ScalarVariable
 name="x" valueReference="0" causality="output"><Real start="1"/>
<DirectDependency/></ScalarVariable>
<ScalarVariable
 name="k" valueReference="1" variability="parameter"><Real start="1"/></ScalarVariable>
<ScalarVariable
 name="u" valueReference="2" causality="input"><Real start="0"/></ScalarVariable>
<ScalarVariable
 name="y" valueReference="3" causality="output"><Real/>
<DirectDependency><Name>u</Name></DirectDependency></ScalarVariable>
<ScalarVariable
 name="limit" valueReference="4" variability="parameter"><Real start="-1e300"/></ScalarVariable>
<ScalarVariable
 name="n" valueReference="0" causality="output" variability="discrete">
<Integer/></ScalarVariable>
<ScalarVariable
 name="on" valueReference="0" causality="output" variability="discrete">
<Boolean/></ScalarVariable>
<ScalarVariable
 name="minus" valueReference="0" causality="output" alias="negatedAlias"><Real/></ScalarVariable>
</ModelVariables>
<Implementation><CoSimulation_StandAlone>
<Capabilities canHandleVariableCommunicationStepSize="true"/>
</CoSimulation_StandAlone></Implementation></fmiModelDescription>
"""


@pytest.fixture
def decay(tmp_path: Path) -> Path:
    path = tmp_path / "decay1.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.writestr("binaries/linux64/decay1.so", library("decay1", lambda _: [str(SHELL)]))
    return path


def test_a_description_says_what_the_file_says(decay: Path) -> None:
    about = read_description(decay)
    assert (about.version, about.variable_step, about.restorable) == ("1.0", True, False)
    assert about.depends == {"x": (), "y": ("u",)}
    assert [v.name for v in about.variables.values() if v.causality == "parameter"] == ["k", "limit"]
    assert "minus" not in about.variables


@pytest.mark.parametrize("process", ["shared", "own"])
def test_its_motion_is_exact(process: str, decay: Path, tmp_path: Path) -> None:
    """x' = -k x + u with values of all kinds; numbers of other types too."""
    table = {"participant": decay, "process": process, "parameters": {"k": 2.0}, "inputs": {"u": 0.5}}
    _, found = ran(scenario({"one": table}), tmp_path / "out")
    exact = 0.25 + 0.75 * np.exp(-2.0 * found["time"])
    np.testing.assert_allclose(found["one.x"], exact, rtol=1e-12)
    np.testing.assert_allclose(found["one.y"], exact + 0.5, rtol=1e-12)
    assert np.array_equal(found["one.n"], np.arange(101.0))
    assert np.array_equal(found["one.on"], exact > 0.5)


def test_coupled_ones_get_means_and_are_of_second_order(decay: Path, tmp_path: Path) -> None:
    """x' = -x + z, z' = -z: (1 + t) e^-t; refinement finds the order and the error."""
    errors = []
    for step in (0.02, 0.01):
        one = scenario(
            {"first": {"participant": decay}, "second": {"participant": decay}},
            connections=["first.x -> second.u"],
            macro_step=step,
            reference={},
            tolerance={"second.x": 1.0},
            master={"name": "jacobi", "extrapolation": "linear"},
        )
        summary, found = ran(one, tmp_path / f"{step:g}")
        t = found["time"]
        errors.append(float(np.max(np.abs(found["second.x"] - (1.0 + t) * np.exp(-t)))))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
    error = summary.errors["second.x"]
    assert error.order == pytest.approx(2.0, abs=0.1)
    assert error.max_abs == pytest.approx(errors[1], rel=0.02)


def test_a_step_that_it_discards_ends_the_run_with_its_words(decay: Path, tmp_path: Path) -> None:
    table = {"participant": decay, "parameters": {"limit": 0.5}}
    summary, found = ran(scenario({"one": table}), tmp_path / "out")
    assert summary.exit_status == 3
    # The last attempt is one of the shortest steps, over which x falls by less than 5e-6.
    refused = float(summary.message.partition("x would be ")[2].partition(";")[0])
    assert 0.5 - 5e-6 < refused < 0.5
    assert found["time"][-1] == pytest.approx(0.69)
