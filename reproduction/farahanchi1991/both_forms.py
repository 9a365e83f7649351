"""Claims that F's equation and the right one are both asked for."""

from dataclasses import dataclass, replace
from functools import partial

from ..statement import Claim, Numbers, Statement
from .force import check_symmetry
from .motions import describe_motion
from .runs import CORRECTED, PUBLISHED, Case, Runs


@dataclass(frozen=True)
class BothForms(Claim[Runs]):
    """`quantity` gets the form too. The reason is written with the numbers of the published form."""

    def judge(self, runs: Runs) -> Statement:
        own, right = (self.apply(Numbers(self.quantity(runs, form))) for form in (PUBLISHED, CORRECTED))
        values = {**own.values, **{f"corrected_{name}": value for name, value in right.values.items()}}
        return replace(own, values=values, corrected=right.computed, corrected_verdict=right.verdict)


def of_kind(place: str, text: str, case: Case, kind: str, reason: str = "") -> BothForms:
    """F's word for a case, judged over the starts."""
    key = f"{case.damping:g}-{case.gap:g}" if case.restitution == 0.9 else f"e-{case.restitution:g}"
    reason += "{also}" if reason else "{rule}"
    quantity = partial(describe_motion, case=case)
    return BothForms(f"kind-{key}", place, text, quantity, "{words}", lambda v: bool(v.kind == kind), reason)


def of_symmetry(
    key: str, text: str, damping: float, gap: float, broken: bool = False, reason: str = ""
) -> BothForms:
    """What F says of the wall forces' symmetry: (i) of the two walls, (ii) of half a turn; exact, but for
    rounding, or broken."""
    quantity = partial(check_symmetry, damping=damping, gap=gap, half_turn="(ii)" in text)
    computed = "sum up to {fault:.2g} of the largest force"
    return BothForms(key, "2.6", text, quantity, computed, lambda v: (v.fault >= 1e-9) == broken, reason)
