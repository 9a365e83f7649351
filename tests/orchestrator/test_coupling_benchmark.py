"""Masters on solved problems; published pairs of masses and the manipulator's equations.

The quarter car of Schierz, Arnold and Clauss (2012) against its matrix exponential: orders, errors, steps.

Errors are the largest over all four states and 4 s. The ceilings at H = 1 ms are those of an independent
script with exact subsystems (shared notes of the project); ours are rounded as it prints them. It begins with
held inputs, which leaves its quadratic signals at second order, and happens to take 16 % off the error of its
linear ones: hence Gauss-Seidel in that row, and the Jacobi one beside it with the method's own error.
"""

from collections.abc import Sequence
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.hydraulic_manipulator import OPENING, PRESSURE_1, PRESSURE_2, WEIGHT, links
from benchmarks.published import compare_manipulator, describe_manipulator, describe_two_masses
from models.core.system import Instance, System
from models.monolithic import solve
from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from orchestrator.errors import UnstableCouplingError
from orchestrator.masters import GaussSeidel, Iterated, Jacobi, Newton
from orchestrator.participants.capabilities import HIGHEST
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start
from orchestrator.stepping import ControlledSteps, StepControl
from orchestrator.stepping.guard import RunawayGuard
from tests.models.exact_oscillators import quarter_car, two_masses

from ..third_party.runs import public
from .coupled import Recorder, run_coupled

PUBLISHED = "cosim-benchmarks/hydraulicManipulator_refM2.csv"


def solve_masses(name: str, times: np.ndarray) -> np.ndarray:
    """The published pair of masses by its matrix exponential."""
    system = build_system(describe_two_masses(name))
    coupled = CoupledMassParameters(**system.instances["first"].parameters)
    sprung = SprungMassParameters(**system.instances["second"].parameters)
    return two_masses(times, coupled, sprung, system.x0)


def test_published_pairs_of_masses_have_their_modes() -> None:
    """Closed forms: half the sum of the even and the odd mode."""
    times = np.linspace(0.016, 0.96, 60)
    precice = solve_masses("precice-oscillator", times)
    modes = 0.5 * np.cos(2.0 * np.pi * times), 0.5 * np.cos(6.0 * np.pi * times)
    np.testing.assert_allclose(precice[:, 0], modes[0] + modes[1], atol=1e-11)
    np.testing.assert_allclose(precice[:, 2], modes[0] - modes[1], atol=1e-11)
    damped = solve_masses("mass-spring-damper", times)

    def decay(rate: float) -> np.ndarray:
        """x'' + rate (x' + x) = 0 from 1/2 at rest."""
        turn = np.sqrt(rate - 0.25 * rate**2)
        swing = np.cos(turn * times) + 0.5 * rate / turn * np.sin(turn * times)
        return np.asarray(0.5 * np.exp(-0.5 * rate * times) * swing)

    np.testing.assert_allclose(damped[:, 0], decay(1.0) + decay(3.0), atol=1e-11)
    np.testing.assert_allclose(damped[:, 2], decay(1.0) - decay(3.0), atol=1e-11)


@pytest.mark.long
def test_the_start_is_the_published_equilibrium() -> None:
    """To the digits that are printed there; nothing moves while the valve does not (its motion begins with
    t^2)."""
    assert [f"{PRESSURE_1 / 1e6:.4f}", f"{PRESSURE_2 / 1e6:.4f}"] == ["3.1708", "4.5292"]
    assert (f"{OPENING:.4f}", f"{WEIGHT / 1e3:.3f}") == ("0.4543", "8.829")
    solution = solve(build_system(describe_manipulator(1.0)), np.array([0.0, 1e-4]))
    np.testing.assert_allclose(solution["links.length"], 0.5, atol=1e-12)
    np.testing.assert_allclose(solution["cylinder.force"], 8829.0, rtol=1e-6)


