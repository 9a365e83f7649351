"""The film and its temperatures together: Newton's method for the film, then the heat, until both settle.

The film is solved with factors that the temperatures make (see `shear`), the temperatures with the film's
flows (see `heat`), along the film and back. Where entrainment reverses, oil is carried by the drift that its
temperatures make: there the film is solved with what its pressures make of that drift (`foresee_drift`).
"""

import math
from typing import Any

from ...compile.kernel import kernel
from ...core.integrator import copy, copy_rows
from ..asperities import find_separation, pressure_under, real_area_share
from ..fluid import Lubricant
from ..friction import boundary_friction
from .cavities import find_filled, keeps_oil
from .heat import COOL, build_bodies, build_columns, settle_heat, store, warm
from .mixed import Bodies
from .newton import TOLERANCE, FilmProblem, FilmSolution, begin_newton, newton
from .reynolds import Flow, cell
from .shear import SOLID_LAYERS, Heat, HeatLaws, flow_film, shear_film, thin_film
from .workspace import Workspace

# The heat alone settles to this share of the highest rise.
CLOSED = 1e-5
MOST_TURNS = 20
# Pressures of a turn are found to this share of the last change of temperatures, of which the first is taken
# to be FIRST, or of that to which they settle.
NEAR, FIRST = 0.1, 0.03
# Changes of so many times that may be the last but for what is foreseen.
FORESEEN = 5.0


@kernel
def is_heated(laws: HeatLaws) -> bool:
    """Whether the film has temperatures."""
    return laws.conductivity > 0.0


@kernel
def warm_asperities(
    h: Any, scale: float, sliding: float, bodies: Bodies, laws: HeatLaws, w: Workspace
) -> None:
    """Heat of boundary friction in the nodes' volumes (W/m)."""
    w.heat.rough[:] = 0.0
    last = h.shape[0] - 1 if bodies.roughness > 0.0 else 1
    for i in range(1, last):
        pressed = pressure_under(h[i], bodies.roughness, bodies.asperity_scale).pressure
        share = 0.0
        if laws.traction.boundary_stress > 0.0 and pressed > 0.0:
            share = real_area_share(find_separation(h[i] / bodies.roughness), bodies.roughness_parameter)
        rubbed = boundary_friction(pressed, share, sliding, laws.traction) * sliding
        w.heat.rough[i] = scale * cell(w.X, i) * rubbed


@kernel
def find_change(heat: Heat) -> float:
    """The largest change from the guess over the highest rise; nan where a temperature is not finite."""
    largest, highest, total = 0.0, COOL, 0.0
    for i in range(heat.flat.shape[0]):
        largest, highest = max(largest, abs(heat.flat[i] - heat.guess[i])), max(highest, abs(heat.flat[i]))
        total += heat.flat[i]
    return largest / highest if math.isfinite(total) else math.nan


@kernel
def is_settled(changed: float, before: float, settled: float) -> bool:
    """Whether all further turns, which change temperatures less and less by the rate of the last two, would
    change them by no more than `settled`."""
    slow = changed >= before or changed > FORESEEN * settled
    return changed <= settled or (not slow and changed**2 <= settled * (before - changed))


@kernel
def close(heat: Heat) -> bool:
    """`warm` until what is left, the order in which columns are solved, closes the balance of heat; the last
    time was back."""
    step = 1
    for _ in range(2 * MOST_TURNS):
        copy(heat.guess, heat.flat)
        warm(heat, step)
        if find_change(heat) <= CLOSED:
            settle_heat(heat)
            return True
        step = -step
    return False


