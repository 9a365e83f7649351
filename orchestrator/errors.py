"""Errors of a run. Each message names the thing, what was seen and the remedy."""

from __future__ import annotations


class RunError(Exception):
    """A coupled run that cannot go on; what was computed before it is valid."""


class ParticipantError(RunError):
    """A participant refused a call, failed, or gave values that are not numbers."""


class UnstableCouplingError(RunError):
    """Exchanged values run away from their own prediction: the macro step is too large for the master."""


class NonConvergenceError(RunError):
    """The iteration of a macro step did not reach its tolerance."""


class MistakeError(ValueError):
    """What was asked for cannot be done; nothing was run or written."""
