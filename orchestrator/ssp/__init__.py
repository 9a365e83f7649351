"""Scenarios as packages of System Structure and Parameterization (SSP 1.0), and the other way."""

from .exported import export
from .imported import read_package, unpack_package

__all__ = ["export", "read_package", "unpack_package"]