@kernel
def solve_film(
    p: Any, h: Any, approach: float, problem: FilmProblem, bodies: Bodies, fluid: Lubricant, old: Any,
    laws: HeatLaws, w: Workspace,
) -> FilmSolution:  # fmt: skip
    """As `newton`; of a heated film with w.heat.rise, from the heat in w.heat.base."""
    begin_newton(p, h, approach, problem, bodies, w)
    if not is_heated(laws):
        return newton(p, h, approach, problem, bodies, fluid, old, w, TOLERANCE)
    sliding, heat = problem.drive.sliding, w.heat
    iterations, finite, before = 0, True, math.inf
    build_bodies(problem, laws, w.X, w.nodes, heat)
    for _ in range(MOST_TURNS):
        thin_film(fluid, laws, heat, w.nodes)
        flow_film(w.X, problem.scale, p, h, sliding, fluid, heat, w.nodes)
        near = NEAR * max(min(before, FIRST), laws.settled)
        found = newton(p, h, approach, problem, bodies, fluid, old, w, near)
        approach, iterations = found.approach, iterations + found.iterations
        if found.error != 0.0:
            break
        warm_asperities(h, problem.scale, sliding, bodies, laws, w)
        shear_film(w.X, problem.scale, p, h, sliding, fluid, laws, heat, w.nodes)
        build_columns(p, h, problem, old, laws, w.X, w.nodes, heat)
        copy(heat.guess, heat.flat)
        warm(heat, 1)
        warm(heat, -1)
        changed = find_change(heat)
        if not math.isfinite(changed):
            break
        if is_settled(changed, before, laws.settled):
            if close(heat):
                return FilmSolution(approach, 0.0, iterations)
            break
        before = changed
    # A further attempt goes on from what there is.
    for i in range(heat.flat.shape[0]):
        finite = finite and math.isfinite(heat.flat[i])
    if not finite:
        copy_rows(heat.rise, heat.start)
    return FilmSolution(approach, math.inf, iterations)


@kernel
def begin_heat(
    p: Any, h: Any, filling: Any, scale: float, drive: Flow, fluid: Lubricant, laws: HeatLaws, w: Workspace
) -> None:
    """At a step's start: factors of the nodes for its temperatures, which are kept."""
    if is_heated(laws):
        if keeps_oil(drive):
            find_filled(p, filling, w.nodes)
        copy(w.heat.pressure_base, p)
        copy_rows(w.heat.start, w.heat.rise)
        w.nodes.drift_p[:], w.nodes.drift_left[:], w.nodes.drift_right[:] = 0.0, 0.0, 0.0
        thin_film(fluid, laws, w.heat, w.nodes)
        flow_film(w.X, scale, p, h, drive.sliding, fluid, w.heat, w.nodes)


@kernel
def base_heat(scale: float, mass: Any, laws: HeatLaws, w: Workspace) -> None:
    """The base of a stage that begins with the step: the heat at its start, with the oil there."""
    if is_heated(laws):
        copy_rows(w.heat.rise, w.heat.start)
        store(w.X, scale, mass, w.heat.start, 1.0, laws, w.heat.base)


@kernel
def drain_heat(first_part: float, laws: HeatLaws, w: Workspace) -> None:
    """The heat that `drain_at_the_end` puts back with the oil."""
    layers = w.heat.speed.shape[1]
    for face in range(w.X.shape[0] - 1):
        if w.nodes.share[face] == 1.0:
            continue
        moved = first_part * w.nodes.through[face]
        source = face if moved > 0.0 else face + 1
        for k in range(SOLID_LAYERS, SOLID_LAYERS + layers):
            heat = laws.capacity / layers * moved * w.heat.middle[source, k]
            w.heat.base[face, k] += heat
            w.heat.base[face + 1, k] -= heat


@kernel
def base_heat_after(
    p_start: Any, p: Any, scale: float, mass: Any, part: float, interval: float, laws: HeatLaws, w: Workspace
) -> None:
    """The base of the last stage of a step of that `interval` (s), after one at that part of it."""
    share = (1.0 - part) / part
    if is_heated(laws):
        copy_rows(w.heat.middle, w.heat.rise)
        copy(w.heat.stress_middle, w.heat.stress)
        store(w.X, scale, mass, w.heat.middle, share, laws, w.heat.base)
        drain_heat((1.0 - part) * interval, laws, w)
        for i in range(p.shape[0]):
            w.heat.pressure_base[i] = p_start[i] + share * (p[i] - p_start[i])


@kernel
def foretell_heat(later: float, w: Workspace) -> None:
    """Temperatures guessed `later` (s) than the start by their rates there."""
    for i in range(w.heat.flat.shape[0]):
        w.heat.flat[i] += later * w.heat.slope[i]


@kernel
def foretell_heat_after(share: float, w: Workspace) -> None:
    """Temperatures guessed further along the way from the start to the middle; in w.heat.slope those from
    which the last stage begins."""
    rise, start, middle = w.heat.rise, w.heat.start, w.heat.middle
    rows = rise.shape[1]
    for i in range(rise.shape[0]):
        for r in range(rows):
            way = middle[i, r] - start[i, r]
            rise[i, r] = start[i, r] + share * way
            w.heat.slope[i * rows + r] = rise[i, r] - way
