"""Runs of the shipped valve train in adherence form; each is computed when first asked for."""

import math
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from scipy.optimize import brentq

from models.core.quantities import Vector
from models.core.system import System
from models.monolithic import Reference
from models.valve_train.cams.law import law_lift
from models.valve_train.cams.lift import Lift
from models.valve_train.cams.profile import entraining_velocity
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

from ..adherence import solve_adherence

SCENARIO = "valve-train"
AS_PRINTED, NEGATIVE = "kushwaha", "kushwaha_negative"
# Camshaft speeds (r/min). The source names 600 (Fig 8), 1000 (Figs 4, 5) and 3000 (Fig 6).
SPEEDS = (600.0, 1000.0, 2000.0, 3000.0)
KINEMATIC_SPEED = 1000.0
FLEXIBLE_SPEED = 600.0
# The spring's residual vibration decays as exp(-63 t): below 1e-4 of itself after this time.
SETTLING_TIME_S = 0.15
# Intervals per turn in a cycle: 0.1 degrees.
INTERVALS = 3600
# Far below the 1e-4 to which results are stated; the two methods differ by about 1e-4 N.
TOLERANCE = 1e-6
REVERSALS_DEG = (144.0, 168.0, 192.0, 216.0)
NOSE_DEG = 180.0


def read_parameters(system: System, instance: str) -> Any:
    """The parameter record of a component in a system."""
    layout = system.instances[instance].component.parameters
    return layout.view(system.p[system.parameters.of(instance)])


@dataclass(frozen=True)
class Run:
    """What distinguishes a run: cam speed, spring, shaft and film formula."""

    speed_rpm: float = KINEMATIC_SPEED
    massless_spring: bool = False
    flexible: bool = False
    shaft_length_mm: float = 100.0
    film: str = AS_PRINTED
    coil_masses: int = 2

    def system(self) -> System:
        """The shipped scenario with this run's changes."""
        changes = {
            "flywheel.parameters.initial_speed": f"'{self.speed_rpm} rpm'",
            "camshaft.parameters.flexible": str(self.flexible).lower(),
            "camshaft.parameters.shaft_length": f"'{self.shaft_length_mm} mm'",
            "valve_spring.structure.coil_masses": str(self.coil_masses),
            "contact.parameters.film_model": f"'{self.film}'",
        }
        return build_system(load(SCENARIO, [f"components.{name}={value}" for name, value in changes.items()]))


class Cycle:
    """One steady turn of a run, from base circle to base circle."""

    def __init__(self, run: Run) -> None:
        self.run = run
        period = 60.0 / run.speed_rpm
        # Without surge only the film has a memory, of less than a millisecond.
        settling = 0 if run.massless_spring else math.ceil(SETTLING_TIME_S / period)
        self.angle_deg: Vector = np.linspace(0.0, 360.0, INTERVALS + 1)
        self.time: Vector = (settling + self.angle_deg / 360.0) * period
        self.reference: Reference = solve_adherence(
            run.system(), self.time, TOLERANCE, massless_spring=run.massless_spring
        )

    def __getitem__(self, name: str) -> Vector:
        """The output called "instance.variable"."""
        return self.reference[name]

    def at(self, name: str, angle_deg: float) -> float:
        """An output at a cam angle (driven angle, where the shaft is flexible)."""
        return float(np.interp(angle_deg, self.angle_deg, self[name]))

    def between(self, name: str, low_deg: float, high_deg: float) -> Vector:
        """An output over a part of the cycle."""
        inside = (self.angle_deg >= low_deg) & (self.angle_deg <= high_deg)
        return np.asarray(self[name][inside])

    @cached_property
    def load(self) -> Vector:
        return self["contact.load"]

    @cached_property
    def film(self) -> Vector:
        return self["contact.film_thickness"]

    @cached_property
    def squeeze(self) -> Vector:
        return self["contact.squeeze_velocity"]

    def film_at(self, angle_deg: float) -> float:
        return self.at("contact.film_thickness", angle_deg)


class Runs:
    """All runs and what the statements share; each run is computed once, when first asked for."""

    def __init__(self) -> None:
        self.cycle = cache(Cycle)

    def kinematic(self, speed_rpm: float = KINEMATIC_SPEED, film: str = AS_PRINTED) -> Cycle:
        """Rigid camshaft, spring without inertia."""
        return self.cycle(Run(speed_rpm, massless_spring=True, film=film))

    def surge(self, speed_rpm: float, film: str = AS_PRINTED, coil_masses: int = 2) -> Cycle:
        """Rigid camshaft, spring with its coil masses."""
        return self.cycle(Run(speed_rpm, film=film, coil_masses=coil_masses))

    def flexible(self, speed_rpm: float = FLEXIBLE_SPEED, shaft_length_mm: float = 100.0) -> Cycle:
        """Flexible camshaft and surge."""
        return self.cycle(Run(speed_rpm, flexible=True, shaft_length_mm=shaft_length_mm))

    @cached_property
    def system(self) -> System:
        return Run().system()

    def parameters(self, instance: str) -> Any:
        """The parameter record of a component."""
        return read_parameters(self.system, instance)

    def lift(self, angle_deg: float) -> Lift:
        """Lift and its derivatives by the cam angle."""
        return law_lift(math.radians(angle_deg), self.parameters("camshaft"))

    def entraining(self, angle_deg: float, speed_rpm: float = KINEMATIC_SPEED) -> float:
        """Entraining velocity of the rigid cam (m/s)."""
        base = self.parameters("camshaft").base_radius
        return float(entraining_velocity(base, self.lift(angle_deg), speed_rpm * math.pi / 30.0))

    @cached_property
    def reversals_deg(self) -> tuple[float, ...]:
        """Cam angles at which the entraining velocity changes sign."""
        grid = np.linspace(0.05, 360.05, 3601)
        u = [self.entraining(a) for a in grid]
        return tuple(
            float(brentq(self.entraining, grid[i], grid[i + 1], xtol=1e-12))
            for i in range(len(u) - 1)
            if u[i] * u[i + 1] < 0.0
        )
