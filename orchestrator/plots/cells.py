"""The machine's parameters on axes, and coloured cells around their values."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.figure import Figure

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


def draw_cells(figure: Figure, axes: Axes, x: Vector, y: Vector, values: Vector, **style: Any) -> Colorbar:
    """A cell of colour for each of the values (y, x), and the colour bar."""
    axes.grid(False)
    mesh = axes.pcolormesh(compute_edges(x), compute_edges(y), values, rasterized=True, **style)
    return figure.colorbar(mesh, ax=axes, pad=0.02)
