"""Flywheel: closed forms of the ramps and of free motion."""

from __future__ import annotations

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.system import Instance, System
from models.monolithic import solve

from .systems import outputs_of

RAMP = {"initial_speed": 50.0, "final_speed": 250.0, "ramp_start": 0.2, "ramp_duration": 0.5}


def flywheel(parameters, **more):
    return System({"flywheel": Instance(CATALOGUE["flywheel"](), parameters, **more)}, [])


@pytest.mark.parametrize("shape", [0.0, 1.0])
def test_prescribed_ramp(shape):
    times = np.linspace(0.0, 1.0, 101)
    found = solve(flywheel({**RAMP, "ramp_shape": shape}), times)
    r = np.clip((times - 0.2) / 0.5, 0.0, 1.0)
    done = 3 * r**2 - 2 * r**3 if shape else r
    integral = r**3 - r**4 / 2 if shape else r**2 / 2
    after = np.maximum(times - 0.7, 0.0)
    angle = 50.0 * times + 200.0 * (0.5 * integral + after)
    assert found["flywheel.speed"] == pytest.approx(50.0 + 200.0 * done, rel=1e-12)
    # Kinks of the linear ramp cost the integrators their order: the tolerance, not rounding.
    assert found["flywheel.angle"] == pytest.approx(angle, abs=1e-8)


def test_prescribed_motion_supplies_inertia_and_load_torque():
    wheel = CATALOGUE["flywheel"]()
    found = outputs_of(wheel, {**RAMP, "inertia": 0.3}, {}, {"load_torque[1]": 7.0}, t=0.45)
    assert found["supplied_torque"] == pytest.approx(0.3 * 400.0 + 7.0, rel=1e-12)


def test_free_motion_under_constant_torques():
    times = np.linspace(0.0, 2.0, 21)
    parameters = {"motion": 0.0, "inertia": 0.25}
    inputs = {"drive_torque": 12.0, "load_torque[1]": 2.0}
    found = solve(flywheel(parameters, start={"speed": 30.0}, inputs=inputs), times)
    assert found["flywheel.acceleration"] == pytest.approx(np.full(21, 40.0), rel=1e-14)
    assert found["flywheel.speed"] == pytest.approx(30.0 + 40.0 * times, rel=1e-11)
    assert found["flywheel.angle"] == pytest.approx(30.0 * times + 20.0 * times**2, rel=1e-11)
    residual = found.stored_energy - found.stored_energy[0] + found.dissipated - found.supplied
    assert np.max(np.abs(residual)) < 1e-8


def test_loads_add_up():
    loads = {f"load_torque[{i}]": float(i) for i in (1, 2, 3)}
    wheel = CATALOGUE["flywheel"](loads=3)
    found = outputs_of(wheel, {"motion": 0.0, "inertia": 0.5}, {}, {"drive_torque": 1.0, **loads})
    assert found["acceleration"] == pytest.approx((1.0 - 6.0) / 0.5, rel=1e-15)
