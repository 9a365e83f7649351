"""Reynolds' equation of a plain bearing by finite differences, with Reynolds' condition of cavitation."""

import math
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve

AROUND, ACROSS = 180, 16


class Film(NamedTuple):
    """Force of the journal on the film, over mu R L^3/c^3, and highest pressure over 3/2 mu L^2/c^3."""

    x: float
    y: float
    highest: float


def solve_film(eps: float, ratio: float, direction: float) -> Film:
    """For a journal at eps along x that squeezes with a unit velocity in this direction; ratio = L/D.

    d/dt(h^3 dp/dt) + d/dy(h^3 dp/dy) = -12 u.n over p in mu R^2/c^3, with p >= 0 where the film is whole: the
    set of wet nodes is sought until none has a negative pressure and no dry one would fill.
    """
    angle = np.arange(AROUND) * 2.0 * math.pi / AROUND
    step, width = angle[1], ratio / ACROSS
    film, between = (1.0 - eps * np.cos(angle)) ** 3, (1.0 - eps * np.cos(angle + 0.5 * step)) ** 3
    source = np.repeat(-12.0 * np.cos(angle - direction), ACROSS)
    node = np.arange(AROUND * ACROSS)
    i, j = np.divmod(node, ACROSS)
    ahead, behind = between[i] / step**2, np.roll(between, 1)[i] / step**2
    aside = film[i] / width**2
    rows, columns = [node, node, node], [node, (i + 1) % AROUND * ACROSS + j, (i - 1) % AROUND * ACROSS + j]
    values = [-ahead - behind - 2.0 * aside, ahead, behind]
    # Half of the width, symmetric about j = 0; beyond the last node is the edge.
    out, inward = j < ACROSS - 1, j > 0
    rows += [node[out], node[inward]]
    columns += [node[out] + 1, node[inward] - 1]
    values += [np.where(j[out] == 0, 2.0, 1.0) * aside[out], aside[inward]]
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    matrix = csr_matrix(entries, shape=(node.size, node.size))
    pressure, wet = np.zeros(node.size), np.ones(node.size, bool)
    for _ in range(100):
        here = np.flatnonzero(wet)
        pressure[:] = 0.0
        pressure[here] = spsolve(matrix[here][:, here].tocsc(), source[here])
        fuller = (wet & (pressure > 0.0)) | (~wet & (source - matrix @ pressure < 0.0))
        if np.array_equal(fuller, wet):
            break
        wet = fuller
    field = pressure.reshape(AROUND, ACROSS)
    weights = np.full(ACROSS, 2.0 * width)
    weights[0] = width
    line = field @ weights * step / (8.0 * ratio**3)
    highest = float(field.max()) / (1.5 * (2.0 * ratio) ** 2)
    return Film(float(line @ np.cos(angle)), float(line @ np.sin(angle)), highest)
