"""report.html: a run as one page that needs no network, with its mechanism in motion and all its plots."""

from .page import write_report

__all__ = ["write_report"]
