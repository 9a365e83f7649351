"""Journal bearings: Ocvirk's film against closed forms, quadrature and published maps; whirl of a rotor."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq, root

from models.catalogue import CATALOGUE
from models.contact.asperities import Asperities, asperity_pressure
from models.contact.asperity_arc import Arc, press_arc
from models.contact.finite_bearing import find_finite_squeeze
from models.contact.short_bearing import (
    Squeeze,
    find_force,
    find_impedance,
    find_squeeze,
    highest_pressure,
)
from models.core.evaluation import Evaluation
from models.core.system import Instance, System
from models.monolithic.equilibrium import equilibrium
from models.valve_train.beam import Disc, Shaft, find_bending, find_torsion, list_parameters

from .reynolds_bearing import solve_film
from .systems import outputs_of, rates_of

BEARING = CATALOGUE["journal_bearing"]()
# As good as smooth: asperities apart up to eps = 0.9996.
SMOOTH = {"roughness": 1e-9, "film_model": 0.0}
MU, R, L, C, K = 0.01, 12.5e-3, 12e-3, 25e-6, 2e8
ANGLES = st.floats(-math.pi, math.pi)
RATIOS = st.floats(0.0, 0.99)


def polar(size, angle):
    return Squeeze(size * math.cos(angle), size * math.sin(angle))


def turned(pair, angle):
    c, s = math.cos(angle), math.sin(angle)
    return Squeeze(c * pair[0] - s * pair[1], s * pair[0] + c * pair[1])


# The film


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


def test_squeeze_of_a_full_film_is_its_closed_form():
    """Both halves: pi (1 + 2 eps^2)/(1 - eps^2)^5/2."""
    for eps in (0.0, 0.3, 0.7, 0.95):
        both = find_impedance(eps, 0.0).along + find_impedance(-eps, 0.0).along
        full = math.pi * (1.0 + 2.0 * eps**2) / (1.0 - eps**2) ** 2.5
        assert both == pytest.approx(full, rel=1e-10)


# Finite width


def finite_attitude(eps, ratio):
    """Sommerfeld number mu N L D/W (R/c)^2 and attitude angle (rad) of the film under a steady load."""

    def across(angle):
        """Of the squeeze under a load along x, less that of the rotation, which is at right angles to eps."""
        u = find_finite_squeeze(Squeeze(1.0, 0.0), polar(eps, angle), ratio)
        return u.x * math.cos(angle) + u.y * math.sin(angle)

    angle = brentq(across, 1e-9, 0.5 * math.pi)
    u = find_finite_squeeze(Squeeze(1.0, 0.0), polar(eps, angle), ratio)
    # u = (omega/2) eps c and W = mu R L^3/c^2 per unit.
    return math.hypot(u.x, u.y) / (2.0 * math.pi * eps * ratio**2), angle


def test_a_narrow_bearing_is_short():
    for angle in (0.0, 1.0, 2.0, 3.0):
        eps = polar(0.7, angle)
        short, finite = (
            find_squeeze(Squeeze(0.6, 0.8), eps),
            find_finite_squeeze(Squeeze(0.6, 0.8), eps, 1e-5),
        )
        assert finite == pytest.approx(short, rel=1e-8, abs=1e-9)


# Raimondi and Boyd 1958, bearing of 360 degrees: Sommerfeld number and attitude (deg).
RAIMONDI_BOYD = {
    (0.25, 0.4): (2.83, 60.86),
    (0.25, 0.8): (0.261, 31.04),
    (0.5, 0.2): (2.03, 74.94),
    (0.5, 0.6): (0.319, 48.14),
    (0.5, 0.8): (0.0923, 33.31),
    (1.0, 0.6): (0.121, 50.58),
    (1.0, 0.8): (0.0446, 36.24),
}


@pytest.mark.parametrize(("ratio", "eps"), RAIMONDI_BOYD)
def test_steady_loads_of_finite_bearings(ratio, eps, record):
    """A published fit against a published solution: 15 % of the Sommerfeld number is 0.02 of eps at 0.8."""
    expected, attitude = RAIMONDI_BOYD[ratio, eps]
    found, angle = finite_attitude(eps, ratio)
    quantity = f"journal bearing of L/D = {ratio:g} at eps = {eps:g}"
    source = "Raimondi and Boyd 1958"
    record("Film", f"{quantity}: Sommerfeld number", found, expected, source, relative=0.15)
    record("Film", f"{quantity}: attitude angle (deg)", math.degrees(angle), attitude, source, tolerance=2.0)


@pytest.mark.parametrize(("ratio", "eps"), [(0.5, 0.2), (0.5, 0.8), (1.0, 0.6)])
def test_the_solution_of_reynolds_equation_is_raimondis(ratio, eps):
    """What judges the squeeze below: a steady load is a squeeze at right angles to eps. Their film begins at
    its widest place, this one where its pressure does."""
    film = solve_film(eps, ratio, -0.5 * math.pi)
    number = 1.0 / (2.0 * math.pi * eps * ratio**2 * math.hypot(film.x, film.y))
    expected, attitude = RAIMONDI_BOYD[ratio, eps]
    assert number == pytest.approx(expected, rel=0.01)
    assert math.degrees(math.atan2(-film.y, film.x)) == pytest.approx(attitude, abs=1.5)


@pytest.mark.parametrize(
    ("ratio", "eps", "tolerance"), [(0.25, 0.8, 0.08), (0.5, 0.4, 0.04), (0.5, 0.8, 0.15), (1.0, 0.6, 0.15)]
)
def test_squeeze_of_finite_bearings(ratio, eps, tolerance, record):
    """In nine directions, against Reynolds' equation."""
    worst = 0.0
    for direction in np.linspace(0.0, math.pi, 9):
        film = solve_film(eps, ratio, float(direction))
        u = find_finite_squeeze(Squeeze(film.x, film.y), Squeeze(eps, 0.0), ratio)
        worst = max(worst, math.hypot(u.x - math.cos(direction), u.y - math.sin(direction)))
    quantity = (
        f"journal bearing of L/D = {ratio:g} at eps = {eps:g}: squeeze velocity, largest difference (rel.)"
    )
    record("Film", quantity, worst, 0.0, "finite differences", tolerance=tolerance)


