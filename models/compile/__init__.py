"""Compilation of kernels and the cache of compiled code."""

from .processor import choose

choose()  # before a module of this package imports numba
