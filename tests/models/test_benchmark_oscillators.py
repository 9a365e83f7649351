"""The benchmark oscillators: the components are what their exact solutions solve, and energy closes."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from models.catalogue import CATALOGUE
from models.monolithic import solve
from models.monolithic.modes import find_modes
from models.oscillators.bouncing_mass import FallingMassParameters, SpringStopParameters
from models.oscillators.quarter_car import ChassisParameters, WheelParameters
from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from tests.models import exact_oscillators as exact

from .systems import outputs_of

STATES = [f"{part}.{state}" for part in ("chassis", "wheel") for state in ("position", "velocity")]


def oscillator(name, parameters, starts):
    """The shipped one with these values by instance."""
    system = build_system(load(name))
    return system.with_instances(
        {
            part: replace(instance, parameters=parameters.get(part, {}), start=starts.get(part, {}))
            for part, instance in system.instances.items()
        }
    )


def energy_closes(found, scale):
    """Per component, and over the bonds; the reference integrates powers to 1e-10 per step of `scale` (J)."""
    for name, balance in found.energy.items():
        assert np.max(np.abs(balance.residual)) < 1e-7 * scale, name
        assert np.min(np.diff(balance.dissipated)) >= -1e-9 * scale, name
    received = sum(balance.received for balance in found.energy.values())
    assert np.max(np.abs(received)) < 1e-12 * scale


def crossed(found):
    """The largest energy that went over the bonds (J): what closes is not nothing."""
    return max(np.max(np.abs(balance.received)) for balance in found.energy.values())


@pytest.mark.parametrize("damping", [0.0, 300.0])
def test_quarter_car_is_its_matrix_exponential(damping):
    times = np.linspace(0.0, 4.0, 201)
    found = solve(oscillator("quarter-car", {"wheel": {"tyre_damping": damping}}, {}), times)
    solution = exact.quarter_car(times, wheel=WheelParameters(tyre_damping=damping))
    # Tolerance 1e-10 per step of nominals 0.1 m and 1 m/s, over some hundred steps.
    np.testing.assert_allclose(np.column_stack([found[name] for name in STATES]), solution, atol=1e-9)
    energy_closes(found, 750.0)
    assert crossed(found) > 50.0


@pytest.mark.parametrize("damping", [0.0, 300.0])
def test_modes_of_the_quarter_car_are_the_roots_of_its_polynomial(damping):
    """det(m lambda^2 + d lambda + k) = 0, whose roots are the undamped frequency and the damping ratio."""
    c, w = ChassisParameters(), WheelParameters(tyre_damping=damping)
    system = oscillator("quarter-car", {"wheel": {"tyre_damping": damping}}, {})
    suspension = Polynomial([c.suspension_stiffness, c.suspension_damping])
    chassis = suspension + Polynomial([0.0, 0.0, c.chassis_mass])
    wheel = suspension + Polynomial([w.tyre_stiffness, w.tyre_damping, w.wheel_mass])
    roots = sorted(abs(root) for root in (chassis * wheel - suspension**2).roots() if root.imag > 0.0)
    ratios = sorted(
        -root.real / abs(root) for root in (chassis * wheel - suspension**2).roots() if root.imag > 0.0
    )
    modes = find_modes(system, 0.0, system.x0)
    # Central differences over 1e-7 of linear rates: rounding of some 1e-9.
    np.testing.assert_allclose([2.0 * math.pi * mode.frequency for mode in modes], roots, rtol=1e-7)
    np.testing.assert_allclose(sorted(mode.damping for mode in modes), ratios, rtol=1e-7)
    assert [mode.state.partition(".")[0] for mode in modes] == ["chassis", "wheel"]


@pytest.mark.parametrize("damping", [0.0, 0.7])
def test_two_masses_are_their_matrix_exponential(damping):
    times = np.linspace(0.0, 5.0, 101)
    coupled = {"mass": 5.0, "damping": damping, "coupling_damping": 2.0 * damping}
    sprung = {"mass": 0.5, "stiffness": 3.0, "damping": damping}
    start = {"first": {"position": 1.0, "velocity": -0.5}, "second": {"position": 0.2, "velocity": 0.3}}
    found = solve(oscillator("two-masses", {"first": coupled, "second": sprung}, start), times)
    solution = exact.two_masses(
        times,
        CoupledMassParameters(**coupled),
        SprungMassParameters(**sprung),
        np.array([1.0, -0.5, 0.2, 0.3]),
    )
    np.testing.assert_allclose(found.state, solution, atol=1e-8)
    energy_closes(found, 20.0)
    assert crossed(found) > 1.0


@pytest.mark.parametrize(
    ("damping", "position"),
    [(0.0, 0.1), (20.0, 0.1), (150.0, 0.1), (20.0, -0.005), (0.0, 0.0), (0.0, -5e-4)],
    ids=["undamped", "damped", "strongly damped", "released", "touching", "swinging in contact"],
)
def test_bouncing_mass_is_its_piecewise_solution(damping, position):
    times = np.linspace(0.0, 1.5, 301)
    system = oscillator("bouncing-mass", {"stop": {"damping": damping}}, {"mass": {"position": position}})
    found = solve(system, times)
    solution = exact.bouncing_mass(times, stop=SpringStopParameters(damping=damping), position=position)
    # Kinks and jumps of the force cost the reference digits: it knows by how much.
    uncertain = 10.0 * found.uncertainty["mass.position"].max_abs + 1e-10
    np.testing.assert_allclose(found["mass.position"], solution.motion[:, 0], atol=uncertain)
    energy_closes(found, 1.0)
    # The stop gives the mass its momentum and carries its weight.
    gained = found["mass.velocity"] - found["mass.velocity"][0] + 9.81 * times
    np.testing.assert_allclose(found["stop.impulse"], gained, atol=1e-9)


def test_undamped_bounces_repeat_with_the_closed_form_period():
    """Flight 2 v/g and contact 2 (pi - atan(v w/g))/w, for ever at the same height."""
    g, k, m, h = 9.81, 1e4, 2.0, 0.05
    stop, mass = SpringStopParameters(stiffness=k), FallingMassParameters(mass=m)
    v, w = math.sqrt(2.0 * g * h), math.sqrt(k / m)
    contact, flight = 2.0 * (math.pi - math.atan(v * w / g)) / w, 2.0 * v / g
    period = contact + flight
    found = exact.bouncing_mass(np.array([0.0, 5.0 * period, 5.5 * period, 20.0]), mass, stop, h)
    n = np.arange(found.touches.size)
    np.testing.assert_allclose(found.touches, 0.5 * flight + n * period, rtol=1e-13)
    n = np.arange(found.releases.size)
    np.testing.assert_allclose(found.releases, 0.5 * flight + contact + n * period, rtol=1e-13)
    np.testing.assert_allclose(found.motion[1], [h, 0.0], atol=1e-12)
    depth = m * g / k + math.sqrt((m * g / k) ** 2 + (v / w) ** 2)
    np.testing.assert_allclose(found.motion[2], [-depth, 0.0], atol=1e-11)


def test_contact_margin_is_positive_exactly_where_the_stop_pushes():
    random = np.random.default_rng(3)
    stop = CATALOGUE["spring_stop"]()
    signs = set()
    for position, velocity in random.uniform(-1.0, 1.0, (200, 2)) * (0.01, 1.0):
        y = outputs_of(stop, {"damping": 100.0}, inputs={"position": position, "velocity": velocity})
        assert (y["contact_margin"] > 0.0) == (y["force"] > 0.0)
        signs.add((y["compression"] > 0.0, y["force"] > 0.0))
    assert signs == {(False, False), (True, False), (True, True)}
