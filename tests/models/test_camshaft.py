"""Rotors: ramps and free motion of the flywheel; the flexible camshaft's modes, damping and drive."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
from models.monolithic.driven import Piece, solve_driven

from .systems import find_whirl, outputs_of, rates_of, state_matrix

pytestmark = pytest.mark.plain

CAMSHAFT = CATALOGUE["camshaft"]()


def system_matrix(speed=0.0, **parameters):
    """d(rates)/d(states) of the unloaded, straight shaft at a speed (rad/s), (10, 10)."""
    return state_matrix(CAMSHAFT, {"flexible": 1.0, **parameters}, {"drive_speed": speed}, step=1e-9)


def modes(**parameters):
    """(frequencies in Hz, damping ratios), ascending."""
    values = np.linalg.eigvals(system_matrix(**parameters))
    values = sorted(values[values.imag > 0], key=abs)
    return [abs(v) / (2 * math.pi) for v in values], [-v.real / abs(v) for v in values]


def test_first_bending_and_torsion_frequencies(record):
    """Of torsion also a rod's with a disc: k = G J / l with J = pi d^4 / 32."""
    frequencies, _ = modes()
    assert frequencies[1] == pytest.approx(frequencies[0], rel=1e-9)  # both planes
    # The digits stated.
    for name, value, stated in (("bending", frequencies[0], 520.0), ("torsion", frequencies[2], 1028.0)):
        quantity = f"first frequency of the camshaft in {name} (Hz)"
        record("Cam", quantity, value, stated, "independent evaluation", tolerance=0.5)
    stiffness = 207e9 / 2.6 * math.pi * 0.02**4 / 32 / 0.1
    rod, source = math.sqrt(stiffness / 3.0e-4) / (2 * math.pi), "closed form of a rod with a disc"
    record("Cam", "torsion frequency (Hz)", frequencies[2], rod, source, relative=1e-4)


@pytest.mark.parametrize("ratio", [0.0, 0.02, 0.3])
def test_every_mode_has_the_given_damping_ratio(ratio):
    # Rounding of eigenvalues.
    assert modes(shaft_damping_ratio=ratio)[1] == pytest.approx([ratio] * 5, abs=1e-9)


def bending_stiffness():
    """12 E J/l^3, -6 E J/l^2, 4 E J/l of the default shaft."""
    rigidity = 207e9 * math.pi * 0.02**4 / 64
    return 12 * rigidity / 0.1**3, -6 * rigidity / 0.1**2, 4 * rigidity / 0.1


@pytest.mark.parametrize("speed", [300.0, 3000.0])
def test_whirl_is_that_of_an_overhung_disc(speed):
    """(k11 - m w^2) (k22 - I_t w^2 + I_p Omega w) = k12^2, w > 0 forwards (Den Hartog 1956, section 6.8)."""
    k11, k12, k22 = bending_stiffness()
    axis, tilt = np.array([-0.425, 0.0, k11]), np.array([-1.42e-4, 3.00e-4 * speed, k22])
    expected = np.roots(np.polysub(np.polymul(axis, tilt), [k12**2]))
    places = (CAMSHAFT.state.index(name) for name in ("bending_across", "bending"))
    whirl = find_whirl(system_matrix(speed, shaft_damping_ratio=0.0), *places)
    np.testing.assert_allclose(whirl, np.sort(expected.real), rtol=1e-8)


def test_damping_that_turns_with_the_shaft_feeds_whirl_above_the_critical_speed():
    """It does neither where the shaft whirls as it turns: (k11 - m O^2) (k22 - (I_t - I_p) O^2) = k12^2."""
    k11, k12, k22 = bending_stiffness()
    squares = np.roots(
        [0.425 * (1.42e-4 - 3.00e-4), -0.425 * k22 - (1.42e-4 - 3.00e-4) * k11, k11 * k22 - k12**2]
    )
    critical = math.sqrt(squares[squares > 0.0][0])
    growth = [np.linalg.eigvals(system_matrix(share * critical)).real.max() for share in (0.99, 1.0, 1.01)]
    assert growth[0] < -0.1
    assert growth[1] == pytest.approx(0.0, abs=1e-4)
    assert growth[2] > 0.1


