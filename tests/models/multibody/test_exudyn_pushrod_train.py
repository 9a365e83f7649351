"""A pushrod train built in Exudyn, which has its own bodies, joints and method, without `models`."""

import math
from typing import Any

import numpy as np
import pytest

from models.multibody.ida import solve_ida
from models.multibody.linear import find_rest
from models.multibody.pushrod_train import CAM, PIVOT, ROD_END, TIP, PushrodTrain, pushrod_train

from ..independent_train import cam
from .trains import pushrod_parts

exudyn = pytest.importorskip("exudyn", reason="Exudyn, of the extra dev, has no wheel for this platform")
items = pytest.importorskip("exudyn.itemInterface")
bodies = pytest.importorskip("exudyn.rigidBodyUtilities")

CENTRE = (0.0, 0.0, 0.0)
SOURCE = "Exudyn"
# Of loads and lift, RMS over the largest value. The multipliers of Exudyn's method ring where the cam's third
# derivative jumps, half as much in half the steps.
TOLERANCE = 4e-4
FREE_Y = [1, 0, 1, 1, 1, 1]
SPRING = 0.04  # installed length (m)
SPEED_RPM = 1600.0
OMEGA = SPEED_RPM * math.pi / 30.0
PUSHROD_STEP = 1e-5
ALONG_Y = [0, 1, 0, 0, 0, 0]
SMALL = [1e-5] * 3  # moments of inertia of parts that do not turn (kg m^2)


class ExudynSystem:
    """Bodies and joints under names; `solve` gives what the sensors have read."""

    def __init__(self) -> None:
        self.system = exudyn.SystemContainer().AddSystem()
        self.ground = self.system.CreateGround()
        self.sensors: dict[str, int] = {}

    def add_body(self, mass: float, inertia: Any, place: Any, **options: Any) -> Any:
        """A body with the principal moments of inertia (kg m^2) at a place (m)."""
        own = bodies.RigidBodyInertia(mass=float(mass), inertiaTensor=np.diag(np.asarray(inertia, float)))
        return self.system.CreateRigidBody(referencePosition=list(place), inertia=own, **options)

    def mark(self, body: Any, at: Any = CENTRE) -> Any:
        """A marker at a point of a body, in its axes."""
        return self.system.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=list(at)))

    def join(self, markers: list[Any], axes: list[int], **options: Any) -> Any:
        """A joint that holds these axes of the first marker: x, y, z and the turns about them."""
        return self.system.AddObject(
            items.ObjectJointGeneric(markerNumbers=markers, constrainedAxes=axes, **options)
        )

    def add_spring(
        self, ends: list[tuple[Any, Any]], stiffness: float, damping: float, length: float
    ) -> None:
        """A spring and damper between a point of each of two bodies; `length` without force (m)."""
        self.system.AddObject(
            items.ObjectConnectorSpringDamper(
                markerNumbers=[self.mark(body, at) for body, at in ends],
                stiffness=stiffness, damping=damping, referenceLength=length,
            )
        )  # fmt: skip

    def sense(self, name: str, item: Any, kind: str) -> None:
        """Record an output of a joint or connector."""
        self._add_sensor(name, items.SensorObject, objectNumber=item, outputVariableType=kind)

    def sense_body(self, name: str, body: Any, kind: str) -> None:
        """Record an output of a body."""
        self._add_sensor(name, items.SensorBody, bodyNumber=body, outputVariableType=kind)

    def _add_sensor(self, name: str, sensor: Any, outputVariableType: str, **on: Any) -> None:
        kind = getattr(exudyn.OutputVariableType, outputVariableType)
        self.sensors[name] = self.system.AddSensor(sensor(outputVariableType=kind, storeInternal=True, **on))

    def solve(self, duration: float, step: float) -> tuple[Any, dict[str, Any]]:
        """Times (s), and of every sensor its readings, one row for each."""
        self.system.Assemble()
        settings = exudyn.SimulationSettings()
        settings.timeIntegration.numberOfSteps = round(duration / step)
        settings.timeIntegration.endTime = duration
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.8
        settings.timeIntegration.newton.relativeTolerance = 1e-10
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = step
        self.system.SolveDynamic(settings)
        found = {name: self.system.GetSensorStoredData(sensor) for name, sensor in self.sensors.items()}
        times = next(iter(found.values()))[:, 0]
        return times, {name: data[:, 1:] for name, data in found.items()}


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
def test_exudyn_finds_the_same_loads_and_motion(record):
    """A turn from rest at 1600 r/min, the lever ratio changing with the lift.

    Where the multipliers ring, the largest error is 2e-3 of the load in steps of 10 us.
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
        record("Multibody", quantity, error, 0.0, SOURCE, tolerance=TOLERANCE)
