"""One implicit step of the film: pressure, film and, where the load is given, the approach of the bodies.

Newton's method on the balance of `reynolds` with the complementarity p >= 0 by active sets: a node whose
pressure falls below zero cavitates, a cavitated node whose balance says that oil piles up gets pressure
again; where cavities keep their oil (see `cavities`), one whose gap does not hold it. As that is seen only
next to the pressurised film, more nodes join when it moves on (1, 2, 4, ...).
Between rough surfaces the unknown is the total pressure (see `mixed`).
The factors of the Jacobian are used until convergence is slow or many nodes have changed sides (see
`woodbury`).
"""

import math
from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ..elimination import add_rows
from ..fluid import Lubricant
from .cavities import Ways, feed_rows, find_ways, hold_layers, keeps_oil, move_layers, room_left, spread
from .hierarchical import BAND, Jacobian
from .mixed import FREE, NEARER, Bodies, couple_asperities, fill_sides, fluid_pressure, is_open, touch
from .reynolds import Flow, balance, cell, properties
from .woodbury import correct_factors, factorise_anew, solve_corrected
from .workspace import Workspace

# Pressures are found to this share of the largest (at least of PRESSURE_FLOOR, Pa): far below what the
# tightest comparison of coupled results asks for, far above rounding.
TOLERANCE = 1e-6
PRESSURE_FLOOR = 1e4
MOST_ITERATIONS = 40
# A balance of this share of the mass over the step is rounding: oil that piles up by that much under an open
# contact at rest would fill and cavitate nodes without end.
ROUNDING = 1e-14
# A solution leaves this share of the mass unbalanced at most: by measurement 3e-6 in smooth motion, 1e20
# where corrections are small only against absurd pressures.
BALANCE = 1e-4
# New factors where an iteration leaves more of the correction than this.
SLOW = 0.5
# An iteration may shrink the film to this share, and so the pressures above HIGH of the largest: steep flanks
# of pressure that move would otherwise leave cavities in the middle of the film that never close.
LEAST_SHARE = 0.2
# Pressures times compliance beyond this are of no elastic body: iterations that run away there may end.
MOST_STRAIN = 1.0
HIGH = 0.05


class FilmProblem(NamedTuple):
    """The step to solve: grid scale (m) and its rate (m/s), drive, load per length (N/m; negative: the
    approach is given) and the time step (s, may be inf)."""

    scale: float
    scale_rate: float
    drive: Flow
    line_load: float
    time_step: float


class FilmSolution(NamedTuple):
    """approach (m), error (0: converged), iterations."""

    approach: float
    error: float
    iterations: int


@kernel
def deflection_factors(scale: float, bodies: Bodies) -> tuple[float, float]:
    """Factor and offset: deflection = factor (D^T + offset 1 weight^T) p."""
    return 2.0 * bodies.compliance * scale / math.pi, math.log(bodies.length / scale)


@kernel
def integrate_pressure(p: Any, weight: Any, scale: float) -> float:
    """Load per length (N/m)."""
    total = 0.0
    for i in range(p.shape[0]):
        total += weight[i] * p[i]
    return total * scale


@kernel
def fill_film(
    p: Any, approach: float, radius: float, scale: float, bodies: Bodies, w: Workspace, h: Any
) -> None:
    """The bodies' gap h = -approach + x^2/(2R) + deflection by the (total) pressure p."""
    factor, offset = deflection_factors(scale, bodies)
    n = p.shape[0]
    level = factor * offset * integrate_pressure(p, w.weight, 1.0)
    first, last = 0, n
    while first < last and p[first] == 0.0:
        first += 1
    while last > first and p[last - 1] == 0.0:
        last -= 1
    for i in range(n):
        h[i] = 0.0
    add_rows(h, p[first:last], w.D, first, 0)
    for i in range(n):
        h[i] = level + factor * h[i] - approach + (scale * w.X[i]) ** 2 / (2.0 * radius)


