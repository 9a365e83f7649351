"""Draws the icons of the FMUs (model.png): python -m fmus.icons"""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Polygon, Rectangle
from PIL import Image

from .build import NAMES

INK, STEEL, OIL = "#1d3557", "#a8b8c8", "#e9a23b"
COLOURS = 64
_LINE: dict[str, Any] = {"edgecolor": INK, "linewidth": 2.5}


def camshaft(axes: Axes) -> None:
    angle = np.linspace(0.0, 2.0 * math.pi, 200)
    radius = 2.2 + 2.0 * np.exp(-(((angle - math.pi / 2.0) / 0.55) ** 2))
    axes.add_patch(
        Polygon(np.c_[5 + radius * np.cos(angle), 3.6 + radius * np.sin(angle)], facecolor=STEEL, **_LINE)
    )
    axes.add_patch(Circle((5, 3.6), 0.8, facecolor="white", **_LINE))
    axes.add_patch(Rectangle((2.4, 7.85), 5.2, 0.9, facecolor=OIL, **_LINE))


def valve_spring(axes: Axes) -> None:
    turns = np.linspace(0.0, 1.0, 400)
    axes.plot(5 + 1.9 * np.sin(turns * 10 * math.pi), 4.2 + 4.2 * turns, color=INK, linewidth=2.5)
    axes.add_patch(Rectangle((2.4, 8.4), 5.2, 0.8, facecolor=OIL, **_LINE))
    axes.plot([5, 5], [1.6, 8.4], color=INK, linewidth=4)
    axes.add_patch(Polygon([(2.4, 0.9), (7.6, 0.9), (5.3, 2.6), (4.7, 2.6)], facecolor=STEEL, **_LINE))


def valve(axes: Axes) -> None:
    axes.plot([5, 5], [3.0, 9.2], color=INK, linewidth=6)
    axes.add_patch(Polygon([(2.2, 1.6), (7.8, 1.6), (5.4, 3.8), (4.6, 3.8)], facecolor=OIL, **_LINE))
    axes.plot([0.8, 2.4], [3.4, 1.9], color=INK, linewidth=4)
    axes.plot([9.2, 7.6], [3.4, 1.9], color=INK, linewidth=4)


def coil_spring(axes: Axes) -> None:
    turns = np.linspace(0.0, 1.0, 400)
    axes.plot(5 + 2.6 * np.sin(turns * 12 * math.pi), 1.6 + 6.8 * turns**1.4, color=INK, linewidth=3)
    axes.add_patch(Rectangle((2.0, 8.4), 6.0, 0.8, facecolor=OIL, **_LINE))
    ground(axes, 1.6)


def shaft(axes: Axes) -> None:
    """A shaft with four cams."""
    axes.add_patch(Rectangle((0.5, 4.6), 9.0, 0.8, facecolor=STEEL, **_LINE))
    for place, side in ((1.6, 1), (3.6, -1), (5.6, 1), (7.6, -1)):
        low = 3.4 if side > 0 else 1.9
        axes.add_patch(Rectangle((place, low), 1.1, 4.7, facecolor=OIL, **_LINE))


def journal_bearing(axes: Axes) -> None:
    """A journal low in its bush."""
    axes.add_patch(Circle((5, 5), 4.2, facecolor=STEEL, **_LINE))
    axes.add_patch(Circle((5, 5), 3.2, facecolor=OIL, **_LINE))
    axes.add_patch(Circle((5.3, 4.5), 2.5, facecolor="white", **_LINE))
    axes.annotate("", (4.6, 5.9), (6.2, 5.6), arrowprops={"arrowstyle": "->", "color": INK, "lw": 2.5})


def tappet(axes: Axes) -> None:
    """A cam under a roller in its guide."""
    angle = np.linspace(0.0, 2.0 * math.pi, 200)
    radius = 1.7 + 1.1 * np.exp(-(((angle - math.pi / 2.0) / 0.6) ** 2))
    axes.add_patch(
        Polygon(np.c_[5 + radius * np.cos(angle), 2.4 + radius * np.sin(angle)], facecolor=STEEL, **_LINE)
    )
    axes.add_patch(Rectangle((4.3, 6.2), 1.4, 3.2, facecolor=OIL, **_LINE))
    axes.add_patch(Circle((5, 6.3), 1.1, facecolor="white", **_LINE))