@pytest.mark.long
def test_links_that_nothing_lifts_keep_their_energy(record) -> None:
    """Over 0.5 s of a free fall of both, of 1.5 kJ."""
    system = System({"links": Instance(links(), inputs={"force": 0.0})}, [])
    solution = solve(system, np.linspace(0.0, 0.5, 51), tolerance=1e-10)
    component, energy = links(), np.zeros((51, 3))
    p, u = component.parameters.start, np.zeros(1)
    for k, x in enumerate(solution.state):
        component.flat_energy(0.0, x, u, p, energy[k])
    quantity = "manipulator in free fall: energy (J)"
    record("FMUs", quantity, energy[:, 0], energy[0, 0], "start", tolerance=1e-5)
    assert np.ptp(solution["links.length"]) > 0.1


def test_the_solution_is_the_published_one(record) -> None:
    """Of the manoeuvre M2 over 10 s, which was integrated there in steps of 0.05 ms with a method of first
    order: some 1e-4 of each output's range."""
    for output, difference in compare_manipulator(public(PUBLISHED)).items():
        record("FMUs", f"hydraulic manipulator, M2: {output}", difference, 0.0, "published", tolerance=5e-4)


STATES = ("chassis.position", "chassis.velocity", "wheel.position", "wheel.velocity")


def run(master, steps):
    recorder = run_coupled(build_system(load("quarter-car")), master, steps, 4.0)
    exact = quarter_car(recorder.times)
    error = max(np.abs(recorder[name] - exact[:, i]).max() for i, name in enumerate(STATES))
    return error, recorder.statistics


TIGHT = 1e-12


@pytest.mark.parametrize(
    ("master", "order", "ceiling"),
    [
        pytest.param(Jacobi("hold"), 1.0, 6.85e-3, marks=pytest.mark.long),
        pytest.param(GaussSeidel("linear"), 2.0, 4.75e-4, marks=pytest.mark.long),
        pytest.param(Jacobi("linear"), 2.0, 5.65e-4, marks=pytest.mark.long),
        (Jacobi("quadratic"), 3.0, 4.75e-4),
        (Jacobi("hermite"), 4.0, 1e-6),
        pytest.param(Iterated("hold", TIGHT), 1.0, 6.75e-3, marks=pytest.mark.long),
        pytest.param(Iterated("linear", TIGHT), 2.0, 1.15e-4, marks=pytest.mark.long),
        pytest.param(Iterated("quadratic", TIGHT), 3.0, 1e-5, marks=pytest.mark.long),
        (Iterated("hermite", TIGHT), 4.0, 7.65e-9),
        pytest.param(Newton("hermite", TIGHT), 4.0, 7.65e-9, marks=pytest.mark.long),
    ],
    ids=str,
)
def test_error_at_one_millisecond_and_order_with_the_start_included(master, order, ceiling, record):
    (coarse, _), (fine, _) = run(master, 2e-3), run(master, 1e-3)
    case = f"quarter car, {type(master).__name__}, {master.extrapolation} inputs"
    record("Coupling", f"{case}: error at 1 ms", fine, 0.0, "matrix exponential", tolerance=ceiling)
    slope = np.log2(coarse / fine)
    record("Coupling", f"{case}: order", slope, order, "order of the signals", tolerance=0.05)


def test_step_controlled_hermite_coupling_takes_at_most_a_hundred_steps_for_the_published_error(record):
    """At the published tolerance of 1e-4; published: 218 steps with quadratic signals for 2.7e-4."""
    error, statistics = run(
        Iterated("hermite", 1e-6), ControlledSteps(1e-3, StepControl("predictor_corrector", 1e-4, 1e-4))
    )
    case, steps = "quarter car, step control, Hermite", statistics.macro_steps + statistics.rejected_steps
    record("Coupling", f"{case}: error", error, 0.0, "matrix exponential", tolerance=2.7e-4)
    source = "218 steps in Schierz et al. (2012)"
    quantity = f"{case}: steps over the published number"
    record("Coupling", quantity, steps / 218, 0.0, source, tolerance=100 / 218)


