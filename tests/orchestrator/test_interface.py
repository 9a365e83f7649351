"""What an iteration makes agree, what is looked for inside a step, and what set its length."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from orchestrator.engine.coupling import Coupling
from orchestrator.engine.coupling_state import CouplingState
from orchestrator.engine.signals import DEGREES
from orchestrator.engine.step import REASONS
from orchestrator.masters.interface import BEND, bind_interface
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.stepping import ControlledSteps, StepControl
from orchestrator.stepping.locator import find_dip

from .faulty import CONTROLLED, TOLERANCE, faulty, simulated
from .test_events import bouncing, controlled, hermite
from .two_masses import two_masses

STEP = 0.01


def exchanging(degree):
    system = two_masses()
    units = {name: in_process(name, instance) for name, instance in system.instances.items()}
    coupling = Coupling(system, units, degree)
    coupling.initialise(0.0, 1.0)
    return coupling


@pytest.mark.parametrize("signal", DEGREES)
def test_signals_that_go_to_a_vector_end_there(signal):
    """A round trip, to rounding. Of rates only cubic signals know."""
    coupling = exchanging(DEGREES[signal])
    interface = bind_interface(coupling, coupling.wiring.all, STEP)
    assert interface.size == (6 if signal == "hermite" else 3)
    wanted = np.random.default_rng(1).standard_normal(interface.size)
    interface.assume(wanted, STEP)
    np.testing.assert_allclose(interface.predict(STEP), wanted, rtol=0.0, atol=1e-13)


def test_the_vector_is_values_and_rates_in_units_of_the_step():
    coupling = exchanging(3)
    coupling.state.values[:], coupling.state.rates[:] = (2.0, 3.0, 5.0), (7.0, 11.0, 13.0)
    for step in (STEP, 2.0 * STEP):
        expected = np.concatenate(
            [
                coupling.state.values / coupling.wiring.nominal,
                BEND * step * coupling.state.rates / coupling.wiring.nominal,
            ]
        )
        interface = bind_interface(coupling, coupling.wiring.all, step)
        np.testing.assert_allclose(interface.gather(), expected, rtol=1e-15)


numbers = st.floats(-1.0, 1.0).filter(lambda value: abs(value) > 1e-3)


@given(ends=st.tuples(numbers, numbers), rates=st.tuples(numbers, numbers), length=st.floats(1.0, 10.0))
def test_an_indicator_that_dips_in_a_step_is_found_where_its_cubic_is_lowest(ends, rates, length):
    """Against the cubic at a thousand instants: its second derivative is below 12 / L^2 + 6 / L, so that
    between two of them it is lower by less than 1e-5."""
    ends = ends[0], abs(ends[1]) * np.sign(ends[0])  # no change of sign from end to end
    before, now = (CouplingState(1, np.array([True]), 3) for _ in range(2))
    for state, value, rate in zip((before, now), ends, rates, strict=True):
        state.values[:], state.rates[:] = value, rate
    found = find_dip([0], before, now, length)
    cubic = CubicHermiteSpline([0.0, length], ends, rates)
    seen = np.sign(ends[0]) * cubic(np.linspace(0.0, length, 1001))
    if found == length:
        assert seen.min() > -1e-5
    else:
        assert np.sign(ends[0]) * cubic(found) == pytest.approx(seen.min(), abs=1e-5)
        assert np.sign(ends[0]) * cubic(found) < 0.0


ERROR, GROWTH = REASONS.index("error"), REASONS.index("growth")


def steps_of(kind, first):
    """Those of two masses from a first step of this length (s)."""
    master, estimator = CONTROLLED[kind]
    control = StepControl(estimator, relative=TOLERANCE, absolute=TOLERANCE)
    recorder, ended = simulated(faulty(), master, ControlledSteps(first, control))
    assert ended is None
    return recorder.steps[1:]  # the start is a step of no length


@pytest.mark.parametrize("kind", CONTROLLED)
def test_a_first_step_far_too_short_grows_until_the_error_sets_the_length(kind):
    """Doubling at most takes the binary logarithm of the ratio; begun at that length, little has to grow."""
    first = 1e-9
    steps = steps_of(kind, first)
    length = float(np.median([step.length for step in steps if step.reason == ERROR]))
    growing = next(i for i, step in enumerate(steps) if step.reason == ERROR)
    assert {step.reason for step in steps[:growing]} == {GROWTH}
    assert growing >= math.log2(steps[growing].length / first)
    begun_there = sum(step.reason == GROWTH for step in steps_of(kind, length))
    assert begun_there < 0.2 * growing


def test_free_flight_is_never_limited_by_the_error():
    """Between bounces nothing is exchanged that changes the motion: the coupling has no error there."""
    recorder, truth, _ = bouncing(controlled(1e-7), hermite(1e-7), 1.0)
    flying = truth[:, 0] > 1e-3  # m over the stop
    ends, steps = np.flatnonzero(flying), recorder.steps
    inside = [steps[i] for i in ends[1:] if flying[i - 1]]
    assert len(inside) > 10
    assert ERROR not in {step.reason for step in inside}
    assert {step.reason for step in steps[1:]} >= {ERROR, GROWTH}
