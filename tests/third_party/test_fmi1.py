"""Co-simulation FMUs of FMI 1.0."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from orchestrator.participants.description import read_description

from .c_fmus import library
from .runs import ran, scenario

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
    assert "x would be 0.496585" in summary.message
    assert found["time"][-1] == pytest.approx(0.69)
