"""Walls that follow their films: kinematics, lag, energy, and bounces on walls that move in any way."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
from models.core.system import Instance, System
from models.monolithic import equilibrium, solve
from models.slider_crank import forms
from models.slider_crank.equations import Crank, thesis_mechanism

from .slider_cranks import CRANK, FILMS, FORMS, LAG, STATE, advance, thesis_parameters, turn
from .systems import wheel


@pytest.mark.parametrize("form", FORMS)
def test_slider_on_a_moving_wall_has_its_velocity_and_acceleration(form: float) -> None:
    """psi' and psi'' are those of psi(theta(t), y(t)), by differences of fourth order (error ~ 1e-9)."""
    rng, m = np.random.default_rng(4), thesis_mechanism(0.1)
    for _ in range(20):
        theta, speed, acceleration = rng.uniform(0.0, 6.0), rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0)
        y, velocity, change = rng.uniform(-0.1, 0.1, 3)

        def psi(t: float) -> float:
            turned = theta + speed * t + 0.5 * acceleration * t**2  # noqa: B023
            return forms.wall_angle(form, turned, y + velocity * t + 0.5 * change * t**2, m)  # noqa: B023

        d = 2e-3
        p = [psi(k * d) for k in (-2, -1, 0, 1, 2)]
        rate = (p[0] - 8.0 * p[1] + 8.0 * p[3] - p[4]) / (12.0 * d)
        second = (-p[0] + 16.0 * p[1] - 30.0 * p[2] + 16.0 * p[3] - p[4]) / (12.0 * d**2)
        found = forms.moving_wall_rate(form, theta, speed, p[2], velocity, m)
        assert found == pytest.approx(rate, abs=1e-9)
        found = forms.moving_wall_acceleration(
            form, Crank(theta, speed, acceleration), p[2], velocity, change, m
        )
        assert found == pytest.approx(second, abs=1e-8)


def test_wall_answers_a_step_of_its_film_as_a_critically_damped_follower() -> None:
    """h_f = h (1 - (1 + t/T) exp(-t/T)), to the integrator's tolerance on a film of mm."""
    p, h = thesis_parameters(0.1, 0.015), 1e-3
    for turns in (0.3, 1.0, 4.0, 20.0):
        x = STATE.vector()
        advance(CRANK, x, p, 0.0, turns * LAG, upper_film_thickness=h, lower_film_thickness=2.0 * h)
        follower = 1.0 - (1.0 + turns) * math.exp(-turns)
        assert x[FILMS[0::2]] == pytest.approx([h * follower, 2.0 * h * follower], abs=1e-12)


def waving_films(t: float, size: float, omega: float) -> dict[str, tuple[float, ...]]:
    """Cubic polynomials at t of films h = size (1 + sin(omega t + phase))/2 on both walls."""
    films = {}
    for wall, phase in (("upper", 0.0), ("lower", 2.0)):
        waves = [omega**k * math.sin(omega * t + phase + 0.5 * k * math.pi) for k in range(4)]
        waves[0] += 1.0
        films[f"{wall}_film_thickness"] = tuple(0.5 * size * wave for wave in waves)
    return films


@settings(max_examples=80, deadline=None, derandomize=True)
@given(
    form=st.sampled_from(FORMS),
    gap=st.floats(-6.0, -2.0).map(lambda power: 10.0**power),
    restitution=st.floats(0.0, 0.95),
    damping=st.floats(0.0, 0.4),
    share=st.floats(0.0, 0.9),
    omega=st.floats(0.0, 4.0).map(lambda power: 10.0**power),
    rate=st.floats(-1.0, 1.0),
)
def test_bounces_on_moving_walls_end_in_sliding_and_pass_no_wall(
    form: float, gap: float, restitution: float, damping: float, share: float, omega: float, rate: float
) -> None:
    """Clearances down to 1e-6 rod lengths, nine tenths of them filled by films that go up and down at up to
    ten thousand radians per radian of crank: no step ends with the event limit, and walls only push."""
    p = thesis_parameters(damping, gap, restitution=restitution, form=form)
    x = STATE.vector({"psi_rate": rate * math.sqrt(gap)})
    x[FILMS[0::2]] = [film[0] for film in waving_films(0.0, share * gap, omega).values()]
    piece = min(1.0 / 60.0, 0.3 / omega)  # of a radian: a cubic is the sine to 1e-3 there
    for k in range(60):
        t = k * piece
        y = turn(CRANK, x, p, t, piece, **waving_films(t, share * gap, omega))
        offset = y["piston_offset"]
        rounding = 1e-13 * gap
        assert -(gap - x[FILMS[2]]) - rounding <= offset <= gap - x[FILMS[0]] + rounding
        # At the instant of release the force is zero to rounding.
        assert min(y["upper_wall_force"], y["lower_wall_force"]) >= -1e-11


def build_lubricated_engine() -> System:
    """The default engine at 2000 r/min with a clearance of 0.1 mm, whose walls' forces load two contacts."""
    crank = Instance(
        CRANK, {"clearance": 1e-4, "restitution": 0.4, "joint_friction": 0.0733}, {"mode": 1.0, "psi": 7.2e-4}
    )
    contact = {"load_is_given": 1.0, "length": 0.04}
    connections = [(f"wheel.{name}", f"crank.crank_{name}") for name in ("angle", "speed", "acceleration")]
    for wall in ("upper", "lower"):
        connections += [
            (f"crank.{wall}_wall_force", f"{wall}.applied_load"),
            ("crank.wall_entraining_velocity", f"{wall}.entraining_velocity"),
            ("crank.wall_radius", f"{wall}.radius_of_curvature"),
            (f"{wall}.film_thickness", f"crank.{wall}_film_thickness"),
        ]
    walls = {wall: Instance(CATALOGUE["ehl_contact"](), contact) for wall in ("upper", "lower")}
    return System({"wheel": wheel(209.4), "crank": crank, **walls}, connections)


@pytest.mark.long
def test_energy_closes_from_one_wall_to_the_other() -> None:
    """From rest on the films, by sliding, release, flight and chatter to its end, on moving walls."""
    system = build_lubricated_engine()
    x0, times = equilibrium(system), np.linspace(0.0, 0.013, 27)
    start = dict(zip(system.state.names, x0, strict=True))
    for wall in ("upper", "lower"):
        assert start[f"crank.{wall}_wall_film"] == pytest.approx(start[f"{wall}.film_thickness"], rel=1e-9)
        assert start[f"crank.{wall}_wall_film_rate"] == pytest.approx(0.0, abs=1e-12)
    found = solve(system, times, x0=x0, tolerance=1e-8)
    assert found["crank.sliding"][0] == 1.0
    assert found["crank.sliding"][-1] == -1.0
    assert found["crank.impact_count"][-1] > 5.0
    # 1e-10 per step and joule over some thousand steps, of energies up to 20 J.
    balance = found.energy["crank"]
    assert np.abs(balance.sourced).max() > 1e-6
    assert np.abs(balance.residual).max() < 1e-7
