"""The components of which native FMUs are made in every run of the tests, and the others, which take long."""

from __future__ import annotations

from fmus.native.fmu import NAMES

from ..names import mark_long

# Machine code of impacts takes longest, that of the contact long: one test has that always.
FAST = ("valve_spring", "flywheel")
EVERY = mark_long(NAMES, FAST)
EVERY_WITH_CONTACT = mark_long(NAMES, (*FAST, "ehl_contact"))
