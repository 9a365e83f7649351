"""The monolithic reference: two methods, located events, interpolation, refusals."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import DOP853
from scipy.optimize import brentq

from models.compile.kernel import kernel
from models.core.component import Events
from models.core.difference import difference, time_weights
from models.core.system import Instance, ModelError, System
from models.monolithic import equilibrium, solve
from models.monolithic.dop853 import LARGEST_DEFECT, CompiledDop853, JudgedDop853
from models.monolithic.reference import SystemProblem, stiffness
from tests.fmus.native.bouncing_ball import (
    GRAVITY,
    Inputs,
    Parameters,
    State,
    bouncing_ball,
    guards,
    list_bounces,
)

from .systems import run, turn, valve_train


def ball(restitution=0.8, start=None):
    """A ball that never rests."""
    return Instance(bouncing_ball(), {"restitution": restitution, "threshold": 0.0}, start or {})


@kernel
def stay_fallen(k: int, t: float, x: State, u: Inputs, p: Parameters) -> None:
    """A faulty transition."""
    x.height = -1.0


def test_events_are_located_to_the_tolerance():
    exact = list_bounces(8, 0.8)
    end = 0.5 * (exact[-2] + exact[-1])
    found = solve(System({"ball": ball()}, []), np.linspace(0.0, end, 201))
    assert [(event.instance, event.guard) for event in found.events] == [("ball", 0)] * 7
    assert [event.time for event in found.events] == pytest.approx(exact[:-1], abs=1e-9)
    # Between impacts: parabolas.
    start = exact[-2]
    v = 0.8**7 * math.sqrt(2 * GRAVITY)
    s = end - start
    assert found["ball.height"][-1] == pytest.approx(v * s - GRAVITY * s**2 / 2, abs=1e-8)
    assert np.all(found["ball.height"] >= 0.0)
    # Both methods locate the events.
    assert found.uncertainty["ball.height"].max_abs < 1e-8


def test_simultaneous_events_all_happen():
    system = System({"one": ball(), "two": ball(0.5)}, [])
    found = solve(system, np.linspace(0.0, 0.6, 61))
    assert sorted(event.instance for event in found.events) == ["one", "two"]
    assert found.uncertainty["two.height"].max_abs < 1e-8


def test_a_guard_that_has_fallen_at_the_start_makes_its_transition_at_once():
    system = System({"ball": ball(start={"height": -0.1, "velocity": -2.0})}, [])
    found = solve(system, np.linspace(0.0, 0.1, 11))
    assert found.events[0].time == 0.0
    assert found["ball.velocity"][0] == pytest.approx(1.6)


def test_a_transition_that_does_not_lift_its_guard_is_refused():
    faulty = replace(bouncing_ball(), events=Events(1, guards, stay_fallen))
    system = System({"ball": Instance(faulty)}, [])
    with pytest.raises(ModelError, match=r"ball: more than 1000 events at t = 0\.447"):
        solve(system, np.linspace(0.0, 1.0, 11))


def test_endless_chatter_is_refused():
    """A ball that loses energy makes infinitely many impacts before 9 sqrt(2/g) s."""
    system = System({"ball": ball()}, [])
    with pytest.raises(ModelError, match="ball: more than 1000 events"):
        solve(system, np.linspace(0.0, 5.0, 11), tolerance=1e-6)


def test_two_methods_agree_within_the_tolerance():
    system = valve_train(1000)
    times = np.linspace(0.0, 0.7, 253) * turn(1000)
    found = solve(system, times, x0=equilibrium(system), tolerance=1e-8)
    assert found.method_names[0].startswith("CVODE")
    assert found.method_names[1].startswith("scipy DOP853")
    assert found.uncertainty["valve_spring.position"].relative_rms < 1e-8
    assert found.uncertainty["contact.film_thickness"].relative_rms < 1e-6
    # The load divides positions of 1e-2 m by a deflection of 1e-6 m: four digits less.
    assert found.uncertainty["contact.load"].relative_rms < 1e-4
    assert set(found.uncertainty) == set(system.outputs.names)


def test_instants_asked_for_do_not_change_the_solution():
    """The value between steps is as good as at their ends."""
    system = valve_train(1000)
    x0 = equilibrium(system)
    end = 0.55 * turn(1000)
    few = solve(system, np.array([0.0, end]), x0=x0, tolerance=1e-9)
    many = solve(system, np.linspace(0.0, end, 1500), x0=x0, tolerance=1e-9)
    sharp = solve(system, np.linspace(0.0, end, 1500), x0=x0, tolerance=1e-11)
    position = "valve_spring.position"
    assert few[position][-1] == pytest.approx(many[position][-1], abs=1e-12)
    assert difference(many[position], sharp[position]).relative_rms < 1e-9
    assert difference(many["contact.load"], sharp["contact.load"]).relative_rms < 1e-5


def test_a_start_before_the_first_instant():
    system = valve_train(1000)
    x0 = equilibrium(system)
    times = np.linspace(0.3, 0.5, 21) * turn(1000)
    late = solve(system, times, x0=x0, t0=0.0, tolerance=1e-8)
    whole = solve(system, np.concatenate([[0.0], times]), x0=x0, tolerance=1e-8)
    assert late["valve_spring.position"] == pytest.approx(whole["valve_spring.position"][1:], abs=1e-11)


def test_progress_runs_from_zero_to_one():
    seen: list[float] = []
    solve(System({"ball": ball()}, []), np.linspace(0.0, 0.3, 4), progress=seen.append)
    assert seen == pytest.approx([0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0])


def test_a_stiff_problem_is_known_as_stiff():
    """A valve of 0.22 kg resting in a seat of k N/m turns at sqrt(k/m), here 3e4 and 7e7 rad/s."""
    times = np.array([0.0, 1.0])

    def is_stiff(seat):
        closed = {"seat_stiffness": seat, "lash": 1e-6}
        problem = SystemProblem(valve_train(600, valve_spring=closed))
        return stiffness(problem, 0.0, problem.start(problem.system.x0), times)[0]

    assert not is_stiff(2e8)
    assert is_stiff(1e15)


def test_stiff_methods_solve_the_same_problem():
    from models.monolithic.cvode import Cvode
    from models.monolithic.march import march
    from models.monolithic.reference import observe
    from models.monolithic.runge_kutta import RungeKutta

    system = valve_train(1000)
    problem = SystemProblem(system)
    z = problem.start(equilibrium(system))
    times = np.linspace(0.0, 0.5, 181) * turn(1000)
    exact = run(problem, system.x0 * 0 + z[: problem.size], times, tolerance=1e-11)
    column = system.outputs.names.index("contact.load")
    for method in (Cvode(problem, 1e-9, True, 1e-4), RungeKutta(problem, 1e-8, True, 1e-4)):
        states, _ = march(problem, method, z, 0.0, times)
        if isinstance(method, Cvode):
            assert np.array_equal(method.along(z, times), states)
        found = observe(problem.evaluation, times, states)[1][:, column]
        assert difference(found, exact[:, column]).relative_rms < 1e-4


def test_a_method_that_fails_says_so_by_its_error_alone(monkeypatch, capfd):
    from models.monolithic import cvode

    problem = SystemProblem(valve_train(1000))
    monkeypatch.setattr(cvode, "STEP_LIMIT", 5)
    method = cvode.Cvode(problem, 1e-9, True, 1e-4)
    method.begin(0.0, problem.start(problem.system.x0), 1.0)
    with pytest.raises(ModelError, match=r"CVODE BDF.* failed at t = .* s: .*max_num_steps"):
        method.to(1.0)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"times": np.array([0.0, 0.0])}, "ascending"),
        ({"times": np.array([0.0, math.nan])}, "ascending finite"),
        ({"times": np.array([0.0, 1.0]), "t0": 0.5}, "must not be behind the first instant 0 s"),
        ({"times": np.array([0.0, 1.0]), "tolerance": 0.0}, "tolerance = 0: must be > 0"),
        ({"times": np.array([0.0, 1.0]), "x0": np.zeros(3)}, "3 elements: the system has 6 states"),
        ({"times": np.array([0.0, 1.0]), "x0": np.full(6, math.nan)}, "not finite"),
    ],
)
def test_refusals(arguments, said):
    with pytest.raises(ModelError, match=said):
        solve(System({"ball": ball()}, []), **arguments)


def test_unknown_output_is_a_key_error():
    found = solve(System({"ball": ball()}, []), np.array([0.0, 0.1]))
    with pytest.raises(KeyError, match=r"ball\.heigth"):
        found["ball.heigth"]


def test_difference_is_relative_to_the_references_spread_or_of_a_constant_to_its_size():
    reference = np.array([1.0, 3.0, 1.0, 3.0])
    found = difference(reference + 0.5, reference)
    assert (found.max_abs, found.rms, found.relative_rms) == (0.5, 0.5, 0.5)
    assert difference(np.full(3, 101.0), np.full(3, 100.0)).relative_rms == pytest.approx(0.01)
    assert difference(np.full(3, 1e-9), np.zeros(3), nominal=1e-6).relative_rms == pytest.approx(1e-3)
    assert difference(np.zeros(3), np.zeros(3)).relative_rms == 0.0
    with pytest.raises(ValueError, match=r"shapes \(2,\) and \(3,\)"):
        difference(np.zeros(2), np.zeros(3))


def test_uneven_records_count_by_the_time_they_stand_for():
    """Closed form: an error t over [0, 1] has the RMS 1 / sqrt(3), a reference t the spread 1 / sqrt(12).

    Both ends stand for half an interval too much: right to the longest interval, 2 / n.
    """
    n = 4000
    times = np.linspace(0.0, 1.0, n) ** 2
    found = difference(2.0 * times, times, weights=time_weights(times))
    assert found.rms == pytest.approx(3.0**-0.5, rel=2.0 / n)
    assert found.relative_rms == pytest.approx(2.0, rel=2.0 / n)
    assert difference(2.0 * times, times).rms == pytest.approx(5.0**-0.5, rel=2.0 / n)  # by count instead


def test_records_at_equal_distances_count_equally():
    random = np.random.default_rng(1)
    values, reference = random.normal(size=(2, 500))
    times = 0.1 + 2e-5 * np.arange(500)
    found = difference(values, reference, weights=time_weights(times))
    # Distances of times are equal to their rounding, 1e-16 of 0.1 s over 20 us.
    assert found.rms == pytest.approx(difference(values, reference).rms, rel=1e-12)
    assert found.relative_rms == pytest.approx(difference(values, reference).relative_rms, rel=1e-12)
    assert difference(values[:1], reference[:1], weights=time_weights(times[:1])).rms > 0.0


# So wide that every step is accepted: rejected ones are made shorter by estimates near rounding.
OPTIONS = {"rtol": 1e-3, "atol": 1e-3, "max_step": 2e-4}
END = 1e-3


@pytest.mark.parametrize(
    "motion", [pytest.param("prescribed", marks=pytest.mark.long), "free: an algebraic loop"]
)
def test_every_step_is_scipys(motion: str) -> None:
    """From the same state with the same length: 1e-13 is the rounding of sums in another order."""
    free = {"motion": 0.0, "inertia": 0.02}
    problem = SystemProblem(valve_train(1000.0, flywheel=free if motion.startswith("free") else None))
    z = problem.start(problem.system.x0)
    t, steps = 0.0, 0

    def rate(t: float, z: Any) -> Any:
        return problem.rate(t, np.ascontiguousarray(z)).copy()

    while t < END:
        begun = (t, z, END)
        theirs = DOP853(rate, *begun, first_step=min(1e-5, END - t), **OPTIONS)
        ours = CompiledDop853(problem, rate, *begun, first_step=min(1e-5, END - t), **OPTIONS)
        theirs.step()
        ours.step()
        middle = 0.5 * (t + theirs.t)
        size = problem.nominal + np.abs(theirs.y)
        assert ours.t == theirs.t
        assert np.max(np.abs(ours.y - theirs.y) / size) < 1e-13
        assert np.max(np.abs(ours.dense_output()(middle) - theirs.dense_output()(middle)) / size) < 1e-13
        t, z, steps = theirs.t, theirs.y, steps + 1
    assert steps >= 100


def test_a_rate_that_is_not_finite_ends_in_a_failure() -> None:
    """The step shrinks to nothing; it does not grow."""
    system = valve_train(1000.0)
    problem = SystemProblem(system)
    z0 = problem.start(system.x0)
    start = problem.rate(0.0, z0).copy()
    solver = CompiledDop853(problem, lambda t, z: start, 0.0, z0, END, **OPTIONS)
    system.p[system.parameters.names.index("valve_spring.valve_mass")] = np.nan
    assert solver.step() is not None
    assert solver.status == "failed"


def largest_error(solver: Any) -> float:
    """Of a solution of y' = -y, y(0) = 1, at and between the ends of steps up to the solver's end."""
    largest = 0.0
    while solver.status == "running":
        solver.step()
        instants = np.linspace(solver.t_old, solver.t, 101)
        largest = max(largest, float(np.max(np.abs(solver.dense_output()(instants) - np.exp(-instants)))))
    return largest


@pytest.mark.parametrize("tolerance", [1e-5, 1e-7, 1e-9])
def test_a_step_for_which_the_error_estimate_vanishes_is_not_kept(tolerance: float) -> None:
    """The estimate of order 5 of a step of y' = -y is a polynomial of its length, with a zero near 5.7."""

    def solver(method: Any, length: float, rtol: float = tolerance) -> Any:
        return method(lambda t, y: -y, 0.0, np.ones(1), 10.0, rtol=rtol, atol=rtol, first_step=length)

    def estimate(length: float) -> float:
        accepting = solver(DOP853, length, rtol=1e6)
        accepting.step()
        return float(accepting.K[:, 0] @ accepting.E5)

    blind = brentq(estimate, 5.5, 6.0, xtol=1e-15)
    assert largest_error(solver(DOP853, blind)) > 1e-3
    # An eighth of the defect in each step; a decaying solution forgets the errors of earlier steps.
    assert largest_error(solver(JudgedDop853, blind)) < 0.2 * LARGEST_DEFECT * tolerance