@kernel
def smallest(h: Any) -> float:
    """The least element; nan where one is not finite."""
    least = h[0]
    for i in range(h.shape[0]):
        if not math.isfinite(h[i]):
            return math.nan
        least = min(least, h[i])
    return least


@kernel
def update_sides(p: Any, fixed: Any, residual: Any, recent: Any, reach: int) -> tuple[int, bool]:
    """Nodes that fell below zero are fixed at it; fixed ones where oil piles up (residual < 0) are freed,
    and with them `reach` more on either side. How many changed sides, and whether the last time too many
    were freed: where such nodes (`recent`) fell, of all that fell only they are fixed.
    """
    n = p.shape[0]
    changed, hasty = 0, False
    for i in range(1, n - 1):
        hasty = hasty or (recent[i] != 0.0 and p[i] < 0.0)
    for i in range(1, n - 1):
        if fixed[i] == 0.0 and p[i] < 0.0 and (recent[i] != 0.0 or not hasty):
            fixed[i] = 2.0
            changed += 1
    for i in range(n):
        recent[i] = 0.0
    for i in range(1, n - 1):
        if fixed[i] == 1.0 and residual[i] < 0.0:
            for j in range(max(i - reach, 1), min(i + reach + 1, n - 1)):
                if fixed[j] == 1.0:
                    recent[j] = 1.0
    for i in range(1, n - 1):
        if recent[i] != 0.0:
            fixed[i] = 0.0
            changed += 1
        elif fixed[i] == 2.0:
            fixed[i] = 1.0
    return changed, hasty


@kernel
def fill_right_side(w: Workspace) -> None:
    """Right sides for `solve`: what is left of the balance, and minus its derivative by the approach."""
    for i in range(w.X.shape[0]):
        w.solution[0, i], w.solution[1, i] = 0.0, 0.0
        if w.mixed.sides[i] != FREE:
            w.solution[0, i] = w.right[i]
            for k in range(BAND):
                w.solution[1, i] += w.B[k, i]


@kernel
def solve(w: Workspace, J: Jacobian, scale: float, missing: float, given: bool) -> float:
    """The change of the approach (m), with that of the pressure in w.solution[0], from the factors in w.

    On entry w.solution[0] holds the right side, and w.solution[1] minus the derivative of the balance by the
    approach, which is not used where that is `given`. `missing`: what the load per length shall change by
    (N/m).
    """
    if given:
        solve_corrected(J, w.mixed.sides, w.hierarchy, w.exchange, w.solution[:1])
        return 0.0
    solve_corrected(J, w.mixed.sides, w.hierarchy, w.exchange, w.solution)
    by_approach = 0.0
    for i in range(w.X.shape[0]):
        missing -= w.weight[i] * scale * w.solution[0, i]
        by_approach += w.weight[i] * scale * w.solution[1, i]
    change = missing / by_approach
    for i in range(w.X.shape[0]):
        w.solution[0, i] += change * w.solution[1, i]
    return change


@kernel
def allowed_share(p: Any, h: Any, highest: float, bodies: Bodies, w: Workspace) -> float:
    """How much of the change of pressure and gap may be made: not so much that the film vanishes, or
    cavitates where it is pressed hard, or that asperities are pressed far into each other."""
    most = 1.0 - LEAST_SHARE
    share = 1.0
    for i in range(p.shape[0]):
        nearer = max(most * h[i], NEARER * bodies.roughness)
        if w.film_change[i] < -nearer:
            share = min(share, -nearer / w.film_change[i])
        change = w.change[i]
        if bodies.roughness > 0.0:
            change -= w.mixed.stiffness[i] * w.film_change[i]
        if p[i] > HIGH * highest and change < -most * p[i]:
            share = min(share, -most * p[i] / change)
    return share


@kernel
def clip(p: Any, q: Any, highest: float, rough: bool, w: Workspace) -> bool:
    """Negative pressures become 0, with what they were in w.change; whether total pressures have changed."""
    moved = False
    for i in range(p.shape[0]):
        w.change[i] = p[i]
        if p[i] < 0.0:
            p[i] = 0.0
            if rough:
                q[i] = w.mixed.asperities[i]
            moved = True
        elif rough and w.fixed[i] != 0.0 and q[i] != 0.0 and is_open(w.mixed.asperities[i], highest):
            q[i] = 0.0
            moved = True
    return moved


