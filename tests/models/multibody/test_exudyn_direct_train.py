"""K's train built in Exudyn from K's data: parts, joints, shaft and 21 constraints, without `models`.

Exudyn has the joints, the shaft as its own elastic connector, whose frames lie half way between its ends,
and generalized-alpha. The contact is a constraint of its coordinates, with gradients by complex steps.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from models.core.quantities import Layout
from models.multibody.direct_train import CONTACT, DRIVE, GUIDE, TrainStart, direct_train
from models.multibody.ida import solve_ida
from models.multibody.linear import find_rest
from models.multibody.mechanism import Mechanism
from models.multibody.pushrod_train import CAM, PIVOT, ROD_END, TIP, PushrodTrain, pushrod_train
from models.valve_train.camshaft import CamshaftParameters
from models.valve_train.valve_spring import ValveSpringParameters

from .. import independent_train as k
from ..independent_train import cam
from .exudyn_system import CENTRE, ExudynSystem, exudyn, items
from .trains import pushrod_parts

SOURCE = "Exudyn"
# Differences of load, drive torque, guide moment and lift, RMS over the largest value. The multipliers of
# Exudyn's method ring where the cam's third derivative jumps, half as much in half the steps; the others
# fall with the square of the step.
TOLERANCES = {"load": 4e-4, "drive torque": 3e-5, "guide moment": 3e-5, "lift": 3e-6}
FREE_Y = [1, 0, 1, 1, 1, 1]
BODIES = ("shaft", "cam", "follower", "spring mass 5", "spring mass 6")
SPRING = 0.04  # installed length (m)
# K Table 1, middle of the ranges (kg, kg m^2). Those of shaft, follower and coils have no effect here.
MASSES = (0.175, k.CAM_MASS, k.VALVE_MASS, k.COIL_MASS, k.COIL_MASS)
SHAFT, SLIDING = (62.5e-6, 62.5e-6, 125e-6), (1e-5, 1e-5, 1e-5)
AXIAL = k.YOUNG * math.pi * k.DIAMETER**2 / (4.0 * k.SHAFT_LENGTH)
AXIAL_DAMPING = 2.0 * k.SHAFT_RATIO * math.sqrt(AXIAL * k.CAM_MASS)
INERTIAS = (SHAFT, (k.TRANSVERSE, k.TRANSVERSE, k.POLAR), SLIDING, SLIDING, SLIDING)


# Each of the twelve coordinates of cam and follower moved by i h: gradients without rounding.
STEP = 1e-30
MOVES = 1j * STEP * np.eye(12)


def turn(angles: Any) -> Any:
    """Rx(alpha) Ry(beta) Rz(gamma), (3, 3, ...) of angles (3, ...) that may be complex."""
    (a, b, c), (sa, sb, sc) = np.cos(angles), np.sin(angles)
    return np.array(
        [
            [b * c, -b * sc, sb],
            [a * sc + sa * sb * c, a * c - sa * sb * sc, -sa * b],
            [sa * sc - a * sb * c, sa * c + a * sb * sc, a * b],
        ]
    )


def see_cam(q: Any) -> Any:
    """Of cam and follower at q (12, ...): n y2, n x2 and n (P3 - P2), n the normal of the follower's face."""
    normal, cam = turn(q[9:])[:, 1], turn(q[3:6])
    seen = (cam[:, 1], cam[:, 0], q[6:9] - q[:3])
    return np.array([(normal * vector).sum(axis=0) for vector in seen])


def find_gap(system: Any, t: float, item: int, q: Any, rates: Any, by_rates: bool) -> list[float]:
    """C = R0 + s(psi) - n (P3 - P2), tan psi = n x2 / n y2."""
    ahead, aside, distance = see_cam(np.asarray(q))
    return [k.BASE + k.cam(math.atan2(aside, ahead))[0] - distance]


def differ_gap(system: Any, t: float, item: int, q: Any, rates: Any, by_rates: bool) -> Any:
    """dC/dq: s' dpsi/dq - d(n (P3 - P2))/dq."""
    here = np.asarray(q)
    ahead, aside, _ = see_cam(here)
    changes = see_cam(here[:, None] + MOVES).imag / STEP
    turning = (ahead * changes[1] - aside * changes[0]) / (ahead * ahead + aside * aside)
    return (k.cam(math.atan2(aside, ahead))[1] * turning - changes[2]).reshape(1, -1)


