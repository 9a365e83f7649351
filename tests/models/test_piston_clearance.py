"""Clearance of valve and piston: closed forms at the dead centres, and of an inclined valve."""

import math

import numpy as np
import pytest

from models.catalogue import CATALOGUE

from .systems import outputs_of

pytestmark = pytest.mark.plain

R, ROD, DECK, RECESS, DEPTH = 43e-3, 143e-3, 1e-3, 1e-3, 3e-3


def find(angle: float, lift: float = 0.0, **parameters: float) -> dict[str, float]:
    return outputs_of(CATALOGUE["piston_clearance"](), parameters, {}, {"angle": angle, "valve_lift": lift})


@pytest.mark.parametrize("offset", [0.0, 8e-3, -8e-3])
def test_the_piston_turns_at_the_sum_and_the_difference_of_rod_and_crank(offset, record):
    """The stroke is sqrt((l+r)^2 - e^2) - sqrt((l-r)^2 - e^2), whichever way the pin is offset."""
    travel = [find(a, pin_offset=offset)["piston_travel"] for a in np.linspace(-math.pi, math.pi, 2001)]
    stroke = math.sqrt((ROD + R) ** 2 - offset**2) - math.sqrt((ROD - R) ** 2 - offset**2)
    # The turning point lies within half a step: R (pi/2000)^2/2 too little.
    record("Train", "stroke with an offset pin (m)", max(travel), stroke, "closed form", relative=2e-6)
    assert find(0.0, pin_offset=offset)["piston_travel"] == pytest.approx(0.0, abs=1e-16)
    assert min(travel) > -1e-15


def test_without_offset_the_travel_is_that_of_the_textbook_crank():
    """x = r (1 - cos) + l (1 - sqrt(1 - (r/l sin)^2))."""
    a = math.radians(77.0)
    expected = R * (1.0 - math.cos(a)) + ROD * (1.0 - math.sqrt(1.0 - (R / ROD * math.sin(a)) ** 2))
    assert find(a)["piston_travel"] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("degrees", [0.0, 20.0, -35.0])
def test_at_top_dead_centre_the_clearance_is_what_the_lift_leaves_of_recess_pocket_and_deck(degrees):
    tilt = math.radians(degrees)
    found = find(2.0, 2.5e-3, valve_angle=tilt, top_angle=2.0)
    assert found["clearance"] == pytest.approx(RECESS + DEPTH + DECK * math.cos(tilt) - 2.5e-3)
    assert found["radial_clearance"] == pytest.approx(2e-3)


def test_an_inclined_pocket_moves_along_and_across_the_valve_as_the_piston_does():
    tilt, angle = math.radians(20.0), 0.6
    found, straight = find(angle, valve_angle=tilt), find(angle, valve_angle=0.0)
    travel = found["piston_travel"]
    along, across = found["clearance"] - RECESS - DEPTH, 2e-3 - found["radial_clearance"]
    assert math.hypot(along - DECK * math.cos(tilt), across) == pytest.approx(travel)
    assert straight["clearance"] - RECESS - DEPTH - DECK == pytest.approx(travel)


def test_a_cam_turns_half_as_far_as_its_crank():
    assert find(0.3, angle_ratio=2.0)["clearance"] == find(0.6)["clearance"]
