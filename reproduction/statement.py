"""Statements of a source: a table of claims, the models' numbers for each, and the verdict."""

import string
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Generic, TypeVar

import numpy as np

from models.core.quantities import Vector

Runs = TypeVar("Runs")
# What a quantity finds, by name.
Values = dict[str, Any]


class Verdict(StrEnum):
    MET = "met"
    NOT_MET = "not met"
    CANNOT = "cannot be met"


@dataclass(frozen=True)
class Statement:
    """`values`: the computed numbers behind text and verdict, SI unless the name says otherwise.

    `corrected` and `corrected_verdict`: the same from the source's model without its errors, where the
    source's own and the right model differ.
    """

    key: str
    place: str
    text: str
    computed: str
    verdict: Verdict
    reason: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)
    corrected: str = ""
    corrected_verdict: Verdict | None = None


class Numbers:
    """The values of a quantity, as attributes; `read` are those that a claim has used."""

    def __init__(self, found: Values) -> None:
        self._found = found
        self.read: Values = {}

    def __getattr__(self, name: str) -> Any:
        self.read[name] = self._found[name]
        return self._found[name]

    def values(self) -> Values:
        """The finite numbers that were read."""
        arrays = {name: np.asarray(value) for name, value in self.read.items()}
        return {n: a.tolist() for n, a in arrays.items() if a.dtype.kind in "iuf" and np.isfinite(a).all()}


class NumberFormatter(string.Formatter):
    """Format strings with lists ({loads:.0f}), prefixes ({film:µ.3f} µm), {share:.1f%} and {angles:.1f°}."""

    PREFIXES: Mapping[str, float] = {"µ": 1e6, "m": 1e3, "G": 1e-9}

    def get_value(self, key: int | str, args: Sequence[Any], kwargs: Mapping[str, Any]) -> Any:
        return getattr(args[0], str(key))

    def format_field(self, value: Any, spec: str) -> str:
        if isinstance(value, Sequence) and not isinstance(value, str):
            return ", ".join(self.format_field(item, spec) for item in value)
        if spec[:1] in self.PREFIXES:
            return format(self.PREFIXES[spec[0]] * value, spec[1:])
        if spec.endswith("°"):
            return format(value, spec[:-1]) + "°"
        return f"{100.0 * value:{spec[:-1]}} %" if spec.endswith("%") else format(value, spec)


def format_numbers(text: str, numbers: object) -> str:
    """A format string (see NumberFormatter) with these attributes."""
    return NumberFormatter().vformat(text, (numbers,), {})


@dataclass(frozen=True)
class Claim(Generic[Runs]):
    """A statement of the source, as a row of a table.

    `text`, `computed` and `reason` are format strings (see NumberFormatter) of the numbers that `quantity`
    finds; `criterion` decides from them whether the statement is met, or is the verdict itself.
    """

    key: str
    place: str
    text: str
    quantity: Callable[..., Values]
    computed: str
    criterion: Verdict | Callable[[Numbers], bool]
    reason: str = ""

    def judge(self, runs: Runs) -> Statement:
        return self.apply(Numbers(self.quantity(runs)))

    def apply(self, found: Numbers) -> Statement:
        """The statement with these numbers."""
        text, computed, reason = (format_numbers(s, found) for s in (self.text, self.computed, self.reason))
        verdict = self.criterion
        if callable(verdict):
            verdict = Verdict.MET if verdict(found) else Verdict.NOT_MET
        return Statement(self.key, self.place, text, computed, verdict, reason, found.values())


def state_verdict(
    key: str, place: str, text: str, computed: str, verdict: Verdict, reason: str = ""
) -> Claim[Any]:
    """A claim that is judged without numbers."""
    return Claim(key, place, text, lambda runs: {}, computed, verdict, reason)


def is_near(value: float, stated: float, share: float = 0.01) -> bool:
    """Equal as printed numbers are: to `share` of the stated one."""
    return abs(value - stated) <= share * abs(stated)


def rms(values: Vector) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def is_rising(values: Sequence[float]) -> bool:
    """Each larger than the one before."""
    return bool(np.all(np.diff(values) > 0.0))
