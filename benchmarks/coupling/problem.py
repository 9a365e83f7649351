"""Problems on which masters are measured, with their solutions.

Macro steps are the samples' spacing over powers of two, so that every fixed step ends at every sample.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_interp_spline

from models.core.quantities import Vector
from models.core.system import System
from models.monolithic import solve
from models.oscillators import exact
from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

Truth = Callable[[Vector], Vector]


@dataclass(frozen=True)
class CouplingProblem:
    """A system that starts at t = 0, and the outputs to compare at the samples' `times` (s).

    `truth(times)` gives the outputs (n, outputs) as they are at any times up to the last sample. The macro
    steps are `spacing` / 2^k for the `halvings` k; held inputs, of order 1, need the `held_halvings`.
    """

    name: str
    system: System
    times: Vector
    outputs: tuple[str, ...]
    truth: Truth
    halvings: tuple[int, ...] = (0, 1, 2, 3, 4)
    held_halvings: tuple[int, ...] = (2, 3, 4, 5, 6)

    @property
    def spacing(self) -> float:
        """Time from one sample to the next (s)."""
        return float(self.times[0])

    @property
    def duration(self) -> float:
        """The last sample's time (s)."""
        return float(self.times[-1])

    @property
    def ladder(self) -> tuple[float, ...]:
        """The macro steps (s), the longest first."""
        return tuple(self.spacing / 2**k for k in self.halvings)

    @property
    def held_ladder(self) -> tuple[float, ...]:
        """The macro steps (s) of masters that hold inputs."""
        return tuple(self.spacing / 2**k for k in self.held_halvings)


@dataclass(frozen=True)
class Kind:
    """A scenario with settings, sampled `samples` times, `spacing` (s) apart; `outputs` are the states."""

    scenario: str
    settings: tuple[str, ...]
    samples: int
    spacing: float
    outputs: tuple[str, ...]

    @property
    def stop(self) -> float:
        """The last sample's time (s)."""
        return self.samples * self.spacing


CAR = ("chassis.position", "chassis.velocity", "wheel.position", "wheel.velocity")
MASSES = ("first.position", "first.velocity", "second.position", "second.velocity")
# Two masses of one between walls, on springs of 4 pi^2 N/m and with one of 16 pi^2 N/m between them:
# Schueller, Rodenberg, Uekermann and Bungartz 2022, the oscillator of preCICE's tutorials, in our split.
PRECICE = (
    f"components.first.parameters={{mass=1.0, stiffness={4.0 * np.pi**2!r}, damping=0.0, "
    f"coupling_stiffness={16.0 * np.pi**2!r}, coupling_damping=0.0}}",
    f"components.second.parameters={{mass=1.0, stiffness={4.0 * np.pi**2!r}, damping=0.0}}",
)
# The mass-spring-damper of INTO-CPS's Maestro: two damped masses, of which one gives its force to the other.
# The values are ours: ones.
MAESTRO = (
    "components.first.parameters={mass=1.0, stiffness=1.0, damping=1.0, coupling_stiffness=1.0, "
    "coupling_damping=1.0}",
    "components.second.parameters={mass=1.0, stiffness=1.0, damping=1.0}",
)
PROBLEMS = {
    "quarter-car": Kind("quarter-car", (), 30, 16e-3, CAR),
    "precice-oscillator": Kind("two-masses", PRECICE, 30, 16e-3, MASSES),
    "mass-spring-damper": Kind("two-masses", MAESTRO, 25, 128e-3, MASSES),
}


def build_problem(name: str, samples: int | None = None) -> CouplingProblem:
    """The problem, against its matrix exponential."""
    kind = PROBLEMS[name]
    system = build_system(load(kind.scenario, list(kind.settings)))
    # The start is no sample, because nothing has been coupled yet.
    times: Vector = kind.spacing * np.arange(1.0, (samples or kind.samples) + 1.0)
    truth: Truth = exact.quarter_car
    if kind.outputs == MASSES:
        coupled = CoupledMassParameters(**system.instances["first"].parameters)
        sprung = SprungMassParameters(**system.instances["second"].parameters)

        def truth(at: Vector) -> Vector:
            return exact.two_masses(at, coupled, sprung, system.x0)

    return CouplingProblem(name, system, times, kind.outputs, truth)


# Instants for each sample at which the reference is solved, with a spline of fifth degree through them: at a
# microsecond it is wrong by 1e-11 of an oscillation at the contact's 6.7 kHz.
FINER = 64


def solve_reference(system: System, outputs: tuple[str, ...], times: Vector) -> Truth:
    """The monolithic reference from 0 to times[-1]."""
    fine = np.linspace(0.0, times[-1], FINER * len(times) + 1)
    solution = solve(system, fine, tolerance=1e-12)
    spline: Truth = make_interp_spline(fine, np.column_stack([solution[o] for o in outputs]), k=5)
    return spline
