"""Wear by Archard's law where a contact has passed.

At a place the depth grows by dh = k p |u_s| dt with the pressure p of what wears, the sliding velocity u_s
and the dimensional wear coefficient k (m2/N, that is m3 of wear for N m of load times sliding distance). Of a
contact that passes at the speed v of its own over the surface this is k (W/L) |u_s/v|; where it turns round,
its width keeps the depth finite. So every record spreads its dose W |u_s| dt over the surface as the Hertz
pressure does. Profiles and loads are those of the unworn surfaces.
"""

import numpy as np

from ..core.quantities import Vector

# So many numbers at once.
_BLOCK = 1_000_000


def hertz_share(place: Vector) -> Vector:
    """The share of a Hertzian line load left of x/b: 1/2 + (x sqrt(1 - x^2) + arcsin x)/pi."""
    x = np.clip(place, -1.0, 1.0)
    return np.asarray(0.5 + (x * np.sqrt(1.0 - x * x) + np.arcsin(x)) / np.pi)


def worn_depth(edges: Vector, place: Vector, half_width: Vector, dose: Vector, period: float = 0.0) -> Vector:
    """Mean depth over k (N/m) of each bin between `edges` (in units of the place), from records.

    place and half_width of the contact, and the dose W |u_s| dt over the contact length (N), each for one
    record; of places that are angles the dose is over the radius, too. With a `period`, places recur after
    it. What falls outside the edges is lost.
    """
    worn = np.zeros(len(edges) - 1)
    images = (-period, 0.0, period) if period else (0.0,)
    # A contact without load wears nothing, whatever its width.
    width = np.where(half_width > 0.0, half_width, 1.0)
    rows = max(1, _BLOCK // len(edges))
    for first in range(0, len(place), rows):
        part = slice(first, first + rows)
        for shift in images:
            share = hertz_share((edges[None, :] - shift - place[part, None]) / width[part, None])
            worn += dose[part] @ np.diff(share, axis=1)
    return worn / np.diff(edges)


def trapezoidal(time: Vector) -> Vector:
    """The time that each record stands for: weights of the trapezoidal rule."""
    weights = np.zeros_like(time)
    weights[:-1] += 0.5 * np.diff(time)
    weights[1:] += 0.5 * np.diff(time)
    return weights
