"""Cam profile of a closed form: rise by a law, dwell about the nose at pi, fall by the same law; ramps."""

import math
from dataclasses import dataclass
from typing import Any

from ... import kinds
from ...compile.kernel import kernel
from ...core.quantities import Condition, Quantity, Vector
from ...core.requirements import require
from .lift import Lift
from .profile import Breaks, CamProfile, turn_to_break
from .ramps import RampParameters, add_ramp, add_ramp_breaks, angle_below_pi, ramp_turn
from .rises import RISES, rise_by_number

IF_POWERS, IF_TRAPEZOID = (Condition(("law",), (law,)) for law in ("high_powers", "modified_trapezoid"))


def _share(description: str, **limits: Any) -> Quantity:
    return kinds.NUMBER.of(f"share of the rise {description}", maximum=1.0, **limits)


@dataclass
class RiseParameters:
    """Defaults: the set `kushwaha2000`."""

    law: float = kinds.NUMBER("law of rise and fall", choices=tuple(RISES))
    lift: float = kinds.CAM_LIFT("lift S of the law, without ramps", 8e-3)
    base_radius: float = kinds.DIAMETER("base circle radius R0", 2.610272395869072 * 8e-3)
    rise_angle: float = angle_below_pi("cam angle of the rise B", positive=True).default(
        math.radians(88.66608103115016)
    )
    fall_angle: float = angle_below_pi("cam angle of the fall; 0: as the rise", minimum=0.0).default()
    dwell_half_width: float = angle_below_pi("half width d of the dwell at the nose", minimum=0.0).default(
        math.radians(1.333918968849847)
    )
    power_p: float = kinds.NUMBER("power p of the law high_powers", 8.0, minimum=4.0, only=IF_POWERS)
    power_q: float = kinds.NUMBER("power q of the law high_powers", 14.0, minimum=4.0, only=IF_POWERS)
    power_r: float = kinds.NUMBER("power r of the law high_powers", 20.0, minimum=4.0, only=IF_POWERS)
    power_t: float = kinds.NUMBER("power t of the law high_powers", 26.0, minimum=4.0, only=IF_POWERS)
    onset_share: float = _share(
        "in which the acceleration of the law modified_trapezoid grows", positive=True, only=IF_TRAPEZOID
    ).default(0.125)
    flank_share: float = _share("in which this acceleration stays", minimum=0.0, only=IF_TRAPEZOID).default(
        0.25
    )
    reversal_share: float = _share(
        "in which it turns into the deceleration", positive=True, only=IF_TRAPEZOID
    ).default(0.25)
    nose_share: float = _share(
        "in which the deceleration stays; in what is left it fades", minimum=0.0, only=IF_TRAPEZOID
    ).default(0.25)


@dataclass
class LawParameters(RampParameters, RiseParameters):
    """Rise, dwell and fall with ramps."""


@kernel
def side_angle(rising: bool, p: Any) -> float:
    """B of this side."""
    return p.rise_angle if rising or p.fall_angle == 0.0 else p.fall_angle


@kernel
def rise_and_dwell(a: float, rise_angle: float, p: Any) -> Lift:
    """One side without ramp; a runs from 0 at the foot to B at the dwell, or the nose without dwell."""
    if a >= rise_angle and p.dwell_half_width > 0.0:
        return Lift(p.lift, 0.0, 0.0)
    if a <= 0.0:
        return Lift(0.0, 0.0, 0.0)
    return rise_by_number(p.law, a, rise_angle, p)


@kernel
def law_lift(angle: float, p: Any) -> Lift:
    """`angle` may be any real number; the nose is at pi (modulo 2 pi)."""
    from_nose = angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi)) - math.pi
    rising = from_nose < 0.0
    rise_angle = side_angle(rising, p)
    a = rise_angle - (abs(from_nose) - p.dwell_half_width)
    cam = add_ramp(rise_and_dwell(a, rise_angle, p), a, rising, p)
    return Lift(cam.s, cam.ds if rising else -cam.ds, cam.dds)


@kernel
def add_side_breaks(rising: bool, angle: float, breaks: Breaks, p: Any) -> Breaks:
    """Those of the rise, or of the fall."""
    side = -1.0 if rising else 1.0
    foot = p.dwell_half_width + side_angle(rising, p)
    breaks = turn_to_break(math.pi + side * p.dwell_half_width, angle, breaks)
    breaks = turn_to_break(math.pi + side * foot, angle, breaks)
    return add_ramp_breaks(rising, math.pi + side * foot, angle, breaks, p)


@kernel
def find_law_breaks(angle: float, p: Any) -> Breaks:
    """Both ends of rise, dwell and fall, and of every part of the ramps."""
    return add_side_breaks(False, angle, add_side_breaks(True, angle, Breaks(math.inf, math.inf), p), p)


@kernel
def turned_by(rising: bool, p: Any) -> float:
    """Cam angle from the middle of the dwell to the end of this side's ramp."""
    return p.dwell_half_width + side_angle(rising, p) + ramp_turn(rising, p)


@require(
    "rise_angle + dwell_half_width with the ramps = {0:g} deg before the nose, {1:g} deg after it: must be "
    "at most 180 deg each"
)
def event_fits(p: Any, numbers: Vector) -> bool:
    """Both sides within half a turn."""
    numbers[0], numbers[1] = math.degrees(turned_by(True, p)), math.degrees(turned_by(False, p))
    return max(turned_by(True, p), turned_by(False, p)) <= math.pi


@require("power_p, power_q, power_r, power_t = {0:g}, {1:g}, {2:g}, {3:g}: must ascend, e.g. 8, 14, 20, 26")
def powers_differ(p: Any, numbers: Vector) -> bool:
    """Otherwise the polynomial has no five coefficients."""
    numbers[0], numbers[1], numbers[2], numbers[3] = p.power_p, p.power_q, p.power_r, p.power_t
    return p.power_p < p.power_q < p.power_r < p.power_t


@require("onset_share + flank_share + reversal_share + nose_share = {0:g}: must be at most 1, the whole rise")
def shares_fit(p: Any, numbers: Vector) -> bool:
    """Up to rounding."""
    numbers[0] = p.onset_share + p.flank_share + p.reversal_share + p.nose_share
    return numbers[0] <= 1.0 + 1e-12


LAW = CamProfile(LawParameters, law_lift, find_law_breaks, (event_fits, powers_differ, shares_fit))
