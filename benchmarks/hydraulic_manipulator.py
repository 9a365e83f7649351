"""Two links in a plane that a hydraulic cylinder lifts: the hydraulicManipulator of cosim-benchmarks.

Laboratorio de Ingenieria Mecanica, Universidade da Coruna (github.com/fgonzalezLIM/cosim-benchmarks). Links
of lengths L and L_h, the first of mass m with m_p at its end, the second without mass with m_h at its end, at
angles theta_1 and theta_2 over the horizontal; g acts downwards:

    M theta'' = c + f + J f_h,  s = L sqrt(1 - sqrt(3)/2 cos theta_1),  J = sqrt(3) L^2 sin theta_1 / (4 s)
    M = [L^2 (m/3 + m_p + m_h), L L_h m_h cos(theta_1 - theta_2); the same, L_h^2 m_h]
    c = -L L_h m_h sin(theta_1 - theta_2) [theta_2'^2, -theta_1'^2]
    f = -g [L (m/2 + m_p + m_h) cos theta_1, L_h m_h cos theta_2]

(the description divides all three masses by 3 and by 2; its code, and its weight of 8829 N, are as here). The
cylinder's two chambers, with valve areas a_i = kappa 5e-4 m^2 and a_o = (1 - kappa) 5e-4 m^2:

    f_h = (p_2 - p_1) a - c s',  l_1 = l/2 + s_0 - s,  l_2 = l/2 + s - s_0
    p_1' = beta(p_1)/(a l_1) (a s' + a_i q(p_P - p_1) - a_o q(p_1 - p_T)),  q(p) = c_d sqrt(2 p/rho)
    p_2' = beta(p_2)/(a l_2) (-a s' + a_o q(p_P - p_2) - a_i q(p_2 - p_T))
    beta(p) = (1 + a_1 p + b_1 p^2)/(a_1 + 2 b_1 p)

The valve follows the sinusoidal manoeuvre M2 (2 Hz, as its data have it), from equilibrium. No energies are
counted in the cylinder, whose fluid comes from outside.
"""

import math
from dataclasses import dataclass

from models.compile.kernel import kernel
from models.core.component import Component
from models.core.quantities import Layout, Quantity, Vector

LENGTH, SECOND = 1.0, 0.5
LINK, FIRST_MASS, SECOND_MASS = 200.0, 250.0, 100.0
GRAVITY = 9.81
AREA, CYLINDER, FRICTION, LENGTH_0 = 65e-4, 0.442, 1e5, 0.5
DISCHARGE, DENSITY, PUMP, TANK = 0.67, 850.0, 7.6e6, 0.1e6
FLUID_A, FLUID_B = 6.53e-10, -1.19e-18
VALVE = 5e-4
# Equilibrium: the weight along the cylinder, pressures about their mean, and equal flows at both chambers.
WEIGHT = GRAVITY * (LINK / 2 + FIRST_MASS + SECOND_MASS) * math.cos(math.pi / 6) / (math.sqrt(3) / 4)
PRESSURE_1, PRESSURE_2 = (0.5 * (PUMP + TANK + sign * WEIGHT / AREA) for sign in (-1.0, 1.0))
OPENING = 1.0 / (1.0 + math.sqrt((PUMP - PRESSURE_1) / (PRESSURE_1 - TANK)))


@dataclass
class LinksParameters:
    load: float = Quantity("kg", "mass m_h at the end of the second link", positive=True).default(SECOND_MASS)


@dataclass
class CylinderParameters:
    friction: float = Quantity("N.s/m", "friction c of the piston", minimum=0.0).default(FRICTION)


@dataclass
class Links:
    angle_1: float = Quantity("rad", "angle theta_1 of the first link").default(math.pi / 6)
    angle_2: float = Quantity("rad", "angle theta_2 of the second link").default(3.0 * math.pi / 2)
    speed_1: float = Quantity("rad/s", "angular velocity of the first link").default()
    speed_2: float = Quantity("rad/s", "angular velocity of the second link").default()


@dataclass
class Force:
    force: float = Quantity("N", "force f_h of the cylinder, which lengthens it", nominal=1e4).default(WEIGHT)


@dataclass
class Motion:
    length: float = Quantity("m", "length s of the cylinder", nominal=0.5).default(LENGTH_0)
    rate: float = Quantity("m/s", "rate of that length", nominal=0.01).default()


@dataclass
class Pressures:
    pressure_1: float = Quantity("Pa", "pressure p_1 of the chamber that shortens", nominal=1e6).default(
        PRESSURE_1
    )
    pressure_2: float = Quantity("Pa", "pressure p_2 of the chamber that lengthens", nominal=1e6).default(
        PRESSURE_2
    )


@dataclass
class Cylinder:
    force: float = Quantity("N", "force f_h of the cylinder, which lengthens it", nominal=1e4).default(WEIGHT)
    pressure_1: float = Quantity("Pa", "pressure p_1", nominal=1e6).default(PRESSURE_1)
    pressure_2: float = Quantity("Pa", "pressure p_2", nominal=1e6).default(PRESSURE_2)


@kernel
def length_of(angle: float) -> float:
    return LENGTH * math.sqrt(1.0 - 0.5 * math.sqrt(3.0) * math.cos(angle))


