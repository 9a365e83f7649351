"""One implicit step of the film: pressure, film and, where the load is given, the approach of the bodies.

Newton's method on the balance of `reynolds` with the complementarity p >= 0 by active sets: a node whose
pressure falls below zero cavitates, a cavitated node whose balance says that oil piles up gets pressure
again. As that is seen only next to the pressurised film, more nodes join when it moves on (1, 2, 4, ...).
Factors of the Jacobian serve until a node changes sides or convergence is slow.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ...kernel import kernel
from ..fluid import Lubricant
from .hierarchical import Jacobian, factorise, solve_below
from .reynolds import Flow, balance, properties
from .workspace import Workspace

# Pressures are found to this share of the largest (at least of PRESSURE_FLOOR, Pa): far below what the
# tightest comparison of coupled results asks for, far above rounding.
TOLERANCE = 1e-8
PRESSURE_FLOOR = 1e4
MOST_ITERATIONS = 30
# New factors where an iteration leaves more of the correction than this.
SLOW = 0.2
# An iteration may shrink the film to this share.
LEAST_SHARE = 0.2


class Bodies(NamedTuple):
    """The elastic pair: elastic compliance (1/Pa) as `hertz.elastic_compliance`, contact length (m)."""

    compliance: float
    length: float


class Task(NamedTuple):
    """What is asked for: grid scale (m) and its rate (m/s), drive, load per length (N/m; negative: the
    approach is given) and the time step (s, may be inf)."""

    scale: float
    scale_rate: float
    drive: Flow
    line_load: float
    time_step: float


class Found(NamedTuple):
    """approach (m), error (0: converged), iterations."""

    approach: float
    error: float
    iterations: int


@kernel
def deflection_factors(scale: float, bodies: Bodies) -> tuple[float, float]:
    """Factor and offset: deflection = factor (D + offset 1 weight^T) p."""
    return 2.0 * bodies.compliance * scale / math.pi, math.log(bodies.length / scale)


@kernel
def line_load_of(p: Any, weight: Any, scale: float) -> float:
    """Load per length (N/m)."""
    total = 0.0
    for i in range(p.shape[0]):
        total += weight[i] * p[i]
    return total * scale


@kernel
def fill_film(
    p: Any, approach: float, radius: float, scale: float, bodies: Bodies, w: Workspace, h: Any
) -> None:
    """h = -approach + x^2/(2R) + deflection by p."""
    factor, offset = deflection_factors(scale, bodies)
    n = p.shape[0]
    level = factor * offset * line_load_of(p, w.weight, 1.0)
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += w.D[i, j] * p[j]
        h[i] = level + factor * total - approach + (scale * w.X[i]) ** 2 / (2.0 * radius)


@kernel
def smallest(h: Any) -> float:
    """The least element."""
    least = h[0]
    for i in range(h.shape[0]):
        least = min(least, h[i])
    return least


@kernel
def update_sides(p: Any, fixed: Any, residual: Any, newly: Any, reach: int) -> tuple[int, int]:
    """Nodes that fell below zero are fixed at it; fixed ones where oil piles up (residual < 0) are freed,
    and with them `reach` more on either side. How many fell and how many are free anew."""
    n = p.shape[0]
    fallen, freed = 0, 0
    for i in range(n):
        newly[i] = 0.0
    for i in range(1, n - 1):
        if fixed[i] != 0.0:
            if residual[i] < 0.0:
                for j in range(max(i - reach, 1), min(i + reach + 1, n - 1)):
                    if fixed[j] != 0.0:
                        newly[j] = 1.0
        elif p[i] < 0.0:
            fixed[i] = 1.0
            fallen += 1
    for i in range(1, n - 1):
        if newly[i] != 0.0:
            fixed[i] = 0.0
            freed += 1
    return fallen, freed


@kernel
def solve(w: Workspace, scale: float, missing: float, given: bool) -> float:
    """The change of the approach (m), with that of the pressure in w.solution[:, 0], from the factors in w.

    w.solution holds on entry the right side, and in column 1, unless the approach is `given`, minus the
    derivative of the balance by it, rows scaled as the factors are. `missing`: what the load per length
    shall change by (N/m).
    """
    n = w.X.shape[0]
    if given:
        solve_below(w.hierarchy, 0, w.solution, 1)
        return 0.0
    solve_below(w.hierarchy, 0, w.solution, 2)
    by_approach = 0.0
    for i in range(n):
        missing -= w.weight[i] * scale * w.solution[i, 0]
        by_approach += w.weight[i] * scale * w.solution[i, 1]
    change = missing / by_approach
    for i in range(n):
        w.solution[i, 0] += change * w.solution[i, 1]
    return change


@kernel
def newton(
    p: Any, h: Any, approach: float, task: Task, bodies: Bodies, fluid: Lubricant, old: Any, w: Workspace
) -> Found:
    """p and h are the guess and the result; a result whose error is not 0 must not be used.

    `old` is rho h times the volumes at the step's start (m^2).
    """
    n = p.shape[0]
    factor, offset = deflection_factors(task.scale, bodies)
    J = Jacobian(w.A, w.B, w.D, w.weight, offset)
    given = task.line_load < 0.0
    fresh, reach, before, error = False, 0, 1e300, 1e300
    for i in range(n):
        w.fixed[i] = 0.0 if 0 < i < n - 1 and p[i] > 0.0 else 1.0
    for iteration in range(MOST_ITERATIONS):
        for i in range(n):
            w.change[i] = max(p[i], 0.0)
        fill_film(w.change, approach, task.drive.radius, task.scale, bodies, w, h)
        if not smallest(h) > 0.0:
            return Found(approach, math.inf, iteration)
        properties(w.change, h, fluid, w.nodes)
        balance(
            w.X, task.scale, task.scale_rate, w.change, h, w.nodes, task.drive, fluid, old,
            task.time_step, w.residual, w.A, w.B,
        )  # fmt: skip
        fallen, freed = update_sides(p, w.fixed, w.residual, w.newly, reach)
        reach = max(1, 2 * reach) if freed > 0 and fallen == 0 else 0
        for i in range(n):
            p[i] = w.change[i]
        # What is left after a correction is that times the last rate of convergence.
        if error * min(error / before, 1.0) <= 1.0 and fallen + freed == 0:
            return Found(approach, 0.0, iteration)
        if fallen + freed > 0:
            fresh = False
        for i in range(n):
            for k in range(5):
                w.B[i, k] *= factor
        if not fresh or error > SLOW * before:
            factorise(J, w.fixed, w.hierarchy)
            fresh = True
        for i in range(n):
            by_approach = 0.0
            for k in range(5):
                by_approach += w.B[i, k]
            scale = w.hierarchy.scale[i]
            w.solution[i, 0] = -p[i] if w.fixed[i] != 0.0 else -scale * w.residual[i]
            w.solution[i, 1] = 0.0 if w.fixed[i] != 0.0 else scale * by_approach / factor
        missing = task.line_load - line_load_of(p, w.weight, task.scale)
        change = solve(w, task.scale, missing, given)
        # Not so far that the film vanishes.
        for i in range(n):
            w.change[i] = w.solution[i, 0]
        fill_film(w.change, change, math.inf, task.scale, bodies, w, w.newly)
        share, largest, highest = 1.0, 0.0, PRESSURE_FLOOR
        for i in range(n):
            if w.newly[i] < -(1.0 - LEAST_SHARE) * h[i]:
                share = min(share, -(1.0 - LEAST_SHARE) * h[i] / w.newly[i])
            largest = max(largest, abs(w.change[i]))
            highest = max(highest, p[i] + w.change[i])
        approach += share * change
        for i in range(n):
            p[i] += share * w.change[i]
        before, error = error, largest / (TOLERANCE * highest)
        if not math.isfinite(error):
            return Found(approach, math.inf, iteration)
        if share < 1.0:
            error = 1e300
    return Found(approach, math.inf, MOST_ITERATIONS)
