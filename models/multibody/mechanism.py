"""A mechanism: bodies, joints and force elements, put together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..core.quantities import Layout, Vector
from ..core.system import ModelError
from ..valve_train.cams.law import LAW
from ..valve_train.cams.profile import CamProfile
from .bodies import GROUND, ORIGIN, Body, Point
from .equations import make_evaluate, turn_coordinates
from .forces import ElasticField, SpringDamper
from .joints import Joint
from .tables import FIELD, ROW, SPRING, Evaluation, Tables, make_evaluation

# A row of the Jacobian of which less than this share is new depends on the rows before it.
INDEPENDENT = 1e-9
# Newton's steps to put a mechanism together, and the violation (m, 1) to which they go.
ASSEMBLY_STEPS = 50
ASSEMBLED = 1e-12
# Longest step of a coordinate (m, rad) in one of Newton's steps.
LONGEST_MOVE = 0.3


class Start(NamedTuple):
    """Consistent initial values: coordinates, velocities, accelerations (6 n,), multipliers (m,)."""

    q: Vector
    v: Vector
    a: Vector
    multipliers: Vector


@dataclass(frozen=True)
class Mechanism:
    """Bodies, joints and force elements. M v' = f - J^T lambda with C(q, t) = 0 (K (11), Q (4)).

    Coordinates q are, of each body, its centre of mass and Cardan angles; velocities v its velocity and
    angular velocity in the axes of the ground.
    """

    bodies: Sequence[Body]
    joints: Sequence[Joint]
    forces: Sequence[SpringDamper | ElasticField] = ()
    gravity: Point = ORIGIN
    profile: CamProfile = LAW

    @cached_property
    def constraint_names(self) -> tuple[str, ...]:
        """ "joint: constraint" for every multiplier."""
        return tuple(f"{joint.name}: {c.name}" for joint in self.joints for c in joint.constraints)

    def find_rows(self, joint: str) -> slice:
        """The multipliers of a joint."""
        first = 0
        for candidate in self.joints:
            if candidate.name == joint:
                return slice(first, first + len(candidate.constraints))
            first += len(candidate.constraints)
        raise ModelError(f"no joint {joint!r}; there are {', '.join(j.name for j in self.joints)}")

    def find_joint(self, name: str) -> Joint:
        """The joint of that name."""
        self.find_rows(name)
        return next(joint for joint in self.joints if joint.name == name)

    def find_body(self, name: str) -> int:
        """The number of a body; 0 is the ground."""
        names = [GROUND, *(body.name for body in self.bodies)]
        if name not in names:
            raise ModelError(f"no body {name!r}; there are {', '.join(names)}")
        return names.index(name)

    @cached_property
    def tables(self) -> Tables:
        """The mechanism's numbers for kernels."""
        return Tables(
            mass=np.array([body.mass for body in self.bodies], float),
            inertia=np.array([body.inertia for body in self.bodies], float),
            gravity=np.array(self.gravity, float),
            rows=self._list_rows(),
            springs=self._list_springs(),
            fields=self._list_fields(),
            cams=self._list_cams(),
        )

    def _list_rows(self) -> Any:
        rows, k, cam = np.zeros(len(self.constraint_names), ROW), 0, 0
        for joint in self.joints:
            for constraint in joint.constraints:
                fields = {"i": self.find_body(joint.i), "j": self.find_body(joint.j), "cam": cam}
                for name, value in {**fields, **constraint.fields}.items():
                    rows[k][name] = value
                k += 1
            cam += joint.cam is not None
        return rows

    def _list_springs(self) -> Any:
        found = [force for force in self.forces if isinstance(force, SpringDamper)]
        springs = np.zeros(len(found), SPRING)
        for row, s in zip(springs, found, strict=True):
            row["i"], row["j"], row["p_i"], row["p_j"] = (
                self.find_body(s.i),
                self.find_body(s.j),
                s.at_i,
                s.at_j,
            )
            row["length"], row["stiffness"], row["damping"] = s.length, s.stiffness, s.damping
        return springs

    def _list_fields(self) -> Any:
        found = [force for force in self.forces if isinstance(force, ElasticField)]
        fields = np.zeros(len(found), FIELD)
        for row, s in zip(fields, found, strict=True):
            row["i"], row["j"], row["p_i"], row["p_j"] = (
                self.find_body(s.i),
                self.find_body(s.j),
                s.at_i,
                s.at_j,
            )
            row["e_i"], row["e_j"], row["rest"] = s.axes_i, s.axes_j, s.rest
            row["stiffness"], row["damping"] = s.stiffness, s.damping
        return fields

    def _list_cams(self) -> Any:
        layout = Layout(self.profile.parameters, {"table_points": 0})
        records = [joint.cam for joint in self.joints if joint.cam is not None] or [layout.defaults()]
        cams = np.zeros(len(records), records[0].dtype)
        for i, cam in enumerate(records):
            cams[i] = cam
        return cams.view(np.recarray)

    @cached_property
    def _storage(self) -> Evaluation:
        return make_evaluation(len(self.bodies), len(self.constraint_names))

    def evaluate(self, t: float, q: Vector, v: Vector) -> Evaluation:
        """The equations at an instant; the next call overwrites them."""
        make_evaluate(self.profile.lift)(t, q, v, self.tables, self._storage)
        return self._storage

    def start(self, t: float = 0.0) -> Start:
        """Put the mechanism together at t: positions, velocities, accelerations and multipliers that agree.

        Raises ModelError if it cannot be assembled, or a constraint is redundant.
        """
        q = self._assemble(t)
        v = np.concatenate([[*b.velocity, *b.angular_velocity] for b in self.bodies]).astype(float)
        v = self.project_velocities(t, q, v)
        a, multipliers = self.accelerate(t, q, v)
        return Start(q, v, a, multipliers)

    def _assemble(self, t: float) -> Vector:
        q = np.concatenate([[*body.position, *body.angles] for body in self.bodies]).astype(float)
        v, change = np.zeros_like(q), np.empty_like(q)
        for _ in range(ASSEMBLY_STEPS):
            e = self.evaluate(t, q, v)
            if np.max(np.abs(e.constraint), initial=0.0) <= ASSEMBLED:
                self._refuse_redundant(e)
                return q
            step = np.asarray(-np.linalg.lstsq(e.jacobian, e.constraint, rcond=1e-12)[0], float)
            step *= min(1.0, LONGEST_MOVE / np.max(np.abs(step), initial=LONGEST_MOVE))
            turn_coordinates(q, step, change)
            q += change
        worst = int(np.argmax(np.abs(e.constraint)))
        raise ModelError(
            f"the mechanism cannot be assembled at t = {t:g} s: {self.constraint_names[worst]} is left with "
            f"{e.constraint[worst]:.3g}; look at the lengths of its bodies, or start nearer to where they fit"
        )

    def find_redundant(self, jacobian: Vector) -> tuple[str, ...]:
        """The constraints whose rows depend on those before them."""
        basis: list[Vector] = []
        redundant = []
        for name, row in zip(self.constraint_names, jacobian, strict=True):
            left = row / np.linalg.norm(row) if np.any(row) else row
            for _ in range(2):  # twice is enough
                for direction in basis:
                    left = left - (direction @ left) * direction
            size = float(np.linalg.norm(left))
            if size < INDEPENDENT:
                redundant.append(name)
            else:
                basis.append(left / size)
        return tuple(redundant)

    def _refuse_redundant(self, e: Evaluation) -> None:
        if redundant := self.find_redundant(e.jacobian):
            raise ModelError(
                f"redundant constraints: {'; '.join(redundant)}. The joints before already hold this: take "
                "joints that hold less, e.g. cylindrical for revolute"
            )

    def project_velocities(self, t: float, q: Vector, v: Vector) -> Vector:
        """The nearest velocities that the joints allow."""
        e = self.evaluate(t, q, v)
        return v - e.jacobian.T @ np.linalg.solve(e.jacobian @ e.jacobian.T, e.jacobian @ v + e.rate)

    def project_coordinates(self, t: float, q: Vector, v: Vector) -> Vector:
        """One of Newton's steps towards coordinates that the joints allow."""
        e, change = self.evaluate(t, q, v), np.empty_like(q)
        turn_coordinates(q, e.jacobian.T @ np.linalg.solve(e.jacobian @ e.jacobian.T, e.constraint), change)
        return q - change

    @property
    def freedoms(self) -> int:
        """Degrees of freedom that joints and drives leave: 6 n - m."""
        return 6 * len(self.bodies) - len(self.constraint_names)

    def accelerate(self, t: float, q: Vector, v: Vector) -> tuple[Vector, Vector]:
        """Accelerations and multipliers: M a + J^T lambda = f, J a = gamma."""
        e = self.evaluate(t, q, v)
        m, size = e.jacobian.shape
        matrix = np.zeros((size + m, size + m))
        matrix[:size, :size], matrix[:size, size:], matrix[size:, :size] = e.mass, e.jacobian.T, e.jacobian
        solution = np.linalg.solve(matrix, np.concatenate([e.force, e.gamma]))
        return solution[:size], solution[size:]
