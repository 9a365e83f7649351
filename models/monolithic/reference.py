"""The reference: a system solved as one problem by two independent methods.

The methods share nothing but the components' kernels. Their difference is published as the reference's
own uncertainty; coupled runs are compared with the reference only above it.
"""

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ..core.difference import Difference, difference, time_weights
from ..core.evaluation import Evaluation, check_start
from ..core.quantities import Vector
from ..core.system import ModelError, System
from .cvode import Cvode
from .energy import EnergyBalance
from .implicit import ImplicitProblem
from .implicit_methods import Bdf3, ImplicitMethod, Sdirk4, march_implicit
from .march import Method, march
from .problem import Event, Problem, SystemProblem, find_jacobian
from .runge_kutta import RungeKutta

# The integrators' tolerance per step and unit of nominal, over the tolerance that the user asks for: a
# contact load is the small difference of two large positions, and errors of steps add up.
SHARPER = 1e-2
# Below this, rounding and not the tolerance decides.
SHARPEST = 1e-13
# Explicit steps that stability alone may cost before the problem is called stiff (DOP853: 12 rates each).
STIFF_STEPS = 100_000
# Length of DOP853's stability interval on the negative real axis.
STABILITY_INTERVAL = 6.0
# Steps of the implicit one-step method (s): a twentieth of the period of a valve on its contact.
LONGEST_STEP = 8e-6
# The multistep method takes this share of them, for one solution in each to five of the other's.
BDF_SHARE = 0.25
# Steps may be this share of the duration even where closer instants are asked for.
SHORT_SHARE = 1e-2


@dataclass(frozen=True)
class Reference:
    """A system's course in time, solved as one problem. n instants.

    Published are the values of the first method (CVODE); `uncertainty` is its difference from the second
    for every output, by "instance.variable". `supplied` holds sources and all that came in over power
    bonds (which cancels between connected components). `energy` has the same by component.
    """

    system: System
    times: Vector
    state: Vector
    inputs: Vector
    outputs: Vector
    uncertainty: Mapping[str, Difference]
    events: list[Event]
    energy: Mapping[str, EnergyBalance]
    wall_time_s: float
    method_names: tuple[str, str]

    @property
    def stored_energy(self) -> Vector:
        """Energy stored in all components (J), (n,)."""
        return np.asarray(sum(e.stored for e in self.energy.values()))

    @property
    def dissipated(self) -> Vector:
        """Energy dissipated since the first instant (J), (n,)."""
        return np.asarray(sum(e.dissipated for e in self.energy.values()))

    @property
    def supplied(self) -> Vector:
        """Energy given to the system since the first instant (J), (n,)."""
        return np.asarray(sum(e.sourced + e.received for e in self.energy.values()))

    def __getitem__(self, name: str) -> Vector:
        """The output called "instance.variable", (n,)."""
        try:
            return np.asarray(self.outputs[:, self.system.outputs.names.index(name)])
        except ValueError:
            raise KeyError(f"{name!r} is no output of the system") from None


def solve(
    system: System,
    times: Vector,
    tolerance: float = 1e-10,
    x0: Vector | None = None,
    t0: float | None = None,
    progress: Callable[[float], None] | None = None,
    longest_step: float = LONGEST_STEP,
    counts_energies: bool = True,
) -> Reference:
    """Solve `system` at `times` (ascending) from the state `x0` (default: its starts) at `t0` (times[0]).

    Method A is CVODE, method B DOP853, or BDF and Radau for a stiff problem; both locate the events of
    components. `tolerance` is relative to nominal + |value|. Where a component is no ODE they are SDIRK4 and
    BDF3 in steps of at most `longest_step` (s) instead, and `tolerance` has no part. `progress` is called
    with the share done. An ODE that does not count its energies has none, and is solved faster. ModelError
    if a method fails.
    """
    begun = time.perf_counter()
    times = check_times(times, t0)
    if not all(instance.component.ode for instance in system.instances.values()):
        return _solve_implicit(system, times, x0, t0, progress, longest_step, begun)
    problem = SystemProblem(system, counts_energies)
    z0 = problem.start(system.x0 if x0 is None else np.asarray(x0, dtype=np.float64))
    start = float(times[0]) if t0 is None else float(t0)
    check_start(system, start, z0[: system.state.size])
    runs, events, names = solve_twice(problem, z0, start, times, tolerance, progress)
    inputs, outputs = observe(problem.evaluation, times, runs[0])
    others = observe(problem.evaluation, times, runs[1])[1]
    n = system.state.size
    stored = problem.energies.along(times, runs[0], inputs)
    return Reference(
        system=system,
        times=times,
        state=runs[0][:, :n],
        inputs=inputs,
        outputs=outputs,
        uncertainty=uncertainties(system, times, outputs, others),
        events=events,
        energy=problem.energies.balances(stored, runs[0][:, n:], runs[0][:, :n]),
        wall_time_s=time.perf_counter() - begun,
        method_names=names,
    )


