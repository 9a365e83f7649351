"""Constraints that depend on others: they hold the same, or they contradict each other."""

from collections.abc import Sequence

import numpy as np

from ..core.quantities import Vector
from .tables import Rows

# A row of the Jacobian of which less than this share is new depends on the rows before it.
INDEPENDENT = 1e-9
# Share of a row that a row before it has at least where both hold the same.
SHARED = 1e-6
# Difference of two motions that contradict each other over the largest that is asked for: above rounding.
CONTRADICTION = 1e-6


def find_dependent(jacobian: Vector) -> list[int]:
    """The rows that depend on those before them."""
    basis: list[Vector] = []
    found = []
    for k, row in enumerate(jacobian):
        left = row / np.linalg.norm(row) if np.any(row) else row
        for _ in range(2):  # twice is enough
            for direction in basis:
                left = left - (direction @ left) * direction
        size = float(np.linalg.norm(left))
        if size < INDEPENDENT:
            found.append(k)
        else:
            basis.append(left / size)
    return found


def find_contradiction(
    held: Rows, dependent: Sequence[int], names: Sequence[str], drives: Vector
) -> str | None:
    """Rows that ask for two speeds, or drives that ask for two accelerations, told by their names; else None.

    `drives` (m,) is true for the rows of drives. Where a mechanism may go on in two ways, accelerations of
    other rows differ without contradiction.
    """
    jacobian = held.jacobian
    for k in dependent:
        before = [i for i in range(k) if i not in dependent]
        share = np.linalg.lstsq(jacobian[before].T, jacobian[k], rcond=None)[0]
        size = SHARED * np.linalg.norm(jacobian[k])
        others = [
            i for i, c in zip(before, share, strict=True) if abs(c) * np.linalg.norm(jacobian[i]) > size
        ]
        motions = [(held.rate, "speeds")]
        if np.count_nonzero(drives[[k, *others]]) > 1:
            motions.append((-held.gamma, "accelerations"))
        for asked, motion in motions:
            allowed = float(share @ asked[before])
            if abs(asked[k] - allowed) > CONTRADICTION * np.max(np.abs(asked)):
                opposed = "; ".join(names[i] for i in others)
                asks = f"they ask for the {motion} {asked[k]:g} and {allowed:g}"
                return f"{names[k]} contradicts {opposed}: {asks}"
    return None
