"""Friction of a lever's pivot: Coulomb friction that sticks, and viscous friction.

A spring with a damper, in series with a Coulomb slider (Prandtl 1928, Jenkins 1962): the touching surfaces
twist by z before they slide, so that the pivot sticks without an event. With the limit T_c = mu r |F| + T_0,
which varies with the load F,

    T  = k (z + tau omega), between -T_c and T_c       where it is cut off, the pivot slides
    z' = (T/k - z)/tau                                 omega, while the pivot sticks

and the whole torque is T + c omega. T omega is the rate of k z^2/2 and losses, none of them negative.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, NamedTuple

from ..compile.kernel import kernel
from ..core.bonds import counts_energies
from ..core.component import Component, PowerBond
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Layout, Quantity, Vector
from ..plausible import PART_LENGTH


@dataclass
class PivotFrictionParameters:
    """Defaults: a pin of 16 mm in mixed lubrication, which twists by 1.3 um under 1000 N before it slides."""

    friction_coefficient: Annotated[
        float, Quantity("1", "Coulomb's coefficient of friction mu", nominal=0.1, minimum=0.0)
    ] = 0.1
    radius: Annotated[
        float,
        Quantity(
            "m", "radius of the pivot's pin or ball", nominal=1e-2, positive=True, display_unit="mm",
            plausible=PART_LENGTH,
        ),
    ] = 8e-3  # fmt: skip
    preload_torque: Annotated[
        float, Quantity("N.m", "limit T_0 of the dry friction without load", nominal=0.1, minimum=0.0)
    ] = 0.0
    viscous_coefficient: Annotated[
        float, Quantity("N.m.s", "viscous friction c over speed", nominal=1e-3, minimum=0.0)
    ] = 0.0
    sticking_stiffness: Annotated[
        float, Quantity("N.m/rad", "stiffness k of the sticking surfaces", nominal=1e3, positive=True)
    ] = 5e3
    relaxation_time: Annotated[
        float, Quantity("s", "damping of their twist over the stiffness, tau", nominal=1e-5, positive=True)
    ] = 3e-5


@dataclass
class PivotFrictionState:
    twist: Annotated[float, Quantity("rad", "elastic twist z of the sticking surfaces", nominal=1e-4)] = 0.0


@dataclass
class PivotFrictionInputs:
    rotation_rate: Annotated[float, Quantity("rad/s", "speed omega of the lever", nominal=10.0)] = 0.0
    load: Annotated[float, Quantity("N", "force F on the pivot", nominal=500.0)] = 0.0


@dataclass
class PivotFrictionOutputs:
    friction_torque: Annotated[
        float, Quantity("N.m", "torque T against the lever's rotation", nominal=0.1)
    ] = 0.0
    sliding_torque: Annotated[
        float, Quantity("N.m", "limit T_c of the dry friction under this load", nominal=0.1)
    ] = 0.0
    sticking_margin: Annotated[
        float,
        Quantity("N.m", "limit less what sticking would take; negative: it slides", nominal=0.1),
    ] = 0.0
    sliding_rate: Annotated[
        float, Quantity("rad/s", "part of the speed by which the surfaces slide", nominal=10.0)
    ] = 0.0
    power_loss: Annotated[float, Quantity("W", "power lost to friction", nominal=1.0)] = 0.0


class Twist(NamedTuple):
    """Torque that sticking would take, and the dry torque (N m); rates of twist and of sliding (rad/s)."""

    sticking: float
    torque: float
    rate: float
    sliding: float


@kernel
def sliding_torque(u: PivotFrictionInputs, p: PivotFrictionParameters) -> float:
    """T_c = mu r |F| + T_0."""
    return p.friction_coefficient * p.radius * abs(u.load) + p.preload_torque


@kernel
def find_twist(x: PivotFrictionState, u: PivotFrictionInputs, p: PivotFrictionParameters) -> Twist:
    limit = sliding_torque(u, p)
    sticking = p.sticking_stiffness * (x.twist + p.relaxation_time * u.rotation_rate)
    if abs(sticking) <= limit:
        return Twist(sticking, sticking, u.rotation_rate, 0.0)
    torque = math.copysign(limit, sticking)
    rate = (torque / p.sticking_stiffness - x.twist) / p.relaxation_time
    return Twist(sticking, torque, rate, u.rotation_rate - rate)


@kernel
def lost_power(twist: Twist, u: PivotFrictionInputs, p: PivotFrictionParameters) -> float:
    """By sliding, which has the sign of T, by the damped twist, and by viscosity."""
    damped = p.sticking_stiffness * p.relaxation_time * twist.rate**2
    return twist.torque * twist.sliding + damped + p.viscous_coefficient * u.rotation_rate**2


@kernel
def derivative(
    t: float,
    x: PivotFrictionState,
    u: PivotFrictionInputs,
    p: PivotFrictionParameters,
    dx: PivotFrictionState,
) -> None:
    dx.twist = find_twist(x, u, p).rate


@kernel
def output(
    t: float,
    x: PivotFrictionState,
    u: PivotFrictionInputs,
    p: PivotFrictionParameters,
    y: PivotFrictionOutputs,
) -> None:
    twist = find_twist(x, u, p)
    y.friction_torque = twist.torque + p.viscous_coefficient * u.rotation_rate
    y.sliding_torque = sliding_torque(u, p)
    y.sticking_margin = y.sliding_torque - abs(twist.sticking)
    y.sliding_rate = twist.sliding
    y.power_loss = lost_power(twist, u, p)


@kernel
def energy(
    t: float, x: PivotFrictionState, u: PivotFrictionInputs, p: PivotFrictionParameters, e: Vector
) -> None:
    e[0] = 0.5 * p.sticking_stiffness * x.twist**2
    e[1] = lost_power(find_twist(x, u, p), u, p)
    e[2] = 0.0


@counts_energies
def pivot_friction() -> Component:
    """T = k (z + tau omega), at most mu r |F| + T_0; z' = (T/k - z)/tau."""
    turning = ("rotation_rate", "load")
    return Component(
        tolerance=FINE_TOLERANCE,
        name="pivot_friction",
        description="Friction of a lever's pivot: sticking, sliding and viscous",
        parameters=Layout(PivotFrictionParameters),
        state=Layout(PivotFrictionState),
        inputs=Layout(PivotFrictionInputs),
        outputs=Layout(PivotFrictionOutputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "friction_torque": turning,
            "sliding_torque": ("load",),
            "sticking_margin": turning,
            "sliding_rate": turning,
            "power_loss": turning,
        },
        bonds=(PowerBond("friction_torque", "rotation_rate", +1),),
        event_indicators=("sticking_margin",),
    )
