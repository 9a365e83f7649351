"""Heat of shear in the inlet thins the oil there, and so the film.

Gupta, Cheng, Zhu, Forster and Schrand (1992), Tribology Transactions 35, 269, a fit to thermal solutions:

    phi_T = [1 - 13.2 (p0/E') L^0.42]/[1 + 0.213 (1 + 2.23 S^0.83) L^0.64]
    L = beta eta0 u^2/k,    S = |u_s/u|,    E' = 2/compliance

with the largest Hertz pressure p0, the coefficient beta = -d ln(eta0)/dT of the oil and its conductivity k.
"""

from ..compile.kernel import kernel

# Least numerator. The fit crosses zero at loads and speeds far beyond the solutions behind it.
_LEAST = 0.1


@kernel
def thermal_reduction(
    pressure: float, velocity: float, sliding: float, compliance: float, viscosity: float,
    temperature_viscosity: float, conductivity: float,
) -> float:  # fmt: skip
    """phi_T, the share of the isothermal film that is left: 1 at rest.

    Largest pressure p0 (Pa), entraining velocity u and sliding velocity u_s (m/s), compliance (1/Pa),
    viscosity eta0 (Pa s), beta (1/K), k (W/(m K)).
    """
    if velocity == 0.0:
        return 1.0
    loading = temperature_viscosity * viscosity * velocity**2 / conductivity
    sliding_ratio = abs(sliding / velocity)
    pressed = 1.0 - 13.2 * 0.5 * pressure * compliance * loading**0.42
    sheared = 1.0 + 0.213 * (1.0 + 2.23 * sliding_ratio**0.83) * loading**0.64
    return max(_LEAST, pressed) / sheared
