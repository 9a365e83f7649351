"""The film in time: a singly diagonally implicit Runge-Kutta method of order 2, with error control.

SDIRK2 (Alexander 1977): gamma = 1 - 1/sqrt(2), stages at gamma and 1, L-stable; both solve the same kind of
implicit step, and it needs nothing from before the step, so that a saved state is pressure, film and grid.
Cavitated nodes need no rate of their own: the first stage's rate of mass is a difference of masses.

The error is estimated with the rate at the start as third, quadrature of order 3, and filtered through the
Jacobian (Shampine), as a change of load and film.

The grid's scale follows the contact, a^2 = b^2 + 2 R h with Hertz's half width b, linearly within a step.
"""

import math
from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ...core.integrator import copy
from ..asperities import pressure_under
from ..fluid import Lubricant
from ..hertz import deflection, find_load, half_width, maximum_pressure
from .cavities import drain_at_the_end, fill_partly, fill_share, keeps_oil, settle
from .heated import (
    base_heat,
    base_heat_after,
    begin_heat,
    foretell_heat,
    foretell_heat_after,
    is_heated,
    solve_film,
)
from .hierarchical import BAND, Jacobian
from .mixed import FREE, Bodies, fill_total, film_of, is_balanced_side, mean_plane_gap
from .newton import (
    FilmProblem,
    FilmSolution,
    deflection_factors,
    forget_factors,
    integrate_pressure,
    solve,
)
from .reynolds import Flow, balance, cell, properties
from .shear import HeatLaws
from .workspace import Workspace

GAMMA = 1.0 - math.sqrt(0.5)
# Weights of the rates at 0, gamma and 1 that integrate squares exactly, less those of the method.
_MIDDLE = 1.0 / (6.0 * GAMMA * (1.0 - GAMMA))
_ERROR_MIDDLE = _MIDDLE - (1.0 - GAMMA)
_ERROR_END = 0.5 - _MIDDLE * GAMMA - GAMMA
_ERROR_START = -_ERROR_MIDDLE - _ERROR_END
# Time in which the grid's scale follows the contact's width (s): some periods of what happens in it.
GRID_TIME = 1e-4
# The grid's scale changes by no more than this factor in a step.
GRID_FACTOR = 1.25
# Loads below this count as this one in the relative error (N): a fiftieth of those that matter here.
LOAD_FLOOR = 10.0


class Drives(NamedTuple):
    """The drive at an instant: flow, approach (m) and load per length (N/m; negative: approach given)."""

    flow: Flow
    approach: float
    line_load: float


class FilmStep(NamedTuple):
    """approach (m) and grid scale (m) after the step; error over the tolerance (nan or inf: failed). At
    GAMMA of the step the approach was `middle_approach`, pressure and film w.p_middle and w.h_middle."""

    approach: float
    scale: float
    error: float
    middle_approach: float


@kernel
def wanted_scale(line_load: float, film: float, radius: float, bodies: Bodies) -> float:
    """sqrt(b^2 + 2 R h): the width of the flattening, or of the wedge where the film is thicker."""
    b = half_width(max(line_load, 0.0) * bodies.length, radius, bodies.length, bodies.compliance)
    return math.sqrt(b**2 + 2.0 * radius * max(film, 0.0))


@kernel
def aimed_scale(scale: float, line_load: float, film: float, radius: float, bodies: Bodies) -> float:
    """The wanted scale, not further away from the grid's than GRID_FACTOR."""
    wanted = wanted_scale(line_load, film, radius, bodies)
    return min(max(wanted, scale / GRID_FACTOR), scale * GRID_FACTOR)


@kernel
def grid_scale_after(
    time_step: float, scale: float, line_load: float, film: float, radius: float, bodies: Bodies
) -> float:
    """The scale after a step: it follows the wanted one within GRID_TIME, by GRID_FACTOR at most.

    Of second order with line load (N/m), central film (m) and radius (m) of the step's middle.
    """
    wanted = aimed_scale(scale, line_load, film, radius, bodies)
    return wanted + (scale - wanted) * math.exp(-time_step / GRID_TIME)


