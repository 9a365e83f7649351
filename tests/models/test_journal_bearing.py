"""Journal bearings: steady loads against Ocvirk's closed forms, whirl of a rotor, symmetry."""

import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root

from models.catalogue import CATALOGUE
from models.core.evaluation import Evaluation
from models.core.system import Instance, System
from models.monolithic.equilibrium import equilibrium
from models.valve_train.beam import Disc, Shaft, find_bending, find_torsion, list_parameters

from .systems import outputs_of, rates_of

BEARING = CATALOGUE["journal_bearing"]()
# As good as smooth: asperities apart up to eps = 0.9996.
SMOOTH = {"roughness": 1e-9, "film_model": 0.0}
MU, R, L, C, K = 0.01, 12.5e-3, 12e-3, 25e-6, 2e8
ANGLES = st.floats(-math.pi, math.pi)


def polar(size, angle):
    return size * np.array([math.cos(angle), math.sin(angle)])


def turned(pair, angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * pair[0] - s * pair[1], s * pair[0] + c * pair[1]])


# Steady loads


def ocvirk_attitude(eps):
    """tan(attitude) = pi sqrt(1 - eps^2)/(4 eps)."""
    return math.atan(math.pi * math.sqrt(1.0 - eps**2) / (4.0 * eps))


def ocvirk_place(eps):
    """The eccentricity (m) under a load along -y."""
    return C * eps * np.array([math.sin(ocvirk_attitude(eps)), -math.cos(ocvirk_attitude(eps))])


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
    """The journal comes to rest where Ocvirk's load is."""
    speed = 100.0
    load = ocvirk_load(eps, speed)

    def unbalanced(ratios):
        return rates_under((0.0, -load), C * ratios, speed, SMOOTH) / (speed * C)

    x, y = root(unbalanced, [0.3 * eps, -0.8 * eps], tol=1e-14).x
    quantity = f"journal bearing under the load of eps = {eps:g}"
    source = "Ocvirk 1952"
    record("Film", f"{quantity}: eps", float(np.hypot(x, y)), eps, source, tolerance=1e-9)
    found, attitude = math.atan2(x, -y), ocvirk_attitude(eps)
    record("Film", f"{quantity}: attitude angle (rad)", found, attitude, source, tolerance=1e-9)


@pytest.mark.parametrize("eps", [0.3, 0.8])
def test_friction_and_pressure_under_a_steady_load(eps):
    """Shear, and half of the load's moment about the bush (Ocvirk 1952); no load, Petroff's. The pressure is
    3 mu omega L^2/(4 c^2) eps sin(theta)/(1 + eps cos(theta))^3 in the middle of the width."""
    speed, load, e = 100.0, ocvirk_load(eps, 100.0), ocvirk_place(eps)
    found = outputs_of(
        BEARING,
        SMOOTH,
        {"eccentricity_x": e[0], "eccentricity_y": e[1]},
        {"shaft_speed": speed, "axis_x": e[0], "axis_y": e[1] - load / K},
    )
    petroff = 2.0 * math.pi * MU * speed * R**3 * L / C
    expected = petroff / math.sqrt(1.0 - eps**2) + 0.5 * load * e[0]
    assert found["friction_torque"] == pytest.approx(expected, rel=1e-9)
    assert found["power_loss"] == pytest.approx(expected * speed, rel=1e-9)
    assert found["load"] == pytest.approx(load, rel=1e-9)
    idle = outputs_of(BEARING, SMOOTH, {}, {"shaft_speed": speed})
    assert idle["friction_torque"] == pytest.approx(petroff, rel=1e-12)
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
    quantity = "journal bearing: time of a squeeze to eps = 0.9 under 500 N (s)"
    record("Film", quantity, float(run.t_events[0][0]), expected, "closed form, half a film", relative=1e-8)


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
    e = ocvirk_place(eps)
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


def test_a_heavy_load_never_whirls():
    """Above eps = 0.756, at any speed."""
    assert math.isfinite(published_threshold(0.75)[0])
    assert published_threshold(0.76)[0] == math.inf
    for parameter in (3.0, 10.0, 30.0):
        assert whirl_roots(0.8, parameter).real.max() < 0.0


# The component


@settings(max_examples=60, deadline=None)
@given(
    st.floats(0.0, 1.05), ANGLES, st.floats(0.0, 3e-5), ANGLES, st.floats(-300.0, 300.0), ANGLES,
    st.sampled_from([1.0, 2.0]),
)  # fmt: skip
@example(1.0, 0.7, 1e-5, 2.0, 100.0, 1.0, 1.0)  # pressed into the bush
@example(0.9, 0.7, 1e-5, 2.0, 100.0, 1.0, 2.0)
def test_all_directions_are_equal(ratio, angle, stretch, direction, speed, turn, model):
    """Turning the journal, its axis and its grooves turns the force and the motion, and nothing else."""

    def evaluate(by):
        e = turned(polar(ratio * C, angle), by)
        a = turned(polar(ratio * C, angle) + polar(stretch, direction), by)
        state = {"eccentricity_x": e[0], "eccentricity_y": e[1]}
        inputs = {"shaft_speed": speed, "axis_x": a[0], "axis_y": a[1]}
        values = {"film_model": model, "groove_angle": 0.3 + by}
        return outputs_of(BEARING, values, state, inputs), rates_of(BEARING, values, state, inputs)

    y, dx = evaluate(0.0)
    there, moved = evaluate(turn)
    for name in ("friction_torque", "load", "maximum_pressure", "asperity_load", "power_loss"):
        assert there[name] == pytest.approx(y[name], rel=1e-6, abs=1e-6)
    force = turned((y["force_x"], y["force_y"]), turn)
    assert (there["force_x"], there["force_y"]) == pytest.approx(force, abs=1e-6)
    rate = turned((dx["eccentricity_x"], dx["eccentricity_y"]), turn)
    size = 1e-6 * (math.hypot(*rate) + 1e-6)
    assert (moved["eccentricity_x"], moved["eccentricity_y"]) == pytest.approx(rate, abs=size)


@settings(max_examples=60, deadline=None)
@given(st.floats(0.9, 1.1), st.floats(0.0, 2e4))
def test_a_pressed_journal_neither_leaves_the_bush_nor_hangs(ratio, load):
    """At rest it sinks slower than in a film of rms thickness, until the asperities carry the load."""
    found = rates_under((load, 0.0), (ratio * C, 0.0), 0.0, {})[0]
    carried = outputs_of(BEARING, {}, {"eccentricity_x": ratio * C}, {})["asperity_load"]
    assume(abs(load - carried) > 1e-9 * load)
    assert (found > 0.0) == (load > carried)
    assert math.isfinite(found)


def test_grooves_concern_the_film_with_grooves_only():
    assert not BEARING.parameter_faults(BEARING.parameters.vector({"groove_width": 20.0}))


@pytest.mark.parametrize("speed", [100.0, 0.5])
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
