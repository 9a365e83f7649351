"""Nahme's film (1940), whose shear heats and thins it, by quadrature with any law of the viscosity."""

import math
from collections.abc import Callable

import numpy as np
from scipy.integrate import quad, simpson, solve_ivp
from scipy.optimize import brentq


def solve_nahme(
    sliding: float, wall: float, conductivity: float, find_viscosity: Callable[[float], float]
) -> tuple[float, float]:
    """Rise (K) in the middle between walls of a given rise, and stress times film over sliding (Pa s).

    int dT/eta(T) from the wall to the middle is u_s^2/(8 k), whatever the film; the stress is int eta du/h,
    where int dT/eta from T to the middle is u^2/(2 k) at u from there.
    """
    wanted = sliding**2 / (8.0 * conductivity)
    highest = wall + 4.0 * wanted * find_viscosity(wall)
    middle = brentq(
        lambda rise: quad(lambda r: 1.0 / find_viscosity(r), wall, rise)[0] - wanted, wall, highest
    )
    u = np.linspace(0.0, 0.5 * sliding, 201)
    # From the middle out, dT/du = -eta u/k.
    path = solve_ivp(
        lambda u, rise: [-find_viscosity(rise[0]) * u / conductivity], (0.0, u[-1]), [middle],
        t_eval=u, rtol=1e-10, atol=1e-10,
    )  # fmt: skip
    assert math.isclose(path.y[0, -1], wall, abs_tol=1e-6)
    return middle, 2.0 * simpson([find_viscosity(rise) for rise in path.y[0]], x=u) / sliding
