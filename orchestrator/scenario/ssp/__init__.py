"""Export and import of scenarios as packages of System Structure and Parameterization (SSP 1.0)."""

from .reader import read_package, unpack_package
from .writer import export

__all__ = ["export", "read_package", "unpack_package"]
