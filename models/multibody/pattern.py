"""Which unknowns of the stabilised form appear in which of its equations, for its matrix by differences."""

from typing import Any, NamedTuple

import numpy as np
from scipy import sparse

from ..core.quantities import Vector
from .tables import Tables

# Least steps of the differences: of coordinates (m, rad) and velocities, films (m) and multipliers (N, N m).
STEPS = (1e-9, 1e-13, 1.0)


class Pattern(NamedTuple):
    """Entries of the matrix by columns, and groups of columns that have no row in common."""

    starts: Any  # (columns + 1,), where a column begins in `rows`
    rows: Any
    first: Any  # (colours + 1,), where a colour begins in `columns`
    columns: Any
    steps: Vector  # least differences, (columns,)


def find_pattern(tables: Tables) -> Pattern:
    """The pattern for y = (q, v, h, lambda, mu); see `make_residual`."""
    bodies, held, films = len(tables.mass), len(tables.rows), len(tables.touches) - len(tables.presses)
    size = 6 * bodies
    first = 2 * size + films
    found: list[list[Any]] = [[], []]

    def join(equations: Any, unknowns: Any) -> None:
        rows, columns = np.meshgrid(np.asarray(equations, int), np.asarray(unknowns, int), indexing="ij")
        found[0].append(rows.ravel())
        found[1].append(columns.ravel())

    def list_places(body: int) -> Any:
        return np.arange(6 * (body - 1), 6 * body)

    def list_ends(row: Any) -> list[int]:
        return [body for body in (int(row["i"]), int(row["j"])) if body > 0]

    for body in range(1, bodies + 1):
        own = list_places(body)
        join(np.r_[own, size + own], np.r_[own, size + own])
    for row in (*tables.rows, *tables.touches, *tables.springs, *tables.fields):
        for one in list_ends(row):
            for other in list_ends(row):
                join(size + list_places(one), np.r_[list_places(other), size + list_places(other)])
    for k, row in enumerate(tables.rows):
        for body in list_ends(row):
            own = list_places(body)
            join([first + k], np.r_[own, size + own])
            join([first + held + k], own)
            join(size + own, [first + k])
            join(own, [first + held + k])
    for k, row in enumerate(tables.touches[:films]):
        join([2 * size + k], [2 * size + k])
        for body in list_ends(row):
            own = list_places(body)
            join([2 * size + k], np.r_[own, size + own])
            join(size + own, [2 * size + k])
    rows, columns = (np.concatenate(part) for part in found)
    width = first + 2 * held
    matrix = sparse.coo_matrix((np.ones(rows.size), (rows, columns)), (width, width)).tocsc()
    matrix.sort_indices()
    colours = _colour(matrix)
    order = np.argsort(colours, kind="stable")
    return Pattern(
        starts=matrix.indptr.astype(np.int64),
        rows=matrix.indices.astype(np.int64),
        first=np.searchsorted(colours[order], np.arange(colours.max() + 2)),
        columns=order,
        steps=np.repeat(STEPS, [2 * size, films, 2 * held]),
    )


def _colour(matrix: Any) -> Any:
    """The first colour of each column that no column with a row in common has yet."""
    taken: list[set[int]] = [set() for _ in range(matrix.shape[0])]
    colours = np.zeros(matrix.shape[1], int)
    for column in range(matrix.shape[1]):
        rows = matrix.indices[matrix.indptr[column] : matrix.indptr[column + 1]]
        used = set().union(*(taken[row] for row in rows))
        colour = 0
        while colour in used:
            colour += 1
        colours[column] = colour
        for row in rows:
            taken[row].add(colour)
    return colours