@kernel
def is_balanced(problem: FilmProblem, w: Workspace) -> bool:
    """Whether w.residual is small at pressurised nodes, and where oil is missing at cavitated ones, against
    the mass, or against what flows through where the step is long."""
    for i in range(1, w.X.shape[0] - 1):
        width = cell(w.X, i) * problem.scale
        allowed = BALANCE * w.nodes.mass[i] * (width / problem.time_step + abs(problem.drive.velocity))
        left = abs(w.residual[i]) if w.fixed[i] == 0.0 else -w.residual[i]
        if not left <= allowed:
            return False
    return True


@kernel
def find_balance(p: Any, h: Any, problem: FilmProblem, fluid: Lubricant, old: Any, w: Workspace) -> None:
    """w.residual with its derivatives; where cavities keep their oil, with the layers that balance them."""
    properties(p, h, fluid, w.nodes)
    if keeps_oil(problem.drive):
        hold_layers(h, w.fixed, problem.drive, w.oil, w.nodes)
    balance(
        w.X, problem.scale, problem.scale_rate, p, h, w.nodes, problem.drive, fluid, old,
        problem.time_step, w.residual, w.A, w.B,
    )  # fmt: skip
    if keeps_oil(problem.drive):
        ways = Ways(w.by_near, w.by_far)
        find_ways(w.X, problem.scale_rate, problem.drive, w.nodes, ways)
        per_time = problem.scale / problem.time_step
        move_layers(w.X, per_time, w.fixed, ways, w.residual, w.nodes, w.oil, w.solution[0])


@kernel
def begin_newton(p: Any, h: Any, approach: float, problem: FilmProblem, bodies: Bodies, w: Workspace) -> None:
    """The guess of the pressures without negative ones, and its gap."""
    for i in range(p.shape[0]):
        p[i] = max(p[i], 0.0)
    q, gap = (w.mixed.total, w.mixed.gap) if bodies.roughness > 0.0 else (p, h)
    fill_film(q, approach, problem.drive.radius, problem.scale, bodies, w, gap)


