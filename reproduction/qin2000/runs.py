"""Steady cycles of the pushrod train, and of valves under gas; each is computed when first asked for."""

from functools import cache

import numpy as np

from models.core.quantities import Vector
from models.core.system import System
from models.monolithic import Reference, solve
from models.monolithic.cycle import Cycle, find_cycle
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start

TRAIN, VALVE = "qin2000-train", "exhaust-valve"
# Speeds of the camshaft (r/min): slow, low, near the rated one, and one at which the train jumps.
SLOW, LOW, RATED, HIGH = 200.0, 1000.0, 1600.0, 3000.0
# Head of the valve (mm2); with the least one the gas has no force.
HEAD_AREA, NO_AREA = 706.86, 0.011
# Crank angles at which the cylinder fires: the nose comes 260 deg after it for exhaust, 470 deg for intake.
# The valve is open from 132 deg before the nose to 132 deg after it: for exhaust from 52 deg before the lower
# dead centre to 32 deg after the upper one, for intake from 22 deg before the upper to 62 deg after the lower
# one.
EXHAUST, INTAKE = 100.0, -110.0
SAMPLES = 720


def resting(scenario: str, *changes: str) -> System:
    """A shipped scenario with changes, in equilibrium."""
    loaded = load(scenario, [f"components.{change}" for change in changes])
    return resolve_start(loaded, build_system(loaded))


class Runs:
    """What statements and figure share."""

    def __init__(self) -> None:
        self.cycle = cache(self._find_cycle)
        self.gas = cache(self._solve_gas)

    def _find_cycle(self, speed_rpm: float, segments: int = 4) -> Cycle:
        system = resting(
            TRAIN,
            f"flywheel.parameters.initial_speed='{speed_rpm} rpm'",
            f"pushrod.structure.segments={segments}",
        )
        return find_cycle(system, 60.0 / speed_rpm, ["flywheel.angle"], samples=SAMPLES)

    def _solve_gas(self, fires_deg: float, head_area: float) -> Reference:
        """A turn of the cam of a valve under gas, at 1000 r/min."""
        system = resting(
            VALVE,
            f"gas.parameters.valve_area='{head_area} mm2'",
            f"gas.parameters.firing_angle='{fires_deg} deg'",
        )
        return solve(system, np.linspace(0.0, 60.0 / LOW, 3601), tolerance=1e-8, x0=system.x0)

    def deviate(self, speed_rpm: float) -> Vector:
        """The valve's position less that of the slow train at the same cam angles (m)."""
        name = "valve_spring.position"
        return np.asarray(self.cycle(speed_rpm)[name] - self.cycle(SLOW)[name])
