"""report.html: one page that needs no network, with the animated mechanism and all plots of a run; and the
figures beside it."""

from .cycle import SAMPLES, Train
from .page import write_cycle, write_report
from .pictures import draw_anew, draw_pictures
from .repetition import repeat

__all__ = ["SAMPLES", "Train", "draw_anew", "draw_pictures", "repeat", "write_cycle", "write_report"]