class Built(ExudynSystem):
    """The train at a cam speed (rad/s), from coordinates and velocities (5, 6) of its bodies on."""

    def __init__(self, speed: float, flexible: bool, q: Any, v: Any) -> None:
        super().__init__()
        self.bodies = {
            name: self.add_body(
                mass, inertia, q[i, :3], referenceRotationMatrix=turn(q[i, 3:]),
                initialVelocity=list(v[i, :3]), initialAngularVelocity=list(v[i, 3:]),
                nodeType=exudyn.NodeType.RotationRxyz,
            )
            for i, (name, mass, inertia) in enumerate(zip(BODIES, MASSES, INERTIAS, strict=True))
        }  # fmt: skip
        self.join([self.mark(self.ground), self.mark(self.bodies["shaft"])], [1, 1, 0, 1, 1, 0])
        self.drive(speed)
        for name, place in zip(BODIES[2:], q[2:, :3], strict=True):
            guide = self.join([self.mark(self.ground, place), self.mark(self.bodies[name])], FREE_Y)
            self.sense(f"guide of {name}", guide, "TorqueLocal")
        self.carry_cam(flexible, speed)
        self.touch()
        self.hang_spring()
        self.sense_body("follower", self.bodies["follower"], "Position")

    def mark_coordinates(self, body: str, coordinate: int | None = None) -> Any:
        """A marker at one of the body's six coordinates, or at all."""
        node = self.system.GetObject(self.bodies[body])["nodeNumber"]
        if coordinate is None:
            return self.system.AddMarker(items.MarkerNodeCoordinates(nodeNumber=node))
        return self.system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))

    def drive(self, speed: float) -> None:
        """K (32): gamma of the shaft is the drive's angle."""
        rest = self.system.AddMarker(
            items.MarkerNodeCoordinate(nodeNumber=self.system.AddNode(items.NodePointGround()), coordinate=0)
        )
        drive = items.ObjectConnectorCoordinate(
            markerNumbers=[rest, self.mark_coordinates("shaft", 5)],
            offsetUserFunction=lambda system, t, item, offset: speed * t,
            offsetUserFunction_t=lambda system, t, item, offset: speed,
        )
        self.sense(DRIVE, self.system.AddObject(drive), "Force")

    def carry_cam(self, flexible: bool, speed: float) -> None:
        """A weld, or K (33) with its damping.

        Exudyn damps v1 - v0, ours what an observer on the shaft sees, v1 - v0 - speed z x d: the difference
        is a force by the shift d.
        """
        markers = [self.mark(self.bodies["shaft"], (0.0, 0.0, k.SHAFT_LENGTH)), self.mark(self.bodies["cam"])]
        if not flexible:
            self.join(markers, [1] * 6)
            return
        stiffness = spread(AXIAL, k.TORSION, k.BENDING)
        damping = spread(AXIAL_DAMPING, k.TORSION_DAMPING, k.BENDING_DAMPING)
        turning = np.zeros((6, 6))
        turning[0, 1], turning[1, 0] = -speed, speed
        self.system.AddObject(
            items.ObjectConnectorRigidBodySpringDamper(
                markerNumbers=markers, useIntrinsicFormulation=True,
                stiffness=stiffness - damping @ turning, damping=damping,
            )
        )  # fmt: skip

    def touch(self) -> None:
        contact = items.ObjectConnectorCoordinateVector(
            markerNumbers=[self.mark_coordinates("cam"), self.mark_coordinates("follower")],
            scalingMarker0=np.zeros((1, 6)), scalingMarker1=np.zeros((1, 6)),
            constraintUserFunction=find_gap, jacobianUserFunction=differ_gap,
        )  # fmt: skip
        self.sense(CONTACT, self.system.AddObject(contact), "Force")

    def hang_spring(self) -> None:
        """K (1) to (3); the follower's spring has the preload where it rests on the base circle."""
        head = (0.0, k.BASE + SPRING, k.SHAFT_LENGTH)
        chain = [*(self.bodies[name] for name in BODIES[2:]), self.ground]
        for lower, upper, rate in zip(chain, chain[1:], (k.END, k.MIDDLE, k.END), strict=False):
            ends = [(lower, CENTRE), (upper, head if upper == self.ground else CENTRE)]
            self.add_spring(ends, rate, k.PROPORTION * rate, SPRING / 3.0 + k.PRELOAD / rate)


