"""A mechanism: bodies, joints and force elements, put together."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..core.errors import ModelError
from ..core.quantities import Vector
from ..valve_train.cams.law import LAW
from ..valve_train.cams.profile import CamProfile
from .bodies import GROUND, ORIGIN, Body, Point, check_vector
from .equations import make_evaluate, turn_coordinates
from .fill import Force, fill_tables
from .forces import ContactSpring, LubricatedCam
from .joints import Joint
from .tables import DRIVEN, Evaluation, Tables, find_drive_angle, make_evaluation

# A row of the Jacobian of which less than this share is new depends on the rows before it.
INDEPENDENT = 1e-9


def find_dependent(jacobian: Vector) -> list[int]:
    """The rows that depend on those before them."""
    sizes = np.linalg.norm(jacobian, axis=1, keepdims=True)
    rows = jacobian / np.where(sizes > 0.0, sizes, 1.0)
    ranks = [0, *(np.linalg.matrix_rank(rows[: k + 1], tol=INDEPENDENT) for k in range(len(rows)))]
    return [k for k in range(len(rows)) if ranks[k + 1] == ranks[k]]


# Newton's steps to put a mechanism together, and the violation (m, 1) to which they go.
ASSEMBLY_STEPS = 50
ASSEMBLED = 1e-12
# Longest step of a coordinate (m, rad) in one of Newton's steps.
LONGEST_MOVE = 0.3


class Start(NamedTuple):
    """Values that agree: coordinates, velocities, accelerations (6 n,), multipliers (m,), films (c,)."""

    q: Vector
    v: Vector
    a: Vector
    multipliers: Vector
    film: Vector


@dataclass(frozen=True)
class Mechanism:
    """Bodies, joints and force elements. M v' = f - J^T lambda with C(q, t) = 0 (K (11), Q (4)).

    Coordinates q are, of each body, its centre of mass and Cardan angles; velocities v its velocity and
    angular velocity in the axes of the ground.
    """

    bodies: Sequence[Body]
    joints: Sequence[Joint]
    forces: Sequence[Force] = ()
    gravity: Point = ORIGIN
    profile: CamProfile = LAW

    def __post_init__(self) -> None:
        """ModelError for names that are not unique, and a gravity that is no vector."""
        if not self.bodies:
            raise ModelError("a mechanism needs at least one body")
        for kind, names in (
            ("body", [GROUND, *(body.name for body in self.bodies)]),
            ("joint or contact", [*(joint.name for joint in self.joints), *self.contacts]),
        ):
            if twice := [name for name in dict.fromkeys(names) if names.count(name) > 1]:
                raise ModelError(f"{kind} {twice[0]}: there are two of this name; give each its own")
        check_vector("gravity", self.gravity)

    @cached_property
    def constraint_names(self) -> tuple[str, ...]:
        """ "joint: constraint" for every multiplier."""
        return tuple(f"{joint.name}: {c.name}" for joint in self.joints for c in joint.constraints)

    def find_joint(self, name: str) -> tuple[Joint, slice]:
        """The joint of that name, and its multipliers."""
        first = 0
        for joint in self.joints:
            end = first + len(joint.constraints)
            if joint.name == name:
                return joint, slice(first, end)
            first = end
        raise ModelError(f"no joint {name!r}; there are {', '.join(j.name for j in self.joints)}")

    def find_body(self, name: str) -> int:
        """The number of a body; 0 is the ground."""
        names = [GROUND, *(body.name for body in self.bodies)]
        if name not in names:
            raise ModelError(f"no body {name!r}; there are {', '.join(names)}")
        return names.index(name)

    @cached_property
    def contacts(self) -> tuple[str, ...]:
        """Names of the contacts that no joint holds, those with an oil film first."""
        return tuple(
            force.name
            for kind in (LubricatedCam, ContactSpring)
            for force in self.forces
            if isinstance(force, kind)
        )

    @cached_property
    def tables(self) -> Tables:
        """The mechanism's numbers for kernels."""
        return fill_tables(self.bodies, self.joints, self.forces, self.gravity, self.profile, self.find_body)

    @cached_property
    def _storage(self) -> Evaluation:
        return make_evaluation(self.tables)

    def evaluate(self, t: float, q: Vector, v: Vector, film: Vector | None = None) -> Evaluation:
        """The equations at an instant, which the next call overwrites; without `film`, with the start's."""
        films = self.start_film if film is None else film
        make_evaluate(self.profile.lift)(t, q, v, films, self.tables, self._storage)
        return self._storage

    @cached_property
    def start_film(self) -> Vector:
        """Film thickness (m) of the contacts at the start."""
        return np.array([force.film for force in self.forces if isinstance(force, LubricatedCam)], float)

    def start(self, t: float = 0.0) -> Start:
        """Put the mechanism together at t: positions, velocities, accelerations and multipliers that agree.

        Raises ModelError if it cannot be assembled, or a constraint is redundant.
        """
        q = self._assemble(t)
        v = np.concatenate([[*b.velocity, *b.angular_velocity] for b in self.bodies]).astype(float)
        v = self.project_velocities(t, q, v)
        a, multipliers = self.accelerate(t, q, v, self.start_film)
        return Start(q, v, a, multipliers, self.start_film.copy())

    def _assemble(self, t: float) -> Vector:
        q = np.concatenate([[*body.position, *body.angles] for body in self.bodies]).astype(float)
        v, change = np.zeros_like(q), np.empty_like(q)
        for _ in range(ASSEMBLY_STEPS):
            e = self.evaluate(t, q, v)
            if np.max(np.abs(e.held.value), initial=0.0) <= ASSEMBLED:
                if names := [self.constraint_names[k] for k in find_dependent(e.held.jacobian)]:
                    raise ModelError(
                        f"redundant constraints: {'; '.join(names)}. The joints before already hold this, or "
                        "contradict it: take joints that hold less, e.g. cylindrical for revolute, and leave "
                        "out a second drive"
                    )
                self._refuse_opposite(t, e)
                return q
            step = np.asarray(-np.linalg.lstsq(e.held.jacobian, e.held.value, rcond=1e-12)[0], float)
            step *= min(1.0, LONGEST_MOVE / np.max(np.abs(step), initial=LONGEST_MOVE))
            turn_coordinates(q, step, change)
            q += change
        worst = int(np.argmax(np.abs(e.held.value)))
        raise ModelError(
            f"the mechanism cannot be assembled at {self.describe_instant(t)}: "
            f"{self.constraint_names[worst]} is left with {e.held.value[worst]:.3g}; look at the lengths of "
            "its bodies and at drives that contradict each other, or start nearer to where they fit"
        )

    def describe_instant(self, t: float) -> str:
        """The time, and the angles of the drives there."""
        angles = [f"{find_drive_angle(row, t):.6g} rad" for row in self.tables.rows if row["kind"] == DRIVEN]
        return f"t = {t:.6g} s" + (f", drive angle {', '.join(angles)}" if angles else "")

    def _refuse_opposite(self, t: float, e: Evaluation) -> None:
        """Joints hold also where axes point in opposite directions, half a turn from where they belong."""
        for joint in self.joints:
            i, j = self.find_body(joint.i), self.find_body(joint.j)
            pairs = list(joint.alike)
            for c in joint.constraints:
                if c.fields["kind"] == DRIVEN:
                    angle = find_drive_angle(c.fields, t)
                    turned = math.cos(angle) * c.fields["a"] + math.sin(angle) * c.fields["a2"]
                    pairs.append((turned, c.fields["b"]))
            if any((e.rotation[i] @ a) @ (e.rotation[j] @ b) < 0.0 for a, b in pairs):
                raise ModelError(
                    f"joint {joint.name}: {joint.j} is put together half a turn from where it belongs at "
                    f"t = {t:g} s; start its angles within 90 deg of there"
                )

    def project_velocities(self, t: float, q: Vector, v: Vector) -> Vector:
        """The nearest velocities that the joints allow."""
        e = self.evaluate(t, q, v)
        jacobian = e.held.jacobian
        return v - jacobian.T @ np.linalg.solve(jacobian @ jacobian.T, jacobian @ v + e.held.rate)

    @property
    def freedoms(self) -> int:
        """Degrees of freedom that joints and drives leave: 6 n - m."""
        return 6 * len(self.bodies) - len(self.constraint_names)

    def accelerate(self, t: float, q: Vector, v: Vector, film: Vector) -> tuple[Vector, Vector]:
        """Accelerations and multipliers: M a + J^T lambda = f, J a = gamma; LinAlgError if not unique."""
        e = self.evaluate(t, q, v, film)
        size, m, jacobian = e.force.size, e.held.gamma.size, e.held.jacobian
        matrix = np.zeros((size + m, size + m))
        matrix[:size, :size], matrix[:size, size:], matrix[size:, :size] = e.mass, jacobian.T, jacobian
        solution = np.linalg.solve(matrix, np.concatenate([e.force, e.held.gamma]))
        return solution[:size], solution[size:]
