"""The lift of a cam and its derivatives by the cam angle. The nose is at pi."""

from typing import NamedTuple


class Lift(NamedTuple):
    """Lift s (m) and its derivatives s' (m/rad), s'' (m/rad^2) by the cam angle."""

    s: float
    ds: float
    dds: float
