"""Exact planar mechanics of crank, connecting rod and tilting piston.

Coordinates: crank angle theta (zero at top dead centre), rod angle eta below the cylinder's axis, piston
tilt chi. The crank pin is at (r cos theta, r sin theta), the piston pin at l (cos eta, -sin eta) from it;
x runs along the cylinder away from the crank, y across it. Nothing is taken as small:

    M(q) q'' + c(q, q') = Q(q, q') + walls.

With a symmetric piston whose pin is at its centre of mass these are the equations of Flores, Leine and
Glocker (2010), section 5, with theta_2 = -eta.
"""

import math
from typing import NamedTuple

from ...compile.kernel import kernel


class Machine(NamedTuple):
    """Lengths (m), masses (kg), inertias about centres of mass (kg m^2).

    Places on the piston are along and across its axis, from the middle of its skirt.
    """

    crank_radius: float
    rod_length: float
    crank_inertia: float  # about the shaft
    crank_imbalance: float  # mass times distance of its centre from the shaft
    rod_mass: float
    rod_centre: float  # from the crank pin
    rod_inertia: float
    piston_mass: float
    piston_inertia: float
    half_length: float
    half_height: float
    clearance: float
    pin_along: float
    pin_across: float
    mass_along: float
    mass_across: float
    crank_pin_friction: float
    piston_pin_friction: float
    gravity_along: float
    gravity_across: float
    bore_area: float


class Coordinates(NamedTuple):
    """Coordinates, their rates or accelerations, or a row of derivatives by them."""

    theta: float
    eta: float
    chi: float


class Symmetric(NamedTuple):
    """A symmetric matrix of the three coordinates."""

    theta_theta: float
    theta_eta: float
    theta_chi: float
    eta_eta: float
    eta_chi: float
    chi_chi: float


@kernel
def dot(a: Coordinates, b: Coordinates) -> float:
    return a.theta * b.theta + a.eta * b.eta + a.chi * b.chi


@kernel
def add(a: Coordinates, factor: float, b: Coordinates) -> Coordinates:
    """a + factor b."""
    return Coordinates(a.theta + factor * b.theta, a.eta + factor * b.eta, a.chi + factor * b.chi)


@kernel
def multiply(s: Symmetric, a: Coordinates) -> Coordinates:
    return Coordinates(
        s.theta_theta * a.theta + s.theta_eta * a.eta + s.theta_chi * a.chi,
        s.theta_eta * a.theta + s.eta_eta * a.eta + s.eta_chi * a.chi,
        s.theta_chi * a.theta + s.eta_chi * a.eta + s.chi_chi * a.chi,
    )


@kernel
def arm_along(along: float, across: float, q: Coordinates, m: Machine) -> float:
    """x of a point of the piston, from the pin."""
    return (along - m.pin_along) * math.cos(q.chi) - (across - m.pin_across) * math.sin(q.chi)


@kernel
def arm_across(along: float, across: float, q: Coordinates, m: Machine) -> float:
    """y of a point of the piston, from the pin."""
    return (along - m.pin_along) * math.sin(q.chi) + (across - m.pin_across) * math.cos(q.chi)


@kernel
def position_along(along: float, across: float, q: Coordinates, m: Machine) -> float:
    """x of a point of the piston."""
    pin = m.crank_radius * math.cos(q.theta) + m.rod_length * math.cos(q.eta)
    return pin + arm_along(along, across, q, m)


@kernel
def position_across(along: float, across: float, q: Coordinates, m: Machine) -> float:
    """y of a point of the piston."""
    pin = m.crank_radius * math.sin(q.theta) - m.rod_length * math.sin(q.eta)
    return pin + arm_across(along, across, q, m)


@kernel
def along_row(along: float, across: float, q: Coordinates, m: Machine) -> Coordinates:
    """Derivatives of `position_along` by the coordinates."""
    return Coordinates(
        -m.crank_radius * math.sin(q.theta), -m.rod_length * math.sin(q.eta), -arm_across(along, across, q, m)
    )


@kernel
def across_row(along: float, across: float, q: Coordinates, m: Machine) -> Coordinates:
    """Derivatives of `position_across` by the coordinates."""
    return Coordinates(
        m.crank_radius * math.cos(q.theta), -m.rod_length * math.cos(q.eta), arm_along(along, across, q, m)
    )


@kernel
def along_turning(along: float, across: float, q: Coordinates, v: Coordinates, m: Machine) -> float:
    """The part of a piston point's x'' that comes from the rates alone."""
    return (
        -m.crank_radius * math.cos(q.theta) * v.theta**2
        - m.rod_length * math.cos(q.eta) * v.eta**2
        - arm_along(along, across, q, m) * v.chi**2
    )


@kernel
def across_turning(along: float, across: float, q: Coordinates, v: Coordinates, m: Machine) -> float:
    """The part of a piston point's y'' that comes from the rates alone."""
    return (
        -m.crank_radius * math.sin(q.theta) * v.theta**2
        + m.rod_length * math.sin(q.eta) * v.eta**2
        - arm_across(along, across, q, m) * v.chi**2
    )


@kernel
def rod_moment(m: Machine) -> float:
    """What the crank pin carries of rod and piston times the distance from it."""
    return m.rod_mass * m.rod_centre + m.piston_mass * m.rod_length


