"""Springs from their wire: closed forms of cylinder and cone, order in which coils close, stress, fatigue."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from models.valve_train.wire_materials import MATERIALS, Fatigue
from models.valve_train.wire_spring import SHARES, WireSpring

pytestmark = pytest.mark.plain

STEEL = MATERIALS["chrome-silicon"]
D, MEAN, COILS, PITCH = 4e-3, 26e-3, 5.5, 8e-3
CYLINDER = WireSpring(D, np.array([MEAN]), np.array([PITCH]), COILS, 2.0, STEEL)
CONE = replace(CYLINDER, mean_diameter=np.array([32e-3, 20e-3]))
# Half of the coils lie closer.
PROGRESSIVE = replace(CYLINDER, pitch=np.array([5e-3, 8e-3]))
# Shares of the wire in the middle rule, and masses in the middle of shares.
MIDDLE = 1.0 / SHARES**2


def test_a_cylindrical_spring_has_the_closed_forms_of_rate_mass_surge_and_length(record):
    rate = STEEL.shear_modulus * D**4 / (8.0 * MEAN**3 * COILS)
    mass = STEEL.density * math.pi * D**2 / 4.0 * math.pi * MEAN * COILS
    record("Spring", "rate of a cylinder (N/m)", CYLINDER.rate(0.0), rate, "G d^4/(8 D^3 n)", relative=1e-12)
    assert CYLINDER.active_mass == pytest.approx(mass, rel=1e-12)
    surge = 0.5 * np.sqrt(rate / mass) * np.array([1.0, 2.0])
    found = CYLINDER.surge_frequencies(0.0)
    record("Spring", "surge of a cylinder (Hz)", found, surge, "j sqrt(k/m)/2", relative=2.0 * MIDDLE)
    assert CYLINDER.free_length == pytest.approx(PITCH * COILS + 2.0 * D, rel=1e-12)
    assert CYLINDER.solid_travel == pytest.approx((PITCH - D) * COILS, rel=1e-12)
    assert CYLINDER.find_force(10e-3) == pytest.approx(rate * 10e-3, rel=1e-12)


def test_a_cone_has_the_integral_of_its_diameter(record):
    one, two = CONE.mean_diameter
    rate = STEEL.shear_modulus * D**4 / (2.0 * COILS * (one**2 + two**2) * (one + two))
    record(
        "Spring",
        "rate of a cone (N/m)",
        CONE.rate(0.0),
        rate,
        "G d^4/(2n(D1^2+D2^2)(D1+D2))",
        relative=MIDDLE,
    )
    step = abs(one - two) / 2.0 / COILS
    assert CONE.gap == pytest.approx(PITCH - math.sqrt(D**2 - step**2), rel=1e-9)


def test_wide_coils_of_a_cone_close_first_and_the_rate_is_the_slope_of_the_force():
    """Between free and solid the force is the integral of the rate."""
    closing = CONE.closing_force
    assert np.all(np.diff(closing) > 0.0)  # from the wide to the narrow end
    travels = np.linspace(0.0, 0.99 * CONE.solid_travel, 400)
    forces = np.array([CONE.find_force(x) for x in travels])
    assert [CONE.compress(f) for f in forces] == pytest.approx(travels, rel=1e-12)
    rates = np.array([CONE.rate(0.5 * (a + b)) for a, b in itertools.pairwise(forces)])
    assert np.all(np.diff(rates) >= 0.0)
    # Shares close one by one: a step of the rate is 1/1000 of the flexibility, more near the solid length.
    assert np.diff(forces) / np.diff(travels) == pytest.approx(rates, rel=0.02)


def test_open_coils_alone_surge():
    """With the close half shut, an even spring surges as one of fewer coils: f ~ 1/n."""
    force = 0.5 * (PROGRESSIVE.closing_force.min() + PROGRESSIVE.closing_force.max())
    share = float(PROGRESSIVE.is_open(force).mean())
    ratio = PROGRESSIVE.surge_frequencies(force)[0] / PROGRESSIVE.surge_frequencies(0.0)[0]
    assert ratio == pytest.approx(1.0 / share, rel=1e-5)
    assert 0.4 < share < 0.6


def test_closed_coils_between_open_ones_are_a_mass_that_moves():
    """Each side swings as a rod with half of it at its end: q tan q = m/(M/2), q = w sqrt(m/k) of a side."""
    barrel = replace(CYLINDER, pitch=np.array([8e-3, 8e-3, 5e-3, 5e-3, 8e-3, 8e-3]))
    force = 0.5 * (barrel.closing_force.min() + barrel.closing_force.max())
    side = 0.5 * float(barrel.is_open(force).mean())
    mass, closed = barrel.active_mass * side, barrel.active_mass * (1.0 - 2.0 * side)
    q = brentq(lambda q: q * math.tan(q) - 2.0 * mass / closed, 1e-3, 1.57)
    expected = q / (2.0 * math.pi) * math.sqrt(2.0 * barrel.rate(force) / mass)
    assert barrel.surge_frequencies(force)[0] == pytest.approx(expected, rel=1e-5)


def test_stress_factors_and_stress_of_the_textbooks():
    """c = 6.5: Wahl 1.2309, Bergstraesser 1.2174; tau = K 8 F D/(pi d^3). Closed coils bear no more."""
    plain = 8.0 * 500.0 * MEAN / (math.pi * D**3)
    assert CYLINDER.stress(500.0)[0] == pytest.approx(plain * 28.0 / 23.0, rel=1e-12)
    wahl = replace(CYLINDER, stress_factor="wahl").stress(500.0)[0]
    assert wahl == pytest.approx(plain * (25.0 / 22.0 + 0.615 / 6.5), rel=1e-12)
    solid = CYLINDER.closing_force[0]
    assert CYLINDER.stress(2.0 * solid)[0] == pytest.approx(CYLINDER.stress(solid)[0])


def test_goodmans_line_goes_through_zimmerlis_point_and_the_shear_strength():
    """4 mm of chrome-silicon: S_ut = 1974/4^0.108 = 1699.5 MPa, S_su = 0.67 of it."""
    fatigue = STEEL.fatigue(D)
    assert fatigue.mean == pytest.approx(0.67 * 1974e6 / 4.0**0.108)
    assert fatigue.use(398e6, 534e6) == pytest.approx(1.0)
    assert Fatigue(5e8, 1e9).use(1e8, 3e8) == pytest.approx(0.5)
    low, high = CYLINDER.stress(300.0)[0], CYLINDER.stress(700.0)[0]
    expected = 1.0 / fatigue.use(0.5 * (high - low), 0.5 * (high + low))
    assert CYLINDER.safety(300.0, 700.0) == pytest.approx(expected)
    with pytest.raises(ValueError, match="must be above the mean stress 534 MPa"):
        replace(STEEL, strength=700e6).fatigue(D)


@pytest.mark.parametrize("spring", [CYLINDER, CONE, PROGRESSIVE], ids=["cylinder", "cone", "progressive"])
def test_gaps_of_segments_add_up_to_the_travel_that_is_left(spring):
    force = spring.find_force(8e-3)
    gaps = spring.cut(force, 9)
    assert gaps.sum() == pytest.approx(spring.solid_travel - 8e-3, rel=1e-9)
    assert np.all(gaps > 0.0)


def test_gaps_are_in_the_order_of_the_segments_from_the_moving_end():
    """The pitch grows towards the moving end, where the gaps are then larger."""
    assert np.all(np.diff(PROGRESSIVE.cut(50.0, 5)) < 0.0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"mean_diameter": np.array([6e-3])}, "mean_diameter = 6 mm: must be 2 to 50 times the wire's 4 mm"),
        ({"pitch": np.array([8e-3, 9.0])}, "pitch = 9000 mm: must be at most the mean diameter, 26 mm"),
        ({"pitch": np.array([3e-3])}, "pitch = 3 mm: must leave a gap between wires of 4 mm"),
    ],
)
def test_coils_that_cannot_be_wound_are_refused(change, said):
    with pytest.raises(ValueError, match=said):
        replace(CYLINDER, **change)


def test_a_length_beyond_the_solid_one_is_refused():
    with pytest.raises(
        ValueError, match=r"by 23 mm: must be >= 0 and less than 22 mm, where all coils touch"
    ):
        CYLINDER.find_force(23e-3)
