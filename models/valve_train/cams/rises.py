"""Laws of the rise of a cam: the lift s and its derivatives over the cam angle a in (0, B).

To add one: a kernel, listed in `RISES`. All laws but the harmonic one begin with s'' = 0.
Norton, Cam Design and Manufacturing Handbook, chapters 2 to 4.
"""

import math
from typing import Any

from ...compile.kernel import kernel
from .lift import Lift
from .trapezoid import modified_trapezoid


@kernel
def cycloidal(a: float, rise_angle: float, p: Any) -> Lift:
    """s = S [a/B - sin(2 pi a/B) / (2 pi)] (Kushwaha et al. 2000, equation 31)."""
    w = 2.0 * math.pi / rise_angle
    return Lift(
        p.lift * (a / rise_angle - math.sin(w * a) / (2.0 * math.pi)),
        p.lift / rise_angle * (1.0 - math.cos(w * a)),
        p.lift / rise_angle * w * math.sin(w * a),
    )


@kernel
def polynomial_345(a: float, rise_angle: float, p: Any) -> Lift:
    """s = S (10 x^3 - 15 x^4 + 6 x^5), x = a/B."""
    x, ds = a / rise_angle, p.lift / rise_angle
    return Lift(
        p.lift * x**3 * (10.0 + x * (6.0 * x - 15.0)),
        ds * 30.0 * x**2 * (1.0 - x) ** 2,
        ds / rise_angle * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
    )


@kernel
def polynomial_4567(a: float, rise_angle: float, p: Any) -> Lift:
    """s = S (35 x^4 - 84 x^5 + 70 x^6 - 20 x^7), x = a/B: no jump of s'''."""
    x, ds = a / rise_angle, p.lift / rise_angle
    return Lift(
        p.lift * x**4 * (35.0 + x * (-84.0 + x * (70.0 - 20.0 * x))),
        ds * 140.0 * x**3 * (1.0 - x) ** 3,
        ds / rise_angle * 420.0 * x**2 * (1.0 - x) ** 2 * (1.0 - 2.0 * x),
    )


@kernel
def modified_sine(a: float, rise_angle: float, p: Any) -> Lift:
    """s'' of quarter sines: period B/2 up to B/8, 3B/2 in between, B/2 again from 7B/8."""
    x, ds = a / rise_angle, p.lift / rise_angle / (math.pi + 4.0)
    dds = ds / rise_angle * 4.0 * math.pi**2
    if 0.125 <= x <= 0.875:
        turned = math.pi / 3.0 * (1.0 + 4.0 * x)
        return Lift(
            p.lift / (math.pi + 4.0) * (2.0 + math.pi * x - 2.25 * math.sin(turned)),
            ds * math.pi * (1.0 - 3.0 * math.cos(turned)),
            dds * math.sin(turned),
        )
    turned = 4.0 * math.pi * x
    offset = 0.0 if x < 0.5 else 4.0
    return Lift(
        p.lift / (math.pi + 4.0) * (offset + math.pi * x - 0.25 * math.sin(turned)),
        ds * math.pi * (1.0 - math.cos(turned)),
        dds * math.sin(turned),
    )


@kernel
def harmonic(a: float, rise_angle: float, p: Any) -> Lift:
    """s = S (1 - cos(pi a/B)) / 2: s'' jumps at both ends."""
    w = math.pi / rise_angle
    return Lift(
        0.5 * p.lift * (1.0 - math.cos(w * a)),
        0.5 * p.lift * w * math.sin(w * a),
        0.5 * p.lift * w * w * math.cos(w * a),
    )


@kernel
def add_power(
    total: Lift, n: float, others: tuple[float, float, float, float], x: float, rise: float
) -> Lift:
    """The total with C_n x^n, x = 1 - a/B; C_n = -prod m/(m - n) over the other powers m."""
    k, l, m, o = others
    c = -(k / (k - n)) * (l / (l - n)) * (m / (m - n)) * (o / (o - n))
    return Lift(
        total.s + c * x**n,
        total.ds - c * n * x ** (n - 1.0) / rise,
        total.dds + c * n * (n - 1.0) * x ** (n - 2.0) / (rise * rise),
    )


@kernel
def high_powers(a: float, rise_angle: float, p: Any) -> Lift:
    """s = S (1 + C_2 x^2 + C_p x^p + C_q x^q + C_r x^r + C_t x^t), x = 1 - a/B.

    At its foot s and four derivatives vanish.
    """
    x = 1.0 - a / rise_angle
    n, q, r, t = p.power_p, p.power_q, p.power_r, p.power_t
    cam = add_power(Lift(1.0, 0.0, 0.0), 2.0, (n, q, r, t), x, rise_angle)
    cam = add_power(cam, n, (2.0, q, r, t), x, rise_angle)
    cam = add_power(cam, q, (2.0, n, r, t), x, rise_angle)
    cam = add_power(cam, r, (2.0, n, q, t), x, rise_angle)
    cam = add_power(cam, t, (2.0, n, q, r), x, rise_angle)
    return Lift(p.lift * cam.s, p.lift * cam.ds, p.lift * cam.dds)


# The order is the number of the law in FMUs: append only.
RISES: dict[str, Any] = {
    "cycloidal": cycloidal,
    "polynomial_345": polynomial_345,
    "polynomial_4567": polynomial_4567,
    "modified_sine": modified_sine,
    "harmonic": harmonic,
    "high_powers": high_powers,
    "modified_trapezoid": modified_trapezoid,
}


def _choose(number: int, rise: Any, others: Any) -> Any:
    @kernel
    def rise_by_number(law: float, a: float, rise_angle: float, p: Any) -> Lift:
        if law == number:
            return rise(a, rise_angle, p)
        return others(law, a, rise_angle, p)

    return rise_by_number


def _rise_by_number() -> Any:
    *others, last = enumerate(RISES.values())
    chosen = _choose(*last, _unknown)
    for number, rise in reversed(others):
        chosen = _choose(number, rise, chosen)
    return chosen


@kernel
def _unknown(law: float, a: float, rise_angle: float, p: Any) -> Lift:
    return Lift(0.0, 0.0, 0.0)


# rise_by_number(law, a, rise_angle, p) -> Lift
rise_by_number = _rise_by_number()
