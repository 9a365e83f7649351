"""Steps of the pairs of Dormand and Prince and of Bogacki and Shampine: order, error estimate, refusals."""

import math
from itertools import takewhile

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.embedded_pair import march, try_step
from models.core.errors import ModelError
from models.core.integrator import NOT_FINITE, OK, TOLERANCE, TOO_MANY_STEPS
from models.core.quantities import Vector
from models.core.system import Instance, System
from models.monolithic import solve

from .stepped import Stepped

SPRING = CATALOGUE["valve_spring"]()
STIFF_SEAT = {"seat_stiffness": 2e7, "seat_damping": 300.0}


def run(stepped, ends) -> Vector:
    for end in ends:
        stepped.advance(end - stepped.t)
    return stepped.x.copy()


def loaded(load=450.0, **parameters):
    return Stepped(SPRING, parameters, {"position": 1e-3}, {"load": load})


def test_error_stays_near_the_tolerance():
    """Free motion of the spring against the reference at 1e-12."""
    end = 0.02
    system = System({"s": Instance(SPRING, start={"position": 1e-3}, inputs={"load": 450.0})}, [])
    exact = solve(system, np.array([0.0, end]), tolerance=1e-11).state[-1]
    error = np.abs(run(loaded(), [end]) - exact) / SPRING.state.nominal
    # Local errors of TOLERANCE in 1 to 2 thousand micro-steps.
    assert np.max(error) < 2000 * TOLERANCE


@pytest.mark.parametrize("cuts", [2, 50])
def test_result_does_not_depend_on_how_the_time_is_cut(cuts):
    end = 0.01
    whole = run(loaded(), [end])
    cut = run(loaded(), np.linspace(0.0, end, cuts + 1)[1:])
    ragged = run(loaded(), [*(end * np.linspace(0.0, 1.0, cuts + 1)[1:-1] ** 2), end])
    for other in (cut, ragged):
        assert np.max(np.abs(other - whole) / SPRING.state.nominal) < 2000 * TOLERANCE


def test_cut_does_not_matter_with_a_bouncing_valve():
    end = 0.004
    state = {"position": 0.2e-3}
    whole = run(Stepped(SPRING, STIFF_SEAT, state), [end])
    cut = run(Stepped(SPRING, STIFF_SEAT, state), np.linspace(0.0, end, 41)[1:])
    # Impacts magnify the difference of the steps, of which there are more.
    assert np.max(np.abs(cut - whole) / SPRING.state.nominal) < 1e5 * TOLERANCE


def test_step_restore_step_is_bit_identical():
    runner = loaded()
    saved = run(runner, [1e-3])
    first = run(runner, [2e-3])
    runner.work[:] = math.nan  # nothing survives in the scratch space
    runner.x[:], runner.t = saved, 1e-3
    assert np.array_equal(run(runner, [2e-3]), first)


def test_inputs_vary_inside_the_step_as_their_polynomials():
    """A mass under the load a + b s + c s^2/2 + d s^3/6 has the integrals of the polynomial."""
    weak = {"spring_rate": 1e-9, "preload": 1.0, "damping_ratio": 0.0}
    runner = Stepped(SPRING, weak)
    a, b, c, d, h = 3.0, 200.0, -4e4, 5e6, 0.01
    runner.U[:, 0] = a + 1.0, b, c, d
    runner.advance(h)
    mass = 0.22
    velocity = (a * h + b * h**2 / 2 + c * h**3 / 6 + d * h**4 / 24) / mass
    position = (a * h**2 / 2 + b * h**3 / 6 + c * h**4 / 24 + d * h**5 / 120) / mass
    assert runner.x[:2] == pytest.approx([position, velocity], abs=1e-11)
    assert runner.u[0] == pytest.approx(a + 1.0 + b * h + c * h**2 / 2 + d * h**3 / 6, rel=1e-14)


@pytest.mark.parametrize(
    ("load", "spring_rate", "expected"),
    [(450.0, 1e11, OK), (450.0, 1e15, TOO_MANY_STEPS), (math.nan, 1e5, NOT_FINITE)],
)
def test_steps_that_fail_leave_the_state(load, spring_rate, expected):
    """At some 900 micro-steps a period: 100 and 10 000 periods, against the limit of a million."""
    runner = loaded(load, spring_rate=spring_rate)
    before = runner.x.copy()
    assert runner.step(1e-3) == expected
    assert np.array_equal(runner.x, before) == (expected != OK)


def decay(y):
    """y' = -y^2: y = 1/(1 + x) from 1."""
    return -(y**2)


def test_a_step_has_order_3_and_its_estimate_order_2():
    """Halved, a step has a 2^4th of its error and a 2^3th of its estimate."""
    errors, estimates, between = [], [], []
    for length in (0.2, 0.1, 0.05, 0.025):
        step = try_step(decay, 0.0, length, np.ones(1), decay(np.ones(1)))
        errors.append(abs(step.states[1][0] - 1.0 / (1.0 + length)))
        estimates.append(step.error)
        between.append(abs(step.at(0.5)[0] - 1.0 / (1.0 + 0.5 * length)))
    for found, order in ((errors, 4.0), (estimates, 3.0), (between, 4.0)):
        orders = np.log2(np.array(found[:-1]) / found[1:])
        assert orders[-1] == pytest.approx(order, abs=0.15)


def test_the_error_falls_with_the_number_of_evaluations_by_order_2():
    """Of the error per change, so that a tolerance of 1/16 takes about 4 times as many; the estimate bounds
    the true error."""
    counts, errors = [], []
    for tolerance in (1e-2, 1e-2 / 16.0, 1e-2 / 256.0):
        count = 0

        def rate(y):
            nonlocal count
            count += 1
            return decay(y)

        steps = list(
            takewhile(
                lambda step: step.begin < 9.0,
                march(rate, np.ones(1), rate(np.ones(1)), 0.1, tolerance, lambda y, f: (0.0, 10.0)),
            )
        )
        true = max(abs(s.states[1][0] - 1.0 / (1.0 + s.begin + s.length)) for s in steps)
        estimated = sum(s.error for s in steps)
        change = 1.0 - steps[-1].states[1][0]
        assert true <= estimated <= tolerance * change
        counts.append(count)
        errors.append(true)
    assert counts[2] < 5.0 * counts[1] < 25.0 * counts[0]
    # Of the solution, which has one order more: about 16^(3/2) each.
    assert errors[2] < errors[1] / 16.0 < errors[0] / 256.0


def test_a_refused_step_is_shortened_and_a_hopeless_one_raised():
    def rate(y):
        if y[0] < 0.5:
            raise ModelError("too little")
        return -np.ones(1)

    reached = list[float]()
    steps = march(rate, np.ones(1), -np.ones(1), 0.4, 1e-2, lambda y, f: (0.3, 1.0))
    with pytest.raises(ModelError, match="too little"):
        reached.extend(step.states[1][0] for step in steps)
    assert reached[0] == pytest.approx(0.6, abs=1e-15)
    assert reached[-1] == pytest.approx(0.5, abs=1e-4)


def test_the_shortest_step_is_taken_whatever_its_error():
    """For this tolerance the first steps would be shorter than 0.01."""
    steps = march(decay, np.ones(1), decay(np.ones(1)), 0.5, 1e-9, lambda y, f: (0.5, 0.5))
    found = [next(steps) for _ in range(3)]
    assert [step.begin for step in found] == [0.0, 0.5, 1.0]
    assert found[0].error > 1e-9
