"""Appendix 2 of Kushwaha et al. 2000: a part's inertia in Euler angles 3-1-3, against a body's kernel."""

import math

import numpy as np
import pytest

from models.core.quantities import Vector
from models.multibody.bodies import Body
from models.multibody.mechanism import Mechanism

INERTIA = (0.1, 0.2, 0.25)


def turn(axis: int, angle: float) -> Vector:
    """The rotation about x (0), y (1) or z (2)."""
    c, s = math.cos(angle), math.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    rotation = np.eye(3)
    rotation[i, i], rotation[i, j], rotation[j, i], rotation[j, j] = c, -s, s, c
    return rotation


def kernel_inertia(psi: float, theta: float, phi: float) -> Vector:
    """L^T (R I R^T) L with omega = L (psi', theta', phi')."""
    first, second = turn(2, psi), turn(2, psi) @ turn(0, theta)
    r = second @ turn(2, phi)
    cardan = (math.atan2(-r[1, 2], r[2, 2]), math.asin(r[0, 2]), math.atan2(-r[0, 1], r[0, 0]))
    q = np.array([0.0, 0.0, 0.0, *cardan])
    block = Mechanism([Body("part", 1.0, INERTIA)], []).evaluate(0.0, q, np.zeros(6)).mass[3:, 3:]
    lever = np.stack([[0.0, 0.0, 1.0], first[:, 0], second[:, 2]], axis=1)
    return np.asarray(lever.T @ block @ lever)


def appendix(theta: float, phi: float, corrected: bool) -> Vector:
    """Rows a, b, c of Appendix 2; the printed c1 and c3 have a factor cos(theta) too many."""
    ixx, iyy, izz = INERTIA
    s, c, sp, cp = math.sin(theta), math.cos(theta), math.sin(phi), math.cos(phi)
    a1 = ixx * s * s * sp * sp + iyy * s * s * cp * cp + izz * c * c
    a2, b2 = (ixx - iyy) * s * sp * cp, ixx * cp * cp + iyy * sp * sp
    c1, c3 = (izz * c, izz) if corrected else (izz * c * c, izz * c)
    return np.array([[a1, a2, izz * c], [a2, b2, 0.0], [c1, 0.0, c3]])


@pytest.mark.plain
@pytest.mark.parametrize("angles", [(0.4, 0.9, -0.7), (-2.0, 1.3, 0.2)])
def test_appendix_2_holds_with_c1_and_c3_corrected(angles: tuple[float, float, float]) -> None:
    _, theta, phi = angles
    right, printed = (appendix(theta, phi, corrected) for corrected in (True, False))
    inertia = kernel_inertia(*angles)
    np.testing.assert_allclose(inertia, right, atol=1e-15)
    np.testing.assert_array_equal(
        np.abs(printed - right) > 1e-3, [[False] * 3, [False] * 3, [True, False, True]]
    )
    assert not np.allclose(printed, printed.T)  # an inertia is symmetric
