"""Diagnosis of a run: what limited its steps, the effort by participant, and suggestions."""

from .facts import Facts
from .numbers import Diagnosis, Interval, Limit, Share, diagnose_steps
from .report import brief, full
from .steps import Steps, read_steps, read_written_steps
from .suggestions import RULES, suggestions

__all__ = [
    "RULES", "Diagnosis", "Facts", "Interval", "Limit", "Share", "Steps", "brief", "diagnose_steps", "full",
    "read_steps", "read_written_steps", "suggestions",
]  # fmt: skip
