"""The end of a lever on a valve: a pad of circular arc on the flat tip of the stem.

The tip is normal to the valve's path. The pad's centre moves on a circle about the lever's pivot.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

from ... import kinds
from ...compile.kernel import kernel
from ...core.component import PowerBond


@dataclass
class TipParameters:
    tip_radius: float = kinds.ARC("radius of the lever's pad on the valve", 10e-3)


@dataclass
class TipInputs:
    tip_load: float = kinds.FORCE("load of the lever on the valve")
    tip_friction: float = kinds.FRICTION("friction on the lever's pad against its sliding")


@dataclass
class TipOutputs:
    tip_position: float = kinds.DISPLACEMENT("position of the pad towards the valve")
    tip_velocity: float = kinds.VELOCITY("velocity of the pad towards the valve")
    tip_entraining_velocity: float = kinds.VELOCITY(
        "mean surface velocity relative to the contact on the valve"
    )
    tip_sliding_velocity: float = kinds.VELOCITY("velocity of the pad over the valve's tip")
    tip_contact_radius: float = kinds.DISTANCE("reduced radius of pad and tip", 10e-3)


@dataclass
class LeverMotion:
    rotation: float = kinds.ANGLE("rotation, zero with the valve closed", nominal=0.1)
    rotation_rate: float = kinds.ROTATION_RATE("rate of the rotation")


TIP_BONDS = (PowerBond("tip_load", "tip_velocity", -1), PowerBond("tip_friction", "tip_sliding_velocity", -1))


class Tip(NamedTuple):
    """Position of the pad (m); its velocity, sliding and entraining velocity per rotation rate (m)."""

    position: float
    by_rotation: float
    sliding: float
    entraining: float


@kernel
def place_tip(rotation: float, arm: float, angle: float, radius: float) -> Tip:
    """The pad's centre is at L (cos a, sin a) from the pivot, a = rotation - angle; rotation 0: valve closed.

    Pad and contact move along the tip with L sin(a). The pad's surface passes the contact with r, the
    tip's with -L sin(a).
    """
    a = rotation - angle
    rise = arm * math.sin(a)
    return Tip(rise + arm * math.sin(angle), arm * math.cos(a), radius + rise, 0.5 * (radius - rise))


@kernel
def show_tip(tip: Tip, rate: float, pivot: float, pivot_velocity: float, p: Any, y: Any) -> None:
    """The outputs of a lever that turns at this rate (rad/s) about a pivot that moves."""
    y.tip_position = pivot + tip.position
    y.tip_velocity = pivot_velocity + tip.by_rotation * rate
    y.tip_sliding_velocity = tip.sliding * rate
    y.tip_entraining_velocity = tip.entraining * rate
    y.tip_contact_radius = p.tip_radius
