"""Short films of journal bearings against quadrature, and their asperities.

Bearings of finite width: Reynolds' equation against closed forms and published tables, and the mobilities of
plain and grooved ones against the equation.
"""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

from models.contact.analysis.bearing.reynolds import Grid, solve
from models.contact.analysis.bearing.steady import GROOVE, SIDES, WEDGE, describe_steady, solve_steady
from models.contact.analysis.bearing.table import describe
from models.contact.asperities import Asperities, asperity_pressure
from models.contact.asperity_arc import Arc, press_arc
from models.contact.finite_bearing import find_finite_squeeze, find_highest_pressure
from models.contact.grooved_bearing import Grooves, find_grooved_squeeze
from models.contact.short_bearing import Squeeze, find_force, find_impedance, find_squeeze, highest_pressure

pytestmark = pytest.mark.plain

R, L, C = 12.5e-3, 12e-3, 25e-6
ANGLES = st.floats(-math.pi, math.pi)
RATIOS = st.floats(0.0, 0.99)


def polar(size, angle):
    return Squeeze(size * math.cos(angle), size * math.sin(angle))


@settings(max_examples=60, deadline=None)
@given(RATIOS, ANGLES)
@example(0.0, 0.0)
def test_the_impedance_is_the_integral_over_half_of_the_film(ratio, angle):
    xi, zeta = polar(ratio, angle)
    weights = (np.cos, np.cos), (np.sin, np.sin), (np.sin, np.cos)
    thin = min(max(angle, -1.5), 1.5)
    for found, (a, b) in zip(find_impedance(xi, zeta), weights, strict=True):
        parts = [
            quad(
                lambda t, a=a, b=b: a(t) * b(t) / (1.0 - xi * math.cos(t) - zeta * math.sin(t)) ** 3,
                *ends,
                epsabs=1e-12,
                epsrel=1e-11,
                limit=400,
            )[0]
            for ends in ((-0.5 * math.pi, thin), (thin, 0.5 * math.pi))
        ]
        assert found == pytest.approx(sum(parts), rel=1e-9, abs=1e-9)


@settings(max_examples=200, deadline=None)
@given(st.floats(0.0, 0.9999), ANGLES, ANGLES)
@example(0.0, 0.0, 0.0)
@example(0.9, math.pi, 0.0)
def test_the_mobility_is_the_inverse_of_the_impedance(ratio, angle, direction):
    """To rounding, which a thin film multiplies by (1 - eps)^-2."""
    eps, force = polar(ratio, angle), polar(1.0, direction)
    found = find_force(find_squeeze(force, eps), eps)
    assert math.hypot(found.x - force.x, found.y - force.y) < 1e-14 / (1.0 - ratio) ** 2


def test_without_force_there_is_no_motion():
    assert find_squeeze(Squeeze(0.0, 0.0), Squeeze(0.5, 0.1)) == (0.0, 0.0)
    assert find_force(Squeeze(0.0, 0.0), Squeeze(0.5, 0.1)) == (0.0, 0.0)


@pytest.mark.parametrize(("ratio", "tolerance"), [(0.1, 0.006), (0.5, 0.03), (0.9, 0.09)])
def test_the_mobility_is_near_bookers_fit(ratio, tolerance, record):
    """His curves for the short bearing, in the axes of the force: (1 - xi)^5/2/pi and
    -4 zeta (1 - xi)^3/2/pi^2, of (L/D)^2 c/(mu L D) (c/R)^2 times the force."""
    worst = 0.0
    for direction in np.linspace(-math.pi, math.pi, 73):
        eps = polar(ratio, direction)
        u = find_squeeze(Squeeze(1.0, 0.0), eps)
        fit = 2.0 * (1.0 - eps.x) ** 2.5 / math.pi, -8.0 * eps.y * (1.0 - eps.x) ** 1.5 / math.pi**2
        worst = max(worst, math.hypot(u.x - fit[0], u.y - fit[1]) / math.hypot(*fit))
    quantity = f"journal bearing at eps = {ratio:g}: mobility, largest difference from the fit (rel.)"
    record("Film", quantity, worst, 0.0, "curve fit of Booker 1971", tolerance=tolerance)


