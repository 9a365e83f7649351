"""The film and its temperatures together: Newton's method for the film, then the heat, until both settle.

The film is solved with factors that the temperatures make (see `shear`), the temperatures with the film's
flows (see `heat`). What one leaves of the other shrinks about tenfold from time to time.
"""

import math
from typing import Any

from ...compile.kernel import kernel
from ...core.integrator import copy
from ..asperities import find_separation, pressure_under, real_area_share
from ..fluid import Lubricant
from ..friction import boundary_friction
from .heat import fill_column, solve_column, store
from .mixed import Bodies
from .newton import FilmProblem, FilmSolution, newton
from .reynolds import cell
from .shear import HeatLaws, newtonian, shear_film
from .workspace import Workspace

# The heat alone settles to this share of the highest rise, or of COOL (K).
CLOSED, COOL = 1e-5, 1.0
MOST_TURNS = 20


@kernel
def is_heated(laws: HeatLaws) -> bool:
    """Whether the film has temperatures."""
    return laws.conductivity > 0.0


@kernel
def warm_asperities(h: float, width: float, sliding: float, bodies: Bodies, laws: HeatLaws) -> float:
    """Heat of boundary friction in a node's volume (W/m)."""
    if bodies.roughness == 0.0:
        return 0.0
    pressed = pressure_under(h, bodies.roughness, bodies.asperity_scale).pressure
    share = 0.0
    if laws.traction.boundary_stress > 0.0 and pressed > 0.0:
        share = real_area_share(find_separation(h / bodies.roughness), bodies.roughness_parameter)
    return width * boundary_friction(pressed, share, sliding, laws.traction) * sliding


@kernel
def highest_rise(rise: Any) -> float:
    """The largest rise (K) anywhere; nan where one is not finite."""
    highest = 0.0
    for i in range(rise.shape[0]):
        for r in range(rise.shape[1]):
            if not math.isfinite(rise[i, r]):
                return math.nan
            highest = max(highest, abs(rise[i, r]))
    return highest


@kernel
def warm(
    p: Any, h: Any, problem: FilmProblem, bodies: Bodies, old: Any, laws: HeatLaws, w: Workspace
) -> float:
    """Temperatures after the step under p and h, forth and back along the film; the largest change (K).

    nan where a temperature is not finite.
    """
    n, largest = p.shape[0], 0.0
    for k in range(1, 2 * n - 3):
        i = k if k < n - 1 else 2 * n - 3 - k
        rough = warm_asperities(h[i], problem.scale * cell(w.X, i), problem.drive.sliding, bodies, laws)
        fill_column(i, p, h, problem, old, rough, laws, w.X, w.nodes, w.heat)
        largest = max(largest, solve_column(i, w.heat))
    return largest if math.isfinite(highest_rise(w.heat.rise)) else math.nan


@kernel
def solve_film(
    p: Any, h: Any, approach: float, problem: FilmProblem, bodies: Bodies, fluid: Lubricant, old: Any,
    laws: HeatLaws, w: Workspace,
) -> FilmSolution:  # fmt: skip
    """As `newton`; of a heated film with w.heat.rise, from the heat in w.heat.base."""
    if not is_heated(laws):
        return newton(p, h, approach, problem, bodies, fluid, old, w)
    oil = newtonian(fluid)
    shear_film(w.X, problem.scale, p, h, problem.drive.sliding, fluid, laws, w.heat, w.nodes)
    iterations = 0
    for _ in range(MOST_TURNS):
        found = newton(p, h, approach, problem, bodies, oil, old, w)
        approach, iterations = found.approach, iterations + found.iterations
        if found.error != 0.0:
            break
        changed = warm(p, h, problem, bodies, old, laws, w)
        if not math.isfinite(changed):
            break
        highest = max(COOL, highest_rise(w.heat.rise))
        if changed <= laws.settled * highest:
            # What is left is the order in which columns were solved, and closes the balance of heat.
            for _ in range(MOST_TURNS):
                if changed <= CLOSED * highest:
                    return FilmSolution(approach, 0.0, iterations)
                changed = warm(p, h, problem, bodies, old, laws, w)
            break
        shear_film(w.X, problem.scale, p, h, problem.drive.sliding, fluid, laws, w.heat, w.nodes)
    # A further attempt goes on from what there is.
    if not math.isfinite(highest_rise(w.heat.rise)):
        w.heat.rise[:] = w.heat.start
    return FilmSolution(approach, math.inf, iterations)


@kernel
def begin_heat(
    p: Any, h: Any, scale: float, sliding: float, fluid: Lubricant, laws: HeatLaws, w: Workspace
) -> None:
    """At a step's start: factors of the nodes for its temperatures, which are kept."""
    if is_heated(laws):
        copy(w.heat.pressure_base, p)
        w.heat.start[:] = w.heat.rise
        shear_film(w.X, scale, p, h, sliding, fluid, laws, w.heat, w.nodes)


@kernel
def base_heat(scale: float, mass: Any, laws: HeatLaws, w: Workspace) -> None:
    """The base of a stage that begins with the step: the heat at its start, with the oil there."""
    if is_heated(laws):
        w.heat.rise[:] = w.heat.start
        store(w.X, scale, mass, w.heat.start, 1.0, laws, w.heat.base)


@kernel
def base_heat_after(
    p_start: Any, p: Any, scale: float, mass: Any, part: float, laws: HeatLaws, w: Workspace
) -> None:
    """The base of the last stage of a step, after one at that part of it."""
    share = (1.0 - part) / part
    if is_heated(laws):
        w.heat.middle[:] = w.heat.rise
        copy(w.heat.stress_middle, w.heat.stress)
        store(w.X, scale, mass, w.heat.middle, share, laws, w.heat.base)
        for i in range(p.shape[0]):
            w.heat.pressure_base[i] = p_start[i] + share * (p[i] - p_start[i])


@kernel
def foretell_heat(share: float, w: Workspace) -> None:
    """Temperatures guessed further along the way from the start to the middle."""
    rise, start, middle = w.heat.rise, w.heat.start, w.heat.middle
    for i in range(rise.shape[0]):
        for r in range(rise.shape[1]):
            rise[i, r] = start[i, r] + share * (middle[i, r] - start[i, r])
