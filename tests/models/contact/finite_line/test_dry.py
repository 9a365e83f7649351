"""The elastic contact without a film: closed forms, complementarity, end peaks, Lundberg's profile."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from models.contact.analysis.finite_line.contact import FiniteLine, Running
from models.contact.analysis.finite_line.grid import Resolution
from models.contact.analysis.finite_line.profiles import Chamfered, Crowned, Straight, johns_gohar, lundberg
from models.contact.hertz import half_width, maximum_pressure

from .cases import AT, COARSE, LENGTH, OIL, STEEL, STRAIGHT, dry_of


def profiled(profile):
    return dataclasses.replace(STRAIGHT, profile=profile)


def test_a_ball_is_hertz_point_contact(record):
    """Crown radius = rolling radius: p0 = (6 W E*^2 / (pi^3 R^2))^(1/3), E* = 1/compliance."""
    radius, load = 20e-3, 5.0
    ball = FiniteLine(0.5e-3, STEEL, OIL, Crowned(radius))
    found = dry_of(ball, Running(load, 0.0, radius), Resolution(16.0, 0.25, 0.2, 60))
    p0 = (6.0 * load / (math.pi**3 * (STEEL * radius) ** 2)) ** (1.0 / 3.0)
    approach = (math.pi * p0 * STEEL / 2.0) ** 2 * radius
    # Cells of a sixteenth and of a fifth of the contact's radius, on its rim half pressed.
    source = "Hertz's point contact"
    record("Field", "finite line: pressure of a ball", found.largest_pressure, p0, source, relative=1e-2)
    record("Field", "finite line: approach of a ball", found.approach, approach, source, relative=1e-2)


def test_a_crown_is_hertz_elliptical_contact(record):
    """Johnson (1985) 4.28-4.30: half axes by complete elliptic integrals of the ratio of the radii."""
    load, along, crown = 200.0, 0.02, 0.5
    reduced = math.sqrt(along * crown)

    def of_axes(ratio):
        """(a/b)^2 E - K and K - E, of the long axis over the short one."""
        square = 1.0 - ratio**-2
        return ratio**2 * ellipe(square) - ellipk(square), ellipk(square) - ellipe(square)

    def miss(ratio):
        first, second = of_axes(ratio)
        return first / second - crown / along

    ratio = brentq(miss, 1.01, 100.0)
    first, second = of_axes(ratio)
    factor = (4.0 / (math.pi * (1.0 - ratio**-2))) ** (1 / 3) * ratio**-0.5 * (first * second) ** (1 / 6)
    mean = (0.75 * load * reduced * STEEL) ** (1 / 3) * factor
    assert mean * math.sqrt(ratio) < 0.5 * LENGTH
    exact = 1.5 * load / (math.pi * mean**2)
    at, lines = Running(load, 0.0, along), (24, 48, 96)
    pressures = [
        dry_of(profiled(Crowned(crown)), at, Resolution(12.0, 0.2, 0.3, n)).largest_pressure for n in lines
    ]
    errors = 1.0 - np.array(pressures) / exact
    # Of second order in the lines, which are as wide as 1/4 to 1/16 of the long half axis.
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx([2.0, 2.0], abs=0.4)
    source = "Hertz's elliptical contact, Johnson (1985)"
    record("Field", "finite line: pressure of a crown (Pa)", pressures[-1], exact, source, relative=1e-3)


def test_the_middle_of_a_long_contact_is_hertz_line_contact():
    found = dry_of(STRAIGHT, AT, COARSE)
    middle = slice(found.grid.shape[1] // 2, found.grid.shape[1] // 2 + 1)
    per_length = float(found.load_per_length[middle][0])
    p0 = maximum_pressure(per_length * LENGTH, AT.radius, LENGTH, STEEL)
    b = half_width(per_length * LENGTH, AT.radius, LENGTH, STEEL)
    pressure, _ = found.middle
    hertz = p0 * np.sqrt(np.maximum(1.0 - (found.grid.x / b) ** 2, 0.0))
    # A square root on 12 nodes: 1 % of p0 beside the edge, where it is steepest 6 %.
    assert found.middle_pressure == pytest.approx(p0, rel=5e-3)
    assert np.mean(np.abs(pressure - hertz)) < 1e-2 * p0


def test_gap_or_pressure_also_where_it_is_tilted():
    """Turned the other way, the contact is the same seen from the other end."""
    found, other = (
        dry_of(STRAIGHT, dataclasses.replace(AT, misalignment=slope), COARSE) for slope in (2e-4, -2e-4)
    )
    assert found.load == pytest.approx(AT.load, rel=1e-9)
    assert np.all(found.pressure >= 0.0)
    # Where the bodies press the gap is closed, to the residual of the linear solver.
    assert np.max(found.film[found.pressure > 0.0]) < 1e-6 * found.approach
    # The linear solver's residual.
    allowed = 1e-5 * found.largest_pressure
    np.testing.assert_allclose(found.pressure, other.pressure[:, ::-1], rtol=1e-4, atol=allowed)
    assert found.moment == pytest.approx(-other.moment, rel=1e-6)
    assert found.moment < 0.0  # the gap opens towards +y


def test_the_peak_of_a_sharp_end_is_the_grids():
    """Pressure rises like distance^-1/2 towards the end: half the cell, sqrt(2) of the peak (within 10 %)."""
    once, twice = (dry_of(STRAIGHT, AT, Resolution(8.0, cell, 0.3, 20)) for cell in (0.1, 0.05))
    assert twice.end_pressure / once.end_pressure == pytest.approx(math.sqrt(2.0), rel=0.1)
    assert twice.approach == pytest.approx(once.approach, rel=2e-3)


@pytest.mark.parametrize("profile", [lundberg, johns_gohar])
def test_lundbergs_profile_carries_its_load_evenly(profile):
    arguments = (AT.load, AT.radius, LENGTH, STEEL) if profile is johns_gohar else (AT.load, LENGTH, STEEL)
    found = dry_of(profiled(profile(*arguments)), AT, COARSE)
    inside = np.abs(found.grid.y) < 0.45 * LENGTH
    spread = found.load_per_length[inside] / (AT.load / LENGTH)
    straight = dry_of(STRAIGHT, AT, COARSE)
    # The profile is made for points far from the ends in half widths: (b/end)^2 = 3 % a twentieth from them.
    assert np.ptp(spread) < 0.04
    assert np.ptp(straight.load_per_length[np.abs(straight.grid.y) < 0.45 * LENGTH]) > 0.1 * AT.load / LENGTH
    assert found.largest_pressure < 1.25 * found.middle_pressure < straight.largest_pressure


def test_a_chamfer_moves_the_peak_to_its_kink():
    assert Chamfered(1e-3, 0.01).drop(np.array([LENGTH / 2]), LENGTH) == pytest.approx(1e-5, rel=1e-12)
    found = dry_of(profiled(Chamfered(1e-3, 0.01)), AT, COARSE)
    at = abs(found.grid.y[np.argmax(found.peak_along)])
    assert at == pytest.approx(LENGTH / 2 - 1e-3, abs=0.2 * found.half_width)
    assert np.all(found.peak_along[np.abs(found.grid.y) > LENGTH / 2 - 0.8e-3] == 0.0)


def test_a_crown_leaves_the_ends_free():
    found = dry_of(profiled(Crowned(2.0)), AT, COARSE)
    assert found.end_pressure == 0.0
    assert found.middle_pressure > dry_of(profiled(Straight()), AT, COARSE).middle_pressure