@kernel
def mass_matrix(q: Coordinates, m: Machine) -> Symmetric:
    """M(q)."""
    x = m.piston_mass * arm_along(m.mass_along, m.mass_across, q, m)
    y = m.piston_mass * arm_across(m.mass_along, m.mass_across, q, m)
    lever_squared = (m.mass_along - m.pin_along) ** 2 + (m.mass_across - m.pin_across) ** 2
    return Symmetric(
        m.crank_inertia + (m.rod_mass + m.piston_mass) * m.crank_radius**2,
        -rod_moment(m) * m.crank_radius * math.cos(q.theta + q.eta),
        m.crank_radius * (y * math.sin(q.theta) + x * math.cos(q.theta)),
        m.rod_inertia + m.rod_mass * m.rod_centre**2 + m.piston_mass * m.rod_length**2,
        m.rod_length * (y * math.sin(q.eta) - x * math.cos(q.eta)),
        m.piston_inertia + m.piston_mass * lever_squared,
    )


@kernel
def turning_forces(q: Coordinates, v: Coordinates, m: Machine) -> Coordinates:
    """c(q, q'): centrifugal and Coriolis terms."""
    r, l = m.crank_radius, m.rod_length
    x = m.piston_mass * arm_along(m.mass_along, m.mass_across, q, m)
    y = m.piston_mass * arm_across(m.mass_along, m.mass_across, q, m)
    rod = rod_moment(m) * r * math.sin(q.theta + q.eta)
    return Coordinates(
        rod * v.eta**2 + r * (x * math.sin(q.theta) - y * math.cos(q.theta)) * v.chi**2,
        rod * v.theta**2 + l * (x * math.sin(q.eta) + y * math.cos(q.eta)) * v.chi**2,
        r * (y * math.cos(q.theta) - x * math.sin(q.theta)) * v.theta**2
        + l * (y * math.cos(q.eta) + x * math.sin(q.eta)) * v.eta**2,
    )


@kernel
def applied_forces(q: Coordinates, v: Coordinates, gas_pressure: float, m: Machine) -> Coordinates:
    """Q: gravity, friction in the joints, and gas.

    The gas force (pressure above that of the crankcase times bore area) acts along the cylinder on the
    middle of the piston, so that a pin beside the middle feels its moment.
    """
    to_rod = -m.crank_pin_friction * (v.theta + v.eta)
    to_piston = -m.piston_pin_friction * (v.chi + v.eta)
    gas = -gas_pressure * m.bore_area
    along, across = m.piston_mass * m.gravity_along, m.piston_mass * m.gravity_across
    hanging = m.crank_imbalance + m.rod_mass * m.crank_radius
    rod = m.rod_mass * m.rod_centre
    forces = Coordinates(
        hanging * (m.gravity_across * math.cos(q.theta) - m.gravity_along * math.sin(q.theta)) + to_rod,
        -rod * (m.gravity_across * math.cos(q.eta) + m.gravity_along * math.sin(q.eta)) + to_rod + to_piston,
        to_piston,
    )
    forces = add(forces, along, along_row(m.mass_along, m.mass_across, q, m))
    forces = add(forces, across, across_row(m.mass_along, m.mass_across, q, m))
    return add(forces, gas, along_row(0.0, 0.0, q, m))


@kernel
def kinetic_energy(q: Coordinates, v: Coordinates, m: Machine) -> float:
    return 0.5 * dot(v, multiply(mass_matrix(q, m), v))


@kernel
def potential_energy(q: Coordinates, m: Machine) -> float:
    """Of gravity."""
    hanging = m.crank_imbalance + m.rod_mass * m.crank_radius
    rod = m.rod_mass * m.rod_centre
    x = hanging * math.cos(q.theta) + rod * math.cos(q.eta)
    y = hanging * math.sin(q.theta) - rod * math.sin(q.eta)
    x += m.piston_mass * position_along(m.mass_along, m.mass_across, q, m)
    y += m.piston_mass * position_across(m.mass_along, m.mass_across, q, m)
    return -(m.gravity_along * x + m.gravity_across * y)


@kernel
def joint_loss(v: Coordinates, m: Machine) -> float:
    """Power (W) that the friction in both pins takes."""
    return m.crank_pin_friction * (v.theta + v.eta) ** 2 + m.piston_pin_friction * (v.chi + v.eta) ** 2


@kernel
def gas_power(q: Coordinates, v: Coordinates, gas_pressure: float, m: Machine) -> float:
    """Power (W) that the gas gives."""
    return -gas_pressure * m.bore_area * dot(along_row(0.0, 0.0, q, m), v)


@kernel
def free_inverse(s: Symmetric) -> Symmetric:
    """Inverse of the mass matrix: the crank moves."""
    tt = s.eta_eta * s.chi_chi - s.eta_chi**2
    te = s.theta_chi * s.eta_chi - s.theta_eta * s.chi_chi
    tc = s.theta_eta * s.eta_chi - s.theta_chi * s.eta_eta
    determinant = s.theta_theta * tt + s.theta_eta * te + s.theta_chi * tc
    return Symmetric(
        tt / determinant,
        te / determinant,
        tc / determinant,
        (s.theta_theta * s.chi_chi - s.theta_chi**2) / determinant,
        (s.theta_eta * s.theta_chi - s.theta_theta * s.eta_chi) / determinant,
        (s.theta_theta * s.eta_eta - s.theta_eta**2) / determinant,
    )


@kernel
def prescribed_inverse(s: Symmetric) -> Symmetric:
    """What forces do to rod and piston when no force moves the crank."""
    determinant = s.eta_eta * s.chi_chi - s.eta_chi**2
    return Symmetric(
        0.0, 0.0, 0.0, s.chi_chi / determinant, -s.eta_chi / determinant, s.eta_eta / determinant
    )
