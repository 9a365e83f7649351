"""The inlet of a loaded contact, in which its film forms."""

from __future__ import annotations

from ...compile.kernel import kernel


@kernel
def inlet_width(half_width: float, film: float, radius: float) -> float:
    """b (2 R h/b^2)^(2/3) (m): at a distance s from the edge the gap of the dry contact is some
    (b^2/2R) (s/b)^(3/2), and in the inlet it is of the size of the film."""
    return half_width * (2.0 * radius * film / half_width**2) ** (2.0 / 3.0)
