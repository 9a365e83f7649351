"""Settings of all tests, and the fixture that records numbers for the validation manual."""

from hypothesis import settings

from .validation import record

__all__ = ["record"]

# An example that comes first compiles kernels, seconds that say nothing of the test; which one that is
# depends on the tests that ran before in the same process.
settings.register_profile("compiling", deadline=None)
settings.load_profile("compiling")
