"""One quick solution of a whole system, by method A of the reference alone.

It has no estimate of its error: it is no reference.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ..core.evaluation import check_start
from ..core.quantities import Vector
from ..core.system import System
from .cvode import Cvode
from .march import march
from .problem import SystemProblem
from .reference import check_times, observe, stiffness


@dataclass(frozen=True)
class Trajectory:
    """Inputs and outputs of all instances at `times`; the rows are instants.

    `states` of those that are ODEs, by name; `rates` of the outputs, where they are known.
    """

    times: Vector
    states: Mapping[str, Vector]
    inputs: Vector
    outputs: Vector
    rates: Vector | None = None


def compute_trajectory(
    system: System, times: Vector, tolerance: float, progress: Callable[[float], None] | None = None
) -> Trajectory:
    """Solve `system` from its starts, at times[0], by CVODE alone; ModelError if that fails.

    `tolerance` is the integrator's, per step and relative to nominal + |value|.
    """
    times = check_times(times, None)
    problem = SystemProblem(system, counts_energies=False)
    z0 = problem.start(system.x0)
    start = float(times[0])
    check_start(system, start, system.x0)
    stiff, longest = stiffness(problem, start, z0, times)
    states, _ = march(problem, Cvode(problem, tolerance, stiff, longest), z0, start, times, progress)
    inputs, outputs = observe(problem.evaluation, times, states)
    by_name = {name: np.asarray(states[:, system.state.of(name)]) for name in system.instances}
    return Trajectory(times, by_name, inputs, outputs)
