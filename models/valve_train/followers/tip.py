"""The end of a lever on a valve: a pad of circular arc on the flat tip of the stem.

The tip is normal to the valve's path. The pad's centre moves on a circle about the lever's pivot.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ...core.component import PowerBond
from ...core.quantities import Quantity
from ...plausible import CURVATURE


@dataclass
class TipParameters:
    tip_radius: float = Quantity(
        "m", "radius of the lever's pad on the valve",
        nominal=1e-2, positive=True, display_unit="mm", plausible=CURVATURE,
    ).default(10e-3)  # fmt: skip


@dataclass
class TipInputs:
    tip_load: float = Quantity("N", "load of the lever on the valve", nominal=500.0).default()
    tip_friction: float = Quantity(
        "N", "friction on the lever's pad against its sliding", nominal=10.0
    ).default()


@dataclass
class TipOutputs:
    tip_position: float = Quantity(
        "m", "position of the pad towards the valve", nominal=1e-3, display_unit="mm"
    ).default()
    tip_velocity: float = Quantity("m/s", "velocity of the pad towards the valve").default()
    tip_entraining_velocity: float = Quantity(
        "m/s", "mean surface velocity relative to the contact on the valve"
    ).default()
    tip_sliding_velocity: float = Quantity("m/s", "velocity of the pad over the valve's tip").default()
    tip_contact_radius: float = Quantity(
        "m", "reduced radius of pad and tip", nominal=1e-2, display_unit="mm"
    ).default(10e-3)


@dataclass
class LeverMotion:
    rotation: float = Quantity(
        "rad", "rotation, zero with the valve closed", nominal=0.1, display_unit="deg"
    ).default()
    rotation_rate: float = Quantity("rad/s", "rate of the rotation", nominal=10.0).default()


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
