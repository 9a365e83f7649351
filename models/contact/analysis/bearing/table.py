"""The table of `contact.finite_bearing`, from Reynolds' equation.

`python -m models.contact.analysis.bearing.table` writes it, in some minutes.
"""

import math
import sys
import textwrap
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from ... import finite_bearing as place
from ...short_bearing import Squeeze, find_squeeze, highest_pressure
from .reynolds import Array, Grid, Solution, solve

# Points along each axis; directions of squeeze.
POINTS, DIRECTIONS = (12, 12), 20
GRIDS = (160, 12), (80, 6)


class Answer(NamedTuple):
    """What a squeeze needs: the angle of its force from eps; the squeeze of a unit force over mu R L^3/c^3
    along it and across (anticlockwise), and its highest pressure over 3/2 mu L^2/c^3."""

    angle: float
    along: float
    across: float
    highest: float


def describe(found: Solution, direction: float) -> Answer:
    """Of a unit squeeze in this direction from eps (rad)."""
    (x, y), ratio = found.force, found.grid.ratio
    size, angle = math.hypot(x, y), math.atan2(y, x) % (2.0 * math.pi)
    along, across = math.cos(direction - angle) / size, math.sin(direction - angle) / size
    return Answer(angle, along, across, found.highest / (6.0 * ratio**2 * size))


def estimate(eps: float, ratio: float, angle: float) -> Answer:
    """Of a force at an angle from eps, by the formula without a table."""
    force, at = Squeeze(1.0, 0.0), Squeeze(eps * math.cos(angle), -eps * math.sin(angle))
    found = place.find_moes_squeeze(force, at, ratio)
    return Answer(angle, found.x, found.y, highest_pressure(find_squeeze(force, at), at))


def gauss(count: int) -> Array:
    return np.asarray(np.cos(math.pi * (np.arange(count) + 0.5) / count))


def fit_angles(grid: Grid, gap: float) -> Array:
    """Coefficients of cos(k alpha) of what multiplies Moes' squeeze and the short film's pressure, less 1: of
    the squeeze by its value and its slope, which the squeeze across the force tells."""
    near, degrees = gap**place.NEARER, np.arange(place.TERMS[2])
    squeezes, slopes, pressures, turns = [], [], [], []
    last = None
    for turn in np.linspace(0.0, math.pi, DIRECTIONS):
        angle = 2.0 * math.atan2(near * math.sin(0.5 * turn), math.cos(0.5 * turn))
        guess = estimate(grid.eps, grid.ratio, angle)
        direction = angle + math.atan2(guess.across, guess.along)
        found = solve(grid, direction, last.wet if last else None)
        last, exact = found, describe(found, direction)
        moes = estimate(grid.eps, grid.ratio, exact.angle)
        half = 0.5 * exact.angle
        stretch = near / ((near * math.cos(half)) ** 2 + math.sin(half) ** 2)
        value = exact.along / moes.along
        squeezes.append(value - 1.0)
        slopes.append(2.0 * (exact.across - value * moes.across) / (moes.along * stretch))
        pressures.append(exact.highest / moes.highest - 1.0)
        turns.append(2.0 * math.atan2(math.sin(half), near * math.cos(half)))
    angles = np.array(turns)[:, None] * degrees
    cosines, sines = np.cos(angles), -degrees * np.sin(angles)
    both = np.linalg.lstsq(np.vstack([cosines, sines]), np.array([*squeezes, *slopes]))[0]
    return np.array([both, np.linalg.lstsq(cosines, np.array(pressures))[0]])


def sample(around: int, across: int) -> Array:
    """Of squeeze and pressure, by share of the width, by gap, by k."""
    found = np.zeros((2, *POINTS, place.TERMS[2]))
    for j, gap in enumerate(0.5 * (1.0 + place.CLOSEST + (1.0 - place.CLOSEST) * gauss(POINTS[1]))):
        for i, share in enumerate(0.5 * (1.0 + gauss(POINTS[0]))):
            grid = Grid(1.0 - gap**2, place.find_ratio(share, gap), around=around, across=across)
            found[:, i, j] = fit_angles(grid, gap)
        print(f"gap {gap:.3f}", file=sys.stderr, flush=True)
    return found


def fit(found: Array) -> Array:
    """Least squares, axis by axis, of the sums in `contact.finite_bearing`."""
    terms, share, gap = place.TERMS, 0.5 * (1.0 + gauss(POINTS[0])), gauss(POINTS[1])
    eps = 1.0 - (0.5 * (1.0 + place.CLOSEST + (1.0 - place.CLOSEST) * gap)) ** 2
    by_share = np.linalg.pinv(chebvander(2.0 * share - 1.0, terms[0] - 1) * share[:, None] ** 2)
    by_gap = chebvander(gap, terms[1] - 1)
    parts = np.einsum("pi,ijk->pjk", by_share, found)
    mean = np.einsum("qj,pj->pq", np.linalg.pinv(by_gap), parts[:, :, 0])
    rest = np.einsum("qj,pjk->pqk", np.linalg.pinv(by_gap * eps[:, None]), parts[:, :, 1:])
    return np.concatenate([mean[:, :, None], rest], 2).T


def write(tables: dict[str, Array], path: Path) -> None:
    """As a module, in units of 1e-5."""
    made = "Made by `models.contact.analysis.bearing.table`: factors of Chebyshev polynomials, in 1e-5."
    lines = [f'"""{made}"""', "", "import numpy as np", ""]
    for name, table in tables.items():
        numbers = textwrap.wrap(" ".join(str(round(1e5 * value)) for value in table.ravel()), 108)
        shape = ", ".join(map(str, table.shape))
        lines += [f"{name} = np.fromstring(", '    """', *numbers, '""",']
        lines += ["    dtype=np.int32,", '    sep=" ",', f").reshape({shape})"]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    # The errors of the grids are of second order.
    fine, coarse = (sample(around, across) for around, across in GRIDS)
    squeeze, pressure = fine + (fine - coarse) / 3.0
    tables = {"SQUEEZE": fit(squeeze), "PRESSURE": fit(pressure)}
    write(tables, Path(place.__file__).with_name("finite_bearing_table.py"))


if __name__ == "__main__":
    main()
