"""Hertzian finite line contact (Kushwaha et al. 2000, equations (5)-(9), corrected).

compliance = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 (1/Pa). K (5) reads b/p = 2 R compliance; in K (9) the
printed 4b is twice the axial half length, that is 2 L_c.
"""

import math
from typing import Any

from ..compile.kernel import kernel

# First yield of a line contact is at a largest pressure of 1.67 times the yield stress in tension, by Tresca
# (Johnson, Contact Mechanics, 1985, section 4.2), here of hardened bearing steel, some 1.2 GPa.
ELASTIC_LIMIT = 1.67 * 1.2e9


@kernel
def elastic_compliance(modulus_1: float, poisson_1: float, modulus_2: float, poisson_2: float) -> float:
    """(1 - nu1^2)/E1 + (1 - nu2^2)/E2 in 1/Pa."""
    return (1.0 - poisson_1**2) / modulus_1 + (1.0 - poisson_2**2) / modulus_2


@kernel
def pair_compliance(p: Any) -> float:
    """The same, in kernels, of a record of parameters with moduli and Poisson's ratios of both bodies."""
    return elastic_compliance(p.youngs_modulus_1, p.poissons_ratio_1, p.youngs_modulus_2, p.poissons_ratio_2)


@kernel
def load_and_deflection(film: float, compliance: float, u: Any, p: Any) -> tuple[float, float]:
    """Elastic load (N) and deflection (m) of a contact with a film (m).

    Of the inputs u, the load if p.load_is_given; else the approach, for the film fills the gap.
    """
    radius = u.radius_of_curvature
    if p.load_is_given != 0.0:
        load = max(0.0, u.applied_load)
        return load, deflection(load, radius, p.length, compliance)
    delta = u.approach - u.retreat + film
    return find_load(delta, radius, p.length, compliance), delta


@kernel
def half_width(load: float, radius: float, length: float, compliance: float) -> float:
    """b = sqrt(4 W R compliance / (pi L)) (K 6)."""
    return math.sqrt(4.0 * load * radius * compliance / (math.pi * length))


@kernel
def maximum_pressure(load: float, radius: float, length: float, compliance: float) -> float:
    """p0 = 2 W / (pi b L) (K 7); 0 without load."""
    if load <= 0.0:
        return 0.0
    return 2.0 * load / (math.pi * half_width(load, radius, length, compliance) * length)


@kernel
def _log_factor(radius: float, length: float, compliance: float) -> float:
    """c in delta = a W (c - ln(W) / 2), for W in newtons."""
    return math.log(2.0 * length / half_width(1.0, radius, length, compliance)) + 0.5


@kernel
def deflection(load: float, radius: float, length: float, compliance: float) -> float:
    """delta = b p0 compliance [ln(2 L / b) + 1/2] (K 9); 0 without load."""
    if load <= 0.0:
        return 0.0
    a = 2.0 * compliance / (math.pi * length)
    return a * load * (_log_factor(radius, length, compliance) - 0.5 * math.log(load))


@kernel
def find_load(delta: float, radius: float, length: float, compliance: float) -> float:
    """The load W >= 0 whose deflection is `delta`, by Newton's method to rounding; 0 for delta <= 0.

    The deflection rises with the load up to where b = 2 L exp(-1/2): no line contact any more, and no load
    has a larger one. Beyond b = L, where it is L^2 (ln 2 + 1/2)/(2 R), the load goes on along the tangent.
    """
    if delta <= 0.0:
        return 0.0
    c = _log_factor(radius, length, compliance)
    target = delta * math.pi * length / (2.0 * compliance)
    widest = math.pi * length**3 / (4.0 * radius * compliance)
    edge = c - 0.5 * math.log(widest)
    if target >= widest * edge:
        return widest + (target - widest * edge) / (edge - 0.5)
    # W (c - ln(W)/2) is increasing and concave: Newton from the left converges monotonically.
    load = target / c if target < 1.0 else target / max(c - 0.5 * math.log(target), 1.0)
    for _ in range(60):
        log_term = c - 0.5 * math.log(load)
        change = (target - load * log_term) / (log_term - 0.5)
        load += change
        if abs(change) <= 4e-16 * load:
            break
    return load


@kernel
def elastic_energy(load: float, radius: float, length: float, compliance: float) -> float:
    """Integral of W d(delta) at fixed radius: a W^2 (c - ln(W)/2 - 1/4) / 2."""
    if load <= 0.0:
        return 0.0
    a = 2.0 * compliance / (math.pi * length)
    c = _log_factor(radius, length, compliance)
    return 0.5 * a * load**2 * (c - 0.5 * math.log(load) - 0.25)
