"""A motion that never leaves the wall."""

import math

from models.slider_crank.motions.machine import Machine, Motion


def test_a_motion_on_the_wall_has_no_memory_from_whatever_moment_it_is_followed() -> None:
    # No start makes a difference on the wall: both exponents are -infinity (F 2.6, region III).
    motion = Motion(Machine(damping=0.25, gap=0.015, form="corrected")).skip(10)
    found = motion.exponents(40)
    assert (found.largest, found.second) == (-math.inf, -math.inf)
    assert found.impacts_per_cycle == 0.0
