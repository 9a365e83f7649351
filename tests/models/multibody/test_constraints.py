"""Joints against sympy: C and the masses from the definitions, C' and C'' by differences in time.

Two bodies move along q = q0 + q1 t + q2 t^2/2 with arbitrary coefficients; the Cardan angles turn a body by
Rx Ry Rz. Nothing of the kernels is used but their results: J v + C_t and J v' - gamma.
"""

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import sympy as sp

from models.core.quantities import Layout, Vector
from models.multibody import joints
from models.multibody.bodies import Body, make_axes
from models.multibody.joints import Joint
from models.multibody.mechanism import Mechanism
from models.valve_train.cams.law import LawParameters

pytestmark = pytest.mark.plain

TIME = sp.Symbol("t")
COEFFICIENTS = sp.symbols("a:12 b:12 c:12")
Q = [COEFFICIENTS[i] + COEFFICIENTS[12 + i] * TIME + COEFFICIENTS[24 + i] * TIME**2 / 2 for i in range(12)]
AT_I, AT_J = (0.1, -0.2, 0.3), (-0.3, 0.2, 0.4)
AXIS_I, AXIS_J = (0.2, -0.5, 0.8), (0.6, 0.3, -0.7)
ROUNDING = 1e-12
# Of the differences below: rounding over the step is 1e-12 in C' and 5e-9 in C'', of a drive at 30 rad/s
# sixth order leaves (30 rad/s x step)^6 of its rates.
STEP = 5e-4
CAM = Layout(LawParameters).defaults()
SPEED, ANGLE, ACCELERATION = 30.0, 0.4, 500.0


def turn(angles: list[sp.Expr]) -> sp.Matrix:
    """Rx Ry Rz."""
    a, b, c = angles
    return (
        sp.Matrix([[1, 0, 0], [0, sp.cos(a), -sp.sin(a)], [0, sp.sin(a), sp.cos(a)]])
        * sp.Matrix([[sp.cos(b), 0, sp.sin(b)], [0, 1, 0], [-sp.sin(b), 0, sp.cos(b)]])
        * sp.Matrix([[sp.cos(c), -sp.sin(c), 0], [sp.sin(c), sp.cos(c), 0], [0, 0, 1]])
    )


R_I, R_J = turn(Q[3:6]), turn(Q[9:12])
D = sp.Matrix(Q[6:9]) + R_J * sp.Matrix(AT_J) - sp.Matrix(Q[0:3]) - R_I * sp.Matrix(AT_I)
A, B = ([sp.Matrix(list(axis)) for axis in make_axes(a)] for a in (AXIS_I, AXIS_J))


def held(axes: list[int]) -> list[sp.Expr]:
    """P_j does not move along these axes of i."""
    return [(R_I * A[i]).dot(D) for i in axes]


def perpendicular(pairs: list[tuple[int, int]]) -> list[sp.Expr]:
    return [(R_I * A[i]).dot(R_J * B[j]) for i, j in pairs]


def parallel_frames(a: list[sp.Matrix], b: list[sp.Matrix]) -> list[sp.Expr]:
    return [(R_I * a[i]).dot(R_J * b[j]) for i, j in ((1, 2), (2, 0), (0, 1))]


def drive() -> sp.Expr:
    """sin(phi - theta): the angle by which j's first axis is ahead of i's is theta."""
    phi = ANGLE + SPEED * TIME + ACCELERATION * TIME**2 / 2
    first = R_J * B[0]
    cosine, sine = (R_I * A[0]).dot(first), (R_I * A[1]).dot(first)
    return sp.sin(phi) * cosine - sp.cos(phi) * sine


def cam() -> sp.Expr:
    """K (31), on the rise, at the angle by which the cam has turned away from the face's normal y."""
    normal, foot = R_J * sp.Matrix([0, 1, 0]), R_I * sp.Matrix([0, 1, 0])
    side = R_I * sp.Matrix([-1, 0, 0])  # z x y
    psi = sp.atan2(-normal.dot(side), normal.dot(foot)) + PHASE
    a = psi - (sp.pi - CAM.dwell_half_width - CAM.rise_angle)
    turns = a / CAM.rise_angle
    return CAM.base_radius + CAM.lift * (turns - sp.sin(2 * sp.pi * turns) / (2 * sp.pi)) - normal.dot(D)


