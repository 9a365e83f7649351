"""Journal bearings of finite width under a steady load: published tables, statics and dynamics."""

import math

import pytest
from scipy.optimize import brentq

from models.contact.analysis.bearing.steady import SIDES, solve_steady

from .page import COMPUTED, Published

pytestmark = pytest.mark.plain


def compare(published, bearing, rows, conditions, source, why) -> None:
    """Rows of quantity, our value, the source's, and half of its band."""
    for quantity, ours, value, band in rows:
        case = Published(
            "Bearings", f"{bearing}: {quantity}", conditions, COMPUTED,
            value - band, value + band, source, value, digits=4,
        )  # fmt: skip
        published(case, ours, why)


@pytest.mark.parametrize(
    ("ratio", "eps", "load", "attitude"),
    [(0.5, 0.6, 0.319, 48.14), (0.5, 0.9, 0.0313, 23.66), (1.0, 0.8, 0.0446, 36.24)],
)
def test_a_plain_bearing_carries_what_raimondi_and_boyd_found(ratio, eps, load, attitude, published) -> None:
    found = solve_steady(eps, ratio)
    rows = (
        ("Sommerfeld number", found.sommerfeld, load, 0.015 * load),
        ("attitude angle (deg)", math.degrees(found.attitude), attitude, 0.6),
    )
    compare(
        published, f"plain bearing, L/D {ratio:g}, eps {eps:g}", rows,
        "360 degrees, film from its widest place, p >= 0; band: 1.5 %, 0.6 deg (their grid)",
        "Raimondi and Boyd (1958), ASLE Trans. 1, 159", "least film (1 - eps) c at a given load",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("ratio", "eps", "load", "attitude", "stiffness", "damping"),
    [(0.5, 0.477, 0.580, 51.01, 3.70, 6.96), (1.0, 0.460, 0.235, 49.27, 3.57, 7.36)],
)
def test_a_bearing_with_two_grooves_yields_as_lunds_and_thomsens(
    ratio, eps, load, attitude, stiffness, damping, published
) -> None:
    found = solve_steady(eps, ratio, SIDES)
    rows = (
        ("Sommerfeld number", found.sommerfeld, load, 0.005 * load),
        ("attitude angle (deg)", math.degrees(found.attitude), attitude, 0.5),
        ("Kxy over W/c", found.stiffness[0, 1], stiffness, 0.03 * stiffness),
        ("Bxx over W/(c omega)", found.damping[0, 0], damping, 0.03 * damping),
    )
    compare(
        published, f"two axial grooves, L/D {ratio:g}, eps {eps:g}", rows,
        "grooves of 20 deg at 90 deg to the load; band: 0.5 %, 0.5 deg, coefficients 3 %",
        "Lund and Thomsen (1978), ASME",
        "motions of the shaft meet these coefficients, which decide its stability",
    )  # fmt: skip


@pytest.mark.parametrize(("sommerfeld", "eps"), [(5.3, 0.03), (4.3, 0.04)])
def test_a_rotor_in_two_grooved_bearings_whirls_as_nicholas_computed(sommerfeld, eps, published) -> None:
    """A rigid rotor: w^2 = K/g, with K = (Kxx Byy + Kyy Bxx - Kxy Byx - Kyx Bxy)/(Bxx + Byy) and the whirl
    ratio's square g = ((Kxx - K) (Kyy - K) - Kxy Kyx)/(Bxx Byy - Bxy Byx)."""
    ours = brentq(lambda x: solve_steady(x, 1.0, SIDES).sommerfeld - sommerfeld, 0.01, 0.1, xtol=1e-4)
    found = solve_steady(ours, 1.0, SIDES)
    (kxx, kxy), (kyx, kyy) = found.stiffness
    (bxx, bxy), (byx, byy) = found.damping
    k = (kxx * byy + kyy * bxx - kxy * byx - kyx * bxy) / (bxx + byy)
    whirl = ((kxx - k) * (kyy - k) - kxy * kyx) / (bxx * byy - bxy * byx)
    compare(
        published, f"two axial grooves, L/D 1, S {sommerfeld:g}",
        (("eps", ours, eps, 0.005), ("threshold of whirl omega sqrt(c/g)", math.sqrt(k / whirl), 2.1, 0.05)),
        "grooves of 20 deg at 90 deg to the load, 8000 r/min; band: half a unit of the last digit",
        "Nicholas, Barrett and Leader (1980), J. Mechanical Design 102, 344, in ROSS's tests",
        "above it a rigid rotor whirls in its bearings",
    )  # fmt: skip
