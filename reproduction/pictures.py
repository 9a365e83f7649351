"""Figures small enough for a repository."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image

from orchestrator.plots.style import save_figure

PALETTE = 128


def save_compact(make: Callable[[], Figure], path: Path, dpi: float | None = None) -> Path:
    """Save a figure in a palette, in which line drawings lose nothing."""
    save_figure(make, path, dpi)
    Image.open(path).convert("RGB").quantize(PALETTE).save(path, optimize=True)
    return path