@settings(max_examples=60, deadline=None)
@given(st.floats(0.0, 0.98), ANGLES, ANGLES)
def test_the_highest_pressure_is_that_of_all_directions(ratio, angle, direction):
    eps, u = polar(ratio, angle), polar(1.0, direction)
    t = np.linspace(-math.pi, math.pi, 20001)
    around = (u.x * np.cos(t) + u.y * np.sin(t)) / (1.0 - eps.x * np.cos(t) - eps.y * np.sin(t)) ** 3
    highest = float(around.max())
    assert highest * (1.0 - 1e-12) <= highest_pressure(u, eps) <= highest * (1.0 + 1e-4)


# The asperities


@pytest.mark.parametrize("separation", [3.0, 0.0, -2.0])
def test_asperities_along_the_arc(separation):
    """Against the quadrature over the circumference, with h = c - e cos and e = c - lambda sigma. The closed
    form has h parabolic and e = c, which is lambda sigma/(2 c) = 2.4 % off at lambda = 3."""
    arc, surfaces = Arc(R, L, C), Asperities(0.4e-6, 0.05, 1e-3)

    def pressure(t):
        more = (C - separation * 0.4e-6) * (1.0 - math.cos(t)) / 0.4e-6
        return asperity_pressure(separation + more, surfaces, 1e-11) * math.cos(t)

    expected = 2.0 * R * L * quad(pressure, 0.0, 0.8, epsrel=1e-10)[0]
    assert press_arc(separation, arc, surfaces, 1e-11).load == pytest.approx(expected, rel=0.03)


@settings(max_examples=40, deadline=None)
@given(st.floats(-6.0, 7.9))
def test_the_energy_of_the_asperities_is_the_work_of_their_load(separation):
    arc, surfaces, h = Arc(R, L, C), Asperities(0.4e-6, 0.05, 1e-3), 1e-4

    def at(place):
        return press_arc(place, arc, surfaces, 1e-11)

    work = (at(separation - h).energy - at(separation + h).energy) / (2.0 * h * 0.4e-6)
    assert at(separation).load == pytest.approx(work, rel=1e-5, abs=1e-6)


EQUATION = "Reynolds' equation, p >= 0"


# Reynolds' equation


def long_pressure(eps, places):
    """Of a bearing without ends whose film begins at its widest place: p' = 12 (h - h*)/(eps h^3) for a unit
    squeeze at a right angle to eps, with h* where p and p' vanish (Swift 1932, Stieber 1933)."""

    def rise(angle, end):
        return 12.0 / eps * (math.cos(end) - math.cos(angle)) * eps / (1.0 - eps * math.cos(angle)) ** 3

    def pressure(at, end):
        return quad(rise, -math.pi, at, args=(end,), epsabs=1e-10, epsrel=1e-10)[0]

    end = brentq(lambda end: pressure(end, end), 1e-3, 0.999 * math.pi, xtol=1e-12)
    return [pressure(at, end) for at in places]


@pytest.mark.parametrize("eps", [0.3, 0.8])
def test_the_middle_of_a_wide_bearing_is_the_long_bearings(eps):
    """On L/D = 10 ends are not felt: to the error of the grid."""
    field, places = solve(Grid(eps, 10.0, (math.pi,)), WEDGE), [-1.0, -0.3, 0.0]
    found = np.interp(places, field.grid.angle, field.pressure[:, 0])
    assert found == pytest.approx(long_pressure(eps, places), rel=2e-3)


@pytest.mark.parametrize("direction", [0.0, 1.0, 2.0, 3.0])
def test_a_narrow_film_is_ocvirks(direction, record):
    """L/D = 0.02: the ends of his film, where p' jumps, are as wide as the bearing."""
    force = solve(Grid(0.6, 0.02), direction).force
    short = find_force(polar(1.0, direction), Squeeze(0.6, 0.0))
    error = math.hypot(force[0] - short.x, force[1] - short.y) / math.hypot(*short)
    quantity = f"journal bearing of L/D = 0.02, squeezed at {direction:g} rad from eps = 0.6: force (rel.)"
    record("Film", quantity, error, 0.0, "Ocvirk 1952", tolerance=2.5e-3)


