"""How a statement is judged in both forms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import NamedTuple

from ...statement import Statement, Verdict, met_if
from ..cases import CORRECTED, PUBLISHED
from ..runs import Runs

Check = Callable[[Runs], Statement]
__all__ = ["Check", "Found", "Statement", "Verdict", "in_both_forms", "met_if"]
NOTHING: Mapping[str, float] = MappingProxyType({})


class Found(NamedTuple):
    """What one form makes of a statement."""

    text: str
    verdict: Verdict
    values: Mapping[str, float] = NOTHING


def in_both_forms(
    key: str, place: str, text: str, judge: Callable[[str], Found], reason: str = ""
) -> Statement:
    """The statement judged as published and corrected."""
    first, second = judge(PUBLISHED), judge(CORRECTED)
    values = dict(first.values) | {f"corrected_{name}": value for name, value in second.values.items()}
    return Statement(key, place, text, first.text, first.verdict, reason, values, second.text, second.verdict)
