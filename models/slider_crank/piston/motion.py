"""Kernels that both piston components share: place, forces in lasting contact, derivatives, outputs.

The states are the piston's offset and tilt: by them, gaps do not depend on the crank. Coordinates that closed
corners determine are computed from the walls, so that integration cannot drift off them.
"""

import math
from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ...core.quantities import Vector
from . import contact as co
from . import mechanics as me
from .contact import CORNERS, Motion, Pair, Push, Touching
from .mechanics import Coordinates

# Outputs that depend on all inputs that set forces in motion.
FORCED_OUTPUTS = (
    "upper_front_force", "upper_rear_force", "lower_front_force", "lower_rear_force", "wall_friction_force",
    "pin_force_along", "pin_force_across", "friction_power",
)  # fmt: skip


class Place(NamedTuple):
    """The piston in its bore."""

    offset: float
    offset_rate: float
    tilt: float
    tilt_rate: float


@kernel
def find_closed_corners(x: Any) -> Touching:
    """The closed corners."""
    first = second = -1
    for i in range(CORNERS):
        if x.closed[i] != 0.0:
            if first < 0:
                first = i
            else:
                second = i
    return Touching(first, second)


@kernel
def jammed_tilt(p: Any) -> float:
    """Tilt with which the piston touches both walls: L sin chi + H cos chi = H + clearance."""
    l, c = p.half_length, p.clearance
    return 2.0 * math.atan(c / (l + math.sqrt(l**2 - c * (2.0 * p.half_height + c))))


@kernel
def find_place(x: Any, p: Any) -> Place:
    """The piston's place; coordinates that closed corners determine are computed from their walls."""
    corners = find_closed_corners(x)
    i, j = corners.first, corners.second
    if i < 0:
        return Place(x.offset, x.offset_rate, x.tilt, x.tilt_rate)
    if j < 0:
        sine, k = math.sin(x.tilt), co.corner_along(i, p)
        lift = p.clearance + 2.0 * p.half_height * math.sin(0.5 * x.tilt) ** 2
        slope = co.side(i) * p.half_height * sine - k * math.cos(x.tilt)
        return Place(co.side(i) * lift - k * sine, slope * x.tilt_rate, x.tilt, x.tilt_rate)
    if co.side(i) == co.side(j):
        return Place(co.side(i) * p.clearance, 0.0, 0.0, 0.0)
    return Place(0.0, 0.0, math.copysign(jammed_tilt(p), co.corner_along(i, p)), 0.0)


@kernel
def coordinates(theta: float, place: Place, p: Any) -> Coordinates:
    """q from the crank angle and the piston's place."""
    pin = place.offset + p.pin_height * math.sin(place.tilt) + p.pin_offset * math.cos(place.tilt)
    eta = math.asin((p.crank_radius * math.sin(theta) - pin) / p.rod_length)
    return Coordinates(theta, eta, place.tilt)


@kernel
def rates(speed: float, q: Coordinates, place: Place, p: Any) -> Coordinates:
    """q' from the crank speed and the piston's rates."""
    lever = p.pin_height * math.cos(q.chi) - p.pin_offset * math.sin(q.chi)
    pin = place.offset_rate + lever * place.tilt_rate
    eta = (p.crank_radius * math.cos(q.theta) * speed - pin) / (p.rod_length * math.cos(q.eta))
    return Coordinates(speed, eta, place.tilt_rate)


@kernel
def friction_ratios(touching: Touching, s: Motion, p: Any) -> Pair:
    """Friction over wall force in lasting contact."""
    return Pair(
        co.sliding_ratio(touching.first, s, p.wall_friction, p.creep_velocity, p),
        co.sliding_ratio(touching.second, s, p.wall_friction, p.creep_velocity, p),
    )


@kernel
def hold_closed(touching: Touching, s: Motion, p: Any) -> Push:
    """What keeps the corners closed."""
    return co.hold(touching, friction_ratios(touching, s, p), co.free_gap_accelerations(touching, s, p), s, p)


@kernel
def differentiate(x: Any, s: Motion, p: Any, dx: Any) -> Coordinates:
    """The derivatives of the shared states; returns q'' with the forces of closed corners."""
    place, touching = find_place(x, p), find_closed_corners(x)
    push = hold_closed(touching, s, p)
    q2 = co.add_reaction(touching, push, s.free, s, p)
    dx.offset = place.offset_rate
    dx.offset_rate = me.dot(me.across_row(0.0, 0.0, s.q, p), q2) + me.across_turning(0.0, 0.0, s.q, s.v, p)
    dx.tilt = place.tilt_rate
    dx.tilt_rate = q2.chi
    for i in range(CORNERS):
        dx.closed[i] = 0.0
        dx.impact_count[i] = 0.0
        dx.impact_impulse[i] = 0.0
        dx.force_integral[i] = co.force_on(i, touching, push)
    dx.last_impact_time = 0.0
    dx.last_impact_velocity = 0.0
    dx.event_count = 0.0
    dx.last_event_time = 0.0
    dx.impact_loss = 0.0
    return q2


