"""The micro-step integrator inside components: tolerance, cutting, inputs, restoring, failure."""

import math

import numpy as np
import pytest

from models.catalogue import CATALOGUE
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
