"""What lubricated contacts go through in a run: extremes, separation, impacts, limits left.

Everything is accumulated at every macro step, whatever is recorded.
"""

from .contact_summary import ContactSummaries, ContactSummary, summarise_rows
from .lines import lines
from .observer import ContactObserver, with_angles

__all__ = ["ContactObserver", "ContactSummaries", "ContactSummary", "lines", "summarise_rows", "with_angles"]
