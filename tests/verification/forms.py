"""The slider-crank's three forms."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from scipy.optimize import brentq

from models.slider_crank.forms import constraint_force
from models.slider_crank.machine import FORMS, Machine

from .table import Row

DERIVED = "models/test_slider_crank_derivation.py::"
NONLINEAR = "models/test_slider_crank_nonlinear.py::"


def least_force(damping: float, form: str, gap: float = 0.0) -> float:
    """The smallest force of the upper wall over a revolution."""
    m = Machine(damping, gap, form=form).mechanism
    number = float(FORMS.index(form))
    return min(
        constraint_force(number, theta, 1.0, 0.0, 0.0, m) for theta in np.linspace(0.0, 2.0 * math.pi, 4001)
    )


def sign_changes(damping: float, form: str) -> int:
    """Of the upper wall's force per revolution, at rho = 0."""
    m, number = Machine(damping, 0.0, form=form).mechanism, float(FORMS.index(form))
    angles = np.linspace(0.0, 2.0 * math.pi, 4001)
    signs = np.sign([constraint_force(number, theta, 1.0, 0.0, 0.0, m) for theta in angles])
    return int(np.count_nonzero(np.diff(signs)))


def rows() -> Iterator[Row]:
    yield Row(
        "three forms behind one interface; a test derives the equation symbolically and shows each sign",
        "a, b, c, f of F (2.13) from the bodies' energy: phi' - psi' gives +beta, phi' + psi' (F) -beta",
        (
            DERIVED + "test_linearised_equation_has_the_kernels_coefficients",
            DERIVED + "test_signs_of_beta_exclude_each_other",
        ),
    )
    yield Row(
        "nonlinear: no small-angle step, varying crank speed, exact wall angles, crank torque",
        "flight at constant speed is the damped pendulum in theta + eta; corrected is its limit",
        (
            DERIVED + "test_nonlinear_motion_is_the_exact_one_at_any_speed",
            DERIVED + "test_nonlinear_walls_are_lines_along_the_cylinder",
            NONLINEAR + "test_free_flight_is_a_damped_pendulum",
            DERIVED + "test_nonlinear_torque_is_the_exact_generalised_force",
            NONLINEAR + "test_linear_form_is_the_limit_of_small_clearance",
        ),
    )
    thresholds = [brentq(least_force, 0.01, 0.5, args=(form,), xtol=1e-10) for form in FORMS]
    yield Row(
        "what the sign error changes: the permanent-sliding threshold 0.2669 against 0.1196",
        ", ".join(f"{form} {value:.5f}" for form, value in zip(FORMS, thresholds, strict=True)),
        ("models/test_slider_crank_equations.py::test_threshold_of_permanent_sliding_on_the_upper_wall",),
    )
    changes = {form: sign_changes(0.01, form) for form in FORMS}
    yield Row(
        "four sign changes of the wall force per cycle at lambda = 0.01",
        ", ".join(f"{form} {count}" for form, count in changes.items()),
    )
