"""Evaluation of one point on a worker."""

from collections.abc import Mapping
from dataclasses import dataclass

import dask

from models.core.remedies import ExplainedError, in_command_line

from ..errors import IncompleteError, MistakeError
from ..scenario.values import Value
from .source import compute_fingerprint, describe_difference
from .subjects import Subject


@dataclass(frozen=True)
class Outcome:
    """The results of a point, or the message of its failure."""

    values: Mapping[str, float | str]
    message: str = ""


def evaluate(subject: Subject, values: Mapping[str, Value], versions: dict[str, str]) -> Outcome | str:
    """The outcome of a point, or why this worker cannot take part.

    Source and libraries here must be those with which the study began (`versions`).
    """
    try:
        found = describe_difference(versions, compute_fingerprint(subject))
    except MistakeError as error:
        return f"cannot take part: {error}"
    if found:
        return f"computes with {found}"
    try:
        with dask.config.set(scheduler="synchronous"):  # else a file that is written asks for a client
            return Outcome(_select_values(subject, subject.evaluate(values)))
    except IncompleteError as error:
        return Outcome(_select_values(subject, error.results), format_message(error))
    except (Exception, SystemExit) as error:
        return Outcome({}, format_message(error))


def _select_values(subject: Subject, results: Mapping[str, float | str]) -> dict[str, float | str]:
    """The declared results that were computed."""
    return {
        name: str(results[name]) if result.text else float(results[name])
        for name, result in subject.results.items()
        if name in results
    }


def format_message(error: BaseException) -> str:
    """The message of an error; of one that is not ours with its type."""
    if isinstance(error, ExplainedError):
        return in_command_line(error)
    return f"{type(error).__name__}: {error}"
