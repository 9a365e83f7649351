"""The alternative to the line contact's factors: bands as preconditioner of a Krylov method."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from scipy.linalg import solve_banded
from scipy.sparse.linalg import LinearOperator, gmres

from models.contact.line.newton import deflection_factors
from models.contact.line.transient import wanted_scale

from .line_contact import BODIES, Turn, build_drives

# Flank, a reversal and the nose (degrees of the cam).
ANGLES = (112.0, 168.0, 180.0)
NODES = (301, 701)
BANDS = 2
# As Newton's method asks of pressures.
TOLERANCE = 1e-6


def assemble_jacobian(nodes: int, angle: float) -> np.ndarray:
    """A + B D of the step that ends at this cam angle, rows scaled by their largest element."""
    turn = Turn(nodes, 0.1)
    turn.run(95.0, angle)
    w, at = turn.w, build_drives(math.radians(angle), 0.0)
    scale = wanted_scale(at.line_load, float(turn.h[nodes // 2]), at.flow.radius, BODIES)
    factor, offset = deflection_factors(scale, BODIES)
    deflections = factor * (w.D.T + offset * w.weight)
    whole = expand_bands(w.A) + expand_bands(w.B) @ deflections
    cavitated = w.fixed != 0.0
    whole[cavitated] = np.eye(nodes)[cavitated]
    return whole / np.abs(whole).max(axis=1, keepdims=True)


def expand_bands(bands: np.ndarray) -> np.ndarray:
    """From element k of row i for column i + k - 2."""
    nodes, reach = bands.shape[1], len(bands) // 2
    whole = np.zeros((nodes, nodes + 2 * reach))
    for k, band in enumerate(bands):
        whole[np.arange(nodes), np.arange(nodes) + k] = band
    return whole[:, reach:-reach]


def count_iterations(whole: np.ndarray) -> int:
    """Iterations of GMRES with the bands of the matrix as preconditioner."""
    nodes = len(whole)
    bands = np.zeros((2 * BANDS + 1, nodes))
    for k in range(-BANDS, BANDS + 1):
        diagonal = np.diag(whole, k)
        bands[BANDS - k, max(k, 0) : nodes + min(k, 0)] = diagonal
    inverse = LinearOperator(whole.shape, matvec=lambda v: solve_banded((BANDS, BANDS), bands, v))
    count = []
    right = np.random.default_rng(0).standard_normal(nodes)
    _, failed = gmres(
        whole, right, M=inverse, rtol=TOLERANCE, restart=nodes, callback=count.append, callback_type="pr_norm"
    )
    if failed:
        raise RuntimeError(f"GMRES did not converge in {len(count)} iterations")
    return len(count)


def measure() -> Iterator[tuple[str, str]]:
    """Figures and their values."""
    for nodes in NODES:
        found = ", ".join(
            f"{count_iterations(assemble_jacobian(nodes, angle))} at {angle:g} degrees" for angle in ANGLES
        )
        yield (
            f"line contact, {nodes} nodes: GMRES iterations for a correction with {2 * BANDS + 1} bands as "
            "preconditioner",
            found,
        )