@kernel
def central(h: Any) -> float:
    """The film at x = 0 (the number of nodes is odd)."""
    return h[h.shape[0] // 2]


@kernel
def least_between(before: float, first: float, second: float, after: float) -> float:
    """The smallest value from first to second of the cubic with the slopes of both neighbours' parabolas."""
    slope, end = 0.5 * (second - before), 0.5 * (after - first)
    bend = 3.0 * (second - first) - 2.0 * slope - end
    turn = bend**2 + 3.0 * (2.0 * (second - first) - slope - end) * slope
    lowest = min(first, second)
    if turn >= 0.0 and bend + math.sqrt(turn) > 0.0:
        # Where the cubic's slope rises through zero, in steps from first.
        s = -slope / (bend + math.sqrt(turn))
        if 0.0 < s < 1.0:
            cubic = slope + end - 2.0 * (second - first)
            lowest = min(lowest, first + s * (slope + s * (bend + s * cubic)))
    return lowest


@kernel
def least(h: Any) -> float:
    """The smallest film, between nodes too: continuous, as it moves from node to node.

    By its logarithm: curves through films themselves would pass below zero where a steep flank is near.
    """
    n = h.shape[0]
    i = 0
    for j in range(n):
        if h[j] < h[i]:
            i = j
    if i < 2 or i > n - 3:
        return h[i]
    a, b, c = math.log(h[i - 2]), math.log(h[i - 1]), math.log(h[i])
    d, e = math.log(h[i + 1]), math.log(h[i + 2])
    return math.exp(min(least_between(a, b, c, d), least_between(b, c, d, e)))


@kernel
def highest(p: Any) -> float:
    """The largest pressure, as `least`."""
    n = p.shape[0]
    i = 0
    for j in range(n):
        if p[j] > p[i]:
            i = j
    if i < 2 or i > n - 3:
        return p[i]
    return -min(
        least_between(-p[i - 2], -p[i - 1], -p[i], -p[i + 1]),
        least_between(-p[i - 1], -p[i], -p[i + 1], -p[i + 2]),
    )


@kernel
def place_film(
    load: float, gap: float, radius: float, bodies: Bodies, X: Any, scale: float, p: Any, h: Any
) -> None:
    """Hertz's pressure under `load` (N) over a gap (of the mean planes, m) of that size, p what asperities
    leave of it: a start that needs no solution."""
    b = half_width(load, radius, bodies.length, bodies.compliance)
    p0 = maximum_pressure(load, radius, bodies.length, bodies.compliance)
    for i in range(p.shape[0]):
        x = abs(scale * X[i])
        if x < b:
            p[i] = p0 * math.sqrt(1.0 - (x / b) ** 2)
            h[i] = gap
        elif b > 0.0:
            s = x / b
            root = math.sqrt(s * s - 1.0)
            p[i] = 0.0
            h[i] = gap + b * b / (2.0 * radius) * (s * root - math.log(s + root))
        else:
            p[i] = 0.0
            h[i] = gap + x * x / (2.0 * radius)
        if bodies.roughness > 0.0:
            h[i] = film_of(h[i], bodies.roughness)
            p[i] = max(p[i] - pressure_under(h[i], bodies.roughness, bodies.asperity_scale).pressure, 0.0)


@kernel
def foretold(p: float, slope: float, time_step: float) -> float:
    """A guess of a pressure after a time; a node that cavitates is taken to go on doing so."""
    return max(p + slope * time_step, 0.0) if p > 0.0 else 0.0


@kernel
def masses(scale: float, w: Workspace, out: Any) -> None:
    """rho h times the volumes (m^2), of the film that `properties` saw last."""
    n = out.shape[0]
    out[0] = 0.0
    out[n - 1] = 0.0
    for i in range(1, n - 1):
        out[i] = w.nodes.mass[i] * scale * cell(w.X, i)


@kernel
def second_base(start: float, middle: float) -> float:
    """What the second stage's implicit step begins from."""
    return start + (1.0 - GAMMA) / GAMMA * (middle - start)


@kernel
def estimate(
    p: Any, h: Any, scale: float, time_step: float, given: bool, bodies: Bodies, w: Workspace
) -> float:  # fmt: skip
    """Error of load (if the approach is given) or central film, relative, by the factors of the end."""
    masses(scale, w, w.estimate)
    for i in range(p.shape[0]):
        first = (w.mass_middle[i] - w.mass_start[i]) / GAMMA
        last = (w.estimate[i] - second_base(w.mass_start[i], w.mass_middle[i])) / GAMMA
        wet = is_balanced_side(w.mixed.sides[i]) and w.p_start[i] > 0.0
        at_start = -w.rate_start[i] * time_step if wet else first
        w.estimate[i] = _ERROR_START * at_start + _ERROR_MIDDLE * first + _ERROR_END * last
    return error_of(p, h, scale, GAMMA * time_step, given, bodies, w)


@kernel
def error_of(
    p: Any, h: Any, scale: float, interval: float, given: bool, bodies: Bodies, w: Workspace
) -> float:
    """What the errors of mass in w.estimate (m^2) make of the load (if the approach is given) or of the
    central film, relative; `interval` (s): that of the implicit step whose factors are in w."""
    n = p.shape[0]
    factor, offset = deflection_factors(scale, bodies)
    for i in range(n):
        w.solution[0, i], w.solution[1, i] = 0.0, 0.0
        if is_balanced_side(w.mixed.sides[i]):
            w.solution[0, i] = w.estimate[i] / interval
        if w.mixed.sides[i] != FREE:
            for k in range(BAND):
                w.solution[1, i] += w.B[k, i]
    change = solve(w, Jacobian(w.A, w.B, w.D, w.weight, factor, offset), scale, 0.0, given)
    load, film, i = 0.0, 0.0, n // 2
    for j in range(n):
        load += w.weight[j] * w.solution[0, j]
        film += factor * (w.D[j, i] + offset * w.weight[j]) * w.solution[0, j]
    floor = LOAD_FLOOR / bodies.length
    rough = bodies.roughness > 0.0
    of_load = abs(load * scale) / (integrate_pressure(w.mixed.total if rough else p, w.weight, scale) + floor)
    of_film = abs(film - change) / h[i]
    return max(of_load, w.mixed.opening[i] * of_film if rough else of_film)


@kernel
def solve_robustly(
    p: Any, h: Any, approach: float, problem: FilmProblem, bodies: Bodies, fluid: Lubricant, old: Any,
    laws: HeatLaws, w: Workspace,
) -> FilmSolution:  # fmt: skip
    """Newton's method from the guess p; after a jump, where that fails, from the pressure at the step's
    start, then from Hertz's of the bodies with the film between them."""
    found = solve_film(p, h, approach, problem, bodies, fluid, old, laws, w)
    for attempt in range(2):
        if found.error == 0.0:
            break
        forget_factors(w)
        if attempt == 0:
            copy(p, w.p_start)
            copy(w.mixed.total, w.mixed.total_start)
        else:
            gap, radius = mean_plane_gap(central(w.h_start), bodies.roughness), problem.drive.radius
            load = problem.line_load * bodies.length
            if load < 0.0:
                load = find_load(approach + gap, radius, bodies.length, bodies.compliance)
            else:
                approach = deflection(load, radius, bodies.length, bodies.compliance) - gap
            place_film(load, gap, radius, bodies, w.X, problem.scale, p, h)
            fill_total(p, h, bodies, w.mixed.total)
        found = solve_film(p, h, approach, problem, bodies, fluid, old, laws, w)
    return found


@kernel
def end_filling(p: Any, h: Any, scale: float, interval: float, drive: Flow, w: Workspace) -> None:
    """w.filling at the end of an implicit step of that `interval` (s)."""
    masses(scale, w, w.estimate)
    settle(w.estimate, interval, w.residual)
    fill_share(w.estimate, p, h, w.X, scale, drive, w.nodes.rho, w.filling)


@kernel
def predict_approach(start: float, middle: float) -> float:
    """A guess of the approach (m) at a step's end, from its start and its first stage."""
    return start + (middle - start) / GAMMA


@kernel
def step(
    p: Any, h: Any, slope: Any, scale: float, new_scale: float, time_step: float, start: Drives,
    middle: Drives, end: Drives, tolerance: float, bodies: Bodies, fluid: Lubricant, laws: HeatLaws,
    w: Workspace,
) -> FilmStep:  # fmt: skip
    """p and h at the step's start become those at its end; `slope` (Pa/s) predicts the total pressure
    and is renewed.

    Unless the error is at most 1 they must not be used (the start is in w.p_start, w.h_start, w.slope_start).
    Where cavities keep their oil, w.filling likewise.
    `start`, `middle`, `end`: Drives at 0, GAMMA and 1 of the step; their approach is the guess where the
    load is given.
    """
    n = p.shape[0]
    rate = (new_scale - scale) / time_step
    half_scale = scale + GAMMA * (new_scale - scale)
    for i in range(n):
        w.p_start[i], w.h_start[i], w.slope_start[i] = p[i], h[i], slope[i]
    conserving = keeps_oil(start.flow)
    w.nodes.share[:] = 1.0
    begin_heat(p, h, w.filling, scale, start.flow, fluid, laws, w)
    properties(p, h, fluid, w.nodes)
    if conserving:
        fill_partly(p, w.filling, w.nodes)
    masses(scale, w, w.mass_start)
    base_heat(scale, w.mass_start, laws, w)
    foretell_heat(GAMMA * time_step, w)
    # The rate at the start is what flows in.
    balance(
        w.X, scale, rate, p, h, w.nodes, start.flow, fluid, w.mass_start, math.inf, w.rate_start, w.A, w.B
    )
    forget_factors(w)
    q, q_start = (w.mixed.total, w.mixed.total_start) if bodies.roughness > 0.0 else (p, w.p_start)
    fill_total(p, h, bodies, q_start)
    for i in range(n):
        q[i] = foretold(q_start[i], slope[i], GAMMA * time_step)
        if q_start[i] == p[i]:
            p[i] = q[i]
    problem = FilmProblem(half_scale, rate, middle.flow, middle.line_load, GAMMA * time_step)
    found = solve_robustly(p, h, middle.approach, problem, bodies, fluid, w.mass_start, laws, w)
    if found.error != 0.0:
        return FilmStep(found.approach, half_scale, math.inf, found.approach)
    masses(half_scale, w, w.mass_middle)
    if conserving:
        settle(w.mass_middle, GAMMA * time_step, w.residual)
        fill_share(w.mass_middle, p, h, w.X, half_scale, middle.flow, w.nodes.rho, w.filling_middle)
    copy(w.p_middle, p)
    copy(w.h_middle, h)
    middle_approach = found.approach
    for i in range(n):
        w.base[i] = second_base(w.mass_start[i], w.mass_middle[i])
    if conserving:
        drain_at_the_end(p, (1.0 - GAMMA) * time_step, 1.0 / GAMMA, w.base, w.nodes.share, w.nodes.through)
    for i in range(n):
        if w.base[i] < 0.0:
            # The film shrinks too much within the step: cavities would balance less than nothing.
            return FilmStep(found.approach, half_scale, math.inf, found.approach)
    base_heat_after(w.p_start, p, half_scale, w.mass_middle, GAMMA, time_step, laws, w)
    foretell_heat_after(1.0 / GAMMA, w)
    # The second stage begins where the first leads to. Pressures of a heated film are foretold by their rates
    # at a step's end, others by the mean ones, with which cavities keep their oil to rounding.
    hot = is_heated(laws)
    for i in range(n):
        alone = p[i] == q[i]
        slope[i] = second_base(q_start[i], q[i]) if hot else q_start[i]
        q[i] = foretold(q[i], (q[i] - q_start[i]) / GAMMA, 1.0 - GAMMA)
        if alone:
            p[i] = q[i]
    given = end.line_load < 0.0
    guess = end.approach if given else predict_approach(start.approach, found.approach)
    problem = FilmProblem(new_scale, rate, end.flow, end.line_load, GAMMA * time_step)
    found = solve_robustly(p, h, guess, problem, bodies, fluid, w.base, laws, w)
    if found.error != 0.0:
        return FilmStep(found.approach, new_scale, math.inf, middle_approach)
    if conserving:
        end_filling(p, h, new_scale, GAMMA * time_step, end.flow, w)
        w.nodes.share[:] = 1.0
    for i in range(n):
        slope[i] = (q[i] - slope[i]) / (GAMMA * time_step if hot else time_step)
    error = estimate(p, h, new_scale, time_step, given, bodies, w)
    return FilmStep(found.approach, new_scale, error / tolerance, middle_approach)