ARM, TILT, RADIUS = 0.4, 0.15, 0.1


def lever(shape: str) -> sp.Expr:
    """Distance of the face from the pivot, less that of the end of an arm that has turned by psi."""
    normal, foot, side = R_J * sp.Matrix([0, 1, 0]), R_I * sp.Matrix([0, 1, 0]), R_I * sp.Matrix([-1, 0, 0])
    psi = sp.atan2(-normal.dot(side), normal.dot(foot))
    # The pad's lowest point; an involute unwinds from it with the arm's rate at psi = 0.
    reach = {
        "pad": RADIUS + ARM * sp.sin(psi - TILT),
        "involute": RADIUS - ARM * sp.sin(TILT) + ARM * sp.cos(TILT) * psi,
    }
    return reach[shape] - normal.dot(D)


PHASE = 2.4
FOOT = (-math.sin(PHASE), math.cos(PHASE), 0.0)
XYZ = [sp.Matrix(list(row)) for row in np.eye(3)]
AT = {"at_i": AT_I, "at_j": AT_J}
AXES = {"axis_i": AXIS_I, "axis_j": AXIS_J}
NONE = "first", "second"
CASES: dict[str, tuple[Joint, Callable[[], list[sp.Expr]]]] = {
    "cylindrical": (
        joints.cylindrical("joint", *NONE, **AT, **AXES),
        lambda: held([0, 1]) + perpendicular([(0, 2), (1, 2)]),
    ),
    "revolute": (
        joints.revolute("joint", *NONE, **AT, **AXES),
        lambda: held([0, 1, 2]) + perpendicular([(0, 2), (1, 2)]),
    ),
    "translational": (
        joints.translational("joint", *NONE, **AT, **AXES),
        lambda: held([0, 1]) + parallel_frames(A, B),
    ),
    "spherical": (joints.spherical("joint", *NONE, **AT), lambda: [(R_I * x).dot(D) for x in XYZ]),
    "support": (joints.support("joint", *NONE, **AT, axis=AXIS_I), lambda: held([0, 1])),
    "plane contact": (
        joints.plane_contact("joint", *NONE, **AT, normal=(0.0, 1.0, 0.0)),
        lambda: [-(R_I * XYZ[1]).dot(D)],
    ),
    **{
        f"lever's end, {shape}": (
            joints.lever_end(
                "joint",
                *NONE,
                joints.LeverEnd(ARM, TILT, RADIUS, shape == "involute"),
                at_lever=AT_I,
                at_slider=AT_J,
            ),
            lambda shape=shape: [lever(shape)],
        )
        for shape in ("pad", "involute")
    },
    "fixed": (
        joints.fixed("joint", *NONE, **AT),
        lambda: [(R_I * x).dot(D) for x in XYZ] + parallel_frames(XYZ, XYZ),
    ),
    "prescribed rotation": (
        joints.prescribed_rotation("joint", *NONE, SPEED, ANGLE, ACCELERATION, **AXES),
        lambda: [drive()],
    ),
    "flat cam": (
        joints.flat_cam("joint", *NONE, CAM, at_cam=AT_I, at_follower=AT_J, foot=FOOT),
        lambda: [cam()],
    ),
}


def in_time(define: Callable[[], list[sp.Expr]], t: float, coefficients: Vector) -> tuple[Vector, ...]:
    """What is defined, with its first and second derivatives by differences of sixth order."""
    compute = sp.lambdify((TIME, *COEFFICIENTS), define(), modules="numpy", cse=True)
    low3, low2, low, here, high, high2, high3 = (
        np.array(compute(t + k * STEP, *coefficients), float) for k in range(-3, 4)
    )
    rate = (45.0 * (high - low) - 9.0 * (high2 - low2) + high3 - low3) / (60.0 * STEP)
    second = 270.0 * (high + low) - 27.0 * (high2 + low2) + 2.0 * (high3 + low3) - 490.0 * here
    return here, rate, second / (180.0 * STEP**2)


