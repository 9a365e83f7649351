"""Steps that resolve a motion coarsely are no unstable coupling: what `analyse` calls stable is run."""

from types import SimpleNamespace

import numpy as np
import pytest

from models.oscillators.exact import quarter_car
from orchestrator.errors import UnstableCouplingError
from orchestrator.masters import GaussSeidel, Jacobi
from orchestrator.participants.capabilities import HIGHEST
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start
from orchestrator.stepping.guard import RunawayGuard

from .coupled import run_coupled
from .recorder import Recorder


def run(master, step: float, stop: float = 2.4) -> Recorder:
    return run_coupled(build_system(load("quarter-car")), master, step, stop)


def error(step: float) -> float:
    recorder = run(GaussSeidel("hermite"), step)
    return float(np.abs(recorder["chassis.position"] - quarter_car(recorder.times)[:, 0]).max())


def test_fourth_order_holds_to_the_steps_that_are_advised(record) -> None:
    """At 20 ms the wheel turns by 1.3 rad of its oscillation in a step: its values miss their linear
    extrapolation, and the error is that of the method all the same. It is scaled from 10 ms."""
    fine = error(0.01)
    for step in (0.016, 0.02, 0.024):
        case = f"quarter car, GaussSeidel, hermite inputs: error at {1000 * step:g} ms over (h / 10 ms)^4"
        record("Coupling", case, error(step) / fine / (step / 0.01) ** 4, 1.0, "order 4", tolerance=0.15)


@pytest.mark.long
@pytest.mark.parametrize("step", [5e-6, 1e-6])
@pytest.mark.parametrize("rpm", [3000, 4000, 7000])
def test_a_follower_that_leaves_its_cam_does_not_end_the_run(rpm, step):
    """One lift with steps of fixed length: below 3500 r/min the follower stays on its cam."""
    ends = ("initial", "final")
    speed = [f"components.flywheel.parameters.{end}_speed='{rpm} rpm'" for end in ends]
    scenario = load("valve-train", speed)
    system = resolve_start(scenario, build_system(scenario))
    recorder = run_coupled(system, scenario.build_master(), step, 60.0 / rpm)
    assert recorder.times[-1] == 60.0 / rpm
    assert (recorder["contact.load"].min() == 0.0) == (rpm > 3500)


@pytest.mark.parametrize("step", [0.05, 0.1])
def test_a_swing_that_grows_is_still_an_instability(step: float) -> None:
    with pytest.raises(UnstableCouplingError, match="unstable coupling"):
        run(Jacobi("hermite"), step, 150 * step)


@pytest.mark.parametrize("rest", [0.0, 1e-290])
def test_a_value_that_has_all_but_died_out_may_jump(rest: float) -> None:
    """From a swing of 1e-290 to 2e4 in one step, as the enthalpy of a pipe that is filled at once, and then a
    ringing over twenty steps that does not grow: as from rest."""
    wiring = SimpleNamespace(
        sources=["pipe.h"], connected=np.array([0]), nominal=np.array([1.0]), degrees=np.array([HIGHEST])
    )
    history = SimpleNamespace(times=np.array([0.0, -0.1, -0.2]), values=np.zeros((3, 1)), count=3)
    state = SimpleNamespace(values=np.zeros(1), history=history)
    guard = RunawayGuard(SimpleNamespace(wiring=wiring, state=state, restorable=False), Jacobi("hold"))
    course = [*rest * (-1.0) ** np.arange(60), *2e4 * (1.0 + 0.9 * (-0.9) ** np.arange(20))]
    for k, value in enumerate(course):
        state.values[0] = value
        guard.judge(0.1 * (k + 1), 0.1)
        history.values[1:], history.times[1:] = history.values[:-1].copy(), history.times[:-1].copy()
        history.values[0], history.times[0] = value, 0.1 * (k + 1)
