"""The steady film of a finite line contact under a load.

Newton's method on the cells that are full; which are, is found on the way (a cell is full where p > 0 or
where its balance asks for p: primal-dual active sets). It starts at the dry contact, lifted by the film of
Moes and Venner's formula, on a grid four times coarser, where the outlet, which moves by a node a step, has
not far to go. Where that fails, a scheme that is less accurate and more robust (straight faces) goes
before, and where that fails too, from an even film in pseudo-time, by steps that grow.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ....core.quantities import Vector
from ....core.system import ModelError
from ...films.moes_venner import film as moes_venner
from ..inlet import inlet_width
from ..line.line_contact import LineContact
from .checks import find_warnings, inlet_share
from .contact import FiniteLine, Running
from .dry import find_dry_load, solve_dry_pressure, touching
from .faults import out_of_range
from .grid import Edges, Grid, Resolution, axial_faces, graded_nodes
from .half_space import refuse_more_memory
from .inlet import before_grid
from .linear import newton_step
from .reynolds import HERE
from .scaled import Scaled
from .solution import Solution

_LARGEST_STEPS = 25
# The grid of the first solution is so much coarser.
_COARSER = 4.0
# Relative to the film: what a cell's balance may miss (root mean square), and the load's own.
_BALANCE_TOLERANCE, _LOAD_TOLERANCE = 1e-6, 1e-9
# The film may lose so much of itself in a step; steps that this makes smaller than that lead nowhere.
_LARGEST_LOSS, _SMALLEST_SHARE = 0.7, 1e-2
# Pseudo-time, in units of the time that oil needs through a half width: first and last step, growth after an
# easy and after a hard one, and what a failure leaves of one; the film it starts from, over the formula's.
_FIRST_STEP, _LAST_STEP = 0.05, 1e4
_EASY_GROWTH, _HARD_GROWTH, _EASY_STEPS, _SHRINK, _MOST_FAILURES = 9.0, 3.0, 4, 0.25, 12
_START_FILM = 1.3
# Of the interpolation to the faces of the cells, see reynolds.upstream_weights.
_STRAIGHT, _CURVED = 0.0, 1.0
_LESS_ACCURATE = (
    "no film found with parabolas at the faces of the cells: this one has straight lines there, and is some "
    "1 % too thin; raise nodes_per_half_width"
)
# A film (m) that is thinner than a molecule is none.
THINNEST = 1e-10
# So much of the pressure of the inlet comes from before the grid (see checks).
_INLET_SHARE = 0.05


@dataclass(frozen=True)
class _State:
    p: Vector
    h0: float
    h: Vector
    steps: int
    straight: bool = False


def steady(
    contact: FiniteLine, running: Running, fine: Resolution | None = None, start: Solution | None = None
) -> Solution:
    """Film and pressure under a load. `start`: the solution of a like instant, to begin from.

    ModelError where the velocity is so small that the film `vanishes` (see `dry`), where the grid is too
    large, and where no solution is found.
    """
    fine = fine or Resolution()
    window = _window(contact, running)
    problem = Scaled(contact, running, window.half_width, window.grid(contact, fine))
    refuse_more_memory(problem.grid)  # before the coarser one is solved
    found = _attempt(problem, window, fine, start)
    if found is None:
        raise _build_error(problem)
    return _finish(problem, found)


def _attempt(problem: Scaled, window: _Window, fine: Resolution, start: Solution | None) -> _State | None:
    """From the start if there is one, from a film on a coarser grid, and by way of straight faces."""
    found = _from(problem, start) if start is not None else None
    if found is not None:
        return found
    coarse = replace(problem, grid=window.grid(problem.contact, fine.refined(1.0 / _COARSER)))
    first = _newton(coarse, *_lift(coarse), curved=_STRAIGHT) or _let_flow_out(coarse)
    straight = None
    if first is not None:
        rough = coarse.solution(first.p, first.h, first.h0, 0)
        found = _from(problem, rough)
        if found is not None:
            return found
        straight = _from(problem, rough, _STRAIGHT)
    straight = straight or _let_flow_out(problem)
    if straight is None:
        return None
    return _newton(problem, straight.p, straight.h0) or replace(straight, straight=True)


def formula_film(contact: FiniteLine, running: Running, load: float, length: float | None = None) -> float:
    """The minimum film of Moes and Venner (m)."""
    fluid = contact.fluid
    return float(
        moes_venner(
            load, abs(running.velocity), running.radius, length or contact.length, contact.compliance,
            fluid.viscosity, fluid.pressure_viscosity,
        )
    )  # fmt: skip


def vanishes(contact: FiniteLine, running: Running) -> bool:
    """No entrainment, or so little that the formula's film is thinner than a molecule: the contact is dry."""
    return running.velocity == 0.0 or formula_film(contact, running, running.load) < THINNEST


def _no_film(velocity: float, bound: str) -> ModelError:
    return out_of_range("entraining velocity", velocity, "m/s", bound, "no steady film there: use `dry`")


def _needs_velocity(running: Running) -> None:
    if running.velocity == 0.0:
        raise _no_film(0.0, "other than zero")


