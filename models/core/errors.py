"""The one family of errors: each is a mistake of the user, or the failure of a run."""

from .remedies import ExplainedError


class MistakeError(ExplainedError, ValueError):
    """What was asked for cannot be done; nothing was run or written."""


class ModelError(MistakeError):
    """A system that cannot be built or evaluated."""


class RunError(ExplainedError):
    """A run that cannot go on; what was computed before it is valid."""
