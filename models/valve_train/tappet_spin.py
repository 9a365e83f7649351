"""Spin of a flat tappet about its axis: its cam stands off the axis by e and turns it, its bore brakes it.

Along the contact line of length L the cam slides over the tappet with the velocity v, which has at the
distance z from the tappet's axis, e - L/2 <= z <= e + L/2, the parts

    v_x = u_s - Omega z along the sliding,    v_z = Omega x along the line

where u_s is the sliding without spin, x the contact's offset along the tappet and Omega the spin. The
friction F of the contact is spread evenly and acts along v, so that the means over the line are

    F_x = F <v_x/|v|>,    T = F <(z v_x - x v_z)/|v|>,    J Omega' = T - 2 pi mu R^3 L_b Omega/c

The contact slides with <|v|>: F_x u_s = F <|v|> + T Omega, no power is lost between them. The bore is sheared
as a bearing without load (Petroff 1883). With x = 0, and nothing that brakes, Omega = u_s/sqrt(e^2 + L^2/4).
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component, PowerBond
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Vector, layouts

# Gauss-Legendre points along the line.
_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_PLACES, _WEIGHTS = 0.5 * _PLACES, 0.5 * _WEIGHTS


@dataclass
class Parameters:
    """Defaults: a bucket of 30 mm in its bore, with hot engine oil."""

    axial_offset: float = kinds.OFFSET(
        "offset e of the cam's middle from the tappet's axis, along the camshaft"
    )
    length: float = kinds.WIDTH("length L of the contact line", 12e-3)
    inertia: float = kinds.INERTIA("moment of inertia J about the axis", 7e-6, nominal=1e-5)
    diameter: float = kinds.DIAMETER("diameter 2 R of the tappet", 30e-3)
    bore_length: float = kinds.WIDTH("length L_b of the bore", 25e-3)
    radial_clearance: float = kinds.CLEARANCE("radial clearance c in the bore", 20e-6)
    viscosity: float = kinds.VISCOSITY("viscosity of the oil", 0.01)


@dataclass
class State:
    spin: float = kinds.SPEED("spin Omega")


@dataclass
class Inputs:
    sliding_velocity: float = kinds.VELOCITY("sliding u_s of the cam over the tappet without spin")
    contact_offset: float = kinds.DISTANCE("offset x of the contact along the tappet")
    friction_force: float = kinds.FRICTION("friction F of the contact")


@dataclass
class Outputs(State):
    contact_sliding: float = kinds.VELOCITY("mean sliding <|v|> of the contact, with the sign of u_s")
    cam_friction: float = kinds.FRICTION("friction F_x on the cam against its sliding")
    spin_torque: float = kinds.PIN_TORQUE("torque T of the cam")
    bore_torque: float = kinds.PIN_TORQUE("torque of the bore against the spin")
    power_loss: float = kinds.POWER("power lost in the bore")


class Traction(NamedTuple):
    """Means over the line: <|v|> (m/s), <v_x/|v|>, and the torque over the friction (m)."""

    sliding: float
    along: float
    arm: float


@kernel
def find_traction(x: State, u: Inputs, p: Parameters) -> Traction:
    sliding = along = arm = 0.0
    across = x.spin * u.contact_offset
    for i in range(len(_PLACES)):
        z = p.axial_offset + p.length * _PLACES[i]
        ahead = u.sliding_velocity - x.spin * z
        speed = math.sqrt(ahead * ahead + across * across)
        if speed > 0.0:
            sliding += _WEIGHTS[i] * speed
            along += _WEIGHTS[i] * ahead / speed
            arm += _WEIGHTS[i] * (z * ahead - u.contact_offset * across) / speed
    return Traction(sliding, along, arm)


@kernel
def brake(p: Parameters) -> float:
    """2 pi mu R^3 L_b/c."""
    return 2.0 * math.pi * p.viscosity * (0.5 * p.diameter) ** 3 * p.bore_length / p.radial_clearance


@kernel
def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
    torque = abs(u.friction_force) * find_traction(x, u, p).arm
    dx.spin = (torque - brake(p) * x.spin) / p.inertia


@kernel
def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    traction = find_traction(x, u, p)
    y.spin = x.spin
    y.contact_sliding = math.copysign(traction.sliding, u.sliding_velocity)
    y.cam_friction = abs(u.friction_force) * traction.along
    y.spin_torque = abs(u.friction_force) * traction.arm
    y.bore_torque = brake(p) * x.spin
    y.power_loss = brake(p) * x.spin**2


@kernel
def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
    """Source: less what the contact loses, F <|v|>."""
    e[0] = 0.5 * p.inertia * x.spin**2
    e[1] = brake(p) * x.spin**2
    e[2] = -abs(u.friction_force) * find_traction(x, u, p).sliding


def tappet_spin() -> Component:
    """J Omega' = F <(z v_x - x v_z)/|v|> - 2 pi mu R^3 L_b Omega/c."""
    places = ("sliding_velocity", "contact_offset")
    return Component(
        tolerance=FINE_TOLERANCE,
        name="tappet_spin",
        description="Spin of a flat tappet about its axis",
        roles=(roles.Spin(), roles.Oiled()),
        **layouts(Parameters, State, Inputs, Outputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "contact_sliding": places,
            "cam_friction": (*places, "friction_force"),
            "spin_torque": (*places, "friction_force"),
        },
        bonds=(PowerBond("cam_friction", "sliding_velocity", +1),),
    )
