"""Every statement of F that can be computed or contradicts another, in F's order."""

from __future__ import annotations

from ...statement import Claim
from ..runs import Runs
from . import chapters_1_to_3, chapters_4_and_5

CLAIMS: tuple[Claim[Runs], ...] = (*chapters_1_to_3.CLAIMS, *chapters_4_and_5.CLAIMS)
