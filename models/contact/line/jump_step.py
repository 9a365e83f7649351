"""A micro-step over a jump of what drives the film, by the implicit Euler method.

A load, approach or radius that jumps moves the bodies in no time; no oil flows meanwhile, gaps that open
cavitate, and what pressure is left is that of bodies pressed on the oil that there was. One implicit step
from before to after the jump finds that, in the limit of no time exactly. SDIRK2 does not: from where its
first stage is it goes on at the rate that led there, so that a gap which sprang open would open 2.4 times as
far, and the oil to close it again is not there.
"""

import math
from typing import Any

from ...compile.kernel import kernel
from ...core.integrator import copy
from ..fluid import Lubricant
from .cavities import keeps_oil
from .heated import base_heat
from .mixed import Bodies
from .newton import FilmProblem, forget_factors
from .shear import HeatLaws
from .transient import Drives, FilmStep, end_filling, error_of, masses, solve_robustly
from .workspace import Workspace


@kernel
def jump_step(
    p: Any, h: Any, slope: Any, scale: float, new_scale: float, time_step: float, end: Drives,
    tolerance: float, bodies: Bodies, fluid: Lubricant, laws: HeatLaws, w: Workspace,
) -> FilmStep:  # fmt: skip
    """As `step`, which has been tried before from the same start. No pressure is foretold after it.

    The error is that of first order in what goes on steadily; it vanishes with the step, the jump has none.
    """
    copy(p, w.p_start)
    copy(h, w.h_start)
    copy(w.mixed.total, w.mixed.total_start)
    base_heat(scale, w.mass_start, laws, w)
    copy(w.heat.pressure_base, w.p_start)
    forget_factors(w)
    w.nodes.share[:] = 1.0
    problem = FilmProblem(new_scale, (new_scale - scale) / time_step, end.flow, end.line_load, time_step)
    found = solve_robustly(p, h, end.approach, problem, bodies, fluid, w.mass_start, laws, w)
    if found.error != 0.0:
        return FilmStep(found.approach, new_scale, math.inf, found.approach)
    if keeps_oil(end.flow):
        end_filling(p, h, new_scale, time_step, end.flow, w)
    masses(new_scale, w, w.estimate)
    for i in range(p.shape[0]):
        slope[i] = 0.0
        at_start = -w.rate_start[i] * time_step
        w.estimate[i] = 0.5 * (w.estimate[i] - w.mass_start[i] - at_start) if w.p_start[i] > 0.0 else 0.0
    error = error_of(p, h, new_scale, time_step, end.line_load < 0.0, bodies, w)
    return FilmStep(found.approach, new_scale, error / tolerance, found.approach)