@pytest.mark.parametrize(("eps", "over"), [(0.4, 0.1), (0.8, 0.35)])
def test_the_highest_pressure_is_on_the_safe_side(eps, over):
    """That of the short film under the same load, at L/D = 1/2: never too low by more than 3 %."""
    for direction in np.linspace(0.0, math.pi, 9):
        film = solve_film(eps, 0.5, float(direction))
        at = Squeeze(eps, 0.0)
        found = highest_pressure(find_squeeze(Squeeze(film.x, film.y), at), at)
        assert 0.97 < found / film.highest < 1.0 + over


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


# Steady loads


def ocvirk_load(eps, speed):
    """mu omega R L^3/(4 c^2) eps/(1 - eps^2)^2 sqrt(pi^2 (1 - eps^2) + 16 eps^2)."""
    root_of = math.sqrt(math.pi**2 * (1.0 - eps**2) + 16.0 * eps**2)
    return MU * speed * R * L**3 / (4.0 * C**2) * eps / (1.0 - eps**2) ** 2 * root_of


def rates_under(load, e, speed, parameters):
    """Of the eccentricity e (m), where the support gives the load (N) to the journal."""
    state = {"eccentricity_x": e[0], "eccentricity_y": e[1]}
    place = {"axis_x": e[0] + load[0] / K, "axis_y": e[1] + load[1] / K}
    found = rates_of(BEARING, parameters, state, {"shaft_speed": speed, **place})
    return np.array([found["eccentricity_x"], found["eccentricity_y"]])


@pytest.mark.parametrize("eps", [0.05, 0.3, 0.6, 0.8, 0.95])
def test_eccentricity_and_attitude_under_a_steady_load(eps, record):
    """The journal comes to rest where Ocvirk's load is; tan(attitude) = pi sqrt(1 - eps^2)/(4 eps)."""
    speed = 100.0
    load = ocvirk_load(eps, speed)

    def unbalanced(ratios):
        return rates_under((0.0, -load), C * ratios, speed, SMOOTH) / (speed * C)

    x, y = root(unbalanced, [0.3 * eps, -0.8 * eps], tol=1e-14).x
    quantity = f"journal bearing under the load of eps = {eps:g}"
    source = "Ocvirk 1952"
    record("Film", f"{quantity}: eps", float(np.hypot(x, y)), eps, source, tolerance=1e-9)
    attitude = math.atan(math.pi * math.sqrt(1.0 - eps**2) / (4.0 * eps))
    record("Film", f"{quantity}: attitude angle (rad)", math.atan2(x, -y), attitude, source, tolerance=1e-9)


