"""Andrews' squeezer: seven bodies in three loops, driven by a torque (test set for IVP solvers, Bari)."""

import math

import numpy as np

from models.multibody.bodies import Body, Point
from models.multibody.forces import SpringDamper
from models.multibody.ida import solve_ida
from models.multibody.joints import Joint, revolute, support
from models.multibody.mechanism import Mechanism

from .page import COMPUTED, Published

SOURCE = "Test Set for IVP Solvers 2.4 (2008), Andrews' squeezing mechanism; Hairer and Wanner (1996), VII.7"
TORQUE, RATE, LENGTH = 0.033, 4530.0, 0.07785  # N m; spring in N/m, m
A, B, C = (-0.06934, -0.00227), (-0.03635, 0.03273), (0.014, 0.072)
# Bodies: mass, inertia, centre of mass and end in own axes from the joint where a body hangs.
BODIES = {
    "K1": (0.04325, 2.194e-6, (0.00092, 0.0), (0.007, 0.0)),
    "K2": (0.00365, 4.410e-7, (-0.0115, 0.0), (-0.028, 0.0)),
    "K3": (0.02373, 5.255e-6, (0.01043, -0.01874), (0.0, -0.035)),
    "K4": (0.00706, 5.667e-7, (0.0, -0.00579), (0.0, -0.02)),
    "K5": (0.07050, 1.169e-5, (0.02308, 0.00916), (0.04, 0.0)),
    "K6": (0.00706, 5.667e-7, (0.00579, 0.0), (0.02, 0.0)),
    "K7": (0.05498, 1.912e-5, (-0.00449, -0.01228), (0.0, -0.04)),
}
SPRING_PIN = (0.02, -0.018)  # on K3
# Where each hangs: on the ground at a point, or at the end of a body.
HANGS = {"K1": (0.0, 0.0), "K2": "K1", "K3": B, "K5": A, "K4": "K5", "K7": A, "K6": "K7"}
# Angles beta, Theta, gamma, Phi, delta, Omega, epsilon at the start and at 0.03 s.
NAMES = ("beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon")
START = (-0.0617138900142764, 0.0, 0.45527981916307, 0.222668390165886, 0.487364979543843,
         -0.222668390165886, 1.2305474445498212)  # fmt: skip
END = (15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948, 0.5244099658805304,
       0.5347301163226948, 1.048080741042263)  # fmt: skip


def squeezer() -> Mechanism:
    beta, theta, gamma, phi, delta, omega, epsilon = START
    angles = {"K1": beta, "K2": beta + theta, "K3": gamma, "K4": phi + delta, "K5": delta,
              "K6": omega + epsilon, "K7": epsilon}  # fmt: skip
    bodies: list[Body] = []
    joints: list[Joint] = []
    ends: dict[str, np.ndarray] = {}
    for name, hangs in HANGS.items():
        mass, inertia, centre, end = BODIES[name]
        c, s = math.cos(angles[name]), math.sin(angles[name])
        turn = np.array([[c, -s], [s, c]])
        start = ends[hangs] if isinstance(hangs, str) else np.array(hangs)
        ends[name] = start + turn @ end
        moment = (0.0, 0.0, TORQUE if name == "K1" else 0.0)
        place, turned = lift(*(start + turn @ centre)), (0.0, 0.0, angles[name])
        bodies.append(Body(name, mass, (inertia,) * 3, place, turned, moment=moment))
        at = pin(hangs) if isinstance(hangs, str) else lift(*hangs)
        on = hangs if isinstance(hangs, str) else "ground"
        joints.append(revolute(f"{on} {name}", on, name, at_i=at, at_j=lift(-centre[0], -centre[1])))
    # The loops close where the ends of K3, K4 and K6 meet that of K2; in the plane, where all else is held.
    joints += [
        support(f"K2 {name}", "K2", name, at_i=pin("K2"), at_j=pin(name)) for name in ("K3", "K4", "K6")
    ]
    at_pin = lift(*(np.array(SPRING_PIN) - BODIES["K3"][2]))
    spring = SpringDamper("ground", "K3", RATE, LENGTH, at_i=lift(*C), at_j=at_pin)
    return Mechanism(bodies, joints, [spring])


def pin(body: str) -> Point:
    """The body's end from its centre of mass."""
    _, _, centre, end = BODIES[body]
    return lift(end[0] - centre[0], end[1] - centre[1])


def lift(x: float, y: float) -> Point:
    return (float(x), float(y), 0.0)


def test_seven_bodies_in_three_loops(published) -> None:
    mechanism = squeezer()
    assert mechanism.freedoms == 1
    motion = solve_ida(mechanism, np.linspace(0.0, 0.03, 31), 1e-10)
    k1, k2, k3, k4, k5, k6, k7 = (motion.angles(f"K{i}")[-1, 2] for i in range(1, 8))
    found = np.array([k1, k2 - k1, k3, k4 - k5, k5, k6 - k7, k7])
    worst = int(np.argmax(np.abs(found - END)))
    for name, ours, value in ((NAMES[worst], found[worst], END[worst]), (NAMES[6], found[6], END[6])):
        case = Published(
            "Mechanisms", f"Andrews' squeezer: angle {name} at 0.03 s (rad)",
            "parameters and start of the test set; band: 1e-6, our tolerance of 1e-10 a step adds up to 1e-7",
            COMPUTED, value - 1e-6, value + 1e-6, SOURCE, value=value, digits=9,
        )  # fmt: skip
        why = "a drive by torque in three closed loops, here of 42 coordinates and 41 constraints in space"
        published(case, ours, why)
