"""The steady film of a finite line contact, for a load or for an approach.

Newton's method on the cells that are full; which are, is found on the way (a cell is full where p > 0 or
where its balance asks for p: primal-dual active sets). It starts at the dry contact, lifted by the film of
Moes and Venner's formula, on a grid four times coarser, where the outlet, which moves by a node a step, has
not far to go. Where that fails, the velocity is raised until it does not and brought down again step by step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from ...quantities import Vector
from ...system import ModelError
from ..films.moes_venner import film as moes_venner
from ..hertz import deflection
from .checks import inlet_share, warnings_of
from .contact import FiniteLine, Running
from .dry import touching, widths
from .faults import finite, within
from .grid import Grid, Resolution, axial_faces, even_nodes
from .inlet import before_grid
from .linear import Closing, newton_step
from .scaled import Scaled
from .solution import Solution

_LARGEST_STEPS = 40
# The grid of the first solution is so much coarser.
_COARSER = 4.0
# Relative to the film: what a cell's balance may miss (root mean square), and the load's own.
_BALANCE_TOLERANCE, _LOAD_TOLERANCE = 1e-6, 1e-9
# The film may lose so much of itself in a step; steps that this makes smaller than that lead nowhere.
_LARGEST_LOSS, _SMALLEST_SHARE = 0.7, 1e-2
# Thin films of coarse grids may not exist: then a finer one than asked for is tried.
_FINER = (1.0, 1.5, 2.25)
# The velocity is raised by up to 2^_RAISES, and brought down by at least the factor 2^(1/_SMALLEST_STEP).
_RAISES, _SMALLEST_STEP = 8, 16
# So much of the pressure of the inlet comes from before the grid (see checks).
_INLET_SHARE = 0.05


@dataclass(frozen=True)
class _State:
    p: Vector
    h0: float
    h: Vector
    steps: int


def steady(
    contact: FiniteLine, running: Running, fine: Resolution | None = None, start: Solution | None = None
) -> Solution:
    """Film and pressure under a load. `start`: the solution of a like instant, to begin from.

    ModelError at zero velocity (a steady film vanishes: see `dry`), and where no solution is found.
    """
    fine = fine or Resolution()
    window = _window(contact, running)
    for finer in _FINER:
        problem = Scaled(contact, running, window.half_width, window.grid(contact, fine.refined(finer)))
        found = _attempt(problem, window, fine.refined(finer), start)
        if found is not None:
            return _finished(problem, found)
    raise _lost(problem)


def _attempt(problem: Scaled, window: _Window, fine: Resolution, start: Solution | None) -> _State | None:
    found = _from(problem, start) if start is not None else None
    if found is None:
        coarse = replace(problem, grid=window.grid(problem.contact, fine.refined(1.0 / _COARSER)))
        first = _newton(coarse, *_lifted(coarse))
        if first is not None:
            found = _from(problem, coarse.solution(first.p, first.h, first.h0, 0))
        found = found or _newton(problem, *_lifted(problem)) or _continued(problem)
    return found


def steady_at(
    contact: FiniteLine, running: Running, approach: float, fine: Resolution | None = None
) -> Solution:
    """Film, pressure and load at an `approach` (m) of the bodies; `running.load` has no part.

    Loads are tried by the secant method, then the approach is given to Newton's itself.
    """
    finite("approach", approach, "m", "give the approach of the bodies")
    fine = fine or Resolution()
    _needs_motion(running)
    compliance, length = contact.compliance, contact.length

    def beyond(log_load: float) -> float:
        """Of the line contact, in metres: elastic approach less film."""
        load = math.exp(log_load)
        return (
            deflection(load, running.radius, length, compliance)
            - formula_film(contact, running, load)
            - approach
        )

    # K (9) holds up to b = 2 L; a load of 1e-9 N/m floats metres high.
    lowest, highest = math.log(1e-9 * length), math.log(length**3 / (running.radius * compliance))
    if beyond(lowest) > 0.0 or beyond(highest) < 0.0:
        raise within(
            "approach", approach, "m", "one that a contact of this length has", "see `hertz.deflection`"
        )
    log_load = float(brentq(beyond, lowest, highest, xtol=1e-3))
    tried: list[tuple[float, Solution]] = []
    for _ in range(12):
        start = tried[-1][1] if tried else None
        found = steady(contact, replace(running, load=math.exp(log_load)), fine, start)
        tried.append((log_load, found))
        miss = found.approach - approach
        if abs(miss) < 1e-2 * (abs(approach) + found.central_film):
            break
        # d(approach)/d(ln W) is the approach's own size, or the film's, until two tries tell it.
        slope = abs(found.approach) + found.central_film
        if len(tried) > 1:
            (before, old), (after, new) = tried[-2:]
            slope = (new.approach - old.approach) / (after - before)
        log_load -= max(-2.0, min(2.0, miss / slope)) if slope > 0.0 else 0.5
    problem = _problem(contact, tried[-1][1].running, fine)
    p, h0 = _carried_over(problem, tried[-1][1])
    target = -approach / problem.film_unit
    state = _newton(problem, p, h0, target)
    if state is None:
        raise _lost(problem)
    problem = replace(problem, running=replace(running, load=_load_of(problem, state)))
    return _finished(problem, state)


def _load_of(problem: Scaled, state: _State) -> float:
    return float((problem.grid.areas * state.p).sum()) * problem.pressure_unit * problem.half_width**2


def formula_film(contact: FiniteLine, running: Running, load: float, length: float | None = None) -> float:
    """The minimum film of Moes and Venner (m)."""
    fluid = contact.fluid
    return float(
        moes_venner(
            load, abs(running.velocity), running.radius, length or contact.length, contact.compliance,
            fluid.viscosity, fluid.pressure_viscosity,
        )
    )  # fmt: skip


def _needs_motion(running: Running) -> None:
    if running.velocity == 0.0:
        raise within(
            "entraining velocity", 0.0, "m/s", "other than zero", "a steady film vanishes there: use `dry`"
        )


@dataclass(frozen=True)
class _Window:
    """What the grid covers along x (m), and the half width where the load is carried."""

    half_width: float
    first: float
    last: float

    def grid(self, contact: FiniteLine, fine: Resolution) -> Grid:
        b = self.half_width
        x = even_nodes(self.first / b, self.last / b, 1.0 / fine.nodes_per_half_width)
        kinks = tuple(k / b for k in contact.profile.kinks(contact.length))
        return Grid(x, axial_faces(contact.length / b, 1.0, kinks, fine))


def _window(contact: FiniteLine, running: Running) -> _Window:
    """As wide as the inlet needs."""
    _needs_motion(running)
    b, largest, carrying = widths(contact, running)
    film = formula_film(contact, running, running.load, carrying)
    mouth = math.sqrt(2.0 * running.radius * film)
    first = max(1.4 * largest, b + mouth)
    while inlet_share(contact, running, b, film, first) > _INLET_SHARE:
        first *= 1.05
    return _Window(b, -first, 1.15 * largest + mouth)


def _problem(contact: FiniteLine, running: Running, fine: Resolution) -> Scaled:
    window = _window(contact, running)
    return Scaled(contact, running, window.half_width, window.grid(contact, fine))


def _lifted(problem: Scaled) -> tuple[Vector, float]:
    """The dry contact, with the formula's film in between."""
    p, h0, _ = touching(problem)
    running = problem.running
    return p, h0 + formula_film(problem.contact, running, running.load) / problem.film_unit


