"""Assessment of lubricated contacts over a run: extremes, separations, impacts, limits exceeded.

It is accumulated at every macro step, independently of the recorded rows.
"""

from .contact_summary import ContactSummaries, ContactSummary, summarise_rows
from .lines import lines, list_details, name_estimates, name_turn
from .observer import ContactObserver, with_angles

__all__ = [
    "ContactObserver", "ContactSummaries", "ContactSummary", "lines", "list_details", "name_estimates",
    "name_turn", "summarise_rows", "with_angles",
]  # fmt: skip