def finger(axes: Axes) -> None:
    """A lever from its pivot over the cam to the valve."""
    axes.add_patch(Polygon([(1.2, 6.2), (8.8, 6.9), (8.8, 7.9), (1.2, 7.6)], facecolor=OIL, **_LINE))
    axes.add_patch(Circle((1.8, 8.0), 0.9, facecolor="white", **_LINE))
    axes.add_patch(Circle((4.8, 5.5), 1.2, facecolor="white", **_LINE))
    axes.add_patch(Circle((4.8, 2.5), 1.8, facecolor=STEEL, **_LINE))
    axes.plot([8.4, 8.4], [7.9, 9.6], color=INK, linewidth=5)


def multibody_valve_train(axes: Axes) -> None:
    """Cam, follower and a spring mass, with the marks of their joints."""
    axes.add_patch(Circle((5, 2.6), 2.0, facecolor=STEEL, **_LINE))
    axes.plot([2.8, 7.2], [5.0, 5.0], color=INK, linewidth=5)
    axes.plot([5, 5], [5.0, 8.6], color=INK, linewidth=4)
    axes.add_patch(Rectangle((3.7, 7.2), 2.6, 1.6, facecolor=OIL, **_LINE))
    for x, y in ((5, 2.6), (5, 8.0)):
        axes.add_patch(Circle((x, y), 0.5, facecolor="white", **_LINE))
    for side in (2.2, 7.8):
        axes.plot([side, side], [6.6, 9.4], color=INK, linewidth=2.5)


def rod(axes: Axes) -> None:
    axes.add_patch(Rectangle((4.4, 1.6), 1.2, 6.8, facecolor=OIL, **_LINE))
    for height in (3.3, 5.0, 6.7):
        axes.plot([4.4, 5.6], [height, height], color=INK, linewidth=2.0)
    axes.add_patch(Circle((5, 1.3), 0.8, facecolor=STEEL, **_LINE))
    axes.add_patch(Circle((5, 8.7), 0.8, facecolor=STEEL, **_LINE))


def rocker(axes: Axes) -> None:
    axes.add_patch(
        Polygon([(0.9, 4.9), (5, 6.6), (9.1, 4.9), (9.1, 6.0), (5, 7.9), (0.9, 6.0)], facecolor=OIL, **_LINE)
    )
    axes.add_patch(Circle((5, 6.3), 0.8, facecolor="white", **_LINE))
    axes.plot([1.5, 1.5], [0.8, 4.9], color=INK, linewidth=5)
    axes.plot([8.5, 8.5], [0.8, 4.9], color=INK, linewidth=3)


def pivot_friction(axes: Axes) -> None:
    """A pin in the eye of a lever."""
    axes.add_patch(Polygon([(4.4, 1.6), (9.5, 3.6), (9.5, 6.4), (4.4, 8.4)], facecolor=STEEL, **_LINE))
    axes.add_patch(Circle((4.4, 5), 3.4, facecolor=STEEL, **_LINE))
    axes.add_patch(Circle((4.4, 5), 2.0, facecolor=OIL, **_LINE))
    axes.add_patch(Circle((4.4, 5), 1.6, facecolor="white", **_LINE))


def pad_friction(axes: Axes) -> None:
    """A pad that slides to and fro."""
    axes.add_patch(Rectangle((0.7, 0.8), 8.6, 3.0, facecolor=STEEL, **_LINE))
    axes.add_patch(Arc((5, 8.2), 8.0, 8.0, theta1=225, theta2=315, color=INK, linewidth=2.5))
    axes.annotate("", (8.2, 7.0), (1.8, 7.0), arrowprops={"arrowstyle": "<->", "color": INK, "lw": 2.5})


def roller(axes: Axes) -> None:
    """A roller on its pin, with its spin."""
    axes.add_patch(Circle((5, 5), 4.0, facecolor=STEEL, **_LINE))
    axes.add_patch(Circle((5, 5), 1.2, facecolor="white", **_LINE))
    axes.add_patch(Arc((5, 5), 5.2, 5.2, theta1=20, theta2=160, color=INK, linewidth=2.5))
    axes.annotate("", (7.5, 5.6), (7.3, 6.3), arrowprops={"arrowstyle": "->", "color": INK, "lw": 2.5})


