"""Quarter car, split between chassis and wheel (displacement-displacement).

Schierz, Arnold and Clauss 2012 (doi 10.3384/ecp12076205), the benchmark of their section on step control:

    m_c x_c'' = -k_c (x_c - x_w) - d_c (x_c' - x_w')
    m_w x_w'' =  k_c (x_c - x_w) + d_c (x_c' - x_w') + k_w (z - x_w) - d_w x_w'

over a road that has stepped to the height z. Each side is given the other's position and velocity and
computes the suspension's force itself. The suspension's energy is booked with the chassis, the tyre's with
the wheel. `exact.quarter_car` has the solution.
"""

from dataclasses import dataclass
from typing import Annotated

from .. import kinds
from ..compile.kernel import kernel
from ..core.component import Component, PowerBond
from ..core.quantities import Vector, layouts

Stiffness = Annotated[float, kinds.STIFFNESS.of("stiffness k_c of the suspension", nominal=1e4, minimum=0.0)]
Damping = Annotated[float, kinds.DAMPING.of("damping d_c of the suspension", nominal=1e3)]
Force = Annotated[float, kinds.WALL_FORCE.of("force of the suspension, upwards on the wheel")]


@dataclass
class ChassisParameters:
    """Defaults: the published benchmark."""

    chassis_mass: float = kinds.MASS("mass m_c of the chassis", 400.0, nominal=100.0, positive=True)
    suspension_stiffness: Stiffness = 15e3
    suspension_damping: Damping = 1e3


@dataclass
class WheelParameters:
    """Defaults: the published benchmark."""

    wheel_mass: float = kinds.MASS("mass m_w of the wheel", 40.0, nominal=10.0, positive=True)
    suspension_stiffness: Stiffness = 15e3
    suspension_damping: Damping = 1e3
    tyre_stiffness: float = kinds.STIFFNESS("stiffness k_w of the tyre", 150e3, nominal=1e5, minimum=0.0)
    tyre_damping: float = kinds.DAMPING("damping d_w of the tyre", nominal=1e3)
    road_step: float = kinds.PLACE("height z to which the road has stepped", 0.1)


@dataclass
class State:
    position: float = kinds.PLACE("height over its rest before the step")
    velocity: float = kinds.VELOCITY("upward velocity")


@dataclass
class ChassisInputs:
    wheel_position: float = kinds.PLACE("height of the wheel")
    wheel_velocity: float = kinds.VELOCITY("upward velocity of the wheel")


@dataclass
class WheelInputs:
    chassis_position: float = kinds.PLACE("height of the chassis")
    chassis_velocity: float = kinds.VELOCITY("upward velocity of the chassis")


@dataclass
class ChassisOutputs(State):
    suspension_force: Force = 0.0


@dataclass
class WheelOutputs(State):
    suspension_force: Force = 0.0
    tyre_force: float = kinds.WALL_FORCE("force of the tyre, upwards on the wheel")


@kernel
def force_on_chassis(x: State, u: ChassisInputs, p: ChassisParameters) -> float:
    spring = p.suspension_stiffness * (u.wheel_position - x.position)
    return spring + p.suspension_damping * (u.wheel_velocity - x.velocity)


@kernel
def chassis_derivative(t: float, x: State, u: ChassisInputs, p: ChassisParameters, dx: State) -> None:
    dx.position = x.velocity
    dx.velocity = force_on_chassis(x, u, p) / p.chassis_mass


@kernel
def chassis_output(t: float, x: State, u: ChassisInputs, p: ChassisParameters, y: ChassisOutputs) -> None:
    y.position = x.position
    y.velocity = x.velocity
    y.suspension_force = -force_on_chassis(x, u, p)


@kernel
def chassis_energy(t: float, x: State, u: ChassisInputs, p: ChassisParameters, e: Vector) -> None:
    stretch, rate = x.position - u.wheel_position, x.velocity - u.wheel_velocity
    e[0] = 0.5 * (p.chassis_mass * x.velocity**2 + p.suspension_stiffness * stretch**2)
    e[1] = p.suspension_damping * rate**2
    e[2] = 0.0


@kernel
def force_on_wheel(x: State, u: WheelInputs, p: WheelParameters) -> float:
    spring = p.suspension_stiffness * (u.chassis_position - x.position)
    return spring + p.suspension_damping * (u.chassis_velocity - x.velocity)


@kernel
def tyre_force(x: State, p: WheelParameters) -> float:
    return p.tyre_stiffness * (p.road_step - x.position) - p.tyre_damping * x.velocity


@kernel
def wheel_derivative(t: float, x: State, u: WheelInputs, p: WheelParameters, dx: State) -> None:
    dx.position = x.velocity
    dx.velocity = (force_on_wheel(x, u, p) + tyre_force(x, p)) / p.wheel_mass


@kernel
def wheel_output(t: float, x: State, u: WheelInputs, p: WheelParameters, y: WheelOutputs) -> None:
    y.position = x.position
    y.velocity = x.velocity
    y.suspension_force = force_on_wheel(x, u, p)
    y.tyre_force = tyre_force(x, p)


@kernel
def wheel_energy(t: float, x: State, u: WheelInputs, p: WheelParameters, e: Vector) -> None:
    elastic = p.tyre_stiffness * (p.road_step - x.position) ** 2
    e[0] = 0.5 * (p.wheel_mass * x.velocity**2 + elastic)
    e[1] = p.tyre_damping * x.velocity**2
    e[2] = 0.0


def quarter_car_chassis() -> Component:
    """The chassis on its suspension, over a wheel that moves as given."""
    return Component(
        name="quarter_car_chassis",
        description="Chassis of the quarter car, on its suspension",
        **layouts(ChassisParameters, State, ChassisInputs, ChassisOutputs),
        derivative=chassis_derivative,
        output=chassis_output,
        energy=chassis_energy,
        feedthrough={"suspension_force": ("wheel_position", "wheel_velocity")},
        bonds=(PowerBond("suspension_force", "wheel_velocity", -1),),
    )


def quarter_car_wheel() -> Component:
    """The wheel on its tyre, under a chassis that moves as given."""
    return Component(
        name="quarter_car_wheel",
        description="Wheel of the quarter car, between road and suspension",
        **layouts(WheelParameters, State, WheelInputs, WheelOutputs),
        derivative=wheel_derivative,
        output=wheel_output,
        energy=wheel_energy,
        feedthrough={"suspension_force": ("chassis_position", "chassis_velocity")},
        bonds=(PowerBond("suspension_force", "velocity", +1),),
    )
