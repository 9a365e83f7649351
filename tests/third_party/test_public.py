"""Every public FMU at hand runs, or is refused with its reason before anything is written."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fmus.fmi.validate import info
from models.core.difference import difference, time_weights
from models.oscillators.exact import quarter_car
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.warnings import list_warnings

from ..archives import rename_files, repack, replace_text
from ..fmus.names import mark_long
from .c_fmus import fmu
from .public import public
from .runs import ran, scenario

# Of other tools each, and one of FMI 3.0.
ALWAYS = ("ecos/ControlledTemperature", "fmpy/Controller", "reference-fmus-3/Roberts")
RUNNING = (
    "ecos/ControlledTemperature", "fmpy/Controller", "fmpy/Drivetrain", "quarter_truck/Chassis",
    "quarter_truck/Wheel", "reference-fmus-2/BouncingBall", "reference-fmus-2/Dahlquist",
    "reference-fmus-2/Feedthrough", "reference-fmus-2/Resource", "reference-fmus-2/Stair",
    "reference-fmus-2/VanDerPol", "reference-fmus-3/BouncingBall", "reference-fmus-3/Dahlquist",
    "reference-fmus-3/Feedthrough", "reference-fmus-3/Resource", "reference-fmus-3/Roberts",
    "reference-fmus-3/Stair", "reference-fmus-3/StateSpace", "reference-fmus-3/VanDerPol",
)  # fmt: skip


@pytest.mark.parametrize("name", mark_long(RUNNING, ALWAYS))
def test_a_public_fmu_runs(name: str, tmp_path: Path) -> None:
    """A second in its own process; all its numbers are finite."""
    table = {"participant": public(f"{name}.fmu"), "process": "own"}
    summary, found = ran(scenario({"one": table}), tmp_path / "out")
    assert summary.complete, summary.message
    assert len(found["time"]) == 101
    assert all(np.all(np.isfinite(column)) for column in found.values())


@pytest.mark.parametrize(
    ("steps", "stop", "changes"),
    [
        ("1 ms", 2.0, {}),
        pytest.param("steps controlled to 1e-4", 1.0, {"step_control": {}}, marks=pytest.mark.long),
    ],
)
def test_the_error_of_a_public_quarter_truck_is_the_true_one(
    steps: str, stop: float, changes: dict[str, Any], tmp_path: Path, record: Any
) -> None:
    """Two FMUs of another tool against the matrix exponential. Their own solvers' tolerance is 1e-4."""
    one = scenario(
        {
            "chassis": {"participant": public("quarter_truck/Chassis.fmu")},
            "wheel": {"participant": public("quarter_truck/Wheel.fmu")},
        },
        connections=["chassis.velocity -> wheel.in_vel", "wheel.out_spring_damper_f -> chassis.force"],
        stop_time=stop,
        macro_step=1e-3,
        reference={},
        tolerance={"chassis.position": 1e-2},
        **changes,
    )
    summary, found = ran(one, tmp_path / "out")
    error = summary.errors["chassis.position"]
    weights = time_weights(found["time"])
    true = difference(found["chassis.position"], quarter_car(found["time"])[:, 0], weights=weights)
    case = f"public quarter truck, {steps}: relative RMS error of chassis.position by refinement"
    own = error.uncertainty.relative_rms + 1e-4
    record("FMUs", case, error.relative_rms, true.relative_rms, "matrix exponential", tolerance=own)


def test_an_fmu_for_scheduled_execution_is_refused() -> None:
    table = {"participant": public("reference-fmus-3/Clocks.fmu")}
    with pytest.raises(ScenarioError, match=r"for scheduled execution only, .* take FMUs for co-simulation"):
        scenario({"one": table})
    assert info(public("reference-fmus-3/Clocks.fmu")).kinds == ("scheduled execution",)


def test_the_only_library_is_taken_whatever_its_name(tmp_path: Path) -> None:
    """With a notice; of two, none is."""
    plain = fmu("dahlquist", 2, tmp_path)
    other = rename_files(plain, tmp_path / "a.fmu", "dahlquist.so", "other.so")
    one = scenario({"one": {"participant": other}})
    assert any("other.so, the only library" in line for line in list_warnings(one))
    _, found = ran(one, tmp_path / "out")
    np.testing.assert_allclose(found["one.x"], np.exp(-found["time"]), rtol=1e-12)

    def add(name: str, content: bytes) -> dict[str, bytes]:
        return {name: content, name.replace("other.so", "second.so"): content}

    two = scenario({"one": {"participant": repack(other, tmp_path / "b.fmu", add)}})
    with pytest.raises(ScenarioError, match=r"dahlquist\.so, its modelIdentifier, but .*second\.so"):
        ran(two, tmp_path / "none")


def test_what_is_inside_is_recorded_of_an_fmu_without_outputs(tmp_path: Path) -> None:
    plain = fmu("dahlquist", 2, tmp_path)
    path = replace_text(plain, tmp_path / "inside.fmu", 'causality="output"', 'causality="local"')
    _, found = ran(scenario({"one": {"participant": path}}), tmp_path / "out")
    np.testing.assert_allclose(found["one.x"], np.exp(-found["time"]), rtol=1e-12)
