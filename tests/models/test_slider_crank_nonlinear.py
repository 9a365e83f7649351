"""The slider-crank without the small-angle step: closed forms, limits, symmetries, impacts."""

import math
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from models.core.quantities import Vector
from models.slider_crank import forms
from models.slider_crank.equations import Crank, coupling, inertia, thesis_mechanism

from .slider_cranks import CRANK, FORMS, INPUTS, STATE, advance, energies, thesis_parameters

XI = 0.3030


def sigma(theta: float, psi: float) -> float:
    """Angle between crank and rod, theta + eta."""
    return theta + math.asin(XI * math.sin(theta)) - psi


@pytest.mark.parametrize(("theta", "psi", "rate"), [(0.4, 0.1, 0.0), (2.0, -0.3, 1.5), (5.0, 0.2, -1.0)])
@pytest.mark.parametrize("speed", [1.0, -0.7])
def test_free_flight_is_a_damped_pendulum(theta, psi, rate, speed, record):
    """a sigma'' + lambda sigma' + k theta'^2 sin sigma = 0 at constant speed; scipy's DOP853 for the same.

    The component's micro-steps are good to 1e-10, some ten of them here.
    """
    damping, span = 0.3, 0.3
    m = thesis_mechanism(damping, corrected=True)
    a, k = inertia(m), coupling(m)
    p = thesis_parameters(damping, 0.69, form=forms.NONLINEAR)
    x = STATE.vector({"psi": psi, "psi_rate": rate})
    y = advance(CRANK, x, p, 0.0, span, crank_angle=(theta, speed), crank_speed=speed)
    assert y["impact_count"] == 0.0
    slope = XI * math.cos(theta) / math.sqrt(1.0 - (XI * math.sin(theta)) ** 2)
    pendulum = solve_ivp(
        lambda t, s: (s[1], -(damping * s[1] + k * speed**2 * math.sin(s[0])) / a),
        (0.0, span),
        (sigma(theta, psi), speed * (1.0 + slope) - rate),
        method="DOP853",
        rtol=1e-13,
        atol=1e-13,
    )
    found, exact = sigma(theta + speed * span, x[0]), pendulum.y[0, -1]
    quantity = "angle of the nonlinear flight (rad)"
    record("Slider-crank", quantity, found, exact, "damped pendulum by DOP853", tolerance=1e-9)


def order(error_of: Callable[[float], float], coarse: float = 1e-3) -> float:
    """Exponent with which an error falls when the clearance is halved."""
    return math.log2(error_of(coarse) / error_of(0.5 * coarse))


@pytest.mark.parametrize("theta", [0.8, 2.4, 4.0])
@pytest.mark.parametrize("name", ["wall", "acceleration", "force", "torque", "energy"])
def test_linear_form_is_the_limit_of_small_clearance(name, theta, record):
    """Second order in psi, third in the energy; at varying speed.

    First order in the wall's force: the linear forms put its lever cos eta at cos phi.
    """
    m, speed, acceleration = thesis_mechanism(0.1, corrected=True), 1.3, -0.7

    def value(form, gap):
        psi = forms.wall_angle(form, theta, gap, m)
        rate = -0.4 * gap
        if name == "wall":
            return psi
        if name == "force":
            return forms.constraint_force(form, Crank(theta, speed, acceleration), psi, m)
        # The same psi for both, away from the walls.
        psi = 0.7 * gap
        if name == "energy":
            return forms.kinetic_energy(form, theta, speed, psi, rate, m)
        change = forms.flight_acceleration(form, Crank(theta, speed, acceleration), psi, rate, m)
        if name == "acceleration":
            return change
        return forms.crank_torque(form, Crank(theta, speed, acceleration), psi, rate, change, 0.0, m)

    def error(gap):
        return abs(value(forms.NONLINEAR, gap) - value(forms.CORRECTED, gap))

    expected = {"energy": 3.0, "force": 1.0}.get(name, 2.0)
    quantity = f"order of the difference between nonlinear and linear form in the clearance, {name}"
    record("Slider-crank", quantity, order(error), expected, "expansion in psi", tolerance=0.15)
    assert error(0.001) < 0.001**expected


