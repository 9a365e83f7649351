"""Exact solutions of the oscillators, to the rounding of a matrix exponential and of a root.

The systems are those that the components make when they are connected; parameters are theirs.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

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
    if m.gravity <= 0.0:
        raise ValueError(f"gravity = {m.gravity:g} m/s2: must be > 0")
    critical = 2.0 * math.sqrt(s.stiffness * m.mass)
    if s.damping >= critical:
        raise ValueError(f"damping = {s.damping:g} N.s/m: must be less than the critical {critical:g}")
    flight, contact = _Flight(m, s), _Contact(m, s)
    c = s.stop_position - position
    pushes = s.stiffness * c - s.damping * velocity > 0.0
    touching = (c > 0.0 and pushes) or (c == 0.0 and velocity <= 0.0)
    motion = np.empty((len(times), 2))
    events: tuple[list[float], list[float]] = ([], [])
    begun, y, v = 0.0, position, velocity
    done = 0
    while done < len(times):
        phase: _Flight | _Contact = contact if touching else flight
        length = phase.length(y, v)
        stop_at = int(np.searchsorted(times, begun + length, side="right"))
        for i in range(done, stop_at):
            motion[i] = phase.at(times[i] - begun, y, v)
        done = stop_at
        if done < len(times):
            events[touching].append(begun + length)
            y, v = phase.at(length, y, v)
            begun, touching = begun + length, not touching
    return Bouncing(motion, np.array(events[0]), np.array(events[1]))


@dataclass(frozen=True)
class _Flight:
    """Free fall."""

    mass: FallingMassParameters
    stop: SpringStopParameters

    def at(self, s: float, y: float, v: float) -> tuple[float, float]:
        g = self.mass.gravity
        return y + v * s - 0.5 * g * s * s, v - g * s

    def length(self, y: float, v: float) -> float:
        """Time until the stop pushes."""
        g, k, d = self.mass.gravity, self.stop.stiffness, self.stop.damping
        c = self.stop.stop_position - y
        if c > 0.0:
            # Lost while still compressed: the force that the damper holds down, a parabola, may come back.
            b = k * v - d * g
            back = (b + math.sqrt(max(0.0, b * b - 2.0 * k * g * (k * c - d * v)))) / (k * g)
            left = v * v - 2.0 * g * c
            out = (v - math.sqrt(left)) / g if v > 0.0 and left >= 0.0 else math.inf
            if back <= out:
                return back
        return (v + math.sqrt(max(0.0, v * v - 2.0 * g * c))) / g


@dataclass(frozen=True)
class _Contact:
    """Oscillation about the place where the stop carries the weight."""

    mass: FallingMassParameters
    stop: SpringStopParameters

    def _swing(self, s: float, r: float, v: float) -> tuple[float, float]:
        """Solution and slope of r'' + (d/m) r' + (k/m) r = 0."""
        k, d, m = self.stop.stiffness, self.stop.damping, self.mass.mass
        decay = 0.5 * d / m
        w = math.sqrt(k / m - decay * decay)
        cosine, sine, size = math.cos(w * s), math.sin(w * s), math.exp(-decay * s)
        slope = size * (v * cosine - (k / m * r + decay * v) / w * sine)
        return size * (r * cosine + (v + decay * r) / w * sine), slope

    def at(self, s: float, y: float, v: float) -> tuple[float, float]:
        middle = self.stop.stop_position - self.mass.mass * self.mass.gravity / self.stop.stiffness
        r, slope = self._swing(s, y - middle, v)
        return middle + r, slope

    def length(self, y: float, v: float) -> float:
        """Time until the stop no longer pushes; infinite if it always does."""
        k, d, m = self.stop.stiffness, self.stop.damping, self.mass.mass
        weight = m * self.mass.gravity
        # The force less the weight swings as the mass does: f'' + (d/m) f' + (k/m) f = 0.
        f = k * (self.stop.stop_position - y) - d * v - weight
        slope = -k * v - d * f / m
        bend = -(k * f + d * slope) / m
        decay = 0.5 * d / m
        w = math.sqrt(k / m - decay * decay)
        extreme = math.atan2(slope, -(bend + decay * slope) / w) % math.pi / w
        earlier = 0.0
        if self._swing(extreme, f, slope)[0] > 0.0:
            earlier, extreme = extreme, extreme + math.pi / w

        def force(s: float) -> float:
            return weight + self._swing(s, f, slope)[0]

        if force(extreme) >= 0.0:
            return math.inf
        return float(brentq(force, earlier, extreme, xtol=1e-300, rtol=4.0 * np.finfo(float).eps))
