"""Plain bearings under a steady load: load, attitude, friction, flow, and the answer to small motions."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from .reynolds import ACROSS, AROUND, Array, Grid, Solution, apply, solve

# A steady journal squeezes the film at a right angle to eps, with omega eps/2 (anticlockwise).
WEDGE = -0.5 * math.pi
# Of axial grooves on both sides of the load.
SIDES = (-0.5 * math.pi, 0.5 * math.pi)
# Their width (rad).
GROOVE = math.radians(20.0)


@dataclass(frozen=True)
class Steady:
    """Under the load W at the speed N: S = mu N L D/W (R/c)^2, the angle between load and eps, the torque
    over W c, the flow over both edges over R c N L, the highest pressure over W/(L D), and what a motion adds
    to the force on the film, along the load and across it (anticlockwise): K over W/c, B over W/(c omega).
    """

    sommerfeld: float
    attitude: float
    friction: float
    side_flow: float
    peak: float
    stiffness: Array
    damping: Array


def solve_steady(
    eps: float, ratio: float, grooves: Sequence[float] = (), around: int = AROUND, across: int = ACROSS
) -> Steady:
    """Of a bearing with grooves at angles (rad) from the load, none by default; ratio = L/D."""

    def at(attitude: float) -> Solution:
        places = tuple(at - attitude for at in grooves)
        return solve(Grid(eps, ratio, places, around, across, GROOVE), WEDGE)

    def turned(attitude: float) -> float:
        x, y = at(attitude).force
        return math.atan2(-y, x) - attitude

    found = at(brentq(turned, 0.02, 1.65, xtol=1e-6) if grooves else 0.0)
    return describe_steady(found)


def describe_steady(found: Solution) -> Steady:
    """In units of c, with omega = 2."""
    grid, force = found.grid, found.grid.eps * found.force
    load, eps = float(np.hypot(*force)), grid.eps
    attitude = math.atan2(-force[1], force[0])
    sommerfeld = 1.0 / (2.0 * math.pi * load * grid.ratio**2)
    shear = 2.0 * math.pi**2 * sommerfeld / math.sqrt(1.0 - eps**2)
    by_place, by_squeeze = _list_slopes(found)
    # The squeeze of a turning journal, -k x eps, changes with its place.
    stiffness = eps * by_place - by_squeeze @ np.array([[0.0, -1.0], [1.0, 0.0]])
    x, y = force / load
    axes = np.array([[x, y], [-y, x]])
    # What leaves the last volumes, and what is squeezed out between them and the edge.
    strip = (grid.ratio - grid.heights[0].sum()) / grid.heights[0][-1]
    squeezed = np.where(found.wet, grid.squeezed(WEDGE), 0.0)[:, -1]
    edge = 2.0 * ((grid.resistance[2] * found.pressure)[:, -1] + strip * squeezed).sum()
    return Steady(
        sommerfeld,
        attitude,
        shear + 0.5 * eps * math.sin(attitude),
        eps * math.pi * edge / (24.0 * grid.ratio),
        # In mu R^2/c^3, over W/(L D) = mu R L^3/c^3 load/(2 R L).
        eps * found.highest / (2.0 * load * grid.ratio**2),
        axes @ stiffness @ axes.T / load,
        2.0 * axes @ by_squeeze @ axes.T / load,
    )


def _list_slopes(found: Solution) -> tuple[Array, Array]:
    """Of the force by eps, at a unit squeeze, and by the squeeze: exact for the equations of the grid."""
    grid = found.grid
    angles = grid.between, grid.angle
    by_place, by_squeeze = [], []
    for of in (np.cos, np.sin):
        links = grid.links(*(-3.0 * grid.film(at) ** 2 * of(at) for at in angles))
        by_place.append(grid.force(found.respond(-apply(links, found.pressure))))
        by_squeeze.append(grid.force(found.respond(12.0 * of(grid.angle)[:, None] * grid.weights)))
    return np.array(by_place).T, np.array(by_squeeze).T