def strike_wall(
    form: float, side: float, restitution: float, threshold: float = 0.0
) -> tuple[Vector, Vector, Vector, float, float]:
    """p, inputs, state just after an impact on a moving film, and psi' and energy just before."""
    p = thesis_parameters(0.2, 0.02, form=form, restitution=restitution, sliding_threshold=threshold)
    films = {"upper_wall_film": 0.003, "lower_wall_film": 0.001}
    rates = {"upper_wall_film_rate": 0.02, "lower_wall_film_rate": -0.01}
    u = INPUTS.vector({"crank_angle": 1.1 + side, "crank_speed": 1.4})
    gap = side * (0.02 - (0.003 if side > 0.0 else 0.001))
    psi = forms.wall_angle(form, u[0], gap, thesis_mechanism(0.2, corrected=True))
    x = STATE.vector({"psi": psi, "psi_rate": side * 0.3, **films, **rates})
    before = energies(CRANK, x, u, p)[0]
    CRANK.flat_transition(0 if side > 0.0 else 1, 0.0, x, u, p)
    return p, u, x, side * 0.3, before


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("restitution", [0.0, 0.6, 1.0])
def test_impact_reverses_the_pistons_velocity_relative_to_the_moving_wall(side, restitution):
    """F (2.16): y' - wall' -> -e (y' - wall'), with y = xi sin theta - sin eta exactly."""
    _, u, x, before, _ = strike_wall(forms.NONLINEAR, side, restitution)
    theta, speed = u[0], u[1]
    wall = -side * (0.02 if side > 0.0 else -0.01)

    def lateral(rate):
        phi = math.asin(XI * math.sin(theta))
        eta_rate = XI * math.cos(theta) / math.cos(phi) * speed - rate
        return XI * math.cos(theta) * speed - math.cos(phi - x[0]) * eta_rate

    assert lateral(x[1]) - wall == pytest.approx(-restitution * (lateral(before) - wall), abs=1e-14)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize(("restitution", "threshold"), [(0.6, 0.0), (1.0, 0.0), (0.6, 1.0)])
def test_energy_of_an_impact_is_work_of_crank_and_film_less_its_loss(form, side, restitution, threshold):
    """Kinetic energy jumps by (crank impulse) theta' + (wall impulse) film' - loss; no loss if elastic.

    Also where sliding begins, by a threshold that each rebound is below.
    """
    p, u, x, _, before = strike_wall(form, side, restitution, threshold)
    after = energies(CRANK, x, u, p)[0]
    names = ("crank_impact_impulse", "upper_impact_impulse", "lower_impact_impulse", "impact_loss")
    on_crank, upper, lower, loss = (x[STATE.index(name)] for name in names)
    work = on_crank * u[1] + upper * 0.02 - lower * 0.01
    # psi is put inside by two roundings.
    assert after - before == pytest.approx(work - loss, abs=1e-14)
    assert x[STATE.index("impact_work")] == pytest.approx(work, abs=1e-14)
    assert (loss == 0.0) == (restitution == 1.0)


@settings(max_examples=20, deadline=None, derandomize=True)
@given(
    damping=st.floats(0.0, 0.4),
    gap=st.floats(1e-4, 0.08),
    restitution=st.floats(0.0, 0.95),
    rate=st.floats(-0.2, 0.2),
    start=st.floats(0.0, 6.0),
    form=st.sampled_from(FORMS),
)
def test_reflected_machine_moves_as_the_mirror_image(damping, gap, restitution, rate, start, form):
    """Crank and rod reflected in the cylinder's axis: psi changes sign, the walls their places.

    Films of 1e-300 m send both motions to the integrator, which has this symmetry to the last bit.
    """
    p = thesis_parameters(damping, gap, restitution=restitution, form=form)

    def motion(side):
        x = STATE.vector({"psi_rate": side * rate})
        films = {"upper_film_thickness": 1e-300, "lower_film_thickness": 1e-300}
        crank = {"crank_angle": (side * start, side), "crank_speed": side}
        return x, advance(CRANK, x, p, 0.0, 4.0, **crank, **films)

    (x, y), (mirrored, outputs) = motion(1.0), motion(-1.0)
    for name in ("psi", "psi_rate", "mode", "crank_impact_impulse"):
        assert mirrored[STATE.index(name)] == -x[STATE.index(name)]
    assert outputs["crank_torque"] == -y["crank_torque"]
    for upper in (name for name in STATE.names if name.startswith("upper")):
        lower = upper.replace("upper", "lower")
        assert mirrored[STATE.index(lower)] == x[STATE.index(upper)]
        assert mirrored[STATE.index(upper)] == x[STATE.index(lower)]


@pytest.mark.parametrize(("theta", "psi"), [(0.4, 0.1), (2.0, -0.3), (5.0, 0.2)])
def test_a_wall_loads_a_crank_at_rest_by_its_virtual_work(theta, psi):
    """The slider is y = xi sin(theta) - sin(eta) above the axis: F downwards takes the torque F dy/dtheta."""
    m = thesis_mechanism(0.0, corrected=True)
    found = forms.crank_torque(forms.NONLINEAR, Crank(theta, 0.0, 0.0), psi, 0.0, 0.0, 3.0, m)
    assert found == pytest.approx(3.0 * XI * math.cos(theta), rel=1e-12)