def _carried_over(problem: Scaled, start: Solution) -> tuple[Vector, float]:
    """The pressure of another solution on this grid, over x/b and y, and its approach."""
    order = -1 if start.running.velocity < 0.0 else 1
    x = start.grid.x[::order] * order / start.half_width
    p = start.pressure[::order] / problem.pressure_unit
    y = problem.grid.y * problem.half_width
    along = np.array([np.interp(problem.grid.x, x, line, 0.0, 0.0) for line in p.T]).T
    p = np.array([np.interp(y, start.grid.y, row) for row in along])
    p *= problem.open
    p *= problem.load / float((problem.grid.areas * p).sum())
    gap = problem.gap + problem.space.deflection(p)
    least = start.smallest_film / problem.film_unit
    return p, least - float(np.min(np.where(p > 0.0, gap, np.inf)))


def _from(problem: Scaled, start: Solution) -> _State | None:
    return _newton(problem, *_carried_over(problem, start))


def _newton(
    problem: Scaled, p: Vector, h0: float, fixed_h0: float | None = None, faster: float = 1.0
) -> _State | None:
    """Newton's method at the load, or at h0 = `fixed_h0`; `faster` multiplies the velocity. None: failed."""
    none = np.zeros_like(p)
    wedge = faster * problem.wedge
    for steps in range(_LARGEST_STEPS):
        h = problem.gap + h0 + problem.space.deflection(p)
        if not np.min(h) > 0.0:
            return None
        g, by_p, by_h = problem.balance(p, h, wedge)
        full = ((p > 0.0) | (g < 0.0)) & problem.open
        above = p - before_grid(h, problem.grid.x, wedge)
        closing = problem.carries(p) if fixed_h0 is None else Closing(none, 1.0, h0 - fixed_h0)
        missed = math.sqrt(float(np.mean(np.where(full, g, above) ** 2)))
        if not math.isfinite(missed):
            return None
        if (
            missed < _BALANCE_TOLERANCE * float(np.median(h[p > 0.0]))
            and abs(closing.fault) < _LOAD_TOLERANCE
        ):
            return _State(p, h0, h, steps)
        try:
            dp, dh0 = newton_step(problem.space, g, by_p, by_h, above, full, closing)
        except np.linalg.LinAlgError:
            return None
        change = problem.space.deflection(dp) + dh0
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.min(np.where(change < 0.0, -_LARGEST_LOSS * h / change, np.inf))
        share = min(1.0, float(room))
        if share < _SMALLEST_SHARE:
            return None
        p = np.maximum(p + share * dp, 0.0)
        h0 += share * dh0
    return None


def _continued(problem: Scaled) -> _State | None:
    """By way of higher velocities, whose films are thicker and easier."""
    p, h0 = _lifted(problem)
    for raised in range(1, _RAISES + 1):
        state = _newton(problem, p, h0, faster=2.0**raised)
        if state is not None:
            break
    else:
        return None
    at, step = float(raised), 1.0
    while at > 0.0:
        next_one = max(0.0, at - step)
        trial = _newton(problem, state.p, state.h0, faster=2.0**next_one)
        if trial is None:
            step *= 0.5
            if step < 1.0 / _SMALLEST_STEP:
                return None
        else:
            state, at, step = trial, next_one, min(2.0 * step, 2.0)
    return state


def _lost(problem: Scaled) -> ModelError:
    r = problem.running
    return ModelError(
        f"no steady film found at load = {r.load:g} N, entraining velocity = {r.velocity:g} m/s, radius = "
        f"{r.radius:g} m, misalignment = {r.misalignment:g} rad; use a finer Resolution, or a larger velocity"
    )


def _finished(problem: Scaled, state: _State) -> Solution:
    found = problem.solution(state.p, state.h, state.h0, state.steps)
    return replace(found, warnings=warnings_of(found))
