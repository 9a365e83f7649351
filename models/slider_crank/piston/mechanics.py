"""Exact planar mechanics of crank, connecting rod and tilting piston.

Coordinates: crank angle theta (zero at top dead centre), rod angle eta below the cylinder's axis, piston
tilt chi. The crank pin is at (r cos theta, r sin theta), the piston pin at l (cos eta, -sin eta) from it;
x runs along the cylinder away from the crank, y across it. Nothing is taken as small:

    M(q) q'' + c(q, q') = Q(q, q') + walls.

Places on the piston are along and across its axis, from the middle of its skirt. With a symmetric piston
whose pin is at its centre of mass these are the equations of Flores, Leine and Glocker (2010), section 5,
with theta_2 = -eta. p: the parameters of the components.
"""

import math
from typing import Any, NamedTuple

from ...compile.kernel import kernel


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
def arm_along(along: float, across: float, q: Coordinates, p: Any) -> float:
    """x of a point of the piston, from the pin."""
    return (along - p.pin_height) * math.cos(q.chi) - (across - p.pin_offset) * math.sin(q.chi)


@kernel
def arm_across(along: float, across: float, q: Coordinates, p: Any) -> float:
    """y of a point of the piston, from the pin."""
    return (along - p.pin_height) * math.sin(q.chi) + (across - p.pin_offset) * math.cos(q.chi)


@kernel
def position_along(along: float, across: float, q: Coordinates, p: Any) -> float:
    """x of a point of the piston."""
    pin = p.crank_radius * math.cos(q.theta) + p.rod_length * math.cos(q.eta)
    return pin + arm_along(along, across, q, p)


@kernel
def position_across(along: float, across: float, q: Coordinates, p: Any) -> float:
    """y of a point of the piston."""
    pin = p.crank_radius * math.sin(q.theta) - p.rod_length * math.sin(q.eta)
    return pin + arm_across(along, across, q, p)


@kernel
def along_row(along: float, across: float, q: Coordinates, p: Any) -> Coordinates:
    """Derivatives of `position_along` by the coordinates."""
    return Coordinates(
        -p.crank_radius * math.sin(q.theta), -p.rod_length * math.sin(q.eta), -arm_across(along, across, q, p)
    )


@kernel
def across_row(along: float, across: float, q: Coordinates, p: Any) -> Coordinates:
    """Derivatives of `position_across` by the coordinates."""
    return Coordinates(
        p.crank_radius * math.cos(q.theta), -p.rod_length * math.cos(q.eta), arm_along(along, across, q, p)
    )


@kernel
def along_turning(along: float, across: float, q: Coordinates, v: Coordinates, p: Any) -> float:
    """The part of a piston point's x'' that comes from the rates alone."""
    return (
        -p.crank_radius * math.cos(q.theta) * v.theta**2
        - p.rod_length * math.cos(q.eta) * v.eta**2
        - arm_along(along, across, q, p) * v.chi**2
    )


@kernel
def across_turning(along: float, across: float, q: Coordinates, v: Coordinates, p: Any) -> float:
    """The part of a piston point's y'' that comes from the rates alone."""
    return (
        -p.crank_radius * math.sin(q.theta) * v.theta**2
        + p.rod_length * math.sin(q.eta) * v.eta**2
        - arm_across(along, across, q, p) * v.chi**2
    )


@kernel
def rod_moment(p: Any) -> float:
    """What the crank pin carries of rod and piston times the distance from it."""
    return p.rod_mass * p.rod_centre + p.piston_mass * p.rod_length


@kernel
def mass_matrix(q: Coordinates, p: Any) -> Symmetric:
    """M(q)."""
    x = p.piston_mass * arm_along(p.mass_height, p.mass_offset, q, p)
    y = p.piston_mass * arm_across(p.mass_height, p.mass_offset, q, p)
    lever_squared = (p.mass_height - p.pin_height) ** 2 + (p.mass_offset - p.pin_offset) ** 2
    return Symmetric(
        p.crank_inertia + p.crank_mass * p.crank_centre**2 + (p.rod_mass + p.piston_mass) * p.crank_radius**2,
        -rod_moment(p) * p.crank_radius * math.cos(q.theta + q.eta),
        p.crank_radius * (y * math.sin(q.theta) + x * math.cos(q.theta)),
        p.rod_inertia + p.rod_mass * p.rod_centre**2 + p.piston_mass * p.rod_length**2,
        p.rod_length * (y * math.sin(q.eta) - x * math.cos(q.eta)),
        p.piston_inertia + p.piston_mass * lever_squared,
    )


