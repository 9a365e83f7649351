"""The rise by segments of its acceleration, with unequal flank and nose: the modified trapezoid.

Over x = a/B, with the shares x1 to x4 of the rise and x5 = 1 - x1 - x2 - x3 - x4:

    onset      x1   s'' grows to A as a quarter sine
    flank      x2   s'' = A
    reversal   x3   s'' falls from A to -D as a half cosine
    nose       x4   s'' = -D
    fade       x5   s'' vanishes as a quarter sine; x5 = 0: the deceleration lasts to the nose

A and D follow from the velocity zero and the lift S at the end. This is the family of sine, constant and
cosine acceleration of Norton, Cam Design and Manufacturing Handbook, chapter 3, there with equal sides: 1/8,
1/4, 1/4, 1/4 is the modified trapezoid, 1/4, 0, 1/2, 0 the cycloidal law, 1/8, 0, 3/4, 0 the modified sine.
"""

import math
from typing import Any

from ...compile.kernel import kernel
from .lift import Lift

# Shares whose sum differs from 1 by less leave no fade.
ROUNDING = 1e-12


@kernel
def pulse(x: float, onset: float, hold: float, end: float) -> Lift:
    """An acceleration 1 with its integrals from 0: a quarter sine, constant, then a half cosine to zero."""
    if x < onset:
        k = 0.5 * math.pi / onset
        return Lift((x - math.sin(k * x) / k) / k, (1.0 - math.cos(k * x)) / k, math.sin(k * x))
    ds = 2.0 * onset / math.pi
    s = (onset - ds) * ds
    past = x - onset
    if past < hold:
        return Lift(s + past * (ds + 0.5 * past), ds + past, 1.0)
    s, ds, past = s + hold * (ds + 0.5 * hold), ds + hold, past - hold
    q = math.pi / end
    if past < end:
        return Lift(
            s + past * (ds + 0.25 * past) + 0.5 * (1.0 - math.cos(q * past)) / q**2,
            ds + 0.5 * (past + math.sin(q * past) / q),
            0.5 * (1.0 + math.cos(q * past)),
        )
    s, ds, past = s + end * (ds + 0.25 * end) + 1.0 / q**2, ds + 0.5 * end, past - end
    return Lift(s + past * ds, ds, 0.0)


@kernel
def modified_trapezoid(a: float, rise_angle: float, p: Any) -> Lift:
    """s = S [A U(x) - D (W'(1) x - W(1) + W(1 - x))], U and W the pulses from the foot and from the nose."""
    x, reversal = a / rise_angle, p.reversal_share
    fade = 1.0 - p.onset_share - p.flank_share - reversal - p.nose_share
    if fade < ROUNDING:
        fade = 0.0
    up, down = pulse(x, p.onset_share, p.flank_share, reversal), pulse(1.0 - x, fade, p.nose_share, reversal)
    whole_up = pulse(1.0, p.onset_share, p.flank_share, reversal)
    whole_down = pulse(1.0, fade, p.nose_share, reversal)
    ratio = whole_up.ds / whole_down.ds
    largest = p.lift / (whole_up.s - ratio * (whole_down.ds - whole_down.s))
    least = ratio * largest
    return Lift(
        largest * up.s - least * (whole_down.ds * x - whole_down.s + down.s),
        (largest * up.ds - least * (whole_down.ds - down.ds)) / rise_angle,
        (largest * up.dds - least * down.dds) / rise_angle**2,
    )
