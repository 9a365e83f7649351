"""Stiffness and damping of a round beam between two frames, K (33), Q (2)."""

import math
from typing import Any

from ..compile.kernel import kernel
from ..core.quantities import Vector

# Coordinates that a beam along x couples in each plane of bending.
PLANES = ((1, 5), (2, 4))


@kernel
def fill_beam_stiffness(
    length: float, diameter: float, youngs_modulus: float, poissons_ratio: float, shear_factor: float, k: Any
) -> None:
    """K (6, 6) of a round Timoshenko beam along x, P = 12 E I A_y/(G A L^2); `shear_factor` A_y 0: Euler."""
    area, second = math.pi * diameter**2 / 4.0, math.pi * diameter**4 / 64.0
    shear_modulus = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
    bending = youngs_modulus * second
    p = 12.0 * bending * shear_factor / (shear_modulus * area * length**2)
    k[:, :] = 0.0
    k[0, 0] = youngs_modulus * area / length
    k[1, 1] = k[2, 2] = 12.0 * bending / (length**3 * (1.0 + p))
    k[3, 3] = 2.0 * shear_modulus * second / length
    k[4, 4] = k[5, 5] = (4.0 + p) * bending / (length * (1.0 + p))
    side = 6.0 * bending / (length**2 * (1.0 + p))
    k[1, 5] = k[5, 1] = -side
    k[2, 4] = k[4, 2] = side


@kernel
def fill_modal_damping(k: Any, masses: Vector, ratio: float, c: Any) -> None:
    """C (6, 6) = 2 zeta M^1/2 A^1/2 M^1/2, A = M^-1/2 K M^-1/2, of a beam whose planes of bending are apart.

    The root of a 2 x 2 matrix is (A + sqrt(det A) 1)/sqrt(tr A + 2 sqrt(det A)).
    """
    c[:, :] = 0.0
    for i in (0, 3):
        c[i, i] = 2.0 * ratio * math.sqrt(k[i, i] * masses[i])
    for i, j in PLANES:
        m1, m2 = math.sqrt(masses[i]), math.sqrt(masses[j])
        a11, a12, a22 = k[i, i] / masses[i], k[i, j] / (m1 * m2), k[j, j] / masses[j]
        root = math.sqrt(a11 * a22 - a12 * a12)
        factor = 2.0 * ratio / math.sqrt(a11 + a22 + 2.0 * root)
        c[i, i], c[j, j] = factor * (a11 + root) * masses[i], factor * (a22 + root) * masses[j]
        c[i, j] = c[j, i] = factor * a12 * m1 * m2
