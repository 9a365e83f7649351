"""Flywheel: closed forms of the ramps and of free motion."""

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.monolithic.driven import Piece, solve_driven

from .systems import outputs_of

pytestmark = pytest.mark.plain

WHEEL = CATALOGUE["flywheel"]()
RAMP = {"initial_speed": 50.0, "final_speed": 250.0, "ramp_start": 0.2, "ramp_duration": 0.5}


def drive(times, parameters, inputs=None, **start):
    """Outputs by name under constant inputs."""
    p, u = WHEEL.parameters.vector(parameters), WHEEL.inputs.vector(inputs)
    piece, x0 = Piece(0.0, u, np.zeros(u.size)), WHEEL.state.vector(start)
    found = solve_driven(WHEEL, [piece], times, p=p, x0=x0)
    return dict(zip(WHEEL.outputs.names, found.outputs.T, strict=True))


@pytest.mark.parametrize("shape", [0.0, 1.0])
def test_prescribed_ramp(shape):
    times = np.linspace(0.0, 1.0, 101)
    found = drive(times, {**RAMP, "ramp_shape": shape})
    r = np.clip((times - 0.2) / 0.5, 0.0, 1.0)
    done = 3 * r**2 - 2 * r**3 if shape else r
    integral = r**3 - r**4 / 2 if shape else r**2 / 2
    after = np.maximum(times - 0.7, 0.0)
    angle = 50.0 * times + 200.0 * (0.5 * integral + after)
    assert found["speed"] == pytest.approx(50.0 + 200.0 * done, rel=1e-12)
    # Kinks of the linear ramp cost the integrators their order: the tolerance, not rounding.
    assert found["angle"] == pytest.approx(angle, abs=1e-8)


def test_prescribed_motion_supplies_inertia_and_load_torque():
    found = outputs_of(WHEEL, {**RAMP, "inertia": 0.3}, {}, {"load_torque[1]": 7.0}, t=0.45)
    assert found["supplied_torque"] == pytest.approx(0.3 * 400.0 + 7.0, rel=1e-12)


def test_free_motion_under_constant_torques():
    times = np.linspace(0.0, 2.0, 21)
    torques = {"drive_torque": 12.0, "load_torque[1]": 2.0}
    found = drive(times, {"motion": 0.0, "inertia": 0.25}, torques, speed=30.0)
    assert found["acceleration"] == pytest.approx(np.full(21, 40.0), rel=1e-14)
    assert found["speed"] == pytest.approx(30.0 + 40.0 * times, rel=1e-11)
    assert found["angle"] == pytest.approx(30.0 * times + 20.0 * times**2, rel=1e-11)


def test_power_that_is_not_stored_is_supplied():
    """dE/dt of J omega^2/2 is the supplied power less that of the load, driven and prescribed."""
    for parameters, torques in (({"motion": 0.0}, {"drive_torque": 12.0, "load_torque[1]": 2.0}), (RAMP, {})):
        p, u, x = WHEEL.parameters.vector(parameters), WHEEL.inputs.vector(torques), WHEEL.state.vector({})
        dx, energies = np.zeros(x.size), np.zeros((3, 3))
        WHEEL.flat_derivative(0.4, x, u, p, dx)
        for e, h in zip(energies, (-1e-5, 0.0, 1e-5), strict=True):
            WHEEL.flat_energy(0.4 + h, x + h * dx, u, p, e)
        speed = outputs_of(WHEEL, parameters, {}, torques, t=0.4)["speed"]
        gained = (energies[2, 0] - energies[0, 0]) / 2e-5
        assert gained == pytest.approx(energies[1, 2] - torques.get("load_torque[1]", 0.0) * speed, rel=1e-7)


def test_loads_add_up():
    loads = {f"load_torque[{i}]": float(i) for i in (1, 2, 3)}
    wheel = CATALOGUE["flywheel"](loads=3)
    found = outputs_of(wheel, {"motion": 0.0, "inertia": 0.5}, {}, {"drive_torque": 1.0, **loads})
    assert found["acceleration"] == pytest.approx((1.0 - 6.0) / 0.5, rel=1e-15)


@pytest.mark.parametrize("shape", [0.0, 1.0])
def test_a_prescribed_acceleration_is_the_slope_of_the_speed(shape):
    ramp, h = {**RAMP, "ramp_shape": shape}, 1e-5
    for t in (0.1, 0.3, 0.45, 0.6, 0.8):
        before, now, after = (outputs_of(WHEEL, ramp, t=t + d) for d in (-h, 0.0, h))
        slope = (after["speed"] - before["speed"]) / (2.0 * h)
        # Central differences: h^2 of the third derivative, 2e4.
        assert now["acceleration"] == pytest.approx(slope, abs=1e-4)
        assert now["supplied_torque"] == pytest.approx(0.1 * now["acceleration"], abs=1e-12)
