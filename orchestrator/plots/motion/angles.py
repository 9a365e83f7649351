"""Crank angles on axes."""

import math

from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MultipleLocator

from models.core.quantities import Vector


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