@kernel
def gain_of(angle: float) -> float:
    return 0.25 * math.sqrt(3.0) * LENGTH**2 * math.sin(angle) / length_of(angle)


@kernel
def mass_matrix(x: Links, p: LinksParameters) -> tuple[float, float, float]:
    """M_11, M_12, M_22."""
    first = LENGTH**2 * (LINK / 3.0 + FIRST_MASS + p.load)
    both = LENGTH * SECOND * p.load * math.cos(x.angle_1 - x.angle_2)
    return first, both, SECOND**2 * p.load


@kernel
def move_links(t: float, x: Links, u: Force, p: LinksParameters, dx: Links) -> None:
    first, both, second = mass_matrix(x, p)
    turning = LENGTH * SECOND * p.load * math.sin(x.angle_1 - x.angle_2)
    load = GRAVITY * LENGTH * (LINK / 2.0 + FIRST_MASS + p.load) * math.cos(x.angle_1)
    torque_1 = gain_of(x.angle_1) * u.force - load - turning * x.speed_2**2
    torque_2 = turning * x.speed_1**2 - GRAVITY * SECOND * p.load * math.cos(x.angle_2)
    determinant = first * second - both**2
    dx.angle_1, dx.angle_2 = x.speed_1, x.speed_2
    dx.speed_1 = (second * torque_1 - both * torque_2) / determinant
    dx.speed_2 = (first * torque_2 - both * torque_1) / determinant


@kernel
def show_motion(t: float, x: Links, u: Force, p: LinksParameters, y: Motion) -> None:
    y.length = length_of(x.angle_1)
    y.rate = gain_of(x.angle_1) * x.speed_1


@kernel
def count_links(t: float, x: Links, u: Force, p: LinksParameters, e: Vector) -> None:
    first, both, second = mass_matrix(x, p)
    moving = 0.5 * (first * x.speed_1**2 + second * x.speed_2**2) + both * x.speed_1 * x.speed_2
    high = LENGTH * (LINK / 2.0 + FIRST_MASS + p.load) * math.sin(x.angle_1)
    e[0] = moving + GRAVITY * (high + SECOND * p.load * math.sin(x.angle_2))
    e[1] = 0.0
    e[2] = 0.0


@kernel
def valve_opening(t: float) -> float:
    """kappa of the manoeuvre M2."""
    amplitude = 0.1 * min(t, max(0.0, min(1.0, 9.0 - t)))
    return OPENING * (1.0 - amplitude * math.sin(4.0 * math.pi * t))


@kernel
def flow(pressure: float) -> float:
    """Through an opening of 1 m^2; none backwards."""
    return DISCHARGE * math.sqrt(2.0 * max(pressure, 0.0) / DENSITY)


@kernel
def bulk_modulus(pressure: float) -> float:
    return (1.0 + FLUID_A * pressure + FLUID_B * pressure**2) / (FLUID_A + 2.0 * FLUID_B * pressure)


@kernel
def change_pressures(t: float, x: Pressures, u: Motion, p: CylinderParameters, dx: Pressures) -> None:
    inner = VALVE * valve_opening(t)
    outer = VALVE - inner
    length_1, length_2 = 0.5 * CYLINDER + LENGTH_0 - u.length, 0.5 * CYLINDER + u.length - LENGTH_0
    flow_1 = AREA * u.rate + inner * flow(PUMP - x.pressure_1) - outer * flow(x.pressure_1 - TANK)
    flow_2 = outer * flow(PUMP - x.pressure_2) - inner * flow(x.pressure_2 - TANK) - AREA * u.rate
    dx.pressure_1 = bulk_modulus(x.pressure_1) * flow_1 / (AREA * length_1)
    dx.pressure_2 = bulk_modulus(x.pressure_2) * flow_2 / (AREA * length_2)


@kernel
def show_cylinder(t: float, x: Pressures, u: Motion, p: CylinderParameters, y: Cylinder) -> None:
    y.force = (x.pressure_2 - x.pressure_1) * AREA - p.friction * u.rate
    y.pressure_1, y.pressure_2 = x.pressure_1, x.pressure_2


@kernel
def count_nothing(t: float, x: Pressures, u: Motion, p: CylinderParameters, e: Vector) -> None:
    e[:] = 0.0


def links() -> Component:
    """The links, on which the cylinder's force acts."""
    return Component(
        name="links",
        description="Two links in a plane that a cylinder lifts",
        parameters=Layout(LinksParameters),
        state=Layout(Links),
        inputs=Layout(Force),
        outputs=Layout(Motion),
        derivative=move_links,
        output=show_motion,
        energy=count_links,
        feedthrough={},
    )


def cylinder() -> Component:
    """The cylinder and its valve, at a length that is given."""
    return Component(
        name="cylinder",
        description="Hydraulic cylinder with its valve",
        parameters=Layout(CylinderParameters),
        state=Layout(Pressures),
        inputs=Layout(Motion),
        outputs=Layout(Cylinder),
        derivative=change_pressures,
        output=show_cylinder,
        energy=count_nothing,
        feedthrough={"force": ("rate",)},
    )