def _solve_implicit(
    system: System,
    times: Vector,
    x0: Vector | None,
    t0: float | None,
    progress: Callable[[float], None] | None,
    longest_step: float,
    begun: float,
) -> Reference:
    """As `solve`, of a system in which components are no ODE."""
    if not longest_step > 0.0:
        raise ModelError(f"longest_step = {longest_step:g} s: must be > 0")
    problem = ImplicitProblem(system)
    x = system.x0 if x0 is None else np.asarray(x0, dtype=np.float64)
    if x.shape != (system.state.size,):
        raise ModelError(f"start state of {x.size} elements: the system has {system.state.size} states")
    start = float(times[0]) if t0 is None else float(t0)
    check_start(system, start, x)
    methods: tuple[ImplicitMethod, ImplicitMethod] = Sdirk4(problem), Bdf3(problem)
    lengths = longest_step, BDF_SHARE * longest_step
    courses = [
        march_implicit(problem, method, x, start, times, longest, progress and half(progress, i))
        for i, (method, longest) in enumerate(zip(methods, lengths, strict=True))
    ]
    first, second = courses
    return Reference(
        system=system,
        times=times,
        state=first.state,
        inputs=first.inputs,
        outputs=first.outputs,
        uncertainty=uncertainties(system, times, first.outputs, second.outputs),
        events=[],
        energy=problem.energies.balances(first.stored, first.energies, first.state),
        wall_time_s=time.perf_counter() - begun,
        method_names=(
            f"{methods[0].name}, steps of {lengths[0]:g} s",
            f"{methods[1].name}, steps of {lengths[1]:g} s",
        ),
    )


def check_times(times: Vector, t0: float | None) -> Vector:
    """`times` as a vector; ModelError unless it ascends from t0."""
    times = np.atleast_1d(np.asarray(times, dtype=np.float64))
    if times.ndim != 1 or times.size == 0 or not np.all(np.isfinite(times)) or np.any(np.diff(times) <= 0.0):
        raise ModelError("times: must be a vector of ascending finite instants")
    if t0 is not None and t0 > times[0]:
        raise ModelError(f"t0 = {t0:g} s: must not be behind the first instant {times[0]:g} s")
    return times


def solve_twice(
    problem: Problem,
    z0: Vector,
    t0: float,
    times: Vector,
    tolerance: float,
    progress: Callable[[float], None] | None = None,
) -> tuple[tuple[Vector, Vector], list[Event], tuple[str, str]]:
    """States by both methods, each (n, size), the first one's events, and the methods' names."""
    if not 0.0 < tolerance < 1.0:
        raise ModelError(f"tolerance = {tolerance:g}: must be > 0 and < 1")
    stiff, longest = stiffness(problem, t0, z0, times)
    sharp = max(SHARPER * tolerance, SHARPEST)
    runs, events, names = [], [], []
    methods: tuple[Method, Method] = (
        Cvode(problem, sharp, stiff, longest),
        RungeKutta(problem, sharp, stiff, longest),
    )
    for i, method in enumerate(methods):
        share = None if progress is None else half(progress, i)
        states, found = march(problem, method, z0, t0, times, share)
        runs.append(states)
        events.append(found)
        names.append(method.name)
    return (runs[0], runs[1]), events[0], (names[0], names[1])


def half(progress: Callable[[float], None], i: int) -> Callable[[float], None]:
    """The progress of the first (i = 0) or second (i = 1) of two equal parts."""
    return lambda share: progress(0.5 * (i + share))


def stiffness(problem: Problem, t0: float, z: Vector, times: Vector) -> tuple[bool, float]:
    """Whether the problem is stiff, and the longest step that a method may take (s).

    Stiff: stability would cost an explicit method more than STIFF_STEPS steps, judged by the largest
    eigenvalue of the Jacobian (by differences) at the start. The limit, of an explicit method the one that
    stability sets as soon as anything moves, keeps a method from leaping from rest over a whole lift.
    """
    jacobian = find_jacobian(lambda state: problem.rate(t0, state), z, problem.nominal)
    if not np.all(np.isfinite(jacobian)):
        raise ModelError(f"the system's rates are not finite at its start, t = {t0:g} s: check start values")
    fastest = float(np.max(np.abs(np.linalg.eigvals(jacobian)), initial=0.0))
    duration = float(times[-1]) - t0
    stiff = fastest * duration > STIFF_STEPS * STABILITY_INTERVAL
    longest = max(float(np.max(np.diff(times, prepend=t0))), duration * SHORT_SHARE)
    if not stiff and fastest > 0.0:
        longest = min(longest, STABILITY_INTERVAL / fastest)
    return stiff, longest if longest > 0.0 else math.inf


def observe(evaluation: Evaluation, times: Vector, states: Vector) -> tuple[Vector, Vector]:
    """Inputs (n, n_in) and outputs (n, n_out) along a solution."""
    inputs, outputs = evaluation.along(times, states)
    if not np.all(np.isfinite(outputs)):
        row, column = np.argwhere(~np.isfinite(outputs))[0]
        name = evaluation.system.outputs.names[column]
        raise ModelError(f"{name} is not finite at t = {times[row]:g} s: check parameters and start values")
    return inputs, outputs


def uncertainties(system: System, times: Vector, outputs: Vector, others: Vector) -> dict[str, Difference]:
    """The difference of two solutions at `times` for every output, by name."""
    weights = time_weights(times)
    return {
        name: difference(others[:, i], outputs[:, i], float(system.outputs.nominal[i]), weights)
        for i, name in enumerate(system.outputs.names)
    }
