"""Exact solutions of the oscillators, to the rounding of a matrix exponential and of a root.

The systems are those that the components make when they are connected; parameters are theirs.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from models.core.quantities import Vector
from models.oscillators.bouncing_mass import FallingMassParameters, SpringStopParameters
from models.oscillators.quarter_car import ChassisParameters, WheelParameters
from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters


def linear_motion(
    masses: Vector, stiffness: Vector, damping: Vector, force: Vector, start: Vector, times: Vector
) -> Vector:
    """M x'' + D x' + K x = f of two masses: position and velocity of each, (n, 4), by the matrix exponential.

    `start`: the same four at t = 0.
    """
    whole = np.zeros((5, 5))
    whole[:4:2, 1:4:2] = np.eye(2)
    whole[1:4:2, :4:2], whole[1:4:2, 1:4:2] = -stiffness / masses[:, None], -damping / masses[:, None]
    whole[1:4:2, 4] = force / masses
    exponentials = expm(np.multiply.outer(np.asarray(times, dtype=np.float64), whole))
    return np.asarray(exponentials[:, :4, :] @ np.append(start, 1.0))


# Of a spring between both masses.
BETWEEN = np.array([[1.0, -1.0], [-1.0, 1.0]])


def quarter_car(
    times: Vector,
    chassis: ChassisParameters | None = None,
    wheel: WheelParameters | None = None,
    start: Vector | None = None,
) -> Vector:
    """Position and velocity of the chassis, then of the wheel: (n, 4); default: the published benchmark.

    Chassis and wheel must have the same suspension (the chassis's is used).
    """
    c, w = chassis or ChassisParameters(), wheel or WheelParameters()
    stiffness = c.suspension_stiffness * BETWEEN + np.diag([0.0, w.tyre_stiffness])
    damping = c.suspension_damping * BETWEEN + np.diag([0.0, w.tyre_damping])
    masses, force = np.array([c.chassis_mass, w.wheel_mass]), np.array([0.0, w.tyre_stiffness * w.road_step])
    return linear_motion(masses, stiffness, damping, force, np.zeros(4) if start is None else start, times)


def two_masses(
    times: Vector, coupled: CoupledMassParameters, sprung: SprungMassParameters, start: Vector
) -> Vector:
    """Position and velocity of the coupled, then of the sprung mass: (n, 4)."""
    stiffness = coupled.coupling_stiffness * BETWEEN + np.diag([coupled.stiffness, sprung.stiffness])
    damping = coupled.coupling_damping * BETWEEN + np.diag([coupled.damping, sprung.damping])
    masses = np.array([coupled.mass, sprung.mass])
    return linear_motion(masses, stiffness, damping, np.zeros(2), start, times)


class Bouncing(NamedTuple):
    """Position and velocity at the asked times, (n, 2), and the instants (s) of touch and release."""

    motion: Vector
    touches: Vector
    releases: Vector


def bouncing_mass(
    times: Vector,
    mass: FallingMassParameters | None = None,
    stop: SpringStopParameters | None = None,
    position: float = 0.1,
    velocity: float = 0.0,
) -> Bouncing:
    """The mass that falls on the stop, at ascending `times` >= 0, from its state at t = 0.

    Piecewise: parabolas, and arcs of a (damped) sine. Needs gravity > 0 and damping < 2 sqrt(k m).
    """
    m, s = mass or FallingMassParameters(), stop or SpringStopParameters()
    g, rest, decay = m.gravity, s.stop_position - m.mass * m.gravity / s.stiffness, 0.5 * s.damping / m.mass
    w = math.sqrt(s.stiffness / m.mass - decay**2)

    def fly(t: Any, y: float, v: float) -> tuple[Any, Any]:
        return y + v * t - 0.5 * g * t * t, v - g * t

    def swing(t: Any, y: float, v: float) -> tuple[Any, Any]:
        """About the place where the stop carries the weight."""
        r, cosine, sine, size = y - rest, np.cos(w * t), np.sin(w * t), np.exp(-decay * t)
        slope = size * (v * cosine - (s.stiffness / m.mass * r + decay * v) / w * sine)
        return rest + size * (r * cosine + (v + decay * r) / w * sine), slope

    def margin(y: Any, v: Any) -> Any:
        """Positive where the stop pushes."""
        return np.minimum(s.stop_position - y, s.stop_position - y - s.damping / s.stiffness * v)

    def find_end(touching: bool, y: float, v: float) -> float:
        """How long the phase lasts: a flight at most as long as the fall to the stop, a contact a period."""
        fall = (v + math.sqrt(max(0.0, v * v + 2.0 * g * (y - s.stop_position)))) / g
        move, most = (swing, 2.0 * math.pi / w) if touching else (fly, 1.001 * fall)
        grid = np.linspace(0.0, most, 4001)
        margins = margin(*move(grid, y, v))
        ended = np.flatnonzero((margins[1:] > 0.0) != touching)
        # A mass that only comes back to the stop's place, to rounding, doesn't leave it.
        if not ended.size or (touching and margins.min() > -1e-15):
            return math.inf
        low, high = grid[ended[0]], grid[ended[0] + 1]
        return float(
            brentq(lambda t: margin(*move(t, y, v)), low, high, xtol=1e-300, rtol=4.0 * np.finfo(float).eps)
        )

    touching = bool(margin(position, velocity) > 0.0) or (position == s.stop_position and velocity <= 0.0)
    motion = np.empty((len(times), 2))
    events: tuple[list[float], list[float]] = ([], [])
    begun, y, v, done = 0.0, position, velocity, 0
    while done < len(times):
        move, length = swing if touching else fly, find_end(touching, y, v)
        end = int(np.searchsorted(times, begun + length, side="right"))
        motion[done:end] = np.transpose(move(np.asarray(times[done:end]) - begun, y, v))
        done = end
        if done < len(times):
            events[touching].append(begun + length)
            y, v = move(length, y, v)
            begun, touching = begun + length, not touching
    return Bouncing(motion, np.array(events[0]), np.array(events[1]))
