"""Title of a figure of one machine."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..style import plt

SYMBOLS = {"damping": "λ", "gap": "ρ", "restitution": "e"}


def titled(
    title: str,
    values: Mapping[str, Any],
    width: float,
    height: float,
    rows: int = 1,
    columns: int = 1,
    **more: Any,
) -> tuple[Figure, Any]:
    """Figure and axes; the title stands on the left, with the machine in a second line."""
    figure, axes = plt.subplots(rows, columns, figsize=(width, height + 0.35), **more)
    figure.suptitle(title, x=0.012, ha="left", fontsize=11, fontweight="bold")
    figure.get_layout_engine().set(rect=(0.0, 0.0, 1.0, 1.0 - 0.2 / (height + 0.35)))
    figure.text(
        0.012, 1.0 - 0.33 / (height + 0.35), machine_in_words(values), ha="left", va="center", fontsize=8.5,
        color="#55606b",
    )  # fmt: skip
    return figure, axes


def legend(figure: Figure, axes: Axes) -> None:
    """The legend of these axes beside the title."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="upper right", bbox_to_anchor=(0.995, 1.0), ncols=len(labels), handlelength=1.8
    )


def machine_in_words(values: Mapping[str, Any]) -> str:
    """λ = 0.05, ρ = 0.01, e = 0.9, corrected."""
    parts = [f"{symbol} = {values[name]:g}" for name, symbol in SYMBOLS.items() if name in values]
    return ", ".join([*parts, str(values["form"]).replace("_", " ")])
