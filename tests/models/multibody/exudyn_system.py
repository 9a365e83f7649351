"""A mechanism in Exudyn, a multibody code that is not ours: bodies on joints, with sensors.

Exudyn has its own bodies, joints and connectors, and a generalized-alpha method of index 3.
"""

from typing import Any

import numpy as np
import pytest

exudyn = pytest.importorskip("exudyn", reason="Exudyn, of the extra dev, has no wheel for this platform")
items = pytest.importorskip("exudyn.itemInterface")
bodies = pytest.importorskip("exudyn.rigidBodyUtilities")

CENTRE = (0.0, 0.0, 0.0)


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