def spread(axial: float, torsion: float, bending: Any) -> Any:
    """Of shift and turn of a shaft along z (6, 6): a slope in y turns against x, one in x about y."""
    matrix = np.diag([0.0, 0.0, axial, 0.0, 0.0, torsion])
    for across, about, sign in ((0, 4, 1.0), (1, 3, -1.0)):
        matrix[across, across], matrix[about, about] = bending[0][0], bending[1][1]
        matrix[across, about] = matrix[about, across] = sign * bending[0][1]
    return matrix


def build_ours(speed: float, flexible: bool) -> Mechanism:
    """The train, beginning at rest under the preload; the shaft is bent as it turns."""
    camshaft, valve = Layout(CamshaftParameters).defaults(), Layout(ValveSpringParameters).defaults()
    camshaft.flexible = float(flexible)
    states = k.Train(speed, flexible, lubricated=False).start()
    begin = dict(zip(k.STATES, states, strict=True))
    bent = {
        name: begin[f"camshaft.{name}"] for name in ("bending", "slope", "bending_across", "slope_across")
    }
    start = TrainStart(position=begin["camshaft.bending"], coil_positions=(0.0, 0.0), **bent)
    return direct_train(camshaft, valve, speed, start=start)


@pytest.mark.long
@pytest.mark.parametrize(
    ("speed_rpm", "flexible", "step"),
    [
        (1000.0, False, 4e-5),
        pytest.param(1000.0, True, 1e-5, marks=pytest.mark.long),
        pytest.param(3000.0, True, 5e-6, marks=pytest.mark.long),
    ],
)
def test_exudyn_finds_ks_loads_torques_and_lift(
    speed_rpm: float, flexible: bool, step: float, record: Callable[..., None]
) -> None:
    """A turn from rest under the preload, the elastic shaft bent as it turns."""
    speed = speed_rpm * math.pi / 30.0
    mechanism = build_ours(speed, flexible)
    begin = mechanism.start()
    built = Built(speed, flexible, begin.q.reshape(-1, 6), begin.v.reshape(-1, 6))
    times, theirs = built.solve(60.0 / speed_rpm, step)
    ours = solve_ida(mechanism, times, 1e-9, begin)
    lift = ours.position("follower")[:, 1] - k.BASE
    found = {
        "load": (theirs[CONTACT][:, 0], ours.load(CONTACT)),
        "drive torque": (-theirs[DRIVE][:, 0], ours.multiplier(DRIVE)[:, 0]),
        "guide moment": (theirs["guide of follower"][:, 2], ours.reaction(GUIDE).moment[:, 2]),
        "lift": (theirs["follower"][:, 1] - k.BASE, lift),
    }
    shaft = "flexible" if flexible else "rigid"
    for name, (other, own) in found.items():
        error = np.sqrt(np.mean((other - own)[2:] ** 2)) / np.max(np.abs(own))
        quantity = f"{name} on a {shaft} shaft at {speed_rpm:g} r/min against Exudyn, RMS error over largest"
        record("Multibody", quantity, error, 0.0, SOURCE, tolerance=TOLERANCES[name])


SPEED_RPM = 1600.0
OMEGA = SPEED_RPM * math.pi / 30.0
PUSHROD_STEP = 1e-5
ALONG_Y = [0, 1, 0, 0, 0, 0]
SMALL = [1e-5] * 3  # moments of inertia of parts that do not turn (kg m^2)


def geared_parts() -> PushrodTrain:
    """With arms that fall, so that the lever ratio changes; the pushrod is rigid."""
    parts = pushrod_parts(segments=0)
    parts.rocker.small_motion, parts.rocker.rod_angle, parts.rocker.valve_angle = 0.0, 0.1, 0.15
    return parts


