"""Errors of a run. Each message names the thing, what was seen and the remedy."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def one_of(names: Iterable[str], given: object = "") -> str:
    """The end of a message about a choice: all of them, and the one that was probably meant."""
    known = list(names)
    close = difflib.get_close_matches(str(given).lower(), known, n=1)
    return f"must be one of {', '.join(known)}" + (f"; did you mean {close[0]}?" if close else "")


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
