"""The equations of motion behind one interface: `equations` and `energetics` (linear in psi), or `nonlinear`.

`as_published` and `corrected` differ in the mechanism's forcing_beta alone. Units as in `equations`:
moments over M l^2, forces over M l, distances over l.
"""

from ..compile.kernel import kernel
from . import energetics, equations, nonlinear
from .equations import Crank, Mechanism, inertia

AS_PUBLISHED, CORRECTED, NONLINEAR = 0.0, 1.0, 2.0


@kernel
def free_moment(form: float, at: Crank, psi: float, rate: float, m: Mechanism) -> float:
    """a psi'' when no wall touches."""
    if form == NONLINEAR:
        return nonlinear.free_moment(at, psi, rate, m)
    return equations.free_moment(at, psi, rate, m)


@kernel
def flight_acceleration(form: float, at: Crank, psi: float, rate: float, m: Mechanism) -> float:
    """psi'' in free flight."""
    return free_moment(form, at, psi, rate, m) / inertia(m)


@kernel
def offset(form: float, theta: float, psi: float, m: Mechanism) -> float:
    """The slider's distance from the centre line, upwards."""
    if form == NONLINEAR:
        return nonlinear.offset(theta, psi, m.xi)
    return equations.rod_cosine(theta, m.xi) * psi


@kernel
def offset_slope(form: float, theta: float, psi: float, m: Mechanism) -> float:
    """Its derivative by psi."""
    if form == NONLINEAR:
        return nonlinear.offset_slope(theta, psi, m.xi)
    return equations.rod_cosine(theta, m.xi)


@kernel
def offset_bend(form: float, theta: float, psi: float, m: Mechanism) -> float:
    """Its second derivative by psi."""
    if form == NONLINEAR:
        return nonlinear.offset_bend(theta, psi, m.xi)
    return 0.0


@kernel
def wall_angle(form: float, theta: float, gap: float, m: Mechanism) -> float:
    """psi at which the slider is `gap` off centre, F (2.14), (2.15)."""
    if form == NONLINEAR:
        return nonlinear.wall_angle(theta, gap, m.xi)
    return equations.wall_angle(theta, gap, m.xi)


@kernel
def wall_rate(form: float, theta: float, speed: float, psi: float, m: Mechanism) -> float:
    """psi' of a slider that keeps its distance from the centre line."""
    if form == NONLINEAR:
        return nonlinear.wall_rate(theta, speed, psi, m.xi)
    return equations.wall_rate(theta, speed, psi, m.xi)


@kernel
def wall_rate_slope(form: float, theta: float, speed: float, psi: float, m: Mechanism) -> float:
    """Its derivative by psi."""
    if form == NONLINEAR:
        return nonlinear.wall_rate_slope(theta, speed, psi, m.xi)
    return -equations.narrowing(theta, m.xi) * speed


@kernel
def wall_acceleration(form: float, at: Crank, psi: float, m: Mechanism) -> float:
    """psi'' of a slider that keeps its distance from the centre line."""
    if form == NONLINEAR:
        return nonlinear.wall_acceleration(at, psi, m.xi)
    return equations.wall_acceleration(at, psi, m.xi)


@kernel
def moving_wall_rate(
    form: float, theta: float, speed: float, psi: float, wall_velocity: float, m: Mechanism
) -> float:
    """psi' of a slider whose distance y from the centre line has the rate `wall_velocity`."""
    return wall_rate(form, theta, speed, psi, m) + wall_velocity / offset_slope(form, theta, psi, m)


@kernel
def moving_wall_acceleration(
    form: float, at: Crank, psi: float, wall_velocity: float, wall_change: float, m: Mechanism
) -> float:
    """psi'' of a slider whose distance y from the centre line has the rates y' and y'' = `wall_change`.

    With S = dy/dpsi and R the wall_rate, psi' = R + y'/S; its derivative in time, in which
    S' = -S dR/dpsi + dS/dpsi y'/S, is A + 2 dR/dpsi y'/S + y''/S - dS/dpsi (y'/S)^2/S, A the
    wall_acceleration.
    """
    slope = offset_slope(form, at.theta, psi, m)
    push = wall_velocity / slope
    bend = offset_bend(form, at.theta, psi, m)
    return (
        wall_acceleration(form, at, psi, m)
        + 2.0 * wall_rate_slope(form, at.theta, at.speed, psi, m) * push
        + (wall_change - bend * push**2) / slope
    )


@kernel
def holding_force(form: float, at: Crank, psi: float, rate: float, rate_change: float, m: Mechanism) -> float:
    """Force towards -psi under which psi'' is `rate_change` (F 2.29, upper wall).

    The lower wall's force is its negative; a wall can only push.
    """
    moment = free_moment(form, at, psi, rate, m)
    return (moment - inertia(m) * rate_change) / offset_slope(form, at.theta, psi, m)


@kernel
def constraint_force(form: float, at: Crank, psi: float, m: Mechanism) -> float:
    """The holding force of a wall that stands still."""
    rate = wall_rate(form, at.theta, at.speed, psi, m)
    change = wall_acceleration(form, at, psi, m)
    return holding_force(form, at, psi, rate, change, m)


@kernel
def kinetic_energy(form: float, theta: float, speed: float, psi: float, rate: float, m: Mechanism) -> float:
    """Kinetic energy."""
    if form == NONLINEAR:
        return nonlinear.kinetic_energy(theta, speed, psi, rate, m)
    return energetics.kinetic_energy(theta, speed, psi, rate, m)


@kernel
def crank_torque(
    form: float, at: Crank, psi: float, rate: float, rate_change: float, wall_force: float, m: Mechanism
) -> float:
    """Torque that the mechanism takes from the crank, at psi'' = `rate_change`."""
    if form == NONLINEAR:
        return nonlinear.crank_torque(at, psi, rate, rate_change, wall_force, m)
    return energetics.crank_torque(at, psi, rate, rate_change, wall_force, m)


@kernel
def crank_impulse(form: float, theta: float, psi: float, rate_jump: float, m: Mechanism) -> float:
    """Angular impulse taken from the crank by an impact that changes psi' by `rate_jump`."""
    if form == NONLINEAR:
        return nonlinear.crank_impulse(theta, psi, rate_jump, m)
    return energetics.crank_impulse(theta, psi, rate_jump, m)
