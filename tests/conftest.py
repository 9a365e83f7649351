"""Settings of all tests, and fixtures of all: numbers for manuals, kernels in plain Python."""

import gc
import os
import signal

from hypothesis import settings

from .measurements.page import published
from .plain import plain_kernels
from .shared import shared_folder
from .validation import record

__all__ = ["plain_kernels", "published", "record", "shared_folder"]

# An example that comes first compiles kernels, seconds that say nothing of the test; which one that is
# depends on the tests that ran before in the same process.
settings.register_profile("compiling", deadline=None)
settings.load_profile("compiling")

# numba makes an error for each type that an operator does not take, whose colours nobody sees.
os.environ["NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING"] = "1"

# In the background of a shell, and then in all that tests start, Ctrl-C is ignored unless it is asked for.
signal.signal(signal.SIGINT, signal.default_int_handler)

# Imports and numba make millions of objects, nearly all of them kept: to look for garbage among these after
# every 700 takes a tenth of the time of the tests.
gc.set_threshold(50_000)


def pytest_collection_finish() -> None:
    """What is imported and collected stays, so it is not looked through again."""
    gc.freeze()