@kernel
def turning_forces(q: Coordinates, v: Coordinates, p: Any) -> Coordinates:
    """c(q, q'): centrifugal and Coriolis terms."""
    r, l = p.crank_radius, p.rod_length
    x = p.piston_mass * arm_along(p.mass_height, p.mass_offset, q, p)
    y = p.piston_mass * arm_across(p.mass_height, p.mass_offset, q, p)
    rod = rod_moment(p) * r * math.sin(q.theta + q.eta)
    return Coordinates(
        rod * v.eta**2 + r * (x * math.sin(q.theta) - y * math.cos(q.theta)) * v.chi**2,
        rod * v.theta**2 + l * (x * math.sin(q.eta) + y * math.cos(q.eta)) * v.chi**2,
        r * (y * math.cos(q.theta) - x * math.sin(q.theta)) * v.theta**2
        + l * (y * math.cos(q.eta) + x * math.sin(q.eta)) * v.eta**2,
    )


@kernel
def applied_forces(q: Coordinates, v: Coordinates, gas_pressure: float, p: Any) -> Coordinates:
    """Q: gravity, friction in the joints, and gas.

    The gas force (pressure above that of the crankcase times bore area) acts along the cylinder on the
    middle of the piston, so that a pin beside the middle feels its moment.
    """
    to_rod = -p.crank_pin_friction * (v.theta + v.eta)
    to_piston = -p.piston_pin_friction * (v.chi + v.eta)
    gas = -gas_pressure * p.bore_area
    along, across = p.piston_mass * p.gravity_along, p.piston_mass * p.gravity_across
    hanging = p.crank_mass * p.crank_centre + p.rod_mass * p.crank_radius
    rod = p.rod_mass * p.rod_centre
    forces = Coordinates(
        hanging * (p.gravity_across * math.cos(q.theta) - p.gravity_along * math.sin(q.theta)) + to_rod,
        -rod * (p.gravity_across * math.cos(q.eta) + p.gravity_along * math.sin(q.eta)) + to_rod + to_piston,
        to_piston,
    )
    forces = add(forces, along, along_row(p.mass_height, p.mass_offset, q, p))
    forces = add(forces, across, across_row(p.mass_height, p.mass_offset, q, p))
    return add(forces, gas, along_row(0.0, 0.0, q, p))


@kernel
def kinetic_energy(q: Coordinates, v: Coordinates, p: Any) -> float:
    return 0.5 * dot(v, multiply(mass_matrix(q, p), v))


@kernel
def potential_energy(q: Coordinates, p: Any) -> float:
    """Of gravity."""
    hanging = p.crank_mass * p.crank_centre + p.rod_mass * p.crank_radius
    rod = p.rod_mass * p.rod_centre
    x = hanging * math.cos(q.theta) + rod * math.cos(q.eta)
    y = hanging * math.sin(q.theta) - rod * math.sin(q.eta)
    x += p.piston_mass * position_along(p.mass_height, p.mass_offset, q, p)
    y += p.piston_mass * position_across(p.mass_height, p.mass_offset, q, p)
    return -(p.gravity_along * x + p.gravity_across * y)


@kernel
def joint_loss(v: Coordinates, p: Any) -> float:
    """Power (W) that the friction in both pins takes."""
    return p.crank_pin_friction * (v.theta + v.eta) ** 2 + p.piston_pin_friction * (v.chi + v.eta) ** 2


@kernel
def gas_power(q: Coordinates, v: Coordinates, gas_pressure: float, p: Any) -> float:
    """Power (W) that the gas gives."""
    return -gas_pressure * p.bore_area * dot(along_row(0.0, 0.0, q, p), v)


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
