"""The problems on which masters are measured. To add one, write a function that builds it and list it below.

Macro steps are the samples' spacing over powers of two, so that every fixed step ends at every sample.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import make_interp_spline

from models.core.quantities import Vector
from models.core.system import System, suggestion
from models.oscillators import exact
from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters

from ...errors import MistakeError
from ...scenario.files import load
from ...scenario.system import build_system

Truth = Callable[[Vector], Vector]


@dataclass(frozen=True)
class CouplingProblem:
    """A system that starts at t = 0, and the outputs to compare at the samples' `times` (s).

    `truth(times)` gives the outputs (n, outputs) as they are at any times up to the last sample;
    `uncertainty` is its relative RMS (0: rounding). The macro steps are `spacing` / 2^k for the `halvings`
    k; held inputs, of order 1, need the `held_halvings`.
    """

    name: str
    description: str
    system: System
    times: Vector
    halvings: tuple[int, ...]
    held_halvings: tuple[int, ...]
    outputs: tuple[str, ...]
    truth: Truth
    uncertainty: float = 0.0

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
    """Builds a problem; by default it has `samples` samples, `spacing` (s) apart."""

    build: Callable[[Vector], CouplingProblem]
    samples: int
    spacing: float


def build_problem(name: str, duration: float | None = None) -> CouplingProblem:
    """The problem; MistakeError for an unknown name or a duration (s) that is no multiple of the spacing."""
    if name not in PROBLEMS:
        raise MistakeError(f"no problem {name!r}; {suggestion(name, PROBLEMS)}")
    kind = PROBLEMS[name]
    samples = kind.samples if duration is None else duration / kind.spacing
    if not samples > 0.5 or abs(samples - round(samples)) > 1e-9 * samples:
        raise MistakeError(
            f"--duration {duration:g}: must be a multiple of {kind.spacing:g} s, the time between the "
            f"samples of {name}"
        )
    # The start is no sample, because nothing has been coupled yet.
    times: Vector = kind.spacing * np.arange(1.0, round(samples) + 1.0)
    return kind.build(times)


def build_quarter_car(times: Vector) -> CouplingProblem:
    """Schierz, Arnold and Clauss 2012: a step of the road, against the matrix exponential."""
    return CouplingProblem(
        name="quarter-car",
        description="after a step of the road, against the exact solution",
        system=build_system(load("quarter-car")),
        times=times,
        halvings=(0, 1, 2, 3, 4, 5, 6),
        held_halvings=(2, 3, 4, 5, 6, 7, 8),
        outputs=("chassis.position", "chassis.velocity", "wheel.position", "wheel.velocity"),
        truth=exact.quarter_car,
    )


def build_two_masses(times: Vector) -> CouplingProblem:
    """The undamped pair with a force-displacement split, against the matrix exponential."""
    return build_masses("two-masses", "an undamped pair, against the exact solution", [], times)


# Two masses of one between walls, on springs of 4 pi^2 N/m and with one of 16 pi^2 N/m between them:
# Schueller, Rodenberg, Uekermann and Bungartz 2022, the oscillator of preCICE's tutorials, in our split.
PRECICE = [
    f"components.first.parameters={{mass=1.0, stiffness={4.0 * np.pi**2!r}, damping=0.0, "
    f"coupling_stiffness={16.0 * np.pi**2!r}, coupling_damping=0.0}}",
    f"components.second.parameters={{mass=1.0, stiffness={4.0 * np.pi**2!r}, damping=0.0}}",
]
# The mass-spring-damper of INTO-CPS's Maestro: two damped masses, of which one gives its force to the other.
# The values are ours: ones.
MAESTRO = [
    "components.first.parameters={mass=1.0, stiffness=1.0, damping=1.0, coupling_stiffness=1.0, "
    "coupling_damping=1.0}",
    "components.second.parameters={mass=1.0, stiffness=1.0, damping=1.0}",
]


def build_precice(times: Vector) -> CouplingProblem:
    """The oscillator of preCICE's tutorials, against the matrix exponential."""
    said = "preCICE's oscillator, against the exact solution"
    return build_masses("precice-oscillator", said, PRECICE, times)


