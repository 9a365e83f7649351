"""Section 2.4: Hertz."""

from __future__ import annotations

import math

from scipy.integrate import quad

from models.contact.hertz import deflection, elastic_compliance, half_width, maximum_pressure

from ...statement import Statement, Verdict, met_if, near
from ..runs import NOSE_DEG, Runs
from .check import Check


def compliance(runs: Runs) -> float:
    """Sigma of the contact (1/Pa)."""
    p = runs.parameters("contact")
    return float(
        elastic_compliance(p.youngs_modulus_1, p.poissons_ratio_1, p.youngs_modulus_2, p.poissons_ratio_2)
    )


def at_nose(runs: Runs) -> tuple[float, float, float, float]:
    """Load, radius, contact length and compliance at the nose."""
    cycle = runs.kinematic()
    load = cycle.at("contact.load", NOSE_DEG)
    radius = cycle.at("camshaft.radius_of_curvature", NOSE_DEG)
    return load, radius, float(runs.parameters("contact").length), compliance(runs)


def half_width_to_pressure(runs: Runs) -> Statement:
    load, radius, length, sigma = at_nose(runs)
    ratio = half_width(load, radius, length, sigma) / maximum_pressure(load, radius, length, sigma)
    printed = 2.0 * radius / (4.0 * runs.parameters("contact").youngs_modulus_1)
    return Statement(
        "width-to-pressure",
        "(5)",
        "b/p = D/(4E)",
        f"Hertz, (6) and (7), gives {ratio / printed:.2f} times that ({ratio:.3e} m/Pa at the nose)",
        met_if(near(printed, ratio)),
        "should read b/p = 2RΣ, as (6) and (7) have it",
        {"printed": printed, "hertz": ratio},
    )


def hertz_width(runs: Runs) -> Statement:
    """(6) with (7): the elliptic pressure carries the load."""
    load, radius, length, sigma = at_nose(runs)
    b = half_width(load, radius, length, sigma)
    printed = math.sqrt(2.0 / math.pi * sigma * load * 2.0 * radius / length)
    carried = quad(lambda x: math.sqrt(1.0 - x * x), -1.0, 1.0)[0] * b * length
    carried *= maximum_pressure(load, radius, length, sigma)
    return Statement(
        "hertz-width",
        "(6), (7)",
        "b0² = (2/π) Σ W D/L_c, p0 = 2W/(π b0 L_c)",
        f"at the nose b0 = {1e6 * printed:.1f} µm; the ellipse carries {carried:.2f} N of {load:.2f} N",
        met_if(near(printed, b, 1e-9) and near(carried, load, 1e-6)),
        "",
        {"half_width": b, "carried_N": carried, "load_N": load},
    )


def central_deflection(runs: Runs) -> Statement:
    """(9) against the integral (4) over the pressure (8), done in y by hand and in x numerically."""
    load, radius, length, sigma = at_nose(runs)
    b, p0 = half_width(load, radius, length, sigma), maximum_pressure(load, radius, length, sigma)

    def strip(x: float) -> float:
        return 2.0 * p0 * math.sqrt(1.0 - (x / b) ** 2) * math.asinh(0.5 * length / x)

    integral = 2.0 * sigma / math.pi * quad(strip, 0.0, b, epsabs=0.0, epsrel=1e-10)[0]
    closed = deflection(load, radius, length, sigma)
    return Statement(
        "central-deflection",
        "(4), (8), (9)",
        "Central deflection b0 p0 Σ [ln(4b/b0) + 0.5]",
        f"at the nose {1e6 * closed:.4f} µm; integral (4) of (8): {1e6 * integral:.4f} µm",
        met_if(near(closed, integral, 1e-3)),
        "with b as half the contact's length: 4b = 2 L_c",
        {"closed_m": closed, "integral_m": integral},
    )


def narrow_contact(runs: Runs) -> Statement:
    cycle = runs.kinematic()
    share = cycle["contact.half_width"] / cycle["camshaft.radius_of_curvature"]
    lengths = cycle["contact.half_width"] / runs.parameters("contact").length
    return Statement(
        "narrow-contact",
        "2.4, 3",
        "The contact is narrow beside the radius of curvature and its own length",
        f"b at most {100 * share.max():.2f} % of the radius and {100 * lengths.max():.2f} % of the length "
        "(1000 r/min)",
        met_if(share.max() < 0.1 and lengths.max() < 0.1),
        "",
        {"of_radius": float(share.max()), "of_length": float(lengths.max())},
    )


def pressure_distribution(runs: Runs) -> Statement:
    pressure = runs.kinematic()["contact.maximum_pressure"]
    return Statement(
        "pressure-distribution",
        "Abstract",
        "The lubricant pressure distribution is investigated, including start-up and acceleration",
        f"largest Hertz pressure of the cycle {pressure.min() / 1e6:.0f}-{pressure.max() / 1e6:.0f} MPa "
        "(1000 r/min)",
        Verdict.NOT_MET,
        "the source shows no pressure distribution and no start-up; its pressure is the Hertz ellipse (8) "
        "(for start-up see the scenario run-up)",
        {"minimum_Pa": float(pressure.min()), "maximum_Pa": float(pressure.max())},
    )


CHECKS: tuple[Check, ...] = (half_width_to_pressure, hertz_width, central_deflection, narrow_contact)
ABSTRACT: tuple[Check, ...] = (pressure_distribution,)
