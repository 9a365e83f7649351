"""The micro-step integrator inside components: tolerance, cutting, inputs, restoring, failure."""

from __future__ import annotations

import math

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.integrator import NOT_FINITE, OK, TOLERANCE, TOO_MANY_STEPS
from models.core.quantities import Vector
from models.core.system import Instance, System
from models.monolithic import solve

SPRING = CATALOGUE["valve_spring"]()
STIFF_SEAT = {"seat_stiffness": 2e7, "seat_damping": 300.0}


class Runner:
    """One component advanced by its own step kernel."""

    def __init__(self, component=SPRING, parameters=None, state=None):
        self.component = component
        self.p = component.parameters.vector(parameters)
        self.x = component.state.vector(state)
        self.U = component.input_polynomial()
        self.work = np.zeros(component.work_size)
        self.u = np.zeros(component.inputs.size)
        self.y = np.zeros(component.outputs.size)

    def step(self, t, h):
        scale = self.component.state.nominal
        return self.component.step(t, h, self.x, self.U, self.p, scale, self.work, self.u, self.y)

    def steps(self, ends) -> Vector:
        t = 0.0
        for end in ends:
            assert self.step(t, end - t) == OK
            t = end
        return self.x.copy()


def loaded(load=450.0, **parameters):
    runner = Runner(parameters=parameters, state={"position": 1e-3})
    runner.U[0, 0] = load
    return runner


def test_error_stays_near_the_tolerance():
    """Free motion of the spring against the reference at 1e-12."""
    end = 0.02
    system = System({"s": Instance(SPRING, start={"position": 1e-3}, inputs={"load": 450.0})}, [])
    exact = solve(system, np.array([0.0, end]), tolerance=1e-11).state[-1]
    error = np.abs(loaded().steps([end]) - exact) / SPRING.state.nominal
    # Local errors of TOLERANCE in 1 to 2 thousand micro-steps.
    assert np.max(error) < 2000 * TOLERANCE


@pytest.mark.parametrize("cuts", [2, 50])
def test_result_does_not_depend_on_how_the_time_is_cut(cuts):
    end = 0.01
    whole = loaded().steps([end])
    cut = loaded().steps(np.linspace(0.0, end, cuts + 1)[1:])
    ragged = loaded().steps([*(end * np.linspace(0.0, 1.0, cuts + 1)[1:-1] ** 2), end])
    for other in (cut, ragged):
        assert np.max(np.abs(other - whole) / SPRING.state.nominal) < 2000 * TOLERANCE


def test_cut_does_not_matter_with_a_bouncing_valve():
    end = 0.004
    state = {"position": 0.2e-3}
    whole = Runner(parameters=STIFF_SEAT, state=state).steps([end])
    cut = Runner(parameters=STIFF_SEAT, state=state).steps(np.linspace(0.0, end, 41)[1:])
    # Impacts magnify the difference of the steps, of which there are more.
    assert np.max(np.abs(cut - whole) / SPRING.state.nominal) < 1e5 * TOLERANCE


def test_step_restore_step_is_bit_identical():
    runner = loaded()
    runner.steps([1e-3])
    saved = runner.x.copy()
    assert runner.step(1e-3, 1e-3) == OK
    first = runner.x.copy()
    runner.work[:] = math.nan  # nothing survives in the scratch space
    runner.x[:] = saved
    assert runner.step(1e-3, 1e-3) == OK
    assert np.array_equal(runner.x, first)


def test_inputs_vary_inside_the_step_as_their_polynomials():
    """A mass under the load a + b s + c s^2/2 + d s^3/6 has the integrals of the polynomial."""
    weak = {"spring_rate": 1e-9, "preload": 1.0, "damping_ratio": 0.0}
    runner = Runner(parameters=weak)
    a, b, c, d, h = 3.0, 200.0, -4e4, 5e6, 0.01
    runner.U[:, 0] = a + 1.0, b, c, d
    assert runner.step(0.0, h) == OK
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
    assert runner.step(0.0, 1e-3) == expected
    assert np.array_equal(runner.x, before) == (expected != OK)
