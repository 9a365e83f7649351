"""Without a film: elastic bodies that touch where p > 0 and part where the gap > 0.

At the sharp end of a straight profile the pressure of elastic bodies is infinite: there the largest value is
the grid's, and grows without bound as the cells shrink. All else converges.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ....core.quantities import Vector
from ...hertz import half_width
from .contact import FiniteLine, Running
from .faults import out_of_range
from .grid import Grid, Mask, Resolution, axial_faces, even_nodes
from .linear import newton_step
from .reynolds import HERE, PLACES
from .scaled import Scaled
from .solution import Solution

# Enough to know where the load goes and how wide the contact is, to one cell.
_ROUGH = Resolution(nodes_per_half_width=6.0, end_cell=0.4, growth=0.5, fewest_lines=16)
_LARGEST_ROUNDS = 60
# Half of the first window, in half widths of the evenly loaded contact; it grows until it holds the contact.
_FIRST_WINDOW, _WINDOW_GROWTH = 1.6, 1.6
# Shares of the load that narrower lines carry.
_MIDDLE_OF_THE_LOAD = 0.25, 0.75


def touching(problem: Scaled) -> tuple[Vector, float, int]:
    """p >= 0, h0 and the number of rounds: gap 0 where p > 0, gap >= 0 elsewhere, by active sets."""
    hertz: Vector = np.sqrt(np.maximum(1.0 - problem.grid.x[:, None] ** 2, 0.0))
    p: Vector = np.where(problem.open, hertz, 0.0)
    h = problem.gap + problem.space.deflection(p)
    # Two rigid surfaces touch at one point of a crowned or tilted contact, and soft ones about there.
    h0 = -float(np.min(h))
    active = p > 0.0
    for rounds in range(1, _LARGEST_ROUNDS):
        p, h0 = _close_gap(problem, p, h + h0, h0, active)
        h = problem.gap + problem.space.deflection(p)
        now = (p > h + h0) & problem.open
        if np.array_equal(now, active):
            return np.maximum(p, 0.0), h0, rounds
        active = now
    raise out_of_range(
        "load", problem.running.load, "N", "one whose contact is found", "raise or lower nodes_per_half_width"
    )


def _close_gap(problem: Scaled, p: Vector, left: Vector, h0: float, active: Mask) -> tuple[Vector, float]:
    """p and h0 that leave no gap in the active cells, where these leave `left`, and no pressure elsewhere."""
    here = np.zeros((PLACES, *p.shape))
    here[HERE] = 1.0
    dp, dh0 = newton_step(problem.space, left, np.zeros_like(here), here, p, active, problem.carries(p))
    return p + dp, h0 + dh0


def solve_dry_pressure(problem: Scaled, p: Vector, film: Vector) -> tuple[Vector, float]:
    """p >= 0 and h0 whose gap is `film` where p > 0, from a p that is not far from it."""
    h = problem.gap + problem.space.deflection(p)
    active = p > 0.0
    h0 = float(np.median((film - h)[active]))
    found, h0 = _close_gap(problem, p, np.where(active, h + h0 - film, 0.0), h0, active)
    return np.maximum(found, 0.0), h0


@dataclass(frozen=True)
class Carried:
    """Where the load is carried: the half width (m) of a line contact that carries it evenly, the half widths
    between which the middle half of it is, the largest one, and the length (m) that carries it."""

    half_width: float
    narrow: float
    wide: float
    largest: float
    length: float


def find_dry_load(contact: FiniteLine, running: Running) -> Carried:
    """By the dry contact, to a cell of a rough grid."""
    b = half_width(running.load, running.radius, contact.length, contact.compliance)
    window = _FIRST_WINDOW
    while True:
        faces = axial_faces(contact.length / b, 1.0, (), _ROUGH)
        x = even_nodes(-window, window, 1.0 / _ROUGH.nodes_per_half_width)
        problem = Scaled(contact, running, b, Grid(x, faces))
        p, _, _ = touching(problem)
        if not (p[2].any() or p[-2].any()):
            break
        window *= _WINDOW_GROWTH
    per_length = problem.grid.columns @ p
    loads = problem.grid.widths * per_length
    carrying = float(np.sum(loads) ** 2 / np.sum(loads * per_length))  # in units of b
    # The load per length of a line contact of half width 1 is pi/2 in these units.
    widths = b * np.sqrt(per_length / (0.5 * math.pi))
    order = np.argsort(widths)
    shares = np.cumsum(loads[order]) / np.sum(loads)
    narrow, wide = (float(widths[order][np.searchsorted(shares, share)]) for share in _MIDDLE_OF_THE_LOAD)
    typical = b * math.sqrt(problem.load / carrying / (0.5 * math.pi))
    return Carried(typical, narrow, wide, float(widths[order][-1]), b * carrying)


def dry(contact: FiniteLine, running: Running, fine: Resolution | None = None) -> Solution:
    """The elastic contact alone; `running.velocity` has no part. ModelError where it is not found."""
    fine = fine or Resolution()
    found = find_dry_load(contact, running)
    b = found.half_width
    faces = axial_faces(
        contact.length / b, 1.0, tuple(k / b for k in contact.profile.kinks(contact.length)), fine
    )
    edge = 1.3 * found.largest / b
    problem = Scaled(
        contact, running, b, Grid(even_nodes(-edge, edge, 1.0 / fine.nodes_per_half_width), faces)
    )
    p, h0, rounds = touching(problem)
    # Where they touch the gap is 0, but for rounding.
    h = np.where(p > 0.0, 0.0, np.maximum(problem.gap + h0 + problem.space.deflection(p), 0.0))
    return problem.solution(p, h, h0, rounds)
