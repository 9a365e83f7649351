"""report.html: one page that needs no network, with the animated mechanism and all plots of a run."""

from .page import write_report

__all__ = ["write_report"]
