"""Analyses of the coupling of third-party FMUs: their responses, by saved states or by fresh instances."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.monolithic.trajectory import Trajectory
from orchestrator.analyses.stability.analyse import survey_scenario
from orchestrator.analyses.stability.responses import Responses
from orchestrator.analyses.stability.survey import Survey
from orchestrator.masters import find_name
from orchestrator.participants.open_fmu import collect_settings, open_fmu
from orchestrator.participants.reopened import Reopened
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.scenario import Scenario, ScenarioError
from orchestrator.scenario.system import build_system, resolve

from ..orchestrator.coupled import Alone
from .c_fmus import fmu
from .runs import masses as coupled_masses
from .runs import never, public, scenario


def masses(second: str, folder: Path, **changes: Any) -> Scenario:
    """For half a second, with an error allowed."""
    more = {"tolerance": {"second.position": 0.3}, "stop_time": 0.5}
    return coupled_masses(second, folder, **more | changes)


# A course of nothing: of those that nothing drives it is not looked at.
IDLE = Trajectory(np.zeros(1), {}, np.zeros((1, 0)), np.zeros((1, 0)))


def surveyed(one: Scenario) -> Survey:
    return survey_scenario(resolve(one), [], Reporter())


@pytest.mark.parametrize("process", ["shared", pytest.param("own", marks=pytest.mark.long)])
def test_a_fresh_instance_repeats_its_calls_to_the_bit(process: str, tmp_path: Path) -> None:
    one = masses("stateless_mass", tmp_path)
    instance = build_system(one).instances["second"]
    path = Path(one.components["second"].participant)
    assert "position" in collect_settings(instance).outputs
    alone = Alone(Reopened(lambda: open_fmu("second", path, instance)), "force", ["position"], 0.0)

    def advance(*steps: int) -> list[list[float]]:
        return [alone.advance(0.1 * k, 0.1, 1.0 + k) for k in steps]

    advance(0, 1)
    saved = alone.unit.save()
    found = advance(2, 3)
    alone.unit.restore(saved)
    assert advance(2, 3) == found
    alone.unit.close()


@pytest.mark.long
def test_fresh_instances_give_the_analysis_that_saved_states_give(tmp_path: Path) -> None:
    """Limits and errors of every method."""
    with_states, without = (surveyed(masses(name, tmp_path)) for name in ("held_mass", "stateless_mass"))
    explicit = {m.master: m for m in with_states.methods if not m.master.implicit}
    compared = [m for m in without.methods if m.master in explicit]
    assert len(compared) >= 6
    for method in compared:
        assert method.limit == pytest.approx(explicit[method.master].limit, rel=1e-6)
    assert without.best is not None
    assert not without.best.master.implicit


@pytest.mark.long
@pytest.mark.parametrize(("second", "within"), [("stateless_mass", 0.1), ("held_mass", 0.05)])
def test_the_error_of_a_third_party_fmu_that_holds_its_inputs_is_predicted(
    second: str, within: float, tmp_path: Path, record: Any
) -> None:
    """Against that of the run, by refinement; with and without saved states."""
    one = masses(second, tmp_path, reference={"enabled": True})
    estimated = surveyed(one).own.errors[one.macro_step]["second.position"]
    summary = run(one, tmp_path / "out", never, Reporter(), figures=False)
    measured = summary.errors["second.position"].relative_rms
    case = f"two masses, {second}, an FMU that holds its inputs: predicted error"
    record("Coupling", case, estimated, measured, "error of the run", tolerance=within * measured)


@pytest.mark.long
@pytest.mark.parametrize(
    ("second", "stop", "allowed"),
    [("stateless_mass", 3.0, 1e-3), ("stateless_mass", 0.5, 1e-2), ("held_mass", 3.0, 1e-3)],
)
def test_a_run_with_the_advised_method_and_step_is_within_the_tolerance(
    second: str, stop: float, allowed: float, tmp_path: Path, record: Any
) -> None:
    """By a factor that the advice leaves."""
    tolerance = {"first.position": allowed, "second.position": allowed}
    one = masses(second, tmp_path, tolerance=tolerance, stop_time=stop, macro_step=2e-3)
    best = surveyed(one).best
    assert best
    master = {"name": find_name(best.master), "extrapolation": best.master.extrapolation, "order": best.order}
    changes = {"macro_step": best.advised_step, "master": master, "reference": {"enabled": True}}
    advised = masses(second, tmp_path, tolerance=tolerance, stop_time=stop, **changes)
    summary = run(advised, tmp_path / "out", never, Reporter(), figures=False)
    largest = max(summary.errors[name].relative_rms for name in tolerance)
    case = f"two masses, {second}, {stop:g} s, {allowed:g} allowed: error with the advised method and step"
    record("Coupling", case, largest, 0.0, "tolerance", tolerance=0.75 * allowed)


@pytest.mark.long
def test_instants_after_which_an_fmu_ends_itself_are_left_out(tmp_path: Path) -> None:
    """Its responses take 0.6 s; one that no connection drives needs none."""
    found = surveyed(masses("ending_mass", tmp_path))
    assert [point.time for point in found.points] == pytest.approx(
        [0.0, 0.0417, 0.0833, 0.125, 0.1667], abs=6e-3
    )
    (said,) = found.left_out
    assert "the FMU ends the simulation at t = 0.795 s, before its responses from t = 0.205 s on" in said
    tables = {
        "landing": {"participant": fmu("landing", 2, tmp_path), "parameters": {"until": 0.5}},
        "driven": {"component": "sprung_mass", "participant": "in-process"},
    }
    lines, tolerance = ["landing.x * 1 -> driven.force"], {"driven.position": 0.1}
    driven = scenario(tables, connections=lines, tolerance=tolerance, stop_time=0.5)
    assert len(surveyed(driven).points) == 12


def test_an_fmu_that_nothing_drives_responds_to_nothing(tmp_path: Path) -> None:
    """Its input is free, and it has two outputs."""
    path = fmu("held_mass", 2, tmp_path)
    system = build_system(scenario({"mass": {"participant": path}}))
    unit = open_fmu("mass", path, system.instances["mass"])
    try:
        found = Responses("mass", unit, system, 0.01).about(IDLE, 0, ["position", "velocity"])
    finally:
        unit.close()
    assert (found.A.shape, found.B.shape, found.D.shape) == ((0, 0), (0, 1), (2, 1))
    assert not found.D.any()


def test_a_repetition_that_costs_too_much_is_refused_with_its_cost(tmp_path: Path) -> None:
    one = masses("stateless_mass", tmp_path, stop_time=2e4)
    with pytest.raises(ScenarioError, match=r"48 fresh instances would make 4.8e\+07 steps"):
        surveyed(one)


@pytest.mark.long
def test_signals_to_fmus_that_take_slopes_only_are_predicted_as_lines(tmp_path: Path, record: Any) -> None:
    """A public drive train and its controller, linearised by directional derivatives: the predicted error of
    the coupling against that of the run by refinement, and no gain from rates."""
    tables = {
        "drive": {"participant": public("fmpy/Drivetrain.fmu")},
        "control": {"participant": public("fmpy/Controller.fmu"), "parameters": {"PI.k": 20.0}},
    }
    error = {}
    for signal in ("linear", "hermite"):
        one = scenario(
            tables, connections=["drive.w -> control.u_m", "control.y -> drive.tau"], macro_step=4e-3,
            master={"name": "jacobi", "extrapolation": signal}, tolerance={"drive.w": 1e-3},
            reference={"method": "refinement"},
        )  # fmt: skip
        error[signal] = surveyed(one).own.errors[one.macro_step]["drive.w"]
        if signal == "linear":
            summary = run(one, tmp_path / "out", never, Reporter(), figures=False)
            measured = summary.errors["drive.w"].relative_rms
    assert error["hermite"] == pytest.approx(error["linear"], rel=0.05)
    case = "public drive train, slopes only: predicted relative RMS error of drive.w"
    record("Coupling", case, error["linear"], measured, "error of the run", tolerance=0.5 * measured)
