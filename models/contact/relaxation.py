"""The squeeze term of a film formula as a relaxation (Kushwaha et al. 2000, K 10)."""

import math

from ..compile.kernel import kernel

# C of K (10).
SQUEEZE_CONSTANT = 96.775


@kernel
def relaxation_rate(film: float, steady_film: float, velocity: float, squeeze_constant: float) -> float:
    """dh/dt = -(|u|/C) ln(h/h_ss): K (10) solved for its squeeze velocity; 0 at u = 0.

    Without a steady film (h_ss = 0) the film stays. A film that is not positive and a steady film below zero
    have no rate (nan): an integrator must reject the trial.
    """
    if velocity == 0.0 or steady_film == 0.0:
        return 0.0
    if film <= 0.0 or steady_film < 0.0:
        return math.nan
    return -abs(velocity) / squeeze_constant * math.log(film / steady_film)
