"""The motion of a mechanism: places, multipliers, reactions of joints, drift of the constraints."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..core.errors import ModelError
from ..core.quantities import Vector
from .bodies import GROUND
from .mechanism import Mechanism

# Cosine of the Cardan angle beta below which its rates are said to be lost.
UPRIGHT = 1e-3
# Below it rounding and not the tolerance decides, and steps do not end.
LEAST_TOLERANCE = 1e-14


class Reaction(NamedTuple):
    """Load of a joint on its body j at its point P_j, in the axes of the ground: N and N m, (times, 3)."""

    force: Vector
    moment: Vector


class Drift(NamedTuple):
    """Largest violation of the constraints (m or rad), and of their rates."""

    position: float
    velocity: float


@dataclass(frozen=True)
class Motion:
    """Coordinates, velocities and accelerations (times, 6 n), multipliers (times, m) of a mechanism.

    Loads (times, c) and films are those of the contacts that no joint holds. Accelerations and multipliers
    belong to the coordinates and velocities at each instant: M a + J^T lambda = f, J a = gamma.
    """

    mechanism: Mechanism
    times: Vector
    q: Vector
    v: Vector
    film: Vector
    a: Vector
    multipliers: Vector
    loads: Vector
    method: str

    def position(self, body: str) -> Vector:
        """The centre of mass (times, 3)."""
        return self.q[:, self._find_columns(body)[:3]]

    def angles(self, body: str) -> Vector:
        """Cardan angles 1-2-3 (times, 3)."""
        return self.q[:, self._find_columns(body)[3:]]

    def _find_columns(self, body: str) -> list[int]:
        if body == GROUND:
            raise ModelError(f"body {GROUND!r}: does not move")
        first = 6 * (self.mechanism.find_body(body) - 1)
        return list(range(first, first + 6))

    def multiplier(self, joint: str) -> Vector:
        """The multipliers of a joint (times, constraints)."""
        return self.multipliers[:, self.mechanism.find_joint(joint)[1]]

    def load(self, contact: str) -> Vector:
        """Load of a contact (times,): by its law, or the multiplier of one that is held."""
        contacts = self.mechanism.contacts
        return (
            self.loads[:, contacts.index(contact)] if contact in contacts else self.multiplier(contact)[:, 0]
        )

    def film_thickness(self, contact: str) -> Vector:
        """Film of a lubricated contact (times,)."""
        return self.film[:, self.mechanism.contacts.index(contact)]

    def reaction(self, joint: str) -> Reaction:
        """What the joint does to its body j, at the point P_j."""
        j, rows = self.mechanism.find_joint(joint)
        body = self.mechanism.find_body(j.j)
        column = slice(6 * (body - 1), 6 * body)
        forces, moments = np.zeros((self.times.size, 3)), np.zeros((self.times.size, 3))
        for n, (t, q, v) in enumerate(zip(self.times, self.q, self.v, strict=True)):
            e = self.mechanism.evaluate(float(t), q, v)
            load = -self.multipliers[n, rows] @ e.held.jacobian[rows, column]
            forces[n] = load[:3]
            moments[n] = load[3:] - np.cross(e.rotation[body] @ np.asarray(j.at_j, float), load[:3])
        return Reaction(forces, moments)

    @property
    def drift(self) -> Drift:
        """How far the constraints are violated."""
        position = velocity = 0.0
        for t, q, v in zip(self.times, self.q, self.v, strict=True):
            e = self.mechanism.evaluate(float(t), q, v)
            position = max(position, float(np.max(np.abs(e.held.value), initial=0.0)))
            velocity = max(velocity, float(np.max(np.abs(e.held.jacobian @ v + e.held.rate), initial=0.0)))
        return Drift(position, velocity)


def check_request(times: Vector, tolerance: float) -> Vector:
    """The times as an array; ModelError unless they are finite and ascend, and the tolerance is in range."""
    times = np.asarray(times, float)
    if times.ndim != 1 or times.size < 2 or not np.all(np.isfinite(times)) or np.any(np.diff(times) <= 0.0):
        raise ModelError("times: must be at least two finite instants (s) in ascending order")
    if not LEAST_TOLERANCE <= tolerance <= 1e-2:
        raise ModelError(f"tolerance = {tolerance:g}: must be from {LEAST_TOLERANCE:g} to 0.01")
    return times


def complete(mechanism: Mechanism, times: Vector, states: Vector, method: str) -> Motion:
    """The motion whose states (q, v, films) are rows of `states`, with all that belongs to them."""
    size = 6 * len(mechanism.bodies)
    q, v, film = states[:, :size], states[:, size : 2 * size], states[:, 2 * size :]
    a, loads = np.empty_like(q), np.empty((times.size, len(mechanism.contacts)))
    multipliers = np.empty((times.size, len(mechanism.constraint_names)))
    for n, t in enumerate(times):
        with explain_singular(mechanism, float(t), q[n], v[n]):
            a[n], multipliers[n] = mechanism.accelerate(float(t), q[n], v[n], film[n])
        loads[n] = mechanism.evaluate(float(t), q[n], v[n], film[n]).load
    return Motion(mechanism, times, q, v, film, a, multipliers, loads, method)


@contextmanager
def explain_singular(mechanism: Mechanism, t: float, q: Vector, v: Vector) -> Iterator[None]:
    """Equations that cannot be solved at an instant become the error that names the joint."""
    try:
        yield
    except np.linalg.LinAlgError as error:
        raise explain_failure(mechanism, t, q, v, "singular equations") from error


def explain_failure(mechanism: Mechanism, t: float, q: Vector, v: Vector, reason: str) -> ModelError:
    """The error of an integration that cannot go on from there, with the joint that is about to lock."""
    e = mechanism.evaluate(t, q, v)
    if not mechanism.constraint_names:
        return ModelError(f"the motion cannot go on at t = {t:.6g} s ({reason}); look at the force elements")
    tilts = np.abs(np.cos(q[4::6]))
    if np.min(tilts) < UPRIGHT:
        body = mechanism.bodies[int(np.argmin(tilts))].name
        return ModelError(
            f"body {body}: its Cardan angle beta reaches +-90 deg at t = {t:.6g} s, where the angles have no "
            "rates; turn its axes so that it moves about x or z"
        )
    rows = e.held.jacobian / np.linalg.norm(e.held.jacobian, axis=1, keepdims=True)
    combination = np.linalg.svd(rows)[0][:, -1]
    name = mechanism.constraint_names[int(np.argmax(np.abs(combination)))]
    return ModelError(
        f"the mechanism locks, or can go on in two ways, at {mechanism.describe_instant(t)}: {name} cannot "
        f"be held any longer ({reason}); stop before, or change the lengths of its bodies"
    )
