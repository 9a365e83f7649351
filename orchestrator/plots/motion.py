"""What figures of motions share: axes of angles and parameters, titles, marks and coloured cells."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import FuncFormatter, MultipleLocator

from models.core.quantities import Vector
from models.slider_crank.equations import THESIS_ALPHA, THESIS_BETA, THESIS_XI

from .style import ACCENT, COUPLED, MUTED

MILLI = 1e3


def set_angle_axis(axes: Axes, low: float = 0.0, high: float = 2.0 * math.pi) -> None:
    """An abscissa of crank angle in rad, ticks at parts of pi where it is long enough for some."""
    axes.set_xlim(low, high)
    axes.set_xlabel("crank angle θ (rad)")
    span = (high - low) / math.pi
    if span < 1.0:
        return
    axes.xaxis.set_major_locator(MultipleLocator(math.pi * (0.5 if span <= 4.0 else 1.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda angle, _: format_angle(angle)))


def format_angle(angle: float) -> str:
    """Multiples of pi/2 as they are written: 0, π/2, 3π/2."""
    halves = round(2.0 * angle / math.pi)
    number, denominator = (halves // 2, "") if halves % 2 == 0 else (halves, "/2")
    if number == 0:
        return "0"
    sign, size = "−" if number < 0 else "", abs(number)
    return f"{sign}{'' if size == 1 else size}π{denominator}"


def shift_to_first_turn(theta: Vector) -> Vector:
    """The same angles, counted from the start of the first one's revolution."""
    turn = 2.0 * math.pi
    shifted: Vector = theta - turn * math.floor(theta[0] / turn + 1e-9)
    return shifted


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


def draw_phase(
    axes: Axes, psi: Vector, psi_rate: Vector, impacts: Any, slides: Any = False, walls: Sequence[float] = ()
) -> None:
    """psi' over psi: the trajectory is cut before the rows `impacts`, and its jumps drawn lightly; rows in
    which it `slides` are marked. `walls`: psi of the nearest and the farthest that a wall comes to the
    middle."""
    for distance in walls:
        for sign in (-1.0, 1.0):
            axes.axvline(sign * MILLI * distance, color=MUTED, lw=0.8, ls=(0, (5, 3)))
    axes.vlines(
        MILLI * psi[impacts], psi_rate[impacts - 1], psi_rate[impacts], color=COUPLED, lw=0.5, alpha=0.25
    )
    sliding = np.insert(np.where(slides, psi_rate, np.nan), impacts, np.nan)
    psi, psi_rate = np.insert(psi, impacts, np.nan), np.insert(psi_rate, impacts, np.nan)
    axes.plot(MILLI * psi, psi_rate, color=COUPLED, lw=0.9)
    if np.any(slides):
        axes.plot(MILLI * psi, sliding, color=ACCENT, lw=2.2)
    axes.set_xlabel("ψ (mrad)")
    axes.set_ylabel("ψ′")


LABELS = {
    "damping": "friction of the crank pin λ",
    "gap": "clearance ρ",
    "restitution": "coefficient of restitution e",
    "xi": "crank radius ξ",
    "alpha": "rod mass α",
    "beta": "rod inertia β",
    "sliding_threshold": "sliding threshold ε",
}


def compute_edges(values: Vector) -> Vector:
    """Edges of cells with these equally spaced middles."""
    if len(values) == 1:
        half = 0.5 * abs(values[0]) or 0.5
        return np.array([values[0] - half, values[0] + half])
    half = 0.5 * (values[1] - values[0])
    return np.append(values - half, values[-1] + half)


def draw_cells(figure: Figure, axes: Axes, x: Vector, y: Vector, values: Vector, **style: Any) -> Colorbar:
    """A cell of colour for each of the values (y, x), and the colour bar."""
    axes.grid(False)
    mesh = axes.pcolormesh(compute_edges(x), compute_edges(y), values, rasterized=True, **style)
    return figure.colorbar(mesh, ax=axes, pad=0.02)
