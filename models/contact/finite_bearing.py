"""Plain bearing of finite width, in which oil also flows round the journal: its mobility.

Moes' mobility for any L/D (Childs, Moes and van Leeuwen 1977) is the squeeze velocity under a force F, over
c F (c/R)^2/(mu L D). With the components xi and zeta of eps along F and across, and Q = (1 - xi) (D/L)^2,

    M = 0.150 (1 - xi)^3/2 (E, -G),    E = 1 + 2.12 Q,    G = 3 zeta (1 + 3.60 Q)/(4 (1 - xi))

The terms of Q are a fit of the short bearing's mobility, which is exact here. M is the gradient of a
potential k F^2/2, where k is the mobility along F. For L/D = 1 and eps = 0.95 the k of Reynolds' equation
with p >= 0 is 0.9 to 1.4 times his, and films are up to 20 % thinner.

Here k is Moes' times a factor f, a table of that solution (`analysis.bearing`). The squeeze is the gradient
again: it takes power from every motion, and its derivatives by F are symmetric. With the gap
sqrt(1 - eps), sigma = atan((L/D)/(sqrt(2) gap)) over its value for L/D = 1, and the angle theta of F from
eps, stretched near the thin place by tan(alpha/2) = tan(theta/2)/gap^0.7,

    f = 1 + sigma^2 sum T_i(sigma) T_j(gap) (a_ij0 + eps sum a_ijk cos(k alpha))

The table differs from the equation by less than 0.5 % of the squeeze up to eps = 0.95, where least films
differ by less than 0.1 %, by 1.5 % at 0.99 and by 3 % at 0.9991. Above, it keeps its values: at L/D = 1/2
the squeeze differs by 6 % at 0.9997 and by 12 % at 0.9999, the pressure by 19 %.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compile.kernel import kernel
from .finite_bearing_table import PRESSURE, SQUEEZE
from .short_bearing import Squeeze, find_squeeze, highest_pressure

# The table's least sqrt(1 - eps): nearer, f is what it is there.
CLOSEST = 0.03
# The power of the gap by which angles are stretched.
NEARER = 0.7
TERMS = 8, 10, 12
# Of the table's whole numbers, which take a fourth of the room in FMUs.
UNIT = 1e-5


class Factor(NamedTuple):
    """The table's value, and its derivative by the angle of the force."""

    value: float
    slope: float


@kernel
def find_moes_squeeze(force: Squeeze, eps: Squeeze, ratio: float) -> Squeeze:
    """The squeeze u under a force over mu R L^3/c^3 by Moes' formula; `ratio` is L/D."""
    short = find_squeeze(force, eps)
    size = math.sqrt(force.x**2 + force.y**2)
    if size == 0.0:
        return short
    c, s = force.x / size, force.y / size
    open_side = 1.0 - c * eps.x - s * eps.y
    along = 2.0 * ratio**2 * size * 0.150 * open_side * math.sqrt(open_side)
    across = -0.75 * along * (c * eps.y - s * eps.x) / open_side
    return Squeeze(short.x + c * along - s * across, short.y + s * along + c * across)


@kernel
def find_share(ratio: float, gap: float) -> float:
    """sigma, for L/D up to 1."""
    return math.atan(ratio / (math.sqrt(2.0) * gap)) / math.atan(1.0 / (math.sqrt(2.0) * gap))


@kernel
def find_ratio(share: float, gap: float) -> float:
    """L/D, the inverse."""
    return math.sqrt(2.0) * gap * math.tan(share * math.atan(1.0 / (math.sqrt(2.0) * gap)))


def _make_look_up(t: NDArray[np.int32]) -> Callable[[Squeeze, Squeeze, float], Factor]:
    """A kernel for one table, which its code contains."""

    @kernel
    def look_up(force: Squeeze, eps: Squeeze, ratio: float) -> Factor:
        """f, for a force that is not zero."""
        far, size = math.sqrt(eps.x**2 + eps.y**2), math.sqrt(force.x**2 + force.y**2)
        gap = max(math.sqrt(1.0 - far), CLOSEST)
        cos, sin = 1.0, 0.0
        if far > 0.0:
            cos = (eps.x * force.x + eps.y * force.y) / (far * size)
            sin = (eps.x * force.y - eps.y * force.x) / (far * size)
        near = gap ** (2.0 * NEARER)
        denominator = near * (1.0 + cos) + 1.0 - cos
        stretched = (near * (1.0 + cos) - 1.0 + cos) / denominator
        share = find_share(ratio, gap)
        x, y = 2.0 * share - 1.0, (2.0 * gap - 1.0 - CLOSEST) / (1.0 - CLOSEST)
        # sigma^2 T_i, written out as that is several times faster than a loop.
        s0 = share * share
        s1 = s0 * x
        s2 = 2.0 * x * s1 - s0
        s3 = 2.0 * x * s2 - s1
        s4 = 2.0 * x * s3 - s2
        s5 = 2.0 * x * s4 - s3
        s6 = 2.0 * x * s5 - s4
        s7 = 2.0 * x * s6 - s5
        mean, value, slope = 0.0, 0.0, 0.0
        # T_k, and U_(k-1) with dT_k/dx = k U_(k-1).
        cosine, former, sine, less = 1.0, stretched, 0.0, -1.0
        for k in range(TERMS[2]):
            total = 0.0
            by_gap, last = 1.0, y
            for j in range(TERMS[1]):
                a = t[k, j]
                low = (UNIT * a[0] * s0 + UNIT * a[1] * s1) + (UNIT * a[2] * s2 + UNIT * a[3] * s3)
                high = (UNIT * a[4] * s4 + UNIT * a[5] * s5) + (UNIT * a[6] * s6 + UNIT * a[7] * s7)
                total += by_gap * (low + high)
                by_gap, last = 2.0 * y * by_gap - last, by_gap
            if k == 0:
                mean = total
            else:
                value += total * cosine
                slope += k * total * sine
            cosine, former = 2.0 * stretched * cosine - former, cosine
            sine, less = 2.0 * stretched * sine - less, sine
        off = 1.0 - gap * gap
        return Factor(1.0 + mean + off * value, -4.0 * off * slope * near * sin / denominator**2)

    return look_up


find_squeeze_factor, find_pressure_factor = _make_look_up(SQUEEZE), _make_look_up(PRESSURE)


@kernel
def find_finite_squeeze(force: Squeeze, eps: Squeeze, ratio: float) -> Squeeze:
    """The squeeze u under a force over mu R L^3/c^3, as `find_squeeze`; `ratio` is L/D, up to 1."""
    square = force.x**2 + force.y**2
    if square == 0.0:
        return Squeeze(0.0, 0.0)
    moes, f = find_moes_squeeze(force, eps, ratio), find_squeeze_factor(force, eps, ratio)
    turned = 0.5 * f.slope * (moes.x * force.x + moes.y * force.y) / square
    return Squeeze(f.value * moes.x - turned * force.y, f.value * moes.y + turned * force.x)


@kernel
def find_highest_pressure(force: Squeeze, eps: Squeeze, ratio: float) -> float:
    """Over 3/2 mu L^2/c^3: of the short film under the same force, times a table (4 % up to eps = 0.95)."""
    if force.x**2 + force.y**2 == 0.0:
        return 0.0
    return highest_pressure(find_squeeze(force, eps), eps) * find_pressure_factor(force, eps, ratio).value
