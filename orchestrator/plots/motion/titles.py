"""Title of a figure of one machine."""

from collections.abc import Mapping
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from models.slider_crank.equations import THESIS_ALPHA, THESIS_BETA, THESIS_XI

# Inches for both lines.
TITLE = 0.45
MACHINE = {"fontsize": 8.5, "color": "#55606b"}
SYMBOLS = {"damping": "λ", "gap": "ρ", "restitution": "e"}
# Said where they are not these.
USUAL = {
    "xi": ("ξ", THESIS_XI),
    "alpha": ("α", THESIS_ALPHA),
    "beta": ("β", THESIS_BETA),
    "sliding_threshold": ("ε", 0.0),
}


def create_figure(
    title: str, values: Mapping[str, Any], width: float, height: float, mosaic: Any = "A", **more: Any
) -> tuple[Figure, Any]:
    """Figure and its axes, by name where `mosaic` (as matplotlib's) has several; the title stands on the
    left, with the machine in a second line."""
    layout = ConstrainedLayoutEngine(rect=(0.0, 0.0, 1.0, 1.0 - TITLE / (height + TITLE)))
    figure = Figure(figsize=(width, height + TITLE), layout=layout)
    axes = figure.subplot_mosaic(mosaic, **more)
    lines: Any = (
        (title, 0.06, {"fontsize": 11, "fontweight": "bold"}),
        (describe_machine(values), 0.27, MACHINE),
    )
    for text, below, look in lines:
        figure.text(0.012, 1.0 - below / (height + TITLE), text, ha="left", va="top", **look)
    return figure, axes if len(axes) > 1 else axes["A"]


def add_legend(figure: Figure, axes: Axes) -> None:
    """The legend of these axes beside the title."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="upper right", bbox_to_anchor=(0.995, 1.0), ncols=len(labels), handlelength=1.8
    )


def drop_varied(values: Mapping[str, Any], *axes: str) -> dict[str, Any]:
    """The values without the parameters that vary along these axes."""
    varied = {values[axis] for axis in axes}
    return {name: value for name, value in values.items() if name not in varied}


def describe_machine(values: Mapping[str, Any]) -> str:
    """λ = 0.05, ρ = 0.01, e = 0.9, corrected."""
    parts = [f"{symbol} = {values[name]:g}" for name, symbol in SYMBOLS.items() if name in values]
    parts += [
        f"{symbol} = {values[name]:g}"
        for name, (symbol, usual) in USUAL.items()
        if values.get(name, usual) != usual
    ]
    return ", ".join([*parts, str(values["form"]).replace("_", " ")])