def lash_adjuster(axes: Axes) -> None:
    axes.add_patch(Rectangle((2.6, 0.8), 4.8, 6.4, facecolor=STEEL, **_LINE))
    axes.add_patch(Rectangle((3.4, 1.6), 3.2, 2.0, facecolor=OIL, **_LINE))
    axes.add_patch(Rectangle((3.4, 3.6), 3.2, 5.2, facecolor="white", **_LINE))
    axes.add_patch(Circle((5, 3.6), 0.6, facecolor=INK, **_LINE))


def ehl_contact(axes: Axes) -> None:
    axes.add_patch(Circle((5, 7.4), 3.1, facecolor=STEEL, **_LINE))
    axes.add_patch(Rectangle((0.7, 0.8), 8.6, 2.7, facecolor=STEEL, **_LINE))
    axes.add_patch(Rectangle((0.7, 3.5), 8.6, 0.7, facecolor=OIL, edgecolor="none"))
    axes.add_patch(Arc((5, 7.4), 4.2, 4.2, theta1=200, theta2=340, color=INK, linewidth=2.5))
    axes.annotate("", (7.1, 7.1), (6.9, 6.4), arrowprops={"arrowstyle": "->", "color": INK, "lw": 2.5})


def ehl_line_contact(axes: Axes) -> None:
    """The contact, with its pressure over the film."""
    ehl_contact(axes)
    x = np.linspace(-1.0, 1.0, 60)
    axes.plot(5 + 2.6 * x, 0.9 + 2.0 * np.sqrt(1.0 - x**2), color=INK, linewidth=2.5)


def flywheel(axes: Axes) -> None:
    axes.add_patch(Circle((5, 5), 4.1, facecolor=STEEL, **_LINE))
    axes.add_patch(Circle((5, 5), 3.0, facecolor="white", **_LINE))
    for angle in np.arange(6) * math.pi / 3.0:
        axes.plot([5, 5 + 3 * math.cos(angle)], [5, 5 + 3 * math.sin(angle)], color=INK, linewidth=3)
    axes.add_patch(Circle((5, 5), 1.0, facecolor=OIL, **_LINE))


def slider_crank(axes: Axes) -> None:
    axes.add_patch(Circle((2.9, 4), 2.2, facecolor=STEEL, **_LINE))
    pin, wrist = (2.9 + 1.6 * math.cos(1.0), 4 + 1.6 * math.sin(1.0)), (7.7, 4)
    axes.plot([pin[0], wrist[0]], [pin[1], wrist[1]], color=INK, linewidth=4)
    axes.add_patch(Rectangle((6.8, 3.0), 1.9, 2.0, facecolor=OIL, **_LINE))
    axes.plot([5.8, 9.7], [5.3, 5.3], color=INK, linewidth=2.5)
    axes.plot([5.8, 9.7], [2.7, 2.7], color=INK, linewidth=2.5)
    axes.add_patch(Circle(pin, 0.35, facecolor="white", **_LINE))
    axes.add_patch(Circle(wrist, 0.35, facecolor="white", **_LINE))


def tilting_piston(axes: Axes, crank: str) -> None:
    """The slider-crank in section, its piston leaning in the bore."""
    axes.add_patch(Circle((2.6, 4), 2.2, facecolor=crank, **_LINE))
    pin, wrist = (2.6 + 1.6 * math.cos(1.0), 4 + 1.6 * math.sin(1.0)), (7.2, 4)
    corners = np.array([(-1.3, -1.3), (1.5, -1.3), (1.5, 1.3), (-1.3, 1.3)])
    turned = np.array([[math.cos(0.2), -math.sin(0.2)], [math.sin(0.2), math.cos(0.2)]])
    axes.add_patch(Polygon(corners @ turned.T + wrist, facecolor=OIL, **_LINE))
    axes.plot([pin[0], wrist[0]], [pin[1], wrist[1]], color=INK, linewidth=4)
    axes.plot([4.9, 9.7], [5.75, 5.75], color=INK, linewidth=2.5)
    axes.plot([4.9, 9.7], [2.25, 2.25], color=INK, linewidth=2.5)
    axes.add_patch(Circle(pin, 0.35, facecolor="white", **_LINE))
    axes.add_patch(Circle(wrist, 0.35, facecolor="white", **_LINE))


piston_crank = partial(tilting_piston, crank=STEEL)
free_piston_crank = partial(tilting_piston, crank="white")


