"""The look of all figures."""

import math
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context, rcParams
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from .data import FigureData

COUPLED, REFERENCE, ACCENT, MUTED = "#0b5fa5", "#d1495b", "#2a9d5c", "#8d99a6"

RPM = 30.0 / math.pi
TITLE: dict[str, Any] = {"x": 0.012, "ha": "left", "fontsize": 11, "fontweight": "bold"}

# Input signals of masters.
SIGNALS = {"hold": MUTED, "linear": ACCENT, "quadratic": COUPLED, "hermite": REFERENCE}

RC: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.labelsize": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e3e7eb",
    "grid.linewidth": 0.7,
    "lines.linewidth": 1.3,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "figure.dpi": 100,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 200,
}

# Curves that stay below this in their units are zero but for rounding.
NOTHING = 1e-12


def save_figure(make: Callable[[], Figure], path: Path, dpi: float | None = None) -> Path:
    """Make the figure in this style and save it, with the style's dots per inch where none are given."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with rc_context(RC):
        figure = make()
        figure.set_dpi(dpi or rcParams["savefig.dpi"])
        # `savefig` would go through the layout twice.
        FigureCanvasAgg(figure).print_png(path, pil_kwargs={"compress_level": 3})
    return path


def create_subplots(
    rows: int = 1,
    columns: int = 1,
    title: str = "",
    figsize: tuple[float, float] | None = None,
    **create_panels: Any,
) -> tuple[Figure, Any]:
    """A figure with a title on the left, and its panels; without pyplot, so that no window or notebook shows
    it."""
    figure = Figure(figsize=figsize, layout=_Layout())
    if title:
        figure.suptitle(title, **TITLE)
    return figure, figure.subplots(rows, columns, **create_panels)


def create_grid(
    count: int, columns: int, title: str, size: tuple[float, float], margin: float, **options: Any
) -> tuple[Figure, list[Axes]]:
    """A figure and so many panels, row by row. `size` (inches): width, and height of a row, besides the
    height of a `margin`."""
    rows = math.ceil(count / columns)
    figsize = (size[0], size[1] * rows + margin)
    figure, axes = create_subplots(rows, columns, title, figsize, squeeze=False, **options)
    panels = list(axes.flat)
    for panel in panels[count:]:
        panel.remove()
    for panel in panels[max(0, count - columns) : count]:
        panel.tick_params(labelbottom=True)
    return figure, panels[:count]


def list_handles(axes: Iterable[Axes]) -> dict[str, Any]:
    """What legends of these axes have, each label once."""
    return {
        label: handle for ax in axes for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
    }


class _Layout(ConstrainedLayoutEngine):
    """Constrained layout, then the labels of the ordinates of each column of panels in one line.

    matplotlib's `align_ylabels` measures the whole column again for each of its panels.
    """

    def execute(self, fig: Any) -> None:
        super().execute(fig)
        columns: dict[Any, list[Axes]] = {}
        for ax in fig.axes:
            if (place := ax.get_subplotspec()) and ax.get_visible() and ax.get_ylabel():
                columns.setdefault((place.get_gridspec(), place.colspan.start), []).append(ax)
        places: dict[Axes, float] = {}
        for column in columns.values():
            for ax in column:
                ax.yaxis.get_tightbbox()  # moves the label beside its ticks
            left = min(ax.yaxis.label.get_position()[0] - ax.bbox.x0 for ax in column)
            places |= dict.fromkeys(column, left)
        _place_labels(places)
        if any(ax.yaxis.label.get_window_extent().x0 < 0.0 for ax in places):
            # One of several lines is wider than the room that it got beside its own ticks.
            super().execute(fig)
            _place_labels(places)


def _place_labels(places: Mapping[Axes, float]) -> None:
    """At these distances from the left side of their panels, in pixels."""
    for ax, left in places.items():
        ax.yaxis.set_label_coords(left / ax.bbox.width, 0.5)


def create_panels(rows: int, data: FigureData, title: str, height: float = 1.75) -> tuple[Figure, Any]:
    """Create panels over a common abscissa."""
    figsize = (6.8, 0.9 + height * rows)
    figure, axes = create_subplots(rows, 1, title, figsize, sharex=True, squeeze=False)
    axes = axes[:, 0]
    label_abscissa(axes[-1], data)
    return figure, axes


def label_abscissa(axes: Axes, data: FigureData) -> None:
    """Set label, limits and ticks of the abscissa."""
    variable, label = data.abscissa()
    ends = data.x()[[0, -1]]
    axes.set_xlabel(label)
    if variable:
        quarters = 90.0 * np.round(ends / 90.0)  # bent shafts and rounding end within a hair of them
        ends = np.where(np.abs(ends - quarters) < 1e-3 * np.ptp(ends), quarters, ends)
        turns = (ends[1] - ends[0]) / 360.0
        if turns >= 0.75:  # of less, the multiples of 90 degrees would be few or none
            axes.xaxis.set_major_locator(
                MultipleLocator(90.0 if turns <= 3.0 else 180.0 if turns <= 6.0 else 720.0)
            )
    axes.set_xlim(*ends)


def plot_both(axes: Axes, data: FigureData, name: str, words: str) -> None:
    """Draw the coupled run over a wider reference, so that both are seen where they agree."""
    factor, _ = data.shown(name)
    if name in data.reference:
        axes.plot(
            data.x(True), factor * data.reference[name], color=REFERENCE, alpha=0.55, lw=3.2,
            solid_capstyle="round", label=data.names[1],
        )  # fmt: skip
    axes.plot(data.x(), factor * data.coupled[name], color=COUPLED, lw=1.1, label=data.names[0])
    axes.set_ylabel(data.label(name, words))
    widen_zero(axes)


def widen_zero(axes: Axes) -> None:
    """Give curves that are zero but for rounding an ordinate to 1."""
    limits = axes.dataLim
    if np.abs(limits.intervaly).max() < NOTHING:
        axes.update_datalim(((limits.x0, -1.0), (limits.x0, 1.0)))


def shade(axes: Axes, data: FigureData, contact: str) -> None:
    """Shade where contact is lost."""
    shade_where(axes, data, data.lost(contact))


def shade_where(axes: Axes, data: FigureData, lost: NDArray[np.bool_]) -> None:
    """Shade the records that are marked as lost contact."""
    if lost.any():
        axes.fill_between(
            data.x(), 0.0, 1.0, where=lost, color=MUTED, alpha=0.25, lw=0.0, label="contact lost",
            transform=axes.get_xaxis_transform(),
        )  # fmt: skip


def add_legend_above(axes: Axes, columns: int = 2, **options: Any) -> None:
    """Add a legend above the panel, on the right."""
    place = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.2, "handlelength": 1.8}
    axes.legend(ncols=columns, **{**place, **options})


def write_remark(axes: Axes, text: str) -> None:
    """Above a panel, on the right."""
    axes.set_title(text, loc="right", fontsize=7.5, color="0.35", pad=2.0)
