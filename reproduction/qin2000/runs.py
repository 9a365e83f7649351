"""Steady cycles of the pushrod train, and of valves under gas; each is computed when first asked for."""

from functools import cache

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from models.core.quantities import Vector
from models.core.system import System
from models.monolithic import Reference, solve
from models.monolithic.cycle import Cycle, find_cycle
from orchestrator.plots.style import ACCENT, COUPLED, REFERENCE, create_subplots
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start

from ..publication import Drawing

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


COLOURS = {LOW: COUPLED, RATED: ACCENT, HIGH: REFERENCE}
PANELS = (
    ("valve_spring.position", "Valve lift (mm)", 1e3),
    ("valve_spring.velocity", "Valve velocity (m/s)", 1.0),
    ("valve_spring.acceleration", "Valve acceleration (m/s²)", 1.0),
    ("cam_contact.load", "Load of cam and tappet (N)", 1.0),
    ("valve_contact.load", "Load of rocker and valve (N)", 1.0),
    ("cam_contact.maximum_pressure", "Pressure of cam and tappet (MPa)", 1e-6),
)


def plot_train(runs: Runs) -> Figure:
    title = "Pushrod train at three speeds of the camshaft"
    figure, axes = create_subplots(2, 3, title, (11.0, 5.4), sharex=True)
    for (name, label, scale), ax in zip(PANELS, axes.flat, strict=True):
        for speed, colour in COLOURS.items():
            cycle = runs.cycle(speed)
            degrees = np.linspace(0.0, 360.0, cycle.times.size)
            # Blows after a jump would hide all else.
            if speed != HIGH or name in ("valve_spring.position", "valve_spring.velocity"):
                ax.plot(degrees, scale * cycle[name], color=colour, label=f"{speed:.0f} r/min")
        ax.set_ylabel(label)
    figure.legend(*axes.flat[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    for ax in axes[1]:
        ax.set_xlabel("Cam angle (°)")
    axes.flat[0].set_xlim(0.0, 360.0)
    axes.flat[0].xaxis.set_major_locator(MultipleLocator(90.0))
    return figure


FIGURES = (
    Drawing(
        "qin2000-train.png",
        plot_train,
        "Motion of the valve, loads and stress of the pushrod train; loads of 3000 r/min are left out",
    ),
)
