"""The components of which native FMUs are made in every run of the tests, and the others, which take long."""

from __future__ import annotations

from fmus.native.fmu import NAMES

from ..names import mark_long

# Machine code of impacts takes longest: one test has it always.
FAST = ("valve_spring", "ehl_contact", "flywheel")
EVERY = mark_long(NAMES, FAST)
EVERY_WITH_IMPACTS = mark_long(NAMES, (*FAST, "slider_crank"))
