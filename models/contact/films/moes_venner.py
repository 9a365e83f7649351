"""Minimum film of Moes and Venner: a fit between the four asymptotes of the line contact."""

import math

from ...compile.kernel import kernel
from .groups import Conditions, groups


@kernel
def moes_film(M: float, L: float) -> float:
    """H(M, L) = {[(0.99 M^-1/8 L^3/4 t)^r + (2.05 M^-1/5)^r]^(s/r) + (2.45 / M)^s}^(1/s).

    r = exp(1 - 3/(L+4)), s = 3 - exp(-1/(2M)), t = 1 - exp(-3.5 M^1/8 L^-1/4).
    """
    r = math.exp(1.0 - 3.0 / (L + 4.0))
    s = 3.0 - math.exp(-0.5 / M)
    t = 1.0 - math.exp(-3.5 * M**0.125 * L**-0.25) if L > 0.0 else 1.0
    piezoviscous = 0.99 * M**-0.125 * L**0.75 * t
    elastic = 2.05 * M**-0.2
    rigid = 2.45 / M
    return ((piezoviscous**r + elastic**r) ** (s / r) + rigid**s) ** (1.0 / s)


@kernel
def film(load: float, at: Conditions) -> float:
    """h = R H(M, L) U_S^1/2 with U_S = 2 U, M = W U_S^-1/2, L = G U_S^1/4, E' = 2 / compliance; 0 at rest."""
    g = groups(2.0 / at.compliance, load, at)
    u_sum = 2.0 * g.speed
    if u_sum == 0.0:
        return 0.0
    return at.radius * math.sqrt(u_sum) * moes_film(g.load / math.sqrt(u_sum), g.material * u_sum**0.25)