@dataclass(frozen=True)
class _Window:
    """What the grid covers along x, the half width where the load is carried, and the edges of the contact;
    all in m."""

    half_width: float
    first: float
    last: float
    edges: Edges

    def grid(self, contact: FiniteLine, fine: Resolution) -> Grid:
        b = self.half_width
        edges = Edges(self.edges.narrow / b, self.edges.wide / b, self.edges.inlet / b)
        x = graded_nodes(self.first / b, self.last / b, edges, fine)
        kinks = tuple(k / b for k in contact.profile.kinks(contact.length))
        return Grid(x, axial_faces(contact.length / b, 1.0, kinks, fine))


def _window(contact: FiniteLine, running: Running) -> _Window:
    """As wide as the inlet needs."""
    _needs_velocity(running)
    if vanishes(contact, running):
        raise _no_film(running.velocity, f"large enough for a film of {THINNEST:g} m")
    found = find_dry_load(contact, running)
    b = found.half_width
    film = formula_film(contact, running, running.load, found.length)
    mouth = math.sqrt(2.0 * running.radius * film)
    first = max(1.4 * found.largest, b + mouth)
    while inlet_share(contact, running, b, film, first) > _INLET_SHARE:
        first *= 1.05
    edges = Edges(found.narrow, found.wide, inlet_width(b, film, running.radius))
    return _Window(b, -first, 1.15 * found.largest + mouth, edges)


def _lift(problem: Scaled, share: float = 1.0) -> tuple[Vector, float]:
    """The dry contact, with a share of the formula's film in between."""
    p, h0, _ = touching(problem)
    running = problem.running
    return p, h0 + share * formula_film(problem.contact, running, running.load) / problem.film_unit


def _transfer_film(problem: Scaled, start: Solution) -> tuple[Vector, float]:
    """The film of another solution on this grid, over x/b and y, and the pressure that makes room for it.

    Brought over itself, the pressure would not do: thin films are less than what its errors bend.
    """
    order = -1 if start.running.velocity < 0.0 else 1
    x = start.grid.x[::order] * order / start.half_width
    y = problem.grid.y * problem.half_width

    def brought(values: Vector) -> Vector:
        along = np.array([np.interp(problem.grid.x, x, line, 0.0, 0.0) for line in values[::order].T]).T
        return np.array([np.interp(y, start.grid.y, row) for row in along])

    now, then = (formula_film(problem.contact, at, at.load) for at in (problem.running, start.running))
    film = brought(start.film) * (now / then) / problem.film_unit
    p = brought(start.pressure) * problem.open
    p *= problem.load / float((problem.grid.areas * p).sum())
    return solve_dry_pressure(problem, p, film)


def _from(problem: Scaled, start: Solution, curved: float = _CURVED) -> _State | None:
    return _newton(problem, *_transfer_film(problem, start), curved=curved)


@dataclass(frozen=True)
class _Storage:
    """A step of pseudo-time: `mass` rho h before it, and how long it takes, in the units of the balance."""

    mass: Vector
    step: float


def _newton(
    problem: Scaled, p: Vector, h0: float, storage: _Storage | None = None, curved: float = _CURVED
) -> _State | None:
    """Steady, or after a step of `storage`. None: failed."""
    for steps in range(_LARGEST_STEPS):
        h = problem.gap + h0 + problem.space.deflection(p)
        if not np.min(h) > 0.0:
            return None
        g, by_p, by_h = problem.balance(p, h, problem.wedge, curved)
        if storage is not None:
            mass, mass_by_p, mass_by_h = problem.balance.mass(p, h)
            g += (mass - storage.mass) / storage.step
            by_p[HERE] += mass_by_p / storage.step
            by_h[HERE] += mass_by_h / storage.step
        full = ((p > 0.0) | (g < 0.0)) & problem.open
        above = p - before_grid(h, problem.grid.x, problem.wedge)
        closing = problem.carries(p)
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


def _let_flow_out(problem: Scaled) -> _State | None:
    """With straight faces, by pseudo-time: an even film between the dry contact's surfaces flows out."""
    p, h0 = _lift(problem, _START_FILM)
    step, failures, steps = _FIRST_STEP, 0, 0
    while True:
        h = problem.gap + h0 + problem.space.deflection(p)
        mass, _, _ = problem.balance.mass(p, h)
        found = _newton(problem, p, h0, storage=_Storage(mass, step), curved=_STRAIGHT)
        if found is None:
            failures += 1
            if failures > _MOST_FAILURES:
                return None
            step *= _SHRINK
            continue
        p, h0, steps = found.p, found.h0, steps + found.steps
        if step >= _LAST_STEP:
            return _newton(problem, p, h0, curved=_STRAIGHT)
        step *= _EASY_GROWTH if found.steps <= _EASY_STEPS else _HARD_GROWTH


def _build_error(problem: Scaled) -> ModelError:
    r = problem.running
    c = problem.contact
    M = LineContact(r.load, r.velocity, r.radius, c.length, c.compliance, c.fluid).M
    return ModelError(
        f"no steady film found at load = {r.load:g} N, entraining velocity = {r.velocity:g} m/s, radius = "
        f"{r.radius:g} m, misalignment = {r.misalignment:g} rad, that is M = {M:.3g}: should be from 1 "
        "to 1000; raise nodes_per_half_width and nodes_per_inlet, or take a larger velocity, a profile "
        "without sharp ends, or the line contact, which has none"
    )


def _finish(problem: Scaled, state: _State) -> Solution:
    found = problem.solution(state.p, state.h, state.h0, state.steps)
    less = (_LESS_ACCURATE,) if state.straight else ()
    return replace(found, warnings=(*find_warnings(found), *less))
