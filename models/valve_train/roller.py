"""Spin of a roller on its pin: the cam drives it by traction, its inertia and the pin hold it back.

It is the moving surface of a `pad` of tappet or finger, with the surface speed r omega. omega is the spin
about the body that carries the pin, v the surface speed at which nothing would slide:

    J (omega - beta')' = r T - T_p - c omega - r F_R

The traction T sticks and slides as a `slider` with the slip v - r omega and the limit mu W. beta' is the
rotation of the carrier against the spin, T_p + c omega the friction of the pin, F_R the rolling friction.
"""

from dataclasses import dataclass

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component, PowerBond
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Vector, layouts
from .slider import Creep, RelaxationTime, Slip, StickingStiffness, find_slip, lost_power


@dataclass
class Parameters:
    """Defaults: a steel ring of 9 mm and 12 mm length on its pin."""

    radius: float = kinds.ARC("radius r of the roller", 9e-3)
    inertia: float = kinds.INERTIA("moment of inertia J about the pin", 8e-7, nominal=1e-6)
    traction_coefficient: float = kinds.NUMBER(
        "largest traction over load, mu", 0.05, nominal=0.05, minimum=0.0
    )
    pin_damping: float = kinds.TURNING_DAMPING("viscous friction c of the pin over speed", 1e-5, nominal=1e-5)
    sticking_stiffness: StickingStiffness = 1e7
    relaxation_time: RelaxationTime = 3e-5


@dataclass
class State:
    absolute_spin: float = kinds.SPEED("spin in space, omega - beta'")
    creep: Creep = 0.0


@dataclass
class Inputs:
    rolling_velocity: float = kinds.VELOCITY("surface speed v at which nothing would slide")
    load: float = kinds.FORCE("load W of the contact")
    pin_torque: float = kinds.PIN_TORQUE("further friction T_p of the pin, against the spin")
    rolling_friction: float = kinds.FORCE(
        "rolling friction F_R of the contact, against its motion", nominal=1.0
    )
    rotation_rate: float = kinds.ROTATION_RATE("rotation beta' of the carrier, against the spin")


@dataclass
class Outputs:
    surface_speed: float = kinds.VELOCITY("r omega along the carrier")
    spin: float = kinds.SPEED("spin omega about the carrier")
    traction: float = kinds.FRICTION("traction T of the cam")
    traction_margin: float = kinds.FRICTION(
        "largest traction less what sticking would take; negative: it slides"
    )
    slip: float = kinds.VELOCITY("velocity by which the surfaces slide")
    carrier_torque: float = kinds.PIN_TORQUE(
        "torque on the carrier, with the spin, beyond that of a fixed pad"
    )
    power_loss: float = kinds.POWER("power lost to slip, and to the pin's damping")


@kernel
def find_creep(x: State, u: Inputs, p: Parameters) -> Slip:
    slip = u.rolling_velocity - p.radius * (x.absolute_spin + u.rotation_rate)
    limit = p.traction_coefficient * max(0.0, u.load)
    return find_slip(x.creep, slip, limit, p.sticking_stiffness, p.relaxation_time)


@kernel
def braking_torque(x: State, u: Inputs, p: Parameters) -> float:
    """T_p + c omega + r F_R."""
    pin = u.pin_torque + p.pin_damping * (x.absolute_spin + u.rotation_rate)
    return pin + p.radius * u.rolling_friction


@kernel
def lost_to_friction(x: State, u: Inputs, p: Parameters) -> float:
    creep = lost_power(find_creep(x, u, p), p.sticking_stiffness, p.relaxation_time)
    return creep + p.pin_damping * (x.absolute_spin + u.rotation_rate) ** 2


@kernel
def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
    creep = find_creep(x, u, p)
    dx.absolute_spin = (p.radius * creep.transmitted - braking_torque(x, u, p)) / p.inertia
    dx.creep = creep.rate


@kernel
def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    creep = find_creep(x, u, p)
    y.spin = x.absolute_spin + u.rotation_rate
    y.surface_speed = p.radius * y.spin
    y.traction = creep.transmitted
    y.traction_margin = p.traction_coefficient * max(0.0, u.load) - abs(creep.sticking)
    y.slip = creep.sliding
    y.carrier_torque = braking_torque(x, u, p) - p.radius * creep.transmitted
    y.power_loss = lost_to_friction(x, u, p)


@kernel
def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
    e[0] = 0.5 * p.inertia * x.absolute_spin**2 + 0.5 * p.sticking_stiffness * x.creep**2
    e[1] = lost_to_friction(x, u, p)
    e[2] = 0.0


def roller() -> Component:
    """J (omega - beta')' = r T - T_p - c omega, with the traction T of at most mu W."""
    surfaces = ("rolling_velocity", "load", "rotation_rate")
    return Component(
        tolerance=FINE_TOLERANCE,
        name="roller",
        description="Spin of a roller that may slip on its cam",
        roles=(roles.Roller(),),
        **layouts(Parameters, State, Inputs, Outputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "surface_speed": ("rotation_rate",),
            "spin": ("rotation_rate",),
            "traction": surfaces,
            "traction_margin": surfaces,
            "slip": surfaces,
            "carrier_torque": (*surfaces, "pin_torque", "rolling_friction"),
            "power_loss": surfaces,
        },
        bonds=(
            PowerBond("traction", "rolling_velocity", +1),
            PowerBond("pin_torque", "spin", -1),
            PowerBond("rolling_friction", "surface_speed", -1),
            PowerBond("carrier_torque", "rotation_rate", +1),
        ),
        event_indicators=("traction_margin",),
    )
