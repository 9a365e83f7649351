"""Every public FMU at hand runs, or is refused; the errors that coupled ones report are the true ones.

Of coupled ones a linear system of three states (StateSpace, model exchange) is driven by others or its like.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from fmus.fmi.validate import info
from models.core.difference import difference, time_weights
from orchestrator.scenario import Scenario, ScenarioError
from orchestrator.scenario.warnings import list_warnings
from tests.models.exact_oscillators import quarter_car

from ..archives import rename_files, repack, replace_text
from ..fmus.names import mark_long
from .c_fmus import fmu
from .runs import completed, public, ran, scenario

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
    found = completed(scenario({"one": table}), tmp_path / "out")
    assert len(found["time"]) == 101
    assert all(np.all(np.isfinite(column)) for column in found.values())


def quarter_truck(stop: float, **changes: Any) -> Scenario:
    return scenario(
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


def test_the_error_of_a_public_quarter_truck_is_the_true_one(tmp_path: Path, record: Any) -> None:
    """Two FMUs of another tool against the matrix exponential. Their own solvers' tolerance is 1e-4."""
    summary, found = ran(quarter_truck(2.0), tmp_path / "out")
    error = summary.errors["chassis.position"]
    weights = time_weights(found["time"])
    true = difference(found["chassis.position"], quarter_car(found["time"])[:, 0], weights=weights)
    case = "public quarter truck, 1 ms: relative RMS error of chassis.position by refinement"
    own = error.uncertainty.relative_rms + 1e-4
    record("FMUs", case, error.relative_rms, true.relative_rms, "matrix exponential", tolerance=own)


def test_steps_are_not_repeated_with_a_public_fmu_that_saves_no_step_of_its_solver(tmp_path: Path) -> None:
    """After a saved state is restored its solver begins with another step: the outputs differ by 6e-6."""
    with pytest.raises(ScenarioError, match="wheel: the FMU does not come back to the state that it saved"):
        ran(quarter_truck(1.0, step_control={}), tmp_path / "out")


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


# Of the solutions that are integrated here.
EXACT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}
A = np.array([[0.0, 1.0, 0.0], [-9.0, -0.5, 0.0], [0.0, 0.0, -1.0]])
B = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])


def linear(**changes: Any) -> dict[str, Any]:
    """y = x, dx/dt = A x + B u, from rest; the second input is constant."""
    table = {
        "participant": public("reference-fmus-3/StateSpace.fmu"),
        "interface": "model_exchange",
        "parameters": {"A": A.tolist(), "B": B.tolist(), "D": np.zeros((3, 3)).tolist()},
        "inputs": {"u[2]": 0.0, "u[3]": 0.0},
    }
    return table | changes


def answer_step(times: np.ndarray) -> np.ndarray:
    """The first state of the linear system at these times, driven by 1 from t = 0 on."""

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        return np.asarray(A @ x + B[:, 0])

    return np.asarray(solve_ivp(rate, (0.0, times[-1]), np.zeros(3), t_eval=times, **EXACT).y[0])


def test_two_linear_systems_in_a_ring(tmp_path: Path, record: Any) -> None:
    """Each drives the other with its first state; a constant drives one. The reported error is that against
    the matrix exponential of both, within its uncertainty and what their solver misses, 1e-9."""
    one = scenario(
        {"driven": linear(inputs={"u[2]": 1.0, "u[3]": 0.0}), "filter": linear()},
        connections=["filter.y[1] -> driven.u[1]", "driven.y[1] -> filter.u[1]"], stop_time=3.0,
        macro_step=0.02, master={"name": "jacobi", "extrapolation": "linear"}, reference={},
        tolerance={"filter.y[1]": 1.0},
    )  # fmt: skip
    summary, found = ran(one, tmp_path / "out")
    assert summary.complete, summary.message
    whole = np.zeros((7, 7))
    whole[:3, :3] = whole[3:6, 3:6] = A
    whole[:3, 3] = whole[3:6, 0] = B[:, 0]
    whole[:3, 6] = B[:, 1]
    start = np.append(np.zeros(6), 1.0)
    true = np.array([(expm(whole * t) @ start)[3] for t in found["time"]])
    wanted, error = difference(found["filter.y[1]"], true).relative_rms, summary.errors["filter.y[1]"]
    name = "public StateSpace twice in a ring: relative RMS error of filter.y[1], as reported"
    tolerance = error.uncertainty.relative_rms + 1e-9
    record("FMUs", name, error.relative_rms, wanted, "independent solution", tolerance=tolerance)
    assert wanted > 1e-8  # else nothing is compared


def test_time_events_of_one_fmu_are_seen_by_another_at_their_instants(tmp_path: Path, record: Any) -> None:
    """The stair's counter in event mode, whose steps at whole seconds lie inside macro steps of 0.3 s: these
    end there, so that no error is left. Without, it would be of the size of a macro step."""
    tables = {"source": {"participant": public("reference-fmus-3/Stair.fmu")}, "filter": linear()}
    one = scenario(
        tables, connections=["source.counter -> filter.u[1]"], stop_time=3.3, macro_step=0.3,
        master={"name": "gauss_seidel", "extrapolation": "hold"},
    )  # fmt: skip
    found = completed(one, tmp_path / "out")
    true = np.zeros(len(found["time"]))
    for start in (0.0, 1.0, 2.0, 3.0):
        since = found["time"][found["time"] >= start] - start
        true[found["time"] >= start] += answer_step(since)
    error = difference(found["filter.y[1]"], true).relative_rms
    case = "public Stair in event mode and StateSpace: relative RMS error of filter.y[1]"
    record("FMUs", case, error, 0.0, "independent solution", tolerance=1e-8)


@pytest.mark.long
def test_fmus_that_take_slopes_only_are_coupled_by_signals_of_any_order(tmp_path: Path) -> None:
    """A drive train and its controller, of a tool that ignores a call with a second derivative and whose
    rates are no numbers at the start, against their equations: any signal is as good as a line."""
    tables = {
        "drive": {"participant": public("fmpy/Drivetrain.fmu")},
        "control": {"participant": public("fmpy/Controller.fmu"), "parameters": {"PI.k": 20.0}},
    }
    lines = ["drive.w -> control.u_m", "control.y -> drive.tau"]
    error = {}
    for signal in ("linear", "quadratic", "hermite"):
        one = scenario(
            tables, connections=lines, master={"name": "jacobi", "extrapolation": signal}, macro_step=4e-3,
            reference={"method": "monolithic"}, tolerance={"drive.w": 1.0},
        )  # fmt: skip
        summary, _ = ran(one, tmp_path / signal)
        error[signal] = summary.errors["drive.w"].relative_rms
        told = any("drive, control: rates of change" in line for line in summary.tell())
        assert told == (signal == "hermite")
    assert max(error.values()) < 2.0 * error["linear"] < 0.01
