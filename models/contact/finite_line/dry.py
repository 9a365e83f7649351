"""Without a film: elastic bodies that touch where p > 0 and part where the gap > 0.

At the sharp end of a straight profile the pressure of elastic bodies is infinite: there the largest value is
the grid's, and grows without bound as the cells shrink. All else converges.
"""

from __future__ import annotations

import math

import numpy as np

from ...quantities import Vector
from ..hertz import half_width
from .contact import FiniteLine, Running
from .faults import within
from .grid import Grid, Resolution, axial_faces, even_nodes
from .linear import newton_step
from .reynolds import HERE, PLACES
from .scaled import Scaled
from .solution import Solution

# Enough to know where the load goes and how wide the contact is, to one cell.
_ROUGH = Resolution(nodes_per_half_width=6.0, end_cell=0.4, growth=0.5, fewest_lines=16)
_LARGEST_ROUNDS = 60
# Half of the first window, in half widths of the evenly loaded contact; it grows until it holds the contact.
_FIRST_WINDOW, _WINDOW_GROWTH = 1.6, 1.6


def touching(problem: Scaled) -> tuple[Vector, float, int]:
    """p >= 0, h0 and the number of rounds: gap 0 where p > 0, gap >= 0 elsewhere, by active sets."""
    hertz: Vector = np.sqrt(np.maximum(1.0 - problem.grid.x[:, None] ** 2, 0.0))
    p: Vector = np.where(problem.open, hertz, 0.0)
    h = problem.gap + problem.space.deflection(p)
    # Two rigid surfaces touch at one point of a crowned or tilted contact, and soft ones about there.
    h0 = -float(np.min(h))
    active = p > 0.0
    here = np.zeros((PLACES, *p.shape))
    here[HERE] = 1.0
    for rounds in range(1, _LARGEST_ROUNDS):
        dp, dh0 = newton_step(problem.space, h + h0, np.zeros_like(here), here, p, active, problem.carries(p))
        p, h0 = p + dp, h0 + dh0
        h = problem.gap + problem.space.deflection(p)
        now = (p > h + h0) & problem.open
        if np.array_equal(now, active):
            return np.maximum(p, 0.0), h0, rounds
        active = now
    raise within(
        "load", problem.running.load, "N", "one whose contact is found", "use a finer or coarser Resolution"
    )


def widths(contact: FiniteLine, running: Running) -> tuple[float, float, float]:
    """Half width (m) where the load is carried, the largest one, and the length (m) that carries it."""
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
    along = p.sum(axis=0)
    loads = problem.grid.widths * along
    carrying = float(np.sum(loads) ** 2 / np.sum(loads * along))  # in units of b
    per_length = problem.load / carrying
    # The load per length of a line contact of half width 1 is pi/2 in these units.
    typical = b * math.sqrt(per_length / (0.5 * math.pi))
    largest = b * math.sqrt(float(np.max(along)) * problem.grid.spacing / (0.5 * math.pi))
    return typical, largest, b * carrying


def dry(contact: FiniteLine, running: Running, fine: Resolution | None = None) -> Solution:
    """The elastic contact alone; `running.velocity` has no part. ModelError where it is not found."""
    fine = fine or Resolution()
    b, largest, _ = widths(contact, running)
    faces = axial_faces(
        contact.length / b, 1.0, tuple(k / b for k in contact.profile.kinks(contact.length)), fine
    )
    edge = 1.3 * largest / b
    problem = Scaled(
        contact, running, b, Grid(even_nodes(-edge, edge, 1.0 / fine.nodes_per_half_width), faces)
    )
    p, h0, rounds = touching(problem)
    h = np.maximum(problem.gap + h0 + problem.space.deflection(p), 0.0)
    return problem.solution(p, h, h0, rounds)