@pytest.mark.parametrize("eps", [0.3, 0.8])
def test_friction_under_a_steady_load(eps):
    """Shear, and half of the load's moment about the bush (Ocvirk 1952); no load, Petroff's."""
    speed, load = 100.0, ocvirk_load(eps, 100.0)
    attitude = math.atan(math.pi * math.sqrt(1.0 - eps**2) / (4.0 * eps))
    e = C * eps * math.sin(attitude), -C * eps * math.cos(attitude)
    found = outputs_of(
        BEARING,
        SMOOTH,
        {"eccentricity_x": e[0], "eccentricity_y": e[1]},
        {"shaft_speed": speed, "axis_x": e[0], "axis_y": e[1] - load / K},
    )
    petroff = 2.0 * math.pi * MU * speed * R**3 * L / C
    expected = petroff / math.sqrt(1.0 - eps**2) + 0.5 * load * C * eps * math.sin(attitude)
    assert found["friction_torque"] == pytest.approx(expected, rel=1e-9)
    assert found["power_loss"] == pytest.approx(expected * speed, rel=1e-9)
    assert found["load"] == pytest.approx(load, rel=1e-9)
    idle = outputs_of(BEARING, SMOOTH, {}, {"shaft_speed": speed})
    assert idle["friction_torque"] == pytest.approx(petroff, rel=1e-12)


def test_the_steady_pressure_is_ocvirks():
    """3 mu omega L^2/(4 c^2) eps sin(theta)/(1 + eps cos(theta))^3 in the middle of the width."""
    eps, speed = 0.7, 100.0
    attitude = math.atan(math.pi * math.sqrt(1.0 - eps**2) / (4.0 * eps))
    e = C * eps * math.sin(attitude), -C * eps * math.cos(attitude)
    found = outputs_of(
        BEARING,
        SMOOTH,
        {"eccentricity_x": e[0], "eccentricity_y": e[1]},
        {"shaft_speed": speed, "axis_x": e[0], "axis_y": e[1] - ocvirk_load(eps, speed) / K},
    )
    theta = np.linspace(0.0, math.pi, 100001)
    pressure = 0.75 * MU * speed * (L / C) ** 2 * eps * np.sin(theta) / (1.0 + eps * np.cos(theta)) ** 3
    assert found["maximum_pressure"] == pytest.approx(pressure.max(), rel=1e-8)


def test_time_of_a_squeeze_under_a_constant_load(record):
    """t = mu R L^3/(W c^2) [eps^2/(1 - eps^2) + eps (pi/2 + asin eps)/(1 - eps^2)^3/2], without rotation."""
    load, end = 500.0, 0.9

    def approach(t, e):
        return rates_under((0.0, load), (0.0, e[0]), 0.0, SMOOTH)[1:]

    def reach(t, e):
        return e[0] - end * C

    reach.terminal = True
    run = solve_ivp(approach, (0.0, 1.0), [0.0], events=reach, rtol=1e-11, atol=1e-17, method="DOP853")
    square = 1.0 - end**2
    expected = end**2 / square + end * (0.5 * math.pi + math.asin(end)) / square**1.5
    expected *= MU * R * L**3 / (load * C**2)
    record(
        "Film",
        "journal bearing: time of a squeeze to eps = 0.9 under 500 N (s)",
        float(run.t_events[0][0]),
        expected,
        "closed form, half a film",
        relative=1e-8,
    )


# Stability


def ocvirk_coefficients(eps):
    """Stiffness over W/c, damping over W/(c omega), along the load and across (Friswell et al. 2010, 5.5)."""
    s, square = math.pi**2, 1.0 - eps**2
    h = 1.0 / (s * square + 16.0 * eps**2) ** 1.5
    a = h * np.array(
        [
            [
                4.0 * (s * (2.0 - eps**2) + 16.0 * eps**2),
                math.pi * (s * square**2 - 16.0 * eps**4) / (eps * math.sqrt(square)),
            ],
            [
                -math.pi * (s * square * (1.0 + 2.0 * eps**2) + 32.0 * eps**2 * (1.0 + eps**2))
                / (eps * math.sqrt(square)),
                4.0 * (s * (1.0 + 2.0 * eps**2) + 32.0 * eps**2 * (1.0 + eps**2) / square),
            ],
        ]
    )  # fmt: skip
    mixed = -8.0 * (s * (1.0 + 2.0 * eps**2) - 16.0 * eps**2)
    b = h * np.array(
        [
            [2.0 * math.pi * math.sqrt(square) * (s * (1.0 + 2.0 * eps**2) - 16.0 * eps**2) / eps, mixed],
            [mixed, 2.0 * math.pi * (s * square**2 + 48.0 * eps**2) / (eps * math.sqrt(square))],
        ]
    )
    return a, b


