"""The machine's parameters on axes, and cells around their values."""

from __future__ import annotations

import numpy as np

from models.core.quantities import Vector

LABELS = {
    "damping": "friction of the crank pin λ",
    "gap": "clearance ρ",
    "restitution": "coefficient of restitution e",
    "xi": "crank radius ξ",
    "alpha": "rod mass α",
    "beta": "rod inertia β",
    "sliding_threshold": "sliding threshold ε",
}


def compute_edges(values: Vector) -> Vector:
    """Edges of cells with these equally spaced middles."""
    if len(values) == 1:
        half = 0.5 * abs(values[0]) or 0.5
        return np.array([values[0] - half, values[0] + half])
    half = 0.5 * (values[1] - values[0])
    return np.append(values - half, values[-1] + half)
