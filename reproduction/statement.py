"""A statement of a source, what the models make of it, and the verdict."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from models.quantities import Vector


class Verdict(StrEnum):
    MET = "met"
    NOT_MET = "not met"
    CANNOT = "cannot be met"
    UNCHECKED = "cannot be checked"


@dataclass(frozen=True)
class Statement:
    """`values`: the computed numbers behind the text, SI unless the name says otherwise.

    `corrected` and `corrected_verdict`: the same from the source's model without its errors, where the
    source's own and the right model differ.
    """

    key: str
    place: str
    text: str
    computed: str
    verdict: Verdict
    reason: str = ""
    values: Mapping[str, float] = field(default_factory=dict)
    corrected: str = ""
    corrected_verdict: Verdict | None = None


def met_if(condition: bool) -> Verdict:
    return Verdict.MET if condition else Verdict.NOT_MET


def near(value: float, stated: float, share: float = 0.01) -> bool:
    """Equal as printed numbers are: to `share` of the stated one."""
    return abs(value - stated) <= share * abs(stated)


def rms(values: Vector) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
