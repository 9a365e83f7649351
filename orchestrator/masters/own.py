"""Masters of a user's own: what they raise, or return that is no MasterStep, is told with file and line."""

import functools
import inspect
import traceback
from pathlib import Path
from typing import Any

from models.core.remedies import ExplainedError

from ..errors import RunError
from .protocol import MasterStep


def explain_steps(kind: type[Any], name: str) -> type[Any]:
    """The class whose `step` raises RunError for such mistakes; `name` is that of the scenario."""
    step = kind.step
    if hasattr(step, "__wrapped__"):
        return kind

    @functools.wraps(step)
    def explained(self: Any, *given: Any) -> MasterStep:
        try:
            done = step(self, *given)
        except ExplainedError:
            raise
        except Exception as error:
            file = inspect.getsourcefile(kind)
            lines = [one.lineno for one in traceback.extract_tb(error.__traceback__) if one.filename == file]
            place = f"{Path(file).name}, line {lines[-1]}: " if file and lines else ""
            raise RunError(f"{name}: {place}{type(error).__name__}: {error}", "correct its step") from error
        if not isinstance(done, MasterStep):
            raise RunError(
                f"{name}: its step returned {done!r:.60}",
                "return a MasterStep(iterations, predicted), as orchestrator.masters.protocol says",
            )
        return done

    kind.step = explained
    return kind
