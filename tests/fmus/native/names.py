"""The components of which native FMUs are made in every run of the tests, and the others, which take long."""

from fmus.native.fmu import NAMES

from ..names import mark_long

# With vectors and rates. Machine code of impacts and of the contact takes long.
FAST = ("valve_spring",)
EVERY = mark_long(NAMES, FAST)
