"""A motion dense enough to draw: the same motion, with both sides of its impacts."""

from functools import cache

import numpy as np
import pytest

from models.slider_crank.forms import wall_rate
from models.slider_crank.motions.machine import FORMS, Machine, Motion
from models.slider_crank.motions.portrait import Portrait, trace_portrait

CYCLES, POINTS = 3, 200
# psi, psi' and the walls' come from the same formulas; rounding of angles of 10 cycles.
ROUNDING = 1e-13


@cache
def draw_portrait(form: str) -> tuple[Machine, Portrait]:
    machine = Machine(0.05, 0.015, form=form)
    return machine, trace_portrait(Motion(machine).skip(10), CYCLES, POINTS)


def find_impacts(found: Portrait) -> np.ndarray:
    """Places of the second of both points of an impact."""
    return np.flatnonzero(np.diff(found.theta) == 0.0) + 1


@pytest.mark.parametrize("form", FORMS)
def test_portrait_is_the_trace_with_impacts(form: str) -> None:
    """Without the points of impacts it is `Motion.trace`, to the last bit, and ends where that ends."""
    machine, found = draw_portrait(form)
    motion, twin = Motion(machine).skip(10), Motion(machine).skip(10)
    theta, states = motion.trace(CYCLES, POINTS)
    trace_portrait(twin, CYCLES, POINTS)
    kept = np.ones(found.theta.size, dtype=bool)
    for second in find_impacts(found):
        kept[second - 1 : second + 1] = False
    np.testing.assert_array_equal(found.theta[kept], theta)
    np.testing.assert_array_equal(found.psi[kept], states[:, 0])
    np.testing.assert_array_equal(found.psi_rate[kept], states[:, 1])
    np.testing.assert_array_equal(twin.strobe(1), motion.strobe(1))


@pytest.mark.parametrize("form", FORMS)
def test_impacts_are_at_the_walls_and_reverse_the_relative_rate(form: str) -> None:
    """F (2.16), (2.17): psi' - psi'_wall is multiplied by -e; where sliding begins it ends."""
    machine, found = draw_portrait(form)
    assert np.all(np.diff(found.theta) >= 0.0)
    assert np.all(found.psi <= found.upper + ROUNDING)
    assert np.all(found.psi >= found.lower - ROUNDING)
    index, m = float(FORMS.index(form)), machine.mechanism
    impacts = find_impacts(found)
    assert impacts.size > 5
    for i in impacts:
        wall = found.upper[i] if found.psi[i] > 0.0 else found.lower[i]
        assert found.psi[i] == found.psi[i - 1] == pytest.approx(wall, abs=ROUNDING)
        rate = wall_rate(index, found.theta[i], 1.0, found.psi[i], m)
        before, after = found.psi_rate[i - 1] - rate, found.psi_rate[i] - rate
        assert before * np.sign(wall) > 0.0
        left = 0.0 if found.side[i] != 0.0 else machine.restitution
        assert after == pytest.approx(-left * before, abs=ROUNDING)
