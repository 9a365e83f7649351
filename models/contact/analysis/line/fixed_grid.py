"""The steady film under a given load on one grid, whatever the start.

Pseudo-time continuation: implicit steps, first shorter than oil needs through the contact, then longer and
longer, until one that is as good as infinite leaves the film as it is. A step that fails is taken again at a
quarter.
"""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ....compile.kernel import kernel
from ....core.integrator import copy
from ....core.quantities import Vector
from ...fluid import Lubricant
from ...hertz import deflection
from ...line.grid import REACH, fill_kernel_matrix, place_nodes
from ...line.mixed import Bodies, fill_total
from ...line.newton import FilmProblem, FilmSolution, begin_newton, fill_film, forget_factors, newton
from ...line.reynolds import Flow, properties
from ...line.transient import masses, place_film
from ...line.workspace import Workspace, workspace_in, workspace_size

# Steps in units of the time that oil needs through the grid's scale: the first, and the last, in which oil
# is stored in the film at 1e-5 of the rate at which it flows through, times the film's relative change. By
# how much a step grows, after an easy and after a hard one.
FIRST_STEP, LAST_STEP = 0.05, 1e5
EASY_GROWTH, HARD_GROWTH, EASY_ITERATIONS = 9.0, 3.0, 4
SHRINK = 0.25
MOST_FAILURES = 40
# The film is steady when the last step changes the pressure by less, relative to the largest: as Newton's
# method may leave it, which then leaves 1e-10 of the film's mass.
SETTLED = 1e-5
# Start of the film, relative to the expected one: thicker is safer, as the film then only flows out.
START_FILM = 1.3
# Between rough surfaces by so many roughnesses more: asperities hardly press, and settle as it flows out.
START_ROUGH = 3.0
# Elements of the matrices that a thread keeps (8 bytes each).
HELD = 16_000_000

_memory = threading.local()


@dataclass(frozen=True)
class Fields:
    """A film on a grid: X in units of scale (m), pressure p (Pa), film h and approach (m)."""

    mesh: Mesh
    X: Vector
    scale: float
    p: Vector
    h: Vector
    approach: float


class Mesh(NamedTuple):
    """Nodes and what `place_nodes` does with them."""

    nodes: int
    reach: float = REACH
    sharpness: float = 0.0


def workspace(mesh: Mesh) -> Workspace:
    """Scratch with that grid. A thread keeps some: making the largest takes longer than solving on it."""
    held: dict[Mesh, Workspace] = _memory.__dict__.setdefault("held", {})
    if mesh in held:
        held[mesh] = held.pop(mesh)
        return held[mesh]
    while held and sum(m.nodes**2 for m in held) + mesh.nodes**2 > HELD:
        held.pop(next(iter(held)))
    w = workspace_in(np.zeros(workspace_size(mesh.nodes)), mesh.nodes)
    if mesh != Mesh(mesh.nodes):
        place_nodes(w.X, mesh.reach, mesh.sharpness)
        fill_kernel_matrix(w.X, w.weight, w.D)
    held[mesh] = w
    return w


def cold_start(
    load: float, expected_film: float, radius: float, bodies: Bodies, scale: float, mesh: Mesh
) -> Fields:
    """Hertz's pressure over a film of even thickness."""
    w = workspace(mesh)
    p, h = np.zeros(mesh.nodes), np.zeros(mesh.nodes)
    film = START_FILM * expected_film
    if bodies.roughness > 0.0:
        film += START_ROUGH * bodies.roughness
    place_film(load, film, radius, bodies, w.X, scale, p, h)
    approach = deflection(load, radius, bodies.length, bodies.compliance) - film
    return Fields(mesh, w.X, scale, p, h, approach)


def interpolate_film(start: Fields, mesh: Mesh) -> Fields:
    """A film brought to another grid."""
    X = workspace(mesh).X
    p = np.interp(X, start.X, start.p)
    h = np.exp(np.interp(X, start.X, np.log(start.h)))
    return Fields(mesh, X, start.scale, p, h, start.approach)


@kernel
def take_step(
    p: Any, h: Any, approach: float, problem: FilmProblem, bodies: Bodies, fluid: Lubricant, squeeze: float,
    before: Any, w: Workspace,
) -> FilmSolution:  # fmt: skip
    """An implicit step from p and h, which become those at its end; `before`: total pressure at the start.

    `approach` is a guess (m); nan: the one that leaves no film thinner than the start's, though its pressure
    be not smooth. All in one kernel: Newton's method, called from Python, would be compiled a second time.
    """
    mass = w.base
    properties(p, h, fluid, w.nodes)
    masses(problem.scale, w, mass)
    for i in range(1, p.shape[0] - 1):
        opened = squeeze * problem.time_step * 0.5 * problem.scale
        mass[i] -= opened * w.nodes.rho[i] * (w.X[i + 1] - w.X[i - 1])
    fill_total(p, h, bodies, before)
    copy(w.mixed.total, before)
    if math.isnan(approach):
        fill_film(before, 0.0, problem.drive.radius, problem.scale, bodies, w, w.film_change)
        approach = math.inf
        for i in range(p.shape[0]):
            approach = min(approach, w.film_change[i] - h[i])
    forget_factors(w)
    begin_newton(p, h, approach, problem, bodies, w)
    return newton(p, h, approach, problem, bodies, fluid, mass, w)


def steady_on_grid(
    start: Fields, flow: Flow, load: float, bodies: Bodies, fluid: Lubricant, squeeze: float, at_once: bool
) -> Fields | None:
    """The steady film; None where none is found. `at_once`: try the last step first.

    `squeeze`: a rate (m/s) at which the gap is taken to open all along the contact.
    """
    n = start.X.size
    w = workspace(start.mesh)
    scale, line_load = start.scale, load / bodies.length
    transit = scale / abs(flow.velocity)
    p, h = start.p.copy(), start.h.copy()
    before, after = np.empty(n), np.empty(n)
    last = LAST_STEP * transit
    step = last if at_once else FIRST_STEP * transit
    failures = 0
    approach = math.nan
    while True:
        trial_p, trial_h = p.copy(), h.copy()
        problem = FilmProblem(scale, 0.0, flow, line_load, step)
        found = take_step(trial_p, trial_h, approach, problem, bodies, fluid, squeeze, before, w)
        if found.error != 0.0:
            failures += 1
            if failures > MOST_FAILURES:
                return None
            step = SHRINK * step if step < last else FIRST_STEP * transit
            continue
        fill_total(trial_p, trial_h, bodies, after)
        changed = float(np.max(np.abs(after - before))) / float(np.max(after))
        p, h, approach = trial_p, trial_h, found.approach
        if step == last and changed < SETTLED:
            return Fields(start.mesh, start.X, scale, p, h, approach)
        step *= EASY_GROWTH if found.iterations <= EASY_ITERATIONS else HARD_GROWTH
        step = min(step, last)