class BuiltPushrodTrain(ExudynSystem):
    """The train in Exudyn."""

    def __init__(self, parts: PushrodTrain) -> None:
        super().__init__()
        rocker, spring = parts.rocker, parts.valve
        rod_mass = parts.rod.density * parts.rod.area * parts.rod.length
        # The pivot is the origin; at rest the arms fall from its line against the motion of their ends.
        rod_end = np.array([-rocker.rod_arm * math.cos(0.1), -rocker.rod_arm * math.sin(0.1), 0.0])
        pad = np.array([rocker.valve_arm * math.cos(0.15), rocker.valve_arm * math.sin(0.15), 0.0])
        tappet = self.add_body(parts.tappet.mass, SMALL, rod_end - [0.0, 0.3, 0.0])
        rod = self.add_body(rod_mass, SMALL, rod_end - [0.0, 0.1, 0.0])
        lever = self.add_body(0.2, [float(rocker.inertia)] * 3, [0.0, 0.0, 0.0])
        valve = self.add_body(spring.valve_mass, SMALL, pad)
        self.hold(
            CAM, self.ground, tappet, rod_end - [0.0, 0.3, 0.0], [1] * 6, offsetUserFunction=lift_of_cam
        )
        self.hold("seat", tappet, rod, rod_end - [0.0, 0.2, 0.0], [1] * 6)
        self.hold(PIVOT, self.ground, lever, np.zeros(3), [1, 1, 1, 1, 1, 0])
        self.hold(ROD_END, rod, lever, rod_end, ALONG_Y)
        self.hold("guide", self.ground, valve, pad, FREE_Y)
        self.hold(TIP, valve, lever, pad, ALONG_Y)
        self.hang_spring(valve, pad, spring)
        self.sense_body("valve", valve, "Displacement")

    def hold(self, name: str, i: Any, j: Any, place: Any, axes: list[int], **options: Any) -> None:
        """A joint at a place of the ground, with a sensor of its force."""
        markers = [self.mark(body, place - self.place_of(body)) for body in (i, j)]
        self.sense(name, self.join(markers, axes, **options), "ForceLocal")

    def place_of(self, body: Any) -> Any:
        if body == self.ground:
            return np.zeros(3)
        kind = exudyn.OutputVariableType.Position
        reference = exudyn.ConfigurationType.Reference
        return np.array(self.system.GetObjectOutputBody(body, kind, [0, 0, 0], reference))

    def hang_spring(self, valve: Any, place: Any, spring: Any) -> None:
        """K (1) to (3): two masses on springs of 8/3, 4 and 8/3 k0, below the valve."""
        k0, surge = float(spring.spring_rate), math.pi * float(spring.surge_frequency)
        loss = float(spring.damping_ratio) / surge
        coils = []
        for i in (1, 2):
            at = place - [0.0, i * SPRING / 3.0, 0.0]
            coil = self.add_body(2.0 / 3.0 * k0 / surge**2, SMALL, at)
            self.hold(f"coil {i}", self.ground, coil, at, FREE_Y)
            coils.append(coil)
        chain = [valve, *coils, self.ground]
        for lower, upper, share in zip(chain, chain[1:], (8.0 / 3.0, 4.0, 8.0 / 3.0), strict=False):
            head = place - [0.0, SPRING, 0.0] if upper == self.ground else CENTRE
            rate = share * k0
            installed = SPRING / 3.0 + float(spring.preload) / rate
            self.add_spring([(lower, CENTRE), (upper, head)], rate, loss * rate, installed)


def lift_of_cam(system: Any, t: float, item: int, parameters: Any) -> list[float]:
    return [0.0, cam(OMEGA * t)[0], 0.0, 0.0, 0.0, 0.0]


@pytest.mark.long
def test_exudyn_finds_the_same_loads_and_motion(record: Callable[..., None]) -> None:
    """A turn from rest at 1600 r/min, the lever ratio changing with the lift.

    Where the cam's third derivative jumps, the multipliers of Exudyn's method ring for some steps. The
    largest of these errors is 2e-3 of the load in steps of 10 us, and half of it in half the steps.
    """
    parts, turn = geared_parts(), 60.0 / SPEED_RPM
    times, theirs = BuiltPushrodTrain(parts).solve(turn, PUSHROD_STEP)
    mechanism = pushrod_train(parts, OMEGA)
    ours = solve_ida(mechanism, times, 1e-8, find_rest(mechanism))
    valve = ours.position("valve")[:, 1]
    found = {
        "lift of the valve": (theirs["valve"][:, 1], valve - valve[0]),
        "load of the cam": (theirs[CAM][:, 1], ours.load(CAM)),
        "load of the valve": (theirs[TIP][:, 1], ours.load(TIP)),
        "force on the pivot": (theirs[PIVOT][:, 1], -ours.reaction(PIVOT).force[:, 1]),
    }
    for name, (other, own) in found.items():
        error = np.sqrt(np.mean((np.abs(other) - np.abs(own))[2:] ** 2)) / np.max(np.abs(own))
        quantity = f"pushrod train: {name}, RMS error over largest"
        record("Multibody", quantity, error, 0.0, SOURCE, tolerance=4e-4)
