"""The components of which FMUs are made in every run of the tests, and the others, which take long."""

from collections.abc import Iterable

import pytest

from fmus.build import NAMES
from fmus.stimuli import find_stimulus

# Those with impacts, vectors, events in time and plain motion among them.
ALWAYS = ("valve_spring", "slider_crank", "flywheel")

# With internal states, from a file of its own.
LAYER = "tests.models.fluid_layer:fluid_layer"

# Those with reference results.
REFERENCED = tuple(name for name in NAMES if find_stimulus(name))


def mark_long(names: Iterable[str], always: Iterable[str] = ALWAYS) -> list:
    """Parameters of a test, the others than `always` marked as long."""
    return [name if name in always else pytest.param(name, marks=pytest.mark.long) for name in names]