def published_threshold(eps):
    """omega sqrt(m c/W) above which a rigid rotor whirls, and whirl over speed; inf where it never does."""
    a, b = ocvirk_coefficients(eps)
    kappa = (a[0, 0] * b[1, 1] + a[1, 1] * b[0, 0] - a[0, 1] * b[1, 0] - a[1, 0] * b[0, 1]) / np.trace(b)
    square = ((a[0, 0] - kappa) * (a[1, 1] - kappa) - a[0, 1] * a[1, 0]) / np.linalg.det(b)
    return (math.sqrt(kappa / square), math.sqrt(square)) if square > 0.0 else (math.inf, 0.0)


def whirl_roots(eps, parameter, speed=100.0):
    """Eigenvalues of a rigid rotor in the component's bearing, linear about the steady position."""
    load = ocvirk_load(eps, speed)
    mass = load * (parameter / speed) ** 2 / C
    attitude = math.atan(math.pi * math.sqrt(1.0 - eps**2) / (4.0 * eps))
    e = np.array([C * eps * math.sin(attitude), -C * eps * math.cos(attitude)])
    # Support a million times as stiff as the film.
    stiff = 1e6 * load / C
    parameters = {**SMOOTH, "support_stiffness": stiff}
    # Eccentricity, deflection of the support, velocity.
    rest = np.array([*e, 0.0, -load / stiff, 0.0, 0.0])

    def rate(z):
        state = {"eccentricity_x": z[0], "eccentricity_y": z[1]}
        inputs = {"shaft_speed": speed, "axis_x": z[0] + z[2], "axis_y": z[1] + z[3]}
        named = rates_of(BEARING, parameters, state, inputs)
        moved = np.array([named["eccentricity_x"], named["eccentricity_y"]])
        pull = -stiff * z[2:4] - (0.0, load)
        return np.concatenate([moved, z[4:] - moved, pull / mass])

    size = np.repeat([1e-6 * C, 1e-6 * load / stiff, 1e-6 * C * speed], 2)
    matrix = np.column_stack(
        [(rate(rest + s * unit) - rate(rest - s * unit)) / (2.0 * s)
         for s, unit in zip(size, np.eye(6), strict=True)]
    )  # fmt: skip
    return np.linalg.eigvals(matrix)


@pytest.mark.parametrize("eps", [0.02, 0.3, 0.6])
def test_threshold_of_whirl(eps, record):
    """A rigid rotor in the component, against the linear coefficients of Ocvirk's film."""

    def growth(parameter):
        return float(whirl_roots(eps, parameter).real.max())

    expected, ratio = published_threshold(eps)
    found = brentq(growth, 0.8 * expected, 1.25 * expected, xtol=1e-8)
    roots = whirl_roots(eps, found)
    whirl = abs(roots[np.argmax(roots.real)].imag) / 100.0
    source = "coefficients of Friswell et al. 2010"
    quantity = f"rigid rotor in a journal bearing at eps = {eps:g}"
    record("Film", f"{quantity}: threshold omega sqrt(m c/W)", found, expected, source, relative=2e-5)
    record("Film", f"{quantity}: whirl over speed", whirl, ratio, source, relative=2e-5)


def test_a_light_load_whirls_at_half_the_speed(record):
    """kappa -> 6/pi and a ratio of 1/2 give sqrt(24/pi) = 2.764 as eps -> 0."""
    threshold, ratio = published_threshold(1e-4)
    assert ratio == pytest.approx(0.5, rel=1e-6)
    assert threshold == pytest.approx(math.sqrt(24.0 / math.pi), rel=1e-6)
    found = brentq(lambda p: float(whirl_roots(2e-3, p).real.max()), 2.5, 3.0, xtol=1e-8)
    record(
        "Film",
        "rigid rotor in a journal bearing, eps -> 0: threshold omega sqrt(m c/W)",
        found,
        math.sqrt(24.0 / math.pi),
        "closed form",
        relative=1e-3,
    )


def test_a_heavy_load_never_whirls():
    """Above eps = 0.756, at any speed."""
    assert math.isfinite(published_threshold(0.75)[0])
    assert published_threshold(0.76)[0] == math.inf
    for parameter in (3.0, 10.0, 30.0):
        assert whirl_roots(0.8, parameter).real.max() < 0.0


# The component