def cylinder_gas(axes: Axes) -> None:
    volume = np.linspace(1.0, 9.0, 100)
    up, down = 1.2 + 7.5 * (volume[0] / volume) ** 1.3, 1.2 + 0.35 * 7.5 * (volume[0] / volume) ** 1.3
    axes.fill(np.r_[volume, volume[::-1]], np.r_[up, down[::-1]], facecolor=OIL, **_LINE)
    axes.plot([0.7, 0.7, 9.5], [9.3, 0.9, 0.9], color=INK, linewidth=2.5)


def spring(axes: Axes, x: float, low: float, high: float) -> None:
    """A spring drawn as a zigzag."""
    across = np.array([0.0, 0.0, -0.8, 0.8, -0.8, 0.8, -0.8, 0.8, 0.0, 0.0])
    along = np.array([0.0, 0.15, 0.2, 0.32, 0.44, 0.56, 0.68, 0.8, 0.85, 1.0])
    axes.plot(x + across, low + (high - low) * along, color=INK, linewidth=2.5)


def ground(axes: Axes, y: float) -> None:
    axes.plot([0.7, 9.3], [y, y], color=INK, linewidth=4)


def quarter_car(axes: Axes, chassis: str, wheel: str) -> None:
    """Chassis over suspension, wheel, tyre and a stepped road."""
    axes.add_patch(Rectangle((1.6, 7.2), 6.8, 1.9, facecolor=chassis, **_LINE))
    spring(axes, 5, 4.9, 7.2)
    axes.add_patch(Circle((5, 3.4), 1.5, facecolor=wheel, **_LINE))
    axes.plot([0.7, 3.0, 3.0, 9.3], [0.9, 0.9, 1.9, 1.9], color=INK, linewidth=4)


quarter_car_chassis = partial(quarter_car, chassis=OIL, wheel="white")
quarter_car_wheel = partial(quarter_car, chassis="white", wheel=OIL)


def two_masses(axes: Axes, lower: str, upper: str) -> None:
    """One mass on the ground's spring, another one on it."""
    ground(axes, 0.7)
    spring(axes, 5, 0.7, 2.9)
    axes.add_patch(Rectangle((2.7, 2.9), 4.6, 1.9, facecolor=lower, **_LINE))
    spring(axes, 5, 4.8, 7.0)
    axes.add_patch(Rectangle((2.7, 7.0), 4.6, 1.9, facecolor=upper, **_LINE))


coupled_mass = partial(two_masses, lower=OIL, upper="white")
sprung_mass = partial(two_masses, lower="white", upper=OIL)


def bouncing_mass(axes: Axes, mass: str, stop: str) -> None:
    """A ball over a plate on a spring."""
    axes.add_patch(Circle((5, 7.6), 1.6, facecolor=mass, **_LINE))
    axes.add_patch(Rectangle((2.4, 3.6), 5.2, 0.8, facecolor=stop, **_LINE))
    spring(axes, 5, 0.7, 3.6)
    ground(axes, 0.7)


falling_mass = partial(bouncing_mass, mass=OIL, stop="white")
spring_stop = partial(bouncing_mass, mass=STEEL, stop=OIL)


def component(axes: Axes) -> None:
    """Any component without an icon of its own: a body between two connections."""
    axes.plot([0.8, 9.2], [5, 5], color=INK, linewidth=4)
    axes.add_patch(Rectangle((2.8, 2.8), 4.4, 4.4, facecolor=STEEL, **_LINE))
    for x in (0.9, 9.1):
        axes.add_patch(Circle((x, 5), 0.7, facecolor=OIL, **_LINE))


def draw(icon: Callable[[Axes], None], path: Path) -> None:
    """Save the icon as a square image with transparent background, of so few colours that it is small."""
    figure = Figure(figsize=(1.6, 1.6), dpi=100)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0, 10), ylim=(0, 10), aspect="equal")
    axes.axis("off")
    icon(axes)
    drawn = io.BytesIO()
    figure.savefig(drawn, transparent=True)
    Image.open(drawn).quantize(COLOURS, Image.Quantize.FASTOCTREE).save(path, "PNG", optimize=True)


if __name__ == "__main__":
    for name in NAMES:
        draw(globals()[name], Path(__file__).parent / name / "model.png")
    draw(component, Path(__file__).parent / "model.png")
