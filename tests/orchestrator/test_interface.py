"""What an iteration makes agree, and what is looked for inside a step."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from orchestrator.engine.coupling import Coupling
from orchestrator.engine.coupling_state import CouplingState
from orchestrator.engine.signals import DEGREES
from orchestrator.masters.interface import BEND, bind_interface
from orchestrator.participants import in_process
from orchestrator.stepping.locator import find_dip

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
