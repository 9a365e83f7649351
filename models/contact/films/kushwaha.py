"""Rahnejat's central film as Kushwaha et al. 2000 print it, equation (10), without its squeeze term.

E = pi / compliance. The printed load exponent is +0.059; physics wants it negative, the size of the film
wants it positive. The squeeze term becomes the relaxation equation of `ehl_contact`.
"""

import math
from typing import Any

from ...compile.kernel import kernel
from .groups import Conditions, groups


def regression(load_power: float) -> Any:
    """The kernel of h = 1.67 R W^load_power U^0.541 G^0.421 (m)."""

    @kernel
    def film(load: float, at: Conditions) -> float:
        g = groups(math.pi / at.compliance, load, at)
        return 1.67 * at.radius * g.load**load_power * g.speed**0.541 * g.material**0.421

    return film


# (K 10) with the exponent as printed, and with its sign changed.
film, negative_film = regression(0.059), regression(-0.059)