def build_maestro(times: Vector) -> CouplingProblem:
    """Maestro's mass-spring-damper, against the matrix exponential."""
    said = "Maestro's mass-spring-damper, against the exact solution"
    return build_masses("mass-spring-damper", said, MAESTRO, times)


def build_masses(name: str, description: str, settings: list[str], times: Vector) -> CouplingProblem:
    """The scenario two-masses with these settings."""
    system = build_system(load("two-masses", settings))
    coupled = CoupledMassParameters(**system.instances["first"].parameters)
    sprung = SprungMassParameters(**system.instances["second"].parameters)
    return CouplingProblem(
        name=name,
        description=description,
        system=system,
        times=times,
        halvings=(0, 1, 2, 3, 4, 5, 6),
        held_halvings=(2, 3, 4, 5, 6, 7, 8),
        outputs=("first.position", "first.velocity", "second.position", "second.velocity"),
        truth=lambda at: exact.two_masses(at, coupled, sprung, system.x0),
    )


def build_valve_train(times: Vector) -> CouplingProblem:
    """The lift at 1000 r/min from a cam angle of 104 degrees: away from the cam's jerk steps at 90 and 178.7
    degrees, where orders would scatter with the place of the jump in a step."""
    from models.monolithic import equilibrium, solve

    system = _set_starts(build_system(load("valve-train")), {"flywheel": {"angle": np.radians(80.0)}})
    system = _start_at(system, equilibrium(system))
    system = _start_at(system, solve(system, np.linspace(0.0, 4e-3, 11), tolerance=1e-12).state[-1])
    outputs = ("contact.load", "contact.film_thickness")
    truth, uncertainty = solve_reference(system, outputs, times)
    return CouplingProblem(
        name="valve-train",
        description="the lift at 1000 r/min, against the monolithic reference",
        system=system,
        times=times,
        halvings=(1, 2, 3, 4, 5, 6),
        held_halvings=(3, 4, 5, 6, 7, 8),
        outputs=outputs,
        truth=truth,
        uncertainty=uncertainty,
    )


def _set_starts(system: System, starts: Mapping[str, Mapping[str, float]]) -> System:
    return system.with_instances(
        {n: replace(i, start=starts[n]) if n in starts else i for n, i in system.instances.items()}
    )


def _start_at(system: System, x: Vector) -> System:
    """The system with the states x as its start."""
    return _set_starts(
        system, {n: i.component.state.named(x[system.state.of(n)]) for n, i in system.instances.items()}
    )


# Instants for each sample at which the reference is solved, with a spline of fifth degree through them: at a
# microsecond it is wrong by 1e-11 of an oscillation at the contact's 6.7 kHz.
FINER = 64


def solve_reference(system: System, outputs: tuple[str, ...], times: Vector) -> tuple[Truth, float]:
    """The monolithic reference from 0 to times[-1], and its uncertainty."""
    from models.monolithic import solve

    fine = np.linspace(0.0, times[-1], FINER * len(times) + 1)
    solution = solve(system, fine, tolerance=1e-12)
    values = np.column_stack([solution[name] for name in outputs])
    return make_interp_spline(fine, values, k=5), max(solution.uncertainty[o].relative_rms for o in outputs)


PROBLEMS: dict[str, Kind] = {
    "quarter-car": Kind(build_quarter_car, 250, 16e-3),
    "two-masses": Kind(build_two_masses, 156, 64e-3),
    "precice-oscillator": Kind(build_precice, 125, 16e-3),
    "mass-spring-damper": Kind(build_maestro, 100, 128e-3),
    "valve-train": Kind(build_valve_train, 125, 64e-6),
}
