"""The slider-crank component: its numbers, energy, walls, and independence of how time is cut."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
from models.core.component import Component
from models.core.evaluation import check_start
from models.core.quantities import Vector
from models.core.system import Instance, ModelError, System
from models.monolithic import solve
from models.slider_crank import forms
from models.slider_crank.records import mechanism

from .slider_cranks import (
    CRANK,
    DRIVEN,
    FILMS,
    FORMS,
    FREE,
    INPUTS,
    LAG,
    STATE,
    TURN,
    advance,
    power_imbalance,
    thesis_parameters,
    turn,
)


def test_defaults_are_the_thesis_engine():
    m = mechanism(CRANK.parameters.view(CRANK.parameters.vector()))
    assert (m.xi, m.alpha, m.beta) == pytest.approx((0.3030, 1.9000, 0.4719), rel=1e-14)
    assert m.forcing_beta == m.beta
    assert m.damping / (1000.0 * math.pi / 30.0) == pytest.approx(0.05)
    p = CRANK.parameters.named(CRANK.parameters.vector())
    pound_force, inch = 4.4482216152605, 0.0254
    assert p["crank_radius"] == pytest.approx(1.6535 * inch, rel=4e-4)
    assert p["rod_mass"] == pytest.approx(0.00399 * pound_force / inch, rel=4e-4)
    assert p["rod_inertia"] == pytest.approx(0.0295 * pound_force * inch, rel=4e-4)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("mode", [0.0, 1.0, -1.0])
def test_power_balances_at_every_instant(form, mode):
    """d(stored)/dt = torque * speed - friction + source, also at varying speed and with moving films."""
    rng = np.random.default_rng(3)
    p = CRANK.parameters.vector({"form": form})
    for _ in range(20):
        U = CRANK.input_polynomial()
        theta, speed, acceleration = rng.uniform([0.0, -300.0, -1e4], [TURN, 300.0, 1e4])
        films, rates = rng.uniform(0.0, 1e-4, 2), rng.uniform(-0.01, 0.01, 2)
        U[0] = [theta, speed, acceleration, *(films + rng.uniform(-1e-6, 1e-6, 2))]
        U[1] = [speed, acceleration, 0.0, *rates]
        U[2, 0] = acceleration
        x = STATE.vector({"psi": rng.uniform(-0.01, 0.01), "psi_rate": rng.uniform(-5.0, 5.0), "mode": mode})
        x[FILMS] = films[0], rates[0], films[1], rates[1]
        imbalance, size = power_imbalance(CRANK, x, U, p)
        assert abs(imbalance) < 1e-6 * (size + 1e3)


def test_impact_loss_is_that_of_the_restitution():
    """(1 - e) P v / 2 with the impulse P = (1 + e) v m_eff, m_eff = a M / Lambda^2."""
    p = thesis_parameters(0.0, 0.015)
    x = STATE.vector()
    turn(CRANK, x, p, 0.0, 0.9)
    assert x[3] + x[4] == 1.0
    velocity, impulse = x[11], x[5] + x[6]
    big = 1.0 - (0.303 * math.sin(x[10])) ** 2
    assert impulse == pytest.approx(1.9 * velocity * (1.9 / 4.0 + 1.0 + 0.4719) / big, rel=1e-12)
    assert x[12] == pytest.approx(0.05 * impulse * velocity, rel=1e-12)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    damping=st.floats(0.0, 0.5),
    gap=st.floats(0.0, 0.03, allow_subnormal=False),  # those have fewer digits
    restitution=st.floats(0.0, 0.95),
    rate=st.floats(-0.2, 0.2),
    start=st.floats(0.0, 6.0),
    form=st.sampled_from(FORMS),
    threshold=st.sampled_from([0.0, 0.005]),
)
@example(damping=0.1, gap=0.3, restitution=0.9, rate=0.0, start=0.0, form=2.0, threshold=0.0)
def test_walls_are_never_passed_and_only_push(damping, gap, restitution, rate, start, form, threshold):
    p = thesis_parameters(damping, gap, restitution=restitution, form=form, sliding_threshold=threshold)
    x = STATE.vector({"psi_rate": rate})
    sums = np.zeros(4)
    for part in range(20):
        y = turn(CRANK, x, p, start + 0.3 * part, 0.3)
        # The wall's psi is known to rounding.
        assert abs(y["piston_offset"]) <= gap * (1.0 + 1e-13)
        # At the instant of release the force is zero to rounding.
        assert min(y["upper_wall_force"], y["lower_wall_force"]) >= -1e-12
        now = x[5:9].copy()
        assert (now >= sums).all()
        sums = now


def impacts_of(p: Vector, cuts: Vector, **constant: float) -> Vector:
    """Impact count and last impact's time (that of a release does not show) at the end of every piece."""
    x, found = STATE.vector(), []
    for start, end in itertools.pairwise(cuts):
        turn(CRANK, x, p, start, end - start, **constant)
        found.append((x[3] + x[4], x[10]))
    return np.array(found)


