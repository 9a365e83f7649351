"""The components of which native FMUs are made in every run of the tests, and the others, which take long."""

from __future__ import annotations

from fmus.native.fmu import NAMES

from ..names import mark_long

EVERY = mark_long(NAMES)
