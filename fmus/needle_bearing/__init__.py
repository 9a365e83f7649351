"""FMU of the needle bearing."""

from ..pivot_friction import EXPERIMENT, STIMULUS, TERMINALS

__all__ = ["EXPERIMENT", "STIMULUS", "TERMINALS"]
