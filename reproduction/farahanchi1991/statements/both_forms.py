"""Claims that F's equation and the right one are both asked for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

from ...statement import Claim, Numbers, Statement
from ..cases import CORRECTED, PUBLISHED, Case
from ..numbers.motions import describe_motion
from ..runs import Runs


@dataclass(frozen=True)
class BothForms(Claim[Runs]):
    """`quantity` gets the form too. The reason is written with the numbers of the published form."""

    def judge(self, runs: Runs) -> Statement:
        own, right = (self.apply(Numbers(self.quantity(runs, form))) for form in (PUBLISHED, CORRECTED))
        values = {**own.values, **{f"corrected_{name}": value for name, value in right.values.items()}}
        return replace(own, values=values, corrected=right.computed, corrected_verdict=right.verdict)


def of_kind(key: str, place: str, text: str, case: Case, kind: str, reason: str = "") -> BothForms:
    """F's word for a case, judged over the starts."""
    reason += "{also}" if reason else "{rule}"
    quantity = partial(describe_motion, case=case)
    return BothForms(key, place, text, quantity, "{words}", lambda v: bool(v.kind == kind), reason)
