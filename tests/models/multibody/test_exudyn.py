"""Q's single train built in Exudyn, a multibody code that is not ours: loads, motion and reactions.

Exudyn has Euler parameters, its own joints and a generalized-alpha method of index 3.
"""

from __future__ import annotations

import math
from collections.abc import Callable
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

SOURCE = "Exudyn"
SPEED_RPM = 1600.0
OMEGA = SPEED_RPM * math.pi / 30.0
STEP = 1e-5
FREE_Y = [1, 0, 1, 1, 1, 1]
ALONG_Y = [0, 1, 0, 0, 0, 0]
SPRING = 0.04  # installed length (m)


def geared_parts() -> PushrodTrain:
    """With arms that fall, so that the lever ratio changes; the pushrod is rigid."""
    parts = pushrod_parts(segments=0)
    parts.rocker.small_motion, parts.rocker.rod_angle, parts.rocker.valve_angle = 0.0, 0.1, 0.15
    return parts


class Built:
    """The train in Exudyn: bodies on joints, with sensors of forces and places."""

    def __init__(self, parts: PushrodTrain) -> None:
        self.system = exudyn.SystemContainer().AddSystem()
        self.ground = self.system.CreateGround()
        self.sensors: dict[str, int] = {}
        rocker, spring = parts.rocker, parts.valve
        rod_mass = parts.rod.density * parts.rod.area * parts.rod.length
        # The pivot is the origin; at rest the arms fall from its line against the motion of their ends.
        rod_end = np.array([-rocker.rod_arm * math.cos(0.1), -rocker.rod_arm * math.sin(0.1), 0.0])
        pad = np.array([rocker.valve_arm * math.cos(0.15), rocker.valve_arm * math.sin(0.15), 0.0])
        tappet = self.add_body(parts.tappet.mass, rod_end - [0.0, 0.3, 0.0])
        rod = self.add_body(rod_mass, rod_end - [0.0, 0.1, 0.0])
        lever = self.add_body(0.2, [0.0, 0.0, 0.0], rocker.inertia)
        valve = self.add_body(spring.valve_mass, pad)
        self.join(CAM, self.ground, tappet, rod_end - [0.0, 0.3, 0.0], [1] * 6, lift_of_cam)
        self.join("seat", tappet, rod, rod_end - [0.0, 0.2, 0.0], [1] * 6)
        self.join(PIVOT, self.ground, lever, [0.0, 0.0, 0.0], [1, 1, 1, 1, 1, 0])
        self.join(ROD_END, rod, lever, rod_end, ALONG_Y)
        self.join("guide", self.ground, valve, pad, FREE_Y)
        self.join(TIP, valve, lever, pad, ALONG_Y)
        self.hang_spring(valve, pad, spring)
        kind = exudyn.OutputVariableType.Displacement
        self.sensors["valve"] = self.system.AddSensor(
            items.SensorBody(bodyNumber=valve, outputVariableType=kind, storeInternal=True)
        )

    def add_body(self, mass: float, place: Any, inertia: float = 1e-5) -> Any:
        own = bodies.RigidBodyInertia(mass=float(mass), inertiaTensor=float(inertia) * np.eye(3))
        return self.system.CreateRigidBody(referencePosition=list(place), inertia=own)

    def join(self, name: str, i: Any, j: Any, place: Any, axes: list[int], offset: Any = 0) -> None:
        """A joint that holds these axes of i: x, y, z and the turns about them."""
        markers = []
        for body in (i, j):
            at = np.zeros(3) if body == self.ground else self.place_of(body)
            marker = items.MarkerBodyRigid(bodyNumber=body, localPosition=list(place - at))
            markers.append(self.system.AddMarker(marker))
        joint = self.system.AddObject(
            items.ObjectJointGeneric(markerNumbers=markers, constrainedAxes=axes, offsetUserFunction=offset)
        )
        kind = exudyn.OutputVariableType.ForceLocal
        self.sensors[name] = self.system.AddSensor(
            items.SensorObject(objectNumber=joint, outputVariableType=kind, storeInternal=True)
        )

    def place_of(self, body: Any) -> Any:
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
            coil = self.add_body(2.0 / 3.0 * k0 / surge**2, at)
            self.join(f"coil {i}", self.ground, coil, at, FREE_Y)
            coils.append(coil)
        chain = [valve, *coils, self.ground]
        for lower, upper, share in zip(chain, chain[1:], (8.0 / 3.0, 4.0, 8.0 / 3.0), strict=False):
            head = list(place - [0.0, SPRING, 0.0]) if upper == self.ground else [0.0, 0.0, 0.0]
            ends = [(lower, [0.0, 0.0, 0.0]), (upper, head)]
            markers = [
                self.system.AddMarker(items.MarkerBodyPosition(bodyNumber=body, localPosition=at))
                for body, at in ends
            ]
            self.system.AddObject(
                items.ObjectConnectorSpringDamper(
                    markerNumbers=markers, stiffness=share * k0, damping=loss * share * k0,
                    referenceLength=SPRING / 3.0 + float(spring.preload) / (share * k0),
                )
            )  # fmt: skip

    def solve(self, duration: float) -> dict[str, Any]:
        """Times and the y of all sensors."""
        self.system.Assemble()
        settings = exudyn.SimulationSettings()
        settings.timeIntegration.numberOfSteps = round(duration / STEP)
        settings.timeIntegration.endTime = duration
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.8
        settings.timeIntegration.newton.relativeTolerance = 1e-10
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = STEP
        self.system.SolveDynamic(settings)
        found = {name: self.system.GetSensorStoredData(sensor) for name, sensor in self.sensors.items()}
        return {"time": found[CAM][:, 0], **{name: data[:, 2] for name, data in found.items()}}


def lift_of_cam(system: Any, t: float, item: int, parameters: Any) -> list[float]:
    return [0.0, cam(OMEGA * t)[0], 0.0, 0.0, 0.0, 0.0]


def test_exudyn_finds_the_same_loads_and_motion(record: Callable[..., None]) -> None:
    """A turn from rest at 1600 r/min, the lever ratio changing with the lift.

    Where the cam's third derivative jumps, the multipliers of Exudyn's method ring for some steps. The
    largest of these errors is 2e-3 of the load in steps of 10 us, and half of it in half the steps.
    """
    parts, turn = geared_parts(), 60.0 / SPEED_RPM
    theirs = Built(parts).solve(turn)
    mechanism = pushrod_train(parts, OMEGA)
    ours = solve_ida(mechanism, theirs["time"], 1e-8, find_rest(mechanism))
    valve = ours.position("valve")[:, 1]
    found = {
        "lift of the valve": (theirs["valve"], valve - valve[0]),
        "load of the cam": (theirs[CAM], ours.load(CAM)),
        "load of the valve": (theirs[TIP], ours.load(TIP)),
        "force on the pivot": (theirs[PIVOT], -ours.reaction(PIVOT).force[:, 1]),
    }
    for name, (other, own) in found.items():
        error = np.sqrt(np.mean((np.abs(other) - np.abs(own))[2:] ** 2)) / np.max(np.abs(own))
        record(
            "Multibody", f"pushrod train: {name}, RMS error over largest", error, 0.0, SOURCE, tolerance=4e-4
        )
