"""Ramps of a cam, which take up the lash before the event and put the valve down after it.

A ramp is added to the event: a velocity that blends in as a half cosine, stays, and blends out while the
event begins. So s'' has no jump where the event has none.
"""

import math
from dataclasses import dataclass
from typing import Any

from ... import kinds
from ...compile.kernel import kernel
from ...core.quantities import Condition, Quantity
from .lift import Lift
from .profile import Breaks, turn_to_break

IF_RAMPS = Condition(("ramp_height",))


def angle_below_pi(description: str, **limits: Any) -> Quantity:
    """A cam angle of at most half a turn."""
    return kinds.ANGLE.of(description, maximum=math.pi, **limits)


@dataclass
class RampParameters:
    """Defaults: no ramps."""

    ramp_height: float = kinds.LASH("lift of the ramps; 0: none", minimum=0.0)
    opening_ramp_angle: float = angle_below_pi(
        "cam angle of constant velocity before the rise", minimum=0.0, only=IF_RAMPS
    ).default(math.radians(20.0))
    closing_ramp_angle: float = angle_below_pi(
        "cam angle of constant velocity after the fall", minimum=0.0, only=IF_RAMPS
    ).default(math.radians(20.0))
    ramp_blend_angle: float = angle_below_pi(
        "cam angle in which a ramp's velocity blends", positive=True, only=IF_RAMPS
    ).default(math.radians(5.0))


@kernel
def constant_angle(rising: bool, p: Any) -> float:
    """Cam angle of this side's constant velocity."""
    return p.opening_ramp_angle if rising else p.closing_ramp_angle


@kernel
def ramp_turn(rising: bool, p: Any) -> float:
    """Cam angle of this side's ramp outside the event."""
    return 0.0 if p.ramp_height == 0.0 else constant_angle(rising, p) + p.ramp_blend_angle


@kernel
def add_ramp(base: Lift, a: float, rising: bool, p: Any) -> Lift:
    """A lift with the ramp, a > 0 inside the event: the ramp ends at a = blend, at the height.

    v (a + constant + blend) in its middle, with v = height / (constant + blend). Derivatives are by a.
    """
    if p.ramp_height == 0.0:
        return base
    constant = constant_angle(rising, p)
    blend, velocity = p.ramp_blend_angle, p.ramp_height / (constant + p.ramp_blend_angle)
    into, left = a + constant + blend, blend - a
    if into <= 0.0:
        return base
    if left <= 0.0:
        return Lift(base.s + p.ramp_height, base.ds, base.dds)
    near = min(into, left)
    if near >= blend:
        return Lift(base.s + velocity * (into - 0.5 * blend), base.ds + velocity, base.dds)
    w = math.pi / blend
    s = 0.5 * velocity * (near - math.sin(w * near) / w)
    dds = 0.5 * velocity * w * math.sin(w * near)
    return Lift(
        base.s + (s if into < left else p.ramp_height - s),
        base.ds + 0.5 * velocity * (1.0 - math.cos(w * near)),
        base.dds + (dds if into < left else -dds),
    )


@kernel
def add_ramp_breaks(rising: bool, foot: float, angle: float, breaks: Breaks, p: Any) -> Breaks:
    """The breaks with those of the ramp at this foot of the event: both ends of both blends."""
    if p.ramp_height == 0.0:
        return breaks
    out = -1.0 if rising else 1.0
    constant, blend = constant_angle(rising, p), p.ramp_blend_angle
    breaks = turn_to_break(foot - out * blend, angle, breaks)
    breaks = turn_to_break(foot + out * constant, angle, breaks)
    return turn_to_break(foot + out * (constant + blend), angle, breaks)
