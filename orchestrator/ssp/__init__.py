"""Scenarios as packages of System Structure and Parameterization (SSP 1.0), and the other way."""

from .exported import export
from .imported import contents, unpacked

__all__ = ["contents", "export", "unpacked"]