def test_the_error_of_the_grid_is_of_second_order(record):
    loads = [solve_steady(0.8, 0.5, around=n, across=n // 15).sommerfeld for n in (120, 240, 480)]
    order = math.log2((loads[1] - loads[0]) / (loads[2] - loads[1]))
    record(
        "Film", "journal bearing: order of Reynolds' equation on grids", order, 2.0, "theory", tolerance=0.2
    )
    assert loads[1] == pytest.approx(loads[2], rel=2e-4)


def test_the_force_is_a_gradient_by_the_squeeze():
    """Its derivatives are symmetric and positive: power is taken from every motion."""
    slopes = solve_steady(0.7, 0.8).damping
    assert slopes[0, 1] == pytest.approx(slopes[1, 0], rel=1e-9)
    assert np.linalg.eigvalsh(0.5 * (slopes + slopes.T)).min() > 0.0


# Raimondi and Boyd 1958, bearing of 360 degrees whose film begins at its widest place: Sommerfeld number,
# attitude (deg), friction f R/c, flow Q/(R c N L) and the share of it that leaves at the sides, mean over
# highest pressure.
RAIMONDI_BOYD = {
    (0.5, 0.2): (2.03, 74.94, 40.9, 3.72, 0.318, 0.506),
    (0.5, 0.4): (0.779, 61.45, 17.0, 4.29, 0.552, 0.441),
    (0.5, 0.6): (0.319, 48.14, 8.10, 4.85, 0.730, 0.365),
    (0.5, 0.8): (0.0923, 33.31, 3.26, 5.41, 0.874, 0.267),
    (0.5, 0.9): (0.0313, 23.66, 1.60, 5.69, 0.939, 0.206),
    (1.0, 0.2): (0.631, 74.02, 12.8, 3.59, 0.280, 0.529),
    (1.0, 0.4): (0.264, 63.10, 5.79, 3.99, 0.497, 0.484),
    (1.0, 0.6): (0.121, 50.58, 3.22, 4.33, 0.680, 0.415),
    (1.0, 0.8): (0.0446, 36.24, 1.70, 4.62, 0.842, 0.313),
    (1.0, 0.9): (0.0188, 26.45, 1.05, 4.74, 0.919, 0.247),
}


@pytest.mark.parametrize(("ratio", "eps"), RAIMONDI_BOYD)
def test_reynolds_equation_gives_raimondis_and_boyds_tables(ratio, eps, record):
    """Their grid of 1958 has errors of 1.5 %."""
    load, attitude, friction, flow, sides, pressure = RAIMONDI_BOYD[ratio, eps]
    found = describe_steady(solve(Grid(eps, ratio, (math.pi,)), WEDGE))
    quantity = f"Reynolds' equation, L/D = {ratio:g}, eps = {eps:g}"
    source = "Raimondi and Boyd 1958"
    record("Film", f"{quantity}: Sommerfeld number", found.sommerfeld, load, source, relative=0.015)
    degrees = math.degrees(found.attitude)
    record("Film", f"{quantity}: attitude angle (deg)", degrees, attitude, source, tolerance=0.6)
    record("Film", f"{quantity}: friction f R/c", found.friction, friction, source, relative=0.01)
    record("Film", f"{quantity}: side flow", found.side_flow, flow * sides, source, relative=0.02)
    record(
        "Film", f"{quantity}: mean over highest pressure", 1.0 / found.peak, pressure, source, relative=0.03
    )


# Lund and Thomsen 1978, two axial grooves of 20 degrees at a right angle to the load: eps, then Sommerfeld
# number, attitude (deg), Kxx Kxy Kyx Kyy, Bxx Bxy Byy; x along the load.
LUND_THOMSEN = {
    (0.5, 0.244): (1.656, 65.85, 1.69, 5.06, -2.20, 1.95, 9.93, 2.15, 4.80),
    (0.5, 0.372): (0.917, 57.45, 2.12, 4.01, -1.30, 1.85, 7.70, 2.06, 3.23),
    (0.5, 0.477): (0.580, 51.01, 2.67, 3.70, -0.78, 1.75, 6.96, 1.94, 2.40),
    (0.5, 0.570): (0.379, 45.43, 3.33, 3.64, -0.43, 1.68, 6.76, 1.87, 1.89),
    (0.5, 0.655): (0.244, 40.25, 4.21, 3.74, -0.13, 1.64, 6.87, 1.82, 1.54),
    (1.0, 0.150): (0.991, 70.58, 1.56, 7.29, -2.16, 1.52, 14.66, 1.58, 4.49),
    (1.0, 0.460): (0.235, 49.27, 2.19, 3.57, -0.80, 1.55, 7.36, 1.89, 2.19),
    (1.0, 0.650): (0.108, 39.72, 3.45, 3.34, -0.23, 1.44, 6.89, 1.72, 1.43),
}


@pytest.mark.parametrize(("ratio", "eps"), LUND_THOMSEN)
def test_reynolds_equation_gives_lunds_and_thomsens_tables(ratio, eps, record):
    """Coefficients to 1 % of the largest of their kind."""
    load, attitude, *coefficients = LUND_THOMSEN[ratio, eps]
    found = solve_steady(eps, ratio, SIDES)
    quantity = f"Reynolds' equation, two grooves, L/D = {ratio:g}, eps = {eps:g}"
    source = "Lund and Thomsen 1978"
    record("Film", f"{quantity}: Sommerfeld number", found.sommerfeld, load, source, relative=0.005)
    degrees = math.degrees(found.attitude)
    record("Film", f"{quantity}: attitude angle (deg)", degrees, attitude, source, tolerance=0.1)
    ours = *found.stiffness.ravel(), *np.delete(found.damping.ravel(), 2)
    names = "Kxx", "Kxy", "Kyx", "Kyy", "Bxx", "Bxy", "Byy"
    for name, value, published in zip(names, ours, coefficients, strict=True):
        largest = max(np.abs(coefficients[:4] if name[0] == "K" else coefficients[4:]))
        record("Film", f"{quantity}: {name}", value, published, source, tolerance=0.01 * largest)


# The table


def squeeze_of(eps, ratio, angle):
    """The squeeze of a unit force at this angle from eps, along it and across."""
    found = find_finite_squeeze(Squeeze(1.0, 0.0), polar(eps, -angle), ratio)
    return found.x, found.y


@pytest.mark.parametrize("ratio", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("eps", [0.05, 0.5, 0.8, 0.95, 0.99])
def test_squeeze_of_finite_bearings(ratio, eps, record):
    """In nine directions: the largest difference of the vector, over its length."""
    worst, highest, last = 0.0, 0.0, None
    for direction in np.linspace(0.0, math.pi, 9):
        last = solve(Grid(eps, ratio), float(direction), last.wet if last else None)
        exact = describe(last, direction)
        along, across = squeeze_of(eps, ratio, exact.angle)
        off = math.hypot(along - exact.along, across - exact.across)
        worst = max(worst, off / math.hypot(exact.along, exact.across))
        force, at = Squeeze(1.0, 0.0), polar(eps, -exact.angle)
        highest = max(highest, abs(find_highest_pressure(force, at, ratio) / exact.highest - 1.0))
    quantity, near = f"journal bearing of L/D = {ratio:g} at eps = {eps:g}", eps < 0.96
    for name, error, allowed in (("squeeze velocity", worst, 5e-3), ("highest pressure", highest, 0.04)):
        tolerance = allowed if near else 3.0 * allowed
        record("Film", f"{quantity}: {name} (rel.)", error, 0.0, EQUATION, tolerance=tolerance)


def find_squeeze_between_grooves(force, eps, ratio):
    """With grooves at a right angle to x, the load."""
    return find_grooved_squeeze(force, eps, Grooves(ratio, 0.5 * math.pi, GROOVE))


# By the grooves' places from the load.
MOBILITIES = {(): find_finite_squeeze, SIDES: find_squeeze_between_grooves}
NAMES = {(): "journal bearing", SIDES: "journal bearing with two grooves"}


def attitude_of(eps, ratio, mobility):
    """Sommerfeld number mu N L D/W (R/c)^2 and attitude angle (rad) of the film under a steady load."""

    def across(angle):
        """Of the squeeze under a load along x, less that of the rotation, which is at right angles to eps."""
        u = mobility(Squeeze(1.0, 0.0), polar(eps, angle), ratio)
        return u.x * math.cos(angle) + u.y * math.sin(angle)

    angle = brentq(across, 1e-9, 0.5 * math.pi)
    u = mobility(Squeeze(1.0, 0.0), polar(eps, angle), ratio)
    # u = (omega/2) eps c and W = mu R L^3/c^2 per unit.
    return math.hypot(u.x, u.y) / (2.0 * math.pi * eps * ratio**2), angle


@pytest.mark.parametrize(
    ("ratio", "eps", "grooves", "film", "degrees"),
    [
        *((r, e, (), 1e-3, 0.05) for r in (0.25, 0.5, 1.0) for e in (0.2, 0.6, 0.8, 0.9, 0.95)),
        *((r, e, SIDES, 2e-3, 0.1) for r in (0.25, 0.5, 1.0) for e in (0.1, 0.6, 0.8, 0.95)),
        (0.1, 0.8, SIDES, 1e-2, 0.5),
    ],
)
def test_films_and_attitudes_of_steady_loads(ratio, eps, grooves, film, degrees, record):
    """The film at the load that Reynolds' equation has at eps, and the angle there."""
    exact, mobility = solve_steady(eps, ratio, grooves), MOBILITIES[grooves]
    at = brentq(lambda e: attitude_of(e, ratio, mobility)[0] - exact.sommerfeld, 0.5 * eps, 0.5 + 0.5 * eps)
    quantity = f"{NAMES[grooves]} of L/D = {ratio:g} under the load of eps = {eps:g}"
    text = f"{quantity}: least film over the equation's"
    record("Film", text, (1.0 - at) / (1.0 - eps), 1.0, EQUATION, tolerance=film)
    angle, expected = math.degrees(attitude_of(eps, ratio, mobility)[1]), math.degrees(exact.attitude)
    record("Film", f"{quantity}: attitude angle (deg)", angle, expected, EQUATION, tolerance=degrees)


@pytest.mark.parametrize("grooves", [(), SIDES])
@pytest.mark.parametrize(("ratio", "eps"), [(0.5, 0.2), (0.5, 0.8), (1.0, 0.6), (1.0, 0.9)])
def test_coefficients_of_finite_bearings(ratio, eps, grooves, record):
    """Of the mobility: u(F, eps) is linearised, and the force on the film is what balances a small motion."""
    exact, mobility = solve_steady(eps, ratio, grooves), MOBILITIES[grooves]
    _, attitude = attitude_of(eps, ratio, mobility)
    at, step = np.array(polar(eps, attitude)), 1e-4
    size = eps / math.hypot(*mobility(Squeeze(1.0, 0.0), Squeeze(*at), ratio))

    def squeeze(force, place):
        return np.array(mobility(Squeeze(*force), Squeeze(*place), ratio))

    load, axes = np.array([size, 0.0]), np.eye(2)
    by_force, by_place = (
        np.column_stack([(f(step * axis) - f(-step * axis)) / (2.0 * step) for axis in axes])
        for f in (lambda d: squeeze(load + size * d, at) / size, lambda d: squeeze(load, at + d))
    )
    # In units of c with omega = 2: u = e' - k x e.
    damping = np.linalg.inv(by_force)
    stiffness = -damping @ (by_place + np.array([[0.0, -1.0], [1.0, 0.0]]))
    quantity = f"{NAMES[grooves]} of L/D = {ratio:g} at eps = {eps:g}"
    for name, found, expected in (("K", stiffness, exact.stiffness), ("B", 2.0 * damping, exact.damping)):
        off = np.abs(found / size - expected).max() / np.abs(expected).max()
        text = f"{quantity}: {name}, largest error over the largest"
        record("Film", text, off, 0.0, EQUATION, tolerance=0.01)


def test_a_narrow_bearing_is_short():
    for angle in (0.0, 1.0, 2.0, 3.0):
        eps, force = polar(0.7, angle), Squeeze(0.6, 0.8)
        assert find_finite_squeeze(force, eps, 1e-5) == pytest.approx(
            find_squeeze(force, eps), rel=1e-8, abs=1e-9
        )


@settings(max_examples=60, deadline=None)
@given(st.floats(0.0, 0.999), ANGLES, st.floats(0.01, 1.0))
def test_every_film_takes_power_and_has_a_potential(eps, angle, ratio):
    """The squeeze across is half of the derivative by the angle of the squeeze along, times the force."""
    # Near the wall the squeeze is rounded to 1e-9: over this step that is 4 % of the tolerance.
    step = 1e-3 * (1.0 - eps)
    along, across = squeeze_of(eps, ratio, angle)
    assert along > 0.0
    slope = (squeeze_of(eps, ratio, angle + step)[0] - squeeze_of(eps, ratio, angle - step)[0]) / (2.0 * step)
    assert across == pytest.approx(0.5 * slope, rel=1e-4, abs=1e-5 * along / (1.0 - eps))


def test_a_journal_in_the_middle_moves_alike_in_all_directions():
    moved = [squeeze_of(eps, 0.5, angle) for eps in (0.0, 1e-9) for angle in (0.0, 1.0, 3.0)]
    assert moved == [pytest.approx(moved[0], abs=1e-7)] * 6
