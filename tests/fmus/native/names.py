"""The components of which native FMUs are made in every run of the tests, and the others, which take long."""

from __future__ import annotations

import pytest

from fmus.native.fmu import NAMES

# Those with impacts, vectors, events in time, a formula's choice and plain motion among them.
ALWAYS = ("camshaft", "valve_spring", "ehl_contact", "slider_crank", "flywheel")

EVERY = [name if name in ALWAYS else pytest.param(name, marks=pytest.mark.long) for name in NAMES]