@settings(max_examples=60, deadline=None)
@given(st.floats(0.0, 1.05), ANGLES, st.floats(0.0, 3e-5), ANGLES, st.floats(-300.0, 300.0), ANGLES)
def test_all_directions_are_equal(ratio, angle, stretch, direction, speed, turn):
    """Turning the journal and its axis turns the force and the motion, and nothing else."""

    def evaluate(by):
        e = turned(polar(ratio * C, angle), by)
        a = turned(np.add(polar(ratio * C, angle), polar(stretch, direction)), by)
        state = {"eccentricity_x": e.x, "eccentricity_y": e.y}
        inputs = {"shaft_speed": speed, "axis_x": a.x, "axis_y": a.y}
        return outputs_of(BEARING, {}, state, inputs), rates_of(BEARING, {}, state, inputs)

    y, dx = evaluate(0.0)
    there, moved = evaluate(turn)
    for name in ("friction_torque", "load", "maximum_pressure", "asperity_load", "power_loss"):
        assert there[name] == pytest.approx(y[name], rel=1e-6, abs=1e-6)
    force = turned((y["force_x"], y["force_y"]), turn)
    assert there["force_x"] == pytest.approx(force.x, abs=1e-6)
    assert there["force_y"] == pytest.approx(force.y, abs=1e-6)
    rate = turned((dx["eccentricity_x"], dx["eccentricity_y"]), turn)
    size = 1e-6 * (math.hypot(*rate) + 1e-6)
    assert moved["eccentricity_x"] == pytest.approx(rate.x, abs=size)
    assert moved["eccentricity_y"] == pytest.approx(rate.y, abs=size)


@settings(max_examples=60, deadline=None)
@given(st.floats(0.9, 1.1), st.floats(0.0, 2e4))
def test_a_pressed_journal_neither_leaves_the_bush_nor_hangs(ratio, load):
    """At rest it sinks slower than in a film of rms thickness, until the asperities carry the load."""
    found = rates_under((load, 0.0), (ratio * C, 0.0), 0.0, {})[0]
    carried = outputs_of(BEARING, {}, {"eccentricity_x": ratio * C}, {})["asperity_load"]
    assume(abs(load - carried) > 1e-9 * load)
    assert (found > 0.0) == (load > carried)
    assert math.isfinite(found)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"width": 30e-3}, "width = 30 mm: must be <= diameter = 25 mm"),
        ({"roughness": 5e-6}, "roughness = 5 um: must be <= 2.5 um"),
    ],
)
def test_bearings_outside_the_theory_are_refused(values, message):
    assert message in BEARING.parameter_faults(BEARING.parameters.vector(values))[0]


def test_a_journal_outside_its_bush_is_refused():
    x = BEARING.state.vector({"eccentricity_x": 21e-6, "eccentricity_y": 21e-6})
    p, u = BEARING.parameters.vector({}), BEARING.inputs.vector({})
    assert "must be less than 29 um" in BEARING.start_faults(p, x, u)[0]


@pytest.mark.parametrize("speed", [100.0, 5.0, 0.5])
def test_a_loaded_shaft_finds_its_rest_in_its_bearings(speed):
    """From the middle of the clearance, down to speeds at which the asperities carry the load (N)."""
    load, span = 400.0, 0.16
    drawn = Shaft(0.2, 25e-3, [Disc(0.06, 0.1, 1.2e-4, 0.7e-4)], journals=(0.02, 0.18))
    torsion, bending = find_torsion(drawn, 2), find_bending(drawn, 2)
    sizes = {"torsion_modes": torsion.frequency.size, "bending_modes": bending.frequency.size}
    ports = ("axis_x", "axis_y", "axis_velocity_x", "axis_velocity_y")
    wires = []
    for i in (2, 3):
        wires += [(f"shaft.{port}[{i}]", f"bearing_{i}.{port}") for port in ports]
        wires += [(f"shaft.cam_speed[{i}]", f"bearing_{i}.shaft_speed")]
        wires += [(f"bearing_{i}.force_{end}", f"shaft.cam_force_{end}[{i}]") for end in "xy"]
        wires += [(f"bearing_{i}.friction_torque", f"shaft.cam_torque[{i}]")]
    turning = {"drive_speed": speed, "cam_force_y[1]": -load}
    modes = list_parameters(torsion, bending, 0.0, 0.02)
    system = System(
        {
            "shaft": Instance(CATALOGUE["shaft"](cams=3, **sizes), modes, inputs=turning),
            "bearing_2": Instance(BEARING, {}),
            "bearing_3": Instance(BEARING, {}),
        },
        wires,
    )
    found = Evaluation(system).outputs(0.0, equilibrium(system))
    at = dict(zip(system.outputs.names, found, strict=True))
    assert at["bearing_2.force_y"] == pytest.approx(load * 0.12 / span, rel=1e-6)
    assert at["bearing_3.force_y"] == pytest.approx(load * 0.04 / span, rel=1e-6)
    assert at["bearing_2.force_x"] == pytest.approx(0.0, abs=1e-6 * load)
    assert (at["bearing_2.asperity_load"] > 0.5 * load * 0.12 / span) == (speed < 1.0)