@kernel
def newton(
    p: Any, h: Any, approach: float, problem: FilmProblem, bodies: Bodies, fluid: Lubricant, old: Any,
    w: Workspace, tolerance: float = TOLERANCE,
) -> FilmSolution:  # fmt: skip
    """p and h are the guess, of `begin_newton` or of this, and the result, not to be used if it has an error.

    Between rough surfaces w.mixed.total is the guess of the pressure, and p tells where it is the fluid's;
    the result is in both. `old` is rho h times the volumes at the step's start (m^2). The factors in w are
    used where they belong to nearly the same nodes; call `forget_factors` before the first call.
    """
    n = p.shape[0]
    factor, offset = deflection_factors(problem.scale, bodies)
    J = Jacobian(w.A, w.B, w.D, w.weight, factor, offset)
    given = problem.line_load < 0.0
    rough = bodies.roughness > 0.0
    # Of smooth bodies the total pressure is the fluid's, and the gap the film.
    q, gap = (w.mixed.total, w.mixed.gap) if rough else (p, h)
    sides = w.mixed.sides
    slow, error, left = False, math.inf, math.inf
    last, reach, most = 0, 0, n
    highest = PRESSURE_FLOOR
    for i in range(n):
        w.fixed[i] = 0.0 if 0 < i < n - 1 and p[i] > 0.0 else 1.0
        w.recent[i] = 0.0
        highest = max(highest, q[i])
    if rough:
        touch(bodies, w.mixed, h)
        fluid_pressure(p, w.fixed, w.mixed)
        for i in range(n):
            p[i] = max(p[i], 0.0)
    if keeps_oil(problem.drive):
        spread(old, w.X, problem.scale, w.oil)
    for iteration in range(MOST_ITERATIONS):
        if clip(p, q, highest, rough, w):
            fill_film(q, approach, problem.drive.radius, problem.scale, bodies, w, gap)
            if rough:
                touch(bodies, w.mixed, h)
                for i in range(n):
                    if p[i] > 0.0:
                        p[i] = max(q[i] - w.mixed.asperities[i], 0.0)
        if not smallest(h) > 0.0:
            return FilmSolution(approach, math.inf, iteration)
        find_balance(p, h, problem, fluid, old, w)
        if keeps_oil(problem.drive):
            room_left(h, w.oil, ROUNDING, w.right)
            changed, hasty = update_sides(w.change, w.fixed, w.right, w.recent, reach)
            if changed > 0:
                find_balance(p, h, problem, fluid, old, w)
        else:
            for i in range(n):
                if abs(w.residual[i]) <= ROUNDING * old[i] / problem.time_step:
                    w.residual[i] = 0.0
            changed, hasty = update_sides(w.change, w.fixed, w.residual, w.recent, reach)
        most = last // 2 if hasty else most + 1
        last, reach = reach, min(max(1, 2 * reach) if changed > 0 and not hasty else 0, most)
        for i in range(n):
            w.right[i], sides[i] = -w.residual[i], w.fixed[i]
        if rough:
            fill_sides(p, w.fixed, highest, w.mixed)
        if keeps_oil(problem.drive):
            ways = Ways(w.by_near, w.by_far)
            feed_rows(w.X, problem.scale / problem.time_step, w.fixed, ways, w.A, w.B, sides)
        if rough:
            couple_asperities(w.A, w.B, w.mixed, w.right)
        if left <= 1.0 and changed == 0:
            if is_balanced(problem, w):
                if keeps_oil(problem.drive):
                    # Factors leave cavities pressures of rounding, by which they would not be told.
                    for i in range(n):
                        p[i] = p[i] if w.fixed[i] == 0.0 else 0.0
                return FilmSolution(approach, 0.0, iteration)
            # The steep pressure where oil fills the gap again takes corrections that are small elsewhere.
            if not keeps_oil(problem.drive) and left * tolerance <= TOLERANCE:
                return FilmSolution(approach, math.inf, iteration)
        if slow or not correct_factors(sides, w.hierarchy, w.exchange):
            factorise_anew(J, sides, w.hierarchy, w.exchange)
        fill_right_side(w)
        missing = problem.line_load - integrate_pressure(q, w.weight, problem.scale)
        change = solve(w, J, problem.scale, missing, given)
        largest, highest = 0.0, PRESSURE_FLOOR
        for i in range(n):
            w.change[i] = w.solution[0, i]
            largest = max(largest, abs(w.change[i]))
            highest = max(highest, q[i] + w.change[i])
        fill_film(w.change, change, math.inf, problem.scale, bodies, w, w.film_change)
        share = allowed_share(p, h, highest, bodies, w)
        approach += share * change
        for i in range(n):
            q[i] += share * w.change[i]
            gap[i] += share * w.film_change[i]
        if rough:
            touch(bodies, w.mixed, h)
            fluid_pressure(p, w.fixed, w.mixed)
        before, error = error, largest / (tolerance * highest)
        if not math.isfinite(error) or highest * bodies.compliance > MOST_STRAIN:
            return FilmSolution(approach, math.inf, iteration)
        slow = error > SLOW * before
        # What is left after a correction is that times the rate at which they shrink, but not by factors of
        # before nodes changed sides, whose corrections shrink first fast, then slowly.
        left = error
        if w.exchange.count[0] == 0.0 and before < math.inf:
            left *= min(error / before, 1.0)
        if share < 1.0:
            left = math.inf
    return FilmSolution(approach, math.inf, MOST_ITERATIONS)


@kernel
def forget_factors(w: Workspace) -> None:
    """The factors in w are of no use any more."""
    w.exchange.factored[0] = -1.0
