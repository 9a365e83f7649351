"""FMU of the needle bearing."""

from ..pivot_friction import STIMULUS

__all__ = ["STIMULUS"]
