"""report.html: one page that needs no network, with the animated mechanism and all plots of a run; and the
figures beside it."""

from .page import write_report
from .pictures import draw_anew, draw_pictures

__all__ = ["draw_anew", "draw_pictures", "write_report"]