def test_load_twists_the_shaft_back_on_the_rise():
    drive = {"drive_angle": math.radians(130), "drive_speed": 100.0, "contact_load": 500.0}
    rates = rates_of(CATALOGUE["camshaft"](), {"flexible": 1.0}, inputs=drive)
    offset = outputs_of(CATALOGUE["camshaft"](), inputs=drive)["contact_offset"]
    assert rates["twist_rate"] == pytest.approx(-500.0 * offset / 3.0e-4, rel=1e-12)


def test_wind_up_adds_to_the_cams_angle_and_speed():
    drive = {"drive_angle": 2.0, "drive_speed": 100.0}
    y = outputs_of(CATALOGUE["camshaft"](), {"flexible": 1.0}, {"twist": -1e-3, "twist_rate": 2.0}, drive)
    assert y["cam_angle"] == pytest.approx(2.0 - 1e-3, rel=1e-15)
    assert y["cam_speed"] == 102.0
    assert y["surface_velocity"] == pytest.approx(y["contact_offset"] * 102.0, rel=1e-15)


@given(st.floats(0.0, 6.28), st.floats(1.0, 400.0), st.floats(-200.0, 200.0), st.floats(0.0, 2000.0))
def test_friction_takes_its_power_from_the_drive(angle, speed, friction, load):
    """A rigid shaft at constant speed passes on all power: T omega = W s' omega + F u_s, lever R0 + s."""
    u = {"drive_angle": angle, "drive_speed": speed, "contact_load": load}
    rubbed, smooth = (outputs_of(CAMSHAFT, inputs={**u, "friction_force": f}) for f in (friction, 0.0))
    spent = load * rubbed["surface_velocity"] + friction * rubbed["sliding_velocity"]
    # Rounding, of terms that may cancel.
    assert rubbed["drive_torque"] * speed == pytest.approx(spent, rel=1e-12, abs=1e-9)
    lever = CAMSHAFT.parameters.field("base_radius").start + rubbed["cam_lift"]
    assert rubbed["drive_torque"] - smooth["drive_torque"] == pytest.approx(friction * lever, abs=1e-11)


def test_a_load_tilts_the_cam_as_the_end_of_a_cantilever():
    """Displacement and slope have one sense: -W l^3/(3 E J) and -W l^2/(2 E J)."""
    rigidity, load = 207e9 * math.pi * 0.02**4 / 64, 500.0
    bent = {"bending": -load * 0.1**3 / (3 * rigidity), "slope": -load * 0.1**2 / (2 * rigidity)}
    rates = rates_of(CAMSHAFT, {"flexible": 1.0}, bent, {"contact_load": load})
    # At rest, but for rounding of forces of 1 kN.
    assert [0.425 * rates["bending_rate"], 1.42e-4 * rates["slope_rate"]] == pytest.approx([0, 0], abs=1e-8)


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
    slope = np.where((r > 0.0) & (r < 1.0), 6.0 * r * (1.0 - r) if shape else 1.0, 0.0)
    apart = np.minimum(abs(times - 0.2), abs(times - 0.7)) > 1e-9  # from the ramp's ends
    assert found["acceleration"][apart] == pytest.approx(400.0 * slope[apart], rel=1e-12)


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


def test_loads_add_up():
    loads = {f"load_torque[{i}]": float(i) for i in (1, 2, 3)}
    wheel = CATALOGUE["flywheel"](loads=3)
    found = outputs_of(wheel, {"motion": 0.0, "inertia": 0.5}, {}, {"drive_torque": 1.0, **loads})
    assert found["acceleration"] == pytest.approx((1.0 - 6.0) / 0.5, rel=1e-15)
