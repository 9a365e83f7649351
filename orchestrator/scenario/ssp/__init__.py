"""Export and import of scenarios as packages of System Structure and Parameterization (SSP 1.0 and 2.0)."""

from .reader import read_package, unpack_package
from .writer import VERSIONS, export

__all__ = ["VERSIONS", "export", "read_package", "unpack_package"]
