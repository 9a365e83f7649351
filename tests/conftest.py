"""Settings of all tests."""

from hypothesis import settings

# An example that comes first compiles kernels, seconds that say nothing of the test; which one that is
# depends on the tests that ran before in the same process.
settings.register_profile("compiling", deadline=None)
settings.load_profile("compiling")