def along(coefficients: Vector, t: float) -> tuple[Vector, Vector, Vector]:
    """q, v and v' at t, of the symbolic rotation: omega from R' R^T."""
    q0, q1, q2 = coefficients.reshape(3, 12)
    rates = angular()(t, *coefficients)
    q, v, a = q0 + q1 * t + q2 * t * t / 2.0, q1 + q2 * t, q2.copy()
    v[3:6], v[9:12], a[3:6], a[9:12] = (np.asarray(part, float) for part in np.reshape(rates, (4, 3)))
    return q, v, a


@cache
def angular() -> Callable[..., list[float]]:
    omega = []
    for rotation in (R_I, R_J):
        turning = rotation.diff(TIME) * rotation.T
        omega.append([turning[2, 1], turning[0, 2], turning[1, 0]])
    found = [*omega[0], *omega[1], *(sp.diff(w, TIME) for part in omega for w in part)]
    return sp.lambdify((TIME, *COEFFICIENTS), found, modules="numpy", cse=True)


def moving_bodies(joint: list[Joint]) -> Mechanism:
    bodies = [Body("first", 2.0, (0.1, 0.2, 0.25)), Body("second", 1.0, (0.3, 0.4, 0.5))]
    return Mechanism(bodies, joint)


def draw(seed: int) -> Vector:
    """Coefficients: positions, rates and second rates. The cam's angle stays in its rise."""
    return np.random.default_rng(seed).uniform(-0.3, 0.3, 36) * np.repeat([1.0, 5.0, 50.0], 12)


@pytest.mark.parametrize("name", CASES)
def test_joints_and_their_derivatives_are_those_of_the_symbolic_definition(name):
    joint, define = CASES[name]
    coefficients, t = draw(0), 0.01
    q, v, a = along(coefficients, t)
    e = moving_bodies([joint]).evaluate(t, q, v)
    value, rate, second = in_time(define, t, coefficients)
    np.testing.assert_allclose(e.held.value, value, atol=ROUNDING)
    np.testing.assert_allclose(e.held.jacobian @ v + e.held.rate, rate, atol=1e-9)
    np.testing.assert_allclose(e.held.jacobian @ a - e.held.gamma, second, atol=1e-6)


def test_inertia_is_that_of_lagranges_equations_in_cardan_angles():
    """d/dt dT/dq' - dT/dq = (d omega/dq')^T (M v' - f), the left side from the symbolic kinetic energy."""
    symbols = sp.symbols("x:3 v:3 w:3")
    angles, rates, changes = symbols[:3], symbols[3:6], symbols[6:]
    rotation = turn(list(angles))
    turning = sum((rotation.diff(x) * dx for x, dx in zip(angles, rates, strict=True)), sp.zeros(3, 3))
    omega = turning * rotation.T
    spin = sp.Matrix([omega[2, 1], omega[0, 2], omega[1, 0]])
    inertia = (0.1, 0.2, 0.25)
    own = rotation.T * spin
    energy = sum(i * w**2 for i, w in zip(inertia, own, strict=True)) / 2
    momenta = [sp.diff(energy, dx) for dx in rates]
    left = [
        sum(
            sp.diff(p, x) * dx + sp.diff(p, dx) * ddx
            for x, dx, ddx in zip(angles, rates, changes, strict=True)
        )
        - sp.diff(energy, x0)
        for p, x0 in zip(momenta, angles, strict=True)
    ]
    lever = spin.jacobian(rates)
    spin_rate = spin.jacobian(angles) * sp.Matrix(rates) + lever * sp.Matrix(changes)
    compute = sp.lambdify(symbols, [left, list(spin), list(spin_rate), lever], modules="numpy", cse=True)
    values = np.random.default_rng(0).uniform(-1.0, 1.0, 9)
    expected, w, dw, levers = compute(*values)
    q, v, a = np.zeros(6), np.zeros(6), np.zeros(6)
    q[3:], v[3:], a[3:] = values[:3], np.ravel(w), np.ravel(dw)
    e = Mechanism([Body("body", 2.0, inertia)], []).evaluate(0.0, q, v)
    np.testing.assert_allclose(np.asarray(levers, float).T @ (e.mass @ a - e.force)[3:], expected, atol=1e-13)
