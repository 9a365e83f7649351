"""Highest pressure of a plain bearing between axial grooves, by the equations of modes of `grooved_bearing`.

In the middle of the width it is a sum of P for the first three kappa = pi/2, 3 pi/2, 5 pi/2 of the exact
series. Their weights make the sum exact in a wide film, and to two terms of (L/D)^2 in a narrow one:

    sum w = 1,    sum w/kappa^2 = 1/2,    sum w/kappa^4 = 5/24

On finite volumes of tau, elimination from the groove has P_i = a_i P_i+1 + b_i. A mode's film ends at the
first b_i <= 0 (Brennan and Schwartz 1977).
"""

import math
from typing import NamedTuple

from ..compile.kernel import kernel
from .grooved_bearing import Grooves, Pad, find_journal, find_pad, point, see_film, turn
from .short_bearing import Squeeze

SQUARES = tuple((0.5 * math.pi * k) ** 2 for k in (1.0, 3.0, 5.0))


def _weigh(own: float, one: float, two: float) -> float:
    x, y, z = 1.0 / own, 1.0 / one, 1.0 / two
    return (5.0 / 24.0 - 0.5 * (y + z) + y * z) / ((x - y) * (x - z))


MIDDLES = tuple(_weigh(SQUARES[i], SQUARES[i - 1], SQUARES[i - 2]) for i in range(3))
# Along each pad: 2^HALVINGS.
VOLUMES, HALVINGS = 64, 6


class Nodes(NamedTuple):
    """Pressures at three nodes."""

    before: float
    at: float
    after: float


@kernel
def press_mode(pad: Pad, hardness: float, place: int) -> Nodes:
    """P around the node of this number, by P_i = a_i P_i+1 + b_i."""
    step = pad.length / VOLUMES
    a, b, share, after = 0.0, 0.0, 1.0, 0.0
    a_before, b_before, a_at, b_at = 0.0, 0.0, 0.0, 0.0
    at, half = point(pad.begin), point(0.5 * step)
    at = turn(at, half)
    link = 1.0 / (step * see_film(at, pad).ease)
    for i in range(1, VOLUMES):
        at = turn(at, half)
        here = see_film(at, pad)
        at = turn(at, half)
        last, link = link, 1.0 / (step * see_film(at, pad).ease)
        part = 1.0 / (last * (1.0 - a) + link + step * hardness * here.hold)
        a, b = link * part, (last * b + step * here.along) * part
        if b <= 0.0:
            break
        if i == place - 1:
            a_before, b_before = a, b
        elif i == place:
            a_at, b_at = a, b
        elif i > place:
            after += share * b
            share *= a
    pressure = a_at * after + b_at
    return Nodes(a_before * pressure + b_before, pressure, after)


@kernel
def press_pad(pad: Pad, ratio: float) -> float:
    """The highest pressure in the middle of the width, over 3/2 mu L^2/c^3, for a unit squeeze: by halving
    towards the node whose next has less, and a parabola through three."""
    low, place = 0, VOLUMES // 2
    p = Nodes(0.0, 0.0, 0.0)
    for k in range(HALVINGS + 1):
        p = Nodes(0.0, 0.0, 0.0)
        for n in range(3):
            mode, w = press_mode(pad, SQUARES[n] / ratio**2, place), MIDDLES[n]
            p = Nodes(p.before + w * mode.before, p.at + w * mode.at, p.after + w * mode.after)
        if p.after > p.at:
            low = place
        place = low + max(VOLUMES >> (k + 2), 1)
    bent = 2.0 * p.at - p.before - p.after
    top = p.at + (p.after - p.before) ** 2 / (8.0 * bent) if bent > 0.0 else p.at
    return 2.0 * top / ratio**2


@kernel
def find_grooved_pressure(squeeze: Squeeze, eps: Squeeze, grooves: Grooves) -> float:
    """The highest pressure over 3/2 mu L^2/c^3, as `highest_pressure`."""
    size = math.sqrt(squeeze.x**2 + squeeze.y**2)
    if size == 0.0:
        return 0.0
    journal, highest = find_journal(Squeeze(squeeze.x / size, squeeze.y / size), eps), 0.0
    for i in range(4):
        pad = find_pad(i, journal, grooves)
        if pad.share > 0.0:
            highest = max(highest, press_pad(pad, grooves.ratio))
    return size * highest
