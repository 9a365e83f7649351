"""The problems on which masters are measured. To add one: a function that makes it, listed below.

Macro steps are the samples' spacing over powers of two, so that every run has values at every sample.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from models.oscillators import exact
from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from models.quantities import Vector
from models.system import System, suggestion

from .. import assembly
from ..errors import MistakeError
from ..scenario_files import load


@dataclass(frozen=True)
class CouplingProblem:
    """A system on its way from t = 0 to `duration` (s), and the outputs that are compared there.

    `truth(times)` gives the outputs (n, outputs) as they are, and their own relative RMS uncertainty (0: but
    for rounding).
    The macro steps (s) are spacing / 2^k for the `halvings` k; held inputs, of order 1, need the
    `held_halvings`.
    """

    name: str
    description: str
    system: System
    duration: float
    spacing: float
    halvings: tuple[int, ...]
    held_halvings: tuple[int, ...]
    outputs: tuple[str, ...]
    truth: Callable[[Vector], tuple[Vector, float]]

    @property
    def times(self) -> Vector:
        """The samples' times; the start is none, for there nothing has been coupled yet."""
        return self.spacing * np.arange(1, round(self.duration / self.spacing) + 1)

    @property
    def ladder(self) -> tuple[float, ...]:
        """The macro steps, the longest first."""
        return tuple(self.spacing / 2**k for k in self.halvings)

    @property
    def held_ladder(self) -> tuple[float, ...]:
        """The same for masters that hold inputs."""
        return tuple(self.spacing / 2**k for k in self.held_halvings)


def problem_named(name: str, duration: float | None = None) -> CouplingProblem:
    """The problem; MistakeError for an unknown name or a duration (s) that is no multiple of the spacing."""
    if name not in PROBLEMS:
        raise MistakeError(f"no problem {name!r}; {suggestion(name, PROBLEMS)}")
    problem = PROBLEMS[name]()
    if duration is None:
        return problem
    samples = duration / problem.spacing
    if not samples >= 1.0 or abs(samples - round(samples)) > 1e-9 * samples:
        raise MistakeError(
            f"--duration {duration:g}: must be a multiple of {problem.spacing:g} s, the time between the "
            f"samples of {name}"
        )
    return replace(problem, duration=duration)


def started(system: System, starts: Mapping[str, Mapping[str, float]]) -> System:
    """The system with other start values of the instances named."""
    return system.with_instances(
        {n: replace(i, start=starts[n]) if n in starts else i for n, i in system.instances.items()}
    )


def at(system: System, x: Vector) -> System:
    """The system with the states x as its start."""
    return started(
        system, {n: i.component.state.named(x[system.state.of(n)]) for n, i in system.instances.items()}
    )


def monolithic(system: System, outputs: tuple[str, ...]) -> Callable[[Vector], tuple[Vector, float]]:
    """The truth by the monolithic reference at its sharpest."""
    from models.monolithic import solve

    def truth(times: Vector) -> tuple[Vector, float]:
        solution = solve(system, times, tolerance=1e-12, t0=0.0)
        uncertainty = max(solution.uncertainty[name].relative_rms for name in outputs)
        return np.column_stack([solution[name] for name in outputs]), uncertainty

    return truth


def valve_train() -> CouplingProblem:
    """The lift at 1000 r/min from a cam angle of 104 degrees: away from the cam's jerk steps at 90 and 178.7
    degrees, where orders would scatter with the place of the jump in a step."""
    from models.monolithic import equilibrium, solve

    system = started(assembly.system_of(load("valve-train")), {"flywheel": {"angle": np.radians(80.0)}})
    system = at(system, equilibrium(system))
    system = at(system, solve(system, np.linspace(0.0, 4e-3, 11), tolerance=1e-12).state[-1])
    outputs = ("contact.load", "contact.film_thickness")
    return CouplingProblem(
        name="valve-train",
        description="8 ms of the lift at 1000 r/min, against the monolithic reference",
        system=system,
        duration=8e-3,
        spacing=64e-6,
        halvings=(1, 2, 3, 4, 5, 6),
        held_halvings=(3, 4, 5, 6, 7, 8),
        outputs=outputs,
        truth=monolithic(system, outputs),
    )


def quarter_car() -> CouplingProblem:
    """Schierz, Arnold and Clauss 2012, against the matrix exponential."""

    def truth(times: Vector) -> tuple[Vector, float]:
        return exact.quarter_car(times), 0.0

    return CouplingProblem(
        name="quarter-car",
        description="4 s after a step of the road, against the exact solution",
        system=assembly.system_of(load("quarter-car")),
        duration=4.0,
        spacing=16e-3,
        halvings=(0, 1, 2, 3, 4, 5, 6),
        held_halvings=(2, 3, 4, 5, 6, 7, 8),
        outputs=("chassis.position", "chassis.velocity", "wheel.position", "wheel.velocity"),
        truth=truth,
    )


def two_masses() -> CouplingProblem:
    """The undamped pair with a force-displacement split, against the matrix exponential."""
    system = assembly.system_of(load("two-masses"))
    first, second = system.instances["first"], system.instances["second"]

    def truth(times: Vector) -> tuple[Vector, float]:
        coupled = CoupledMassParameters(**first.parameters)
        return exact.two_masses(times, coupled, SprungMassParameters(**second.parameters), system.x0), 0.0

    return CouplingProblem(
        name="two-masses",
        description="10 s of the undamped pair, against the exact solution",
        system=system,
        duration=9.984,
        spacing=64e-3,
        halvings=(0, 1, 2, 3, 4, 5, 6),
        held_halvings=(2, 3, 4, 5, 6, 7, 8),
        outputs=("first.position", "first.velocity", "second.position", "second.velocity"),
        truth=truth,
    )


PROBLEMS: dict[str, Callable[[], CouplingProblem]] = {
    "quarter-car": quarter_car,
    "two-masses": two_masses,
    "valve-train": valve_train,
}