@pytest.mark.parametrize("form", FORMS)
def test_cutting_time_changes_no_impact(form):
    """Pieces of any size, down to 1e-9 rad, over two turns of a chaotic motion: the same impacts.

    Times to 1e-12: rounding of 2e-16 a piece, grown by e^(0.41 * 13) = 200.
    """
    p, horizon = thesis_parameters(0.05, 0.01, form=form), 2.0 * TURN
    rng = np.random.default_rng(7)
    fine = np.concatenate([[0.0, horizon], rng.uniform(0.0, horizon, 400), 3.0 + 1e-9 * np.arange(20)])
    finer = np.unique(np.concatenate([fine, rng.uniform(0.0, horizon, 400)]))
    fine = np.unique(fine)
    first, second = impacts_of(p, fine), impacts_of(p, finer)
    second = second[np.searchsorted(finer, fine[1:]) - 1]
    assert first[-1, 0] > 8.0
    assert np.array_equal(first[:, 0], second[:, 0])
    assert np.abs(first[:, 1] - second[:, 1]).max() < 1e-12
    assert impacts_of(p, np.array([0.0, horizon]))[0] == pytest.approx(first[-1], abs=1e-12)


@pytest.mark.parametrize("form", [0.0, 2.0])
def test_exact_flights_are_those_of_the_integrator(form):
    """A film of 1e-300 m sends the step to the hybrid integrator: the same impacts to its tolerance.

    1e-10 a micro-step, grown by e^(0.41 * 8) = 27 over 8 rad.
    """
    p, cuts = thesis_parameters(0.05, 0.01, form=form), np.linspace(0.0, 8.0, 41)
    exact = impacts_of(p, cuts)
    integrated = impacts_of(p, cuts, upper_film_thickness=1e-300)
    assert np.array_equal(exact[:, 0], integrated[:, 0])
    assert 0.0 < np.abs(exact[:, 1] - integrated[:, 1]).max() < 3e-9


@pytest.mark.parametrize("film", [0.0, 1e-300])
@pytest.mark.parametrize(("end", "mode"), [(13.775, 0.0), (15.0, 1.0), (18.0, 0.0)])
def test_restored_state_repeats_bit_for_bit(film, end, mode):
    """In the middle of chattering (13.775), of sliding and of flight; exact flights and integrated ones."""
    p, x = thesis_parameters(0.25, 0.015), STATE.vector()
    turn(CRANK, x, p, 0.0, end, upper_film_thickness=film)
    assert x[STATE.index("mode")] == mode
    again = x.copy()
    y = turn(CRANK, x, p, end, 12.0, upper_film_thickness=film)
    assert turn(CRANK, again, p, end, 12.0, upper_film_thickness=film) == y
    assert np.array_equal(again, x)


@pytest.mark.parametrize("form", FORMS)
def test_film_narrows_the_clearance_and_moves_the_wall(form):
    """Sliding on a film: the offset is clearance - film, and follows a film of constant rate 2 T late."""
    p, film, rate = thesis_parameters(0.35, 0.015, form=form), 0.002, -1e-4
    x = STATE.vector({"upper_wall_film": film})
    y = turn(CRANK, x, p, 0.0, 20.0, upper_film_thickness=film)
    assert y["sliding"] == 1.0
    assert y["piston_offset"] == pytest.approx(0.015 - film, rel=1e-14)
    y = turn(CRANK, x, p, 20.0, 3.0, upper_film_thickness=(film, rate))
    # To the integrator's tolerance on a film of mm.
    late = film + (3.0 - 2.0 * LAG) * rate
    assert y["piston_offset"] == pytest.approx(0.015 - late, abs=1e-12)
    # The state psi, integrated from the rates, is the same.
    assert x[0] == pytest.approx(y["psi"], rel=1e-9)


@pytest.mark.parametrize("form", FORMS)
def test_no_clearance_is_the_nominal_mechanism(form):
    x = STATE.vector()
    y = turn(CRANK, x, thesis_parameters(0.05, 0.0, form=form), 0.0, 7.0)
    assert y["psi"] == 0.0
    assert abs(y["sliding"]) == 1.0
    assert y["piston_position"] == pytest.approx(
        0.303 * math.cos(7.0) + math.sqrt(1.0 - (0.303 * math.sin(7.0)) ** 2), rel=1e-14
    )


@pytest.mark.parametrize("form", FORMS)
def test_crank_at_rest_comes_to_rest(form):
    """Nothing is divided by the speed: a swinging rod is stopped by friction."""
    p, x = thesis_parameters(0.5, 0.015, form=form), STATE.vector({"psi_rate": 0.05})
    y = advance(CRANK, x, p, 0.0, 200.0)
    assert abs(x[1]) < 1e-10
    assert y["impact_count"] > 2.0


MID_STROKE = {"crank_angle": 0.5 * math.pi}


def slider_faults(form: float, start: dict[str, float], inputs: dict[str, float] | None = None) -> list[str]:
    p = thesis_parameters(0.05, 0.015, form=form)
    return CRANK.start_faults(p, STATE.vector(start), INPUTS.vector(inputs))


