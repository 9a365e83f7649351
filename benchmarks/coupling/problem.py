"""Problems on which masters are measured, with their solutions.

Macro steps are the samples' spacing over powers of two, so that every fixed step ends at every sample.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import make_interp_spline

from models.core.difference import difference
from models.core.quantities import Vector
from models.core.system import System
from models.monolithic import solve
from models.oscillators import exact
from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from orchestrator.run.plan import FmuFile
from orchestrator.scenario.files import load
from orchestrator.scenario.system import Builder, build_system

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


# Relative difference up to which times are the same.
ROUNDING = 1e-9


@dataclass(frozen=True)
class Row:
    """One run. `setting` is the macro step (s), or the tolerance of a run with step control.

    `errors`: RMS error of each output, relative to the true output's spread; empty where the run failed, and
    `note` says why. `calls` counts doStep of all instances, also those that were taken back.
    """

    method: str
    setting: float
    calls: int = 0
    errors: Mapping[str, float] = field(default_factory=dict)
    note: str = ""

    @property
    def error(self) -> float:
        """The largest error; NaN where the run failed."""
        return max(self.errors.values(), default=np.nan)


def compute_errors(problem: CouplingProblem, times: Vector, values: Vector) -> dict[str, float]:
    """Relative RMS errors of the outputs (n, outputs) at `times`, which end with the problem's duration.

    Errors at other times than the samples' are interpolated to these, so that all runs have equal weights.
    """
    truth = problem.truth(problem.times)
    if len(times) == len(problem.times) and np.allclose(times, problem.times, rtol=ROUNDING, atol=0.0):
        error = values - truth
    else:
        # Each time costs a matrix exponential, so only times next to samples are used.
        after = np.minimum(np.searchsorted(times, problem.times * (1.0 - ROUNDING)), len(times) - 1)
        near = np.unique([np.maximum(after - 1, 0), after])
        own = values[near] - problem.truth(times[near])
        error = np.column_stack(
            [np.interp(problem.times, [0.0, *times[near]], [0.0, *column]) for column in own.T]
        )
    return {
        name: difference(truth[:, i] + error[:, i], truth[:, i]).relative_rms
        for i, name in enumerate(problem.outputs)
    }


def build_fmus(problem: CouplingProblem, build: Builder) -> dict[str, FmuFile]:
    """The FMU of every instance."""
    parts = {name: instance.component for name, instance in problem.system.instances.items()}
    return {name: FmuFile(build(c.name, c.structure, "fmu"), "") for name, c in parts.items()}
