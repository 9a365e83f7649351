"""Rocker: a lever on a fixed pivot in its middle, with a pushrod at one end and a valve at the other."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component, PowerBond
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Vector, layouts
from .followers.tip import (
    TIP_BONDS,
    LeverMotion,
    Tip,
    TipInputs,
    TipOutputs,
    TipParameters,
    place_tip,
    show_tip,
)


@dataclass
class RockerParameters(TipParameters):
    """Angles are those of the closed valve. An arm at angle zero is normal to the motion of its end."""

    rod_arm: float = kinds.WIDTH("distance from the pivot to the pushrod's end", 32e-3)
    rod_angle: float = kinds.LEVER_ANGLE("angle by which the pushrod's arm falls")
    valve_arm: float = kinds.WIDTH("distance from the pivot to the centre of the pad", 40e-3)
    valve_angle: float = kinds.LEVER_ANGLE("angle by which the valve's arm falls")
    small_motion: float = kinds.SWITCH("constant lever ratio, that of the closed valve; false: true geometry")
    inertia: float = kinds.INERTIA("moment of inertia about the pivot", 6e-5)
    pivot_damping: float = kinds.TURNING_DAMPING("viscous friction of the pivot", nominal=1e-3)


@dataclass
class RockerInputs(TipInputs):
    rod_force: float = kinds.FORCE("force of the pushrod")
    pivot_torque: float = kinds.FRICTION_TORQUE("torque of the pivot's friction against the rotation")


@dataclass
class RockerOutputs(LeverMotion, TipOutputs):
    rod_position: float = kinds.DISPLACEMENT("position of the pushrod's end")
    rod_velocity: float = kinds.VELOCITY("velocity of the pushrod's end")
    ratio: float = kinds.NUMBER("velocity of the pad over that of the pushrod's end", 1.0)
    pivot_force: float = kinds.FORCE("force on the pivot, along the rod")


class Ends(NamedTuple):
    """The pushrod's end (m; m per rotation), and the pad."""

    rod: float
    rod_by_rotation: float
    tip: Tip


@kernel
def place_ends(x: LeverMotion, p: RockerParameters) -> Ends:
    """a (sin(rotation - alpha) + sin alpha); with small motion the directions stay."""
    turned = 0.0 if p.small_motion != 0.0 else x.rotation
    tip = place_tip(turned, p.valve_arm, p.valve_angle, p.tip_radius)
    a = turned - p.rod_angle
    by_rotation = p.rod_arm * math.cos(a)
    rod = p.rod_arm * (math.sin(a) + math.sin(p.rod_angle))
    if p.small_motion != 0.0:
        rod = by_rotation * x.rotation
        tip = Tip(tip.by_rotation * x.rotation, tip.by_rotation, tip.sliding, tip.entraining)
    return Ends(rod, by_rotation, tip)


def find_rod_position(tip: float, p: Mapping[str, float]) -> float:
    """Position of the pushrod's end (m) where the pad's is `tip` (m): `place_ends` the other way round.

    Where the arm does not reach so far it is that at its end.
    """
    rod, valve = p["rod_arm"], p["valve_arm"]
    if p["small_motion"]:
        return tip * rod * math.cos(p["rod_angle"]) / (valve * math.cos(p["valve_angle"]))
    rotation = p["valve_angle"] + math.asin(min(1.0, tip / valve - math.sin(p["valve_angle"])))
    return rod * (math.sin(rotation - p["rod_angle"]) + math.sin(p["rod_angle"]))


@kernel
def derivative(t: float, x: LeverMotion, u: RockerInputs, p: RockerParameters, dx: LeverMotion) -> None:
    """J phi'' = the moments of rod, valve, friction on the valve, and of the pivot."""
    ends = place_ends(x, p)
    moment = u.rod_force * ends.rod_by_rotation - u.tip_load * ends.tip.by_rotation
    moment -= u.tip_friction * ends.tip.sliding + p.pivot_damping * x.rotation_rate
    moment -= u.pivot_torque
    dx.rotation = x.rotation_rate
    dx.rotation_rate = moment / p.inertia


@kernel
def output(t: float, x: LeverMotion, u: RockerInputs, p: RockerParameters, y: RockerOutputs) -> None:
    ends = place_ends(x, p)
    show_tip(ends.tip, x.rotation_rate, 0.0, 0.0, p, y)
    y.rotation = x.rotation
    y.rotation_rate = x.rotation_rate
    y.rod_position = ends.rod
    y.rod_velocity = ends.rod_by_rotation * x.rotation_rate
    y.ratio = ends.tip.by_rotation / ends.rod_by_rotation
    y.pivot_force = u.rod_force + u.tip_load


@kernel
def energy(t: float, x: LeverMotion, u: RockerInputs, p: RockerParameters, e: Vector) -> None:
    e[0] = 0.5 * p.inertia * x.rotation_rate**2
    e[1] = p.pivot_damping * x.rotation_rate**2
    e[2] = 0.0


def rocker() -> Component:
    """J phi'' = F_rod a cos(..) - W L cos(..) - friction."""
    return Component(
        tolerance=FINE_TOLERANCE,
        name="rocker",
        description="Lever on a fixed pivot between pushrod and valve",
        roles=(roles.Rocker(find_rod_position),),
        **layouts(RockerParameters, LeverMotion, RockerInputs, RockerOutputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={"pivot_force": ("rod_force", "tip_load")},
        bonds=(
            *TIP_BONDS,
            PowerBond("rod_force", "rod_velocity", +1),
            PowerBond("pivot_torque", "rotation_rate", -1),
        ),
        event_indicators=("tip_entraining_velocity",),
    )
