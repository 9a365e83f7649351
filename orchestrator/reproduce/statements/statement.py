"""A statement of the source, what the models make of it, and the verdict."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from models.quantities import Vector

from ..runs import Runs


class Verdict(StrEnum):
    MET = "met"
    NOT_MET = "not met"
    CANNOT = "cannot be met"


@dataclass(frozen=True)
class Statement:
    """`values`: the computed numbers behind the text, SI unless the name says otherwise."""

    key: str
    place: str
    text: str
    computed: str
    verdict: Verdict
    reason: str = ""
    values: Mapping[str, float] = field(default_factory=dict)


Check = Callable[[Runs], Statement]


def met_if(condition: bool) -> Verdict:
    return Verdict.MET if condition else Verdict.NOT_MET


def near(value: float, stated: float, share: float = 0.01) -> bool:
    """Equal as printed numbers are: to `share` of the stated one."""
    return abs(value - stated) <= share * abs(stated)


def rms(values: Vector) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