@kernel
def wall_loss(touching: Touching, push: Push, s: Motion, p: Any) -> float:
    """Power (W) that the walls' friction takes."""
    forces, ratios = push
    total = 0.0
    if touching.first >= 0:
        total += ratios.first * forces.first * co.sliding_velocity(touching.first, s.q, s.v, p)
    if touching.second >= 0:
        total += ratios.second * forces.second * co.sliding_velocity(touching.second, s.q, s.v, p)
    return total


@kernel
def friction_power(x: Any, s: Motion, p: Any) -> float:
    """Power (W) that all friction takes between impacts."""
    touching = find_closed_corners(x)
    return me.joint_loss(s.v, p) + wall_loss(touching, hold_closed(touching, s, p), s, p)


def make_energy(motion: Any) -> Any:
    """The component's energy kernel; motion(x, u, p) -> Motion.

    Stored: kinetic and potential energy. Dissipated: friction, and at impacts `impact_loss`. Source: the gas.
    """

    @kernel
    def energy(t: float, x: Any, u: Any, p: Any, e: Vector) -> None:
        s = motion(x, u, p)
        e[0] = me.kinetic_energy(s.q, s.v, p) + me.potential_energy(s.q, p)
        e[1] = friction_power(x, s, p)
        e[2] = me.gas_power(s.q, s.v, u.gas_pressure, p)

    return energy


@kernel
def observe(x: Any, s: Motion, gas_pressure: float, p: Any, y: Any) -> None:
    """The shared outputs."""
    place, touching = find_place(x, p), find_closed_corners(x)
    push = hold_closed(touching, s, p)
    q2 = co.add_reaction(touching, push, s.free, s, p)
    a, b = p.mass_height, p.mass_offset
    y.piston_position = me.position_along(0.0, 0.0, s.q, p)
    y.piston_velocity = me.dot(me.along_row(0.0, 0.0, s.q, p), s.v)
    y.piston_offset = place.offset
    y.piston_offset_rate = place.offset_rate
    y.piston_tilt = place.tilt
    y.piston_tilt_rate = place.tilt_rate
    y.rod_angle = s.q.eta
    y.upper_front_gap = co.gap(0, place.offset, place.tilt, p)
    y.upper_rear_gap = co.gap(1, place.offset, place.tilt, p)
    y.lower_front_gap = co.gap(2, place.offset, place.tilt, p)
    y.lower_rear_gap = co.gap(3, place.offset, place.tilt, p)
    y.upper_front_force = co.force_on(0, touching, push)
    y.upper_rear_force = co.force_on(1, touching, push)
    y.lower_front_force = co.force_on(2, touching, push)
    y.lower_rear_force = co.force_on(3, touching, push)
    y.wall_friction_force = -push.ratios.first * push.forces.first - push.ratios.second * push.forces.second
    x2 = me.dot(me.along_row(a, b, s.q, p), q2) + me.along_turning(a, b, s.q, s.v, p)
    y2 = me.dot(me.across_row(a, b, s.q, p), q2) + me.across_turning(a, b, s.q, s.v, p)
    gas = -gas_pressure * p.bore_area
    y.pin_force_along = p.piston_mass * (x2 - p.gravity_along) - y.wall_friction_force - gas
    upper = y.upper_front_force + y.upper_rear_force
    lower = y.lower_front_force + y.lower_rear_force
    y.pin_force_across = p.piston_mass * (y2 - p.gravity_across) + upper - lower
    y.upper_wall_impulse = 0.0
    y.lower_wall_impulse = 0.0
    y.impact_count = 0.0
    for i in range(CORNERS):
        y.corner_impact_count[i] = x.impact_count[i]
        y.corner_impact_impulse[i] = x.impact_impulse[i]
        y.impact_count += x.impact_count[i]
    for i in range(2):
        y.upper_wall_impulse += x.impact_impulse[i] + x.force_integral[i]
        y.lower_wall_impulse += x.impact_impulse[2 + i] + x.force_integral[2 + i]
    y.last_impact_time = x.last_impact_time
    y.last_impact_velocity = x.last_impact_velocity
    y.event_count = x.event_count
    y.last_event_time = x.last_event_time
    y.friction_power = me.joint_loss(s.v, p) + wall_loss(touching, push, s, p)
    y.impact_loss = x.impact_loss