@pytest.mark.parametrize(
    ("master", "estimator", "order"),
    [
        pytest.param(Jacobi("linear"), "step_doubling", 2, marks=pytest.mark.long),
        pytest.param(Jacobi("quadratic"), "step_doubling", 3, marks=pytest.mark.long),
        (Jacobi("hermite"), "step_doubling", 4),
        (GaussSeidel("hermite"), "step_doubling", 4),
        (Iterated("hermite", 1e-10), "predictor_corrector", 4),
        pytest.param(Iterated("hermite", 1e-10), "step_doubling", 4, marks=pytest.mark.long),
    ],
    ids=str,
)
def test_the_error_follows_the_tolerance(master, estimator, order):
    """Local errors of tol leave a global one ~ tol^(k / (k + 1)) for a method of order k; within a fifth."""
    loose, tight = (run(master, ControlledSteps(1e-4, StepControl(estimator, t, t)))[0] for t in (1e-5, 1e-7))
    assert np.log10(loose / tight) / 2.0 == pytest.approx(order / (order + 1.0), rel=0.2)


def run_steps(master, step: float, stop: float = 2.4) -> Recorder:
    return run_coupled(build_system(load("quarter-car")), master, step, stop)


def error(step: float) -> float:
    recorder = run_steps(GaussSeidel("hermite"), step)
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
        run_steps(Jacobi("hermite"), step, 150 * step)


def follow(course: Sequence[float]) -> None:
    """What the guard says of a value with this course."""
    wiring = SimpleNamespace(
        sources=["pipe.h"], connected=np.array([0]), nominal=np.array([1.0]), degrees=np.array([HIGHEST])
    )
    values = np.full((3, 1), course[0])
    history = SimpleNamespace(times=np.array([0.0, -0.1, -0.2]), values=values, count=3)
    state = SimpleNamespace(values=np.zeros(1), history=history)
    guard = RunawayGuard(SimpleNamespace(wiring=wiring, state=state, restorable=False), Jacobi("hold"))
    for k, value in enumerate(course):
        state.values[0] = value
        guard.judge(0.1 * (k + 1), 0.1)
        history.values[1:], history.times[1:] = history.values[:-1].copy(), history.times[:-1].copy()
        history.values[0], history.times[0] = value, 0.1 * (k + 1)


@pytest.mark.parametrize("rest", [0.0, 1e-290])
def test_a_value_that_has_all_but_died_out_may_jump(rest: float) -> None:
    """From a swing of 1e-290 to 2e4 in one step, as the enthalpy of a pipe that is filled at once, and then a
    ringing over twenty steps that does not grow: as from rest."""
    follow([*rest * (-1.0) ** np.arange(60), *2e4 * (1.0 + 0.9 * (-0.9) ** np.arange(20))])


def test_landings_that_grow_are_an_instability() -> None:
    """Of a contact that an unstable coupling throws open, for a hundred steps and more: its values swing too
    little between landings. Bounces of bodies fall, or rise and fall."""

    def land(*peaks: float) -> None:
        follow(np.concatenate([[0.5] * 40, *([0.0] * 100 + [peak, 0.4 * peak] for peak in peaks)]).tolist())

    for peaks in ((9.0, 6.0, 3.0), (2.0, 4.0, 8.0, 16.0), (3.0, 9.0, 5.0, 27.0, 81.0), (1e3, 3e3, 2e3)):
        land(*peaks)
    with pytest.raises(UnstableCouplingError, match=r"at t = 34\.6 s"):
        land(3.0, 9.0, 27.0)
    with pytest.raises(UnstableCouplingError, match="unstable coupling"):
        land(3.0, 9.0, 5.0, 27.0, 81.0, 243.0)


@pytest.mark.parametrize("turn", [np.pi, 2.0, 1.0])
def test_what_grows_is_unstable_and_what_dies_out_slowly_is_not(turn: float) -> None:
    """A value of a coupling with an eigenvalue r exp(i turn), over 400 steps from 1000 nominal sizes."""
    steps = np.arange(400)
    for radius in (0.5, 0.85, 0.9, 0.95, 0.98, 0.99):
        follow(1e3 * radius**steps * np.cos(turn * steps))
    for radius in (1.0, 1.001, 1.01, 1.1):
        with pytest.raises(UnstableCouplingError, match="unstable coupling"):
            follow(1e3 * radius**steps * np.cos(turn * steps))