@pytest.mark.parametrize("form", FORMS)
def test_slider_starts_between_or_on_its_walls(form):
    """Up to a millionth of the travel outside, which is the rounding of what a user types."""
    for psi in (-0.0149, 0.0, 0.015, 0.015 + 1e-6 * 0.03):
        assert slider_faults(form, {"psi": psi}) == []
    assert slider_faults(form, {"psi": -0.0157}, MID_STROKE) == []
    for psi in (-0.0157, 0.0157):
        (fault,) = slider_faults(form, {"psi": psi})
        assert fault.startswith(f"psi = {psi:g} rad")
        assert "from -0.015" in fault
        assert "to 0.015" in fault
        assert "crank_angle = 0 rad" in fault


@pytest.mark.parametrize(
    ("form", "start", "inputs", "key"),
    [
        # At mid-stroke the upper wall is at 0.01574 rad (linear) and 0.01570 rad (exact).
        (forms.CORRECTED, {"psi": 0.01572}, MID_STROKE, None),
        (forms.NONLINEAR, {"psi": 0.01572}, MID_STROKE, "to 0.0157013789 rad"),
        (forms.CORRECTED, {"psi": 0.012, "upper_wall_film": 0.005}, None, "to 0.01 rad"),
        (forms.CORRECTED, {"upper_wall_film": 0.01, "lower_wall_film": 0.03}, None, "clearance of 0.015"),
        (forms.CORRECTED, {"mode": -1.0, "psi": -0.0149}, None, None),
        (forms.CORRECTED, {"mode": 1.0, "psi": 0.0149}, None, None),
        (forms.CORRECTED, {"mode": -1.0, "psi": 0.015}, None, "psi = -0.015 rad"),
        (forms.CORRECTED, {"mode": 1.0, "psi": -0.015}, None, "psi = 0.015 rad"),
    ],
)
def test_walls_of_the_start_are_those_of_form_films_and_mode(form, start, inputs, key):
    faults = slider_faults(form, start, inputs)
    assert len(faults) == (key is not None)
    assert key is None or key in faults[0]


def engine(psi: float) -> System:
    """The default engine on a flywheel that starts at mid-stroke."""
    wheel = Instance(CATALOGUE["flywheel"](), start={"angle": 0.5 * math.pi, "speed": 100.0})
    return System(
        {"wheel": wheel, "engine": Instance(CRANK, start={"psi": psi})},
        [("wheel.angle", "engine.crank_angle"), ("wheel.speed", "engine.crank_speed")],
    )


def test_system_checks_the_start_with_connected_inputs():
    check_start(engine(0.0157), 0.0, engine(0.0157).x0)
    for psi in (0.0158, -0.0158):
        with pytest.raises(ModelError, match=rf"^components\.engine\.start\.psi = {psi:g} rad .*= 1\.5708"):
            check_start(engine(psi), 0.0, engine(psi).x0)
    with pytest.raises(ModelError, match=r"^components\.engine\.start\.psi"):
        solve(engine(0.02), np.linspace(0.0, 1e-3, 3))


def random_slider_state(random: np.random.Generator) -> Vector:
    mode, psi, rate = random.integers(-1, 2), random.uniform(-0.01, 0.01), random.uniform(-5.0, 5.0)
    x = STATE.vector({"psi": psi, "psi_rate": rate, "mode": float(mode)})
    x[FILMS] = random.uniform(0.0, 1e-6, 4)
    return x


def random_piston_state(component: Component, random: np.random.Generator) -> Vector:
    modes = ((), (0,), (3,), (0, 1), (2, 3), (0, 3), (1, 2))
    x = component.state.vector({f"closed[{i + 1}]": 1.0 for i in modes[random.integers(len(modes))]})
    x[:4] = random.uniform(-1.0, 1.0, 4) * np.array([1e-5, 0.3, 2e-4, 5.0])
    return x


@pytest.mark.parametrize(
    ("component", "values"),
    [
        *((CRANK, {"form": form}) for form in FORMS),
        *(
            pytest.param(piston, {"pin_offset": 1e-3, "mass_offset": -0.5e-3}, marks=pytest.mark.long)
            for piston in (DRIVEN, FREE)
        ),
    ],
)
def test_outputs_depend_on_no_other_inputs_than_declared(component, values):
    """Changing an input changes only the outputs that list it, and all that list it in some mode."""
    random = np.random.default_rng(5)
    p, seen = component.parameters.vector(values), set()
    outputs, inputs = component.outputs, component.inputs
    for _ in range(60):
        x = random_slider_state(random) if component is CRANK else random_piston_state(component, random)
        u = random.uniform(0.5, 2.0, inputs.size) * inputs.nominal
        y, changed = np.zeros(outputs.size), np.zeros(outputs.size)
        component.flat_output(0.0, x, u, p, y)
        for j, name in enumerate(inputs.names):
            other = u.copy()
            other[j] *= 1.01
            component.flat_output(0.0, x, other, p, changed)
            seen |= {(outputs.names[i], name) for i in np.nonzero(y != changed)[0]}
    assert seen == {(out, name) for out, names in component.feedthrough.items() for name in names}
