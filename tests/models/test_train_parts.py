"""Parts of valve trains: the power balance of all, and what each one is for by closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
from models.core.system import Instance, System
from models.monolithic.equilibrium import equilibrium

from .systems import outputs_of, rates_of, state_matrix

pytestmark = pytest.mark.plain

PARTS = {
    "flat tappet": ("tappet", {"guide_damping": 5.0, "gravity": 9.81}),
    "tilted tappet": ("tappet", {"tilt": 0.3, "guide_damping": 5.0}),
    "roller tappet": ("tappet", {"follower": 1.0, "follower_radius": 9e-3, "offset": 2e-3}),
    "pad tappet": ("tappet", {"follower": 2.0, "follower_radius": 40e-3, "offset": -3e-3}),
    "pad finger": ("finger", {"pivot_stiffness": 1e7, "pivot_damping": 50.0}),
    "roller finger": ("finger", {"rolls": 1.0, "cam_arm": -28e-3, "valve_arm": -40e-3}),
    "bonded rod": ("rod", {"bonded": 1.0}),
    "loose rod": ("rod", {"clearance": 1e-5, "gravity": 9.81}),
    "valve body": ("valve", {"lash": 1e-4, "guide_damping": 3.0}),
    "coil spring": ("coil_spring", {"gap[1]": 1e-4, "gap[9]": 2e-4}),
    "shaft": ("shaft", {"gyroscopic[1]": 0.02, "direction[1]": 0.5, "drive_ratio": 0.5}),
    "journal bearing": ("journal_bearing", {}),
    "short journal bearing": ("journal_bearing", {"film_model": 0.0}),
    "rubbing journal bearing": ("journal_bearing", {"roughness": 2.4e-6}),
    "rocker": ("rocker", {"rod_angle": 0.1, "valve_angle": 0.2, "pivot_damping": 1e-3}),
    "rocker of small motion": ("rocker", {"small_motion": 1.0, "valve_angle": 0.2}),
    "pivot friction": ("pivot_friction", {"viscous_coefficient": 1e-3}),
    "loaded pivot friction": ("pivot_friction", {"preload_torque": 1e-3, "sticking_stiffness": 2e4}),
    "pad friction": ("pad_friction", {"viscous_coefficient": 3.0}),
    "sliding pad friction": ("pad_friction", {"friction_coefficient": 1e-4}),
    "roller": ("roller", {}),
    "slipping roller": ("roller", {"traction_coefficient": 1e-4, "pin_damping": 1e-4}),
    "adjuster": ("lash_adjuster", {}),
    "adjuster with air": ("lash_adjuster", {"air_content": 0.05}),
    "adjuster with isothermal air": ("lash_adjuster", {"air_content": 0.05, "air_exponent": 1.0}),
    "pin": ("pin_bearing", {"roughness": 1.5e-6, "face_gap": 1e-4}),
    "needles": ("needle_bearing", {}),
    "guide": ("guide_friction", {}),
    "spinning tappet": ("tappet_spin", {}),
    "prescribed rotor": ("flywheel", {"final_speed": 250.0, "ramp_start": 0.2, "ramp_duration": 0.5}),
    "free rotor": ("flywheel", {"motion": 0.0}),
    "flexible camshaft": ("camshaft", {"flexible": 1.0}),
    "valve": ("valve_spring", {"seat_stiffness": 2e7, "seat_damping": 300.0, "lash": 1e-4}),
}
BUILT = {name: CATALOGUE[name]() for name, _ in PARTS.values()}
DEFAULTS = {name: component.parameters.defaults() for name, component in BUILT.items()}


def rate_of(position: str) -> str:
    """The input that is the rate of another one."""
    rates = {
        "axis_x": "axis_velocity_x",
        "axis_y": "axis_velocity_y",
        "cam_angle": "cam_speed",
        "drive_speed": "drive_acceleration",
    }
    return rates.get(position, position.replace("position", "velocity"))


@pytest.mark.parametrize("part", PARTS)
@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_power_through_the_bonds_is_stored_or_lost(part, seed):
    """dE/dt = sum of the bonds' powers - dissipation + source, at any state and inputs."""
    name, given_parameters = PARTS[part]
    c = BUILT[name]
    random = np.random.default_rng(seed)
    p = c.parameters.vector(given_parameters)
    x = c.state.nominal * random.uniform(-1.0, 1.0, c.state.size)
    u = c.inputs.start + c.inputs.nominal * random.uniform(-1.0, 1.0, c.inputs.size)
    if "cam_angle" in c.inputs.names:
        u[c.inputs.index("cam_angle")] = random.uniform(0.0, 2.0 * math.pi)
    y, dx, e = np.zeros(c.outputs.size), np.zeros(c.state.size), np.zeros(3)
    c.flat_output(0.4, x, u, p, y)
    c.flat_derivative(0.4, x, u, p, dx)
    c.flat_energy(0.4, x, u, p, e)
    _, lost, source = e.tolist()
    du = np.zeros_like(u)
    for i, field in enumerate(c.inputs.names):
        if rate_of(field) != field and rate_of(field) in c.inputs.names:
            du[i] = u[c.inputs.index(rate_of(field))]

    def stored(t):
        c.flat_energy(0.4 + t, x + t * dx, u + t * du, p, e)
        return e[0]

    # Central differences over a time in which nothing moves by more than 1e-4 of its size. A kink on the way
    # adds as much to the power.
    h = 1e-4 * np.min(np.r_[c.state.nominal, 1.0] / (np.abs(np.r_[dx, 0.0]) + np.r_[c.state.nominal, 1.0]))
    h = min(h, 1e-4 * np.min(c.inputs.nominal / (np.abs(du) + c.inputs.nominal)))
    gained = (stored(h) - stored(-h)) / (2.0 * h)
    values = {**c.inputs.named(u), **c.outputs.named(y)}
    powers = [bond.sign * values[bond.effort] * values[bond.flow] for bond in c.bonds]
    size = sum(map(abs, powers)) + abs(lost) + abs(gained)
    assert lost >= 0.0
    assert gained == pytest.approx(sum(powers) - lost + source, abs=1e-4 * size)


@settings(max_examples=30, deadline=None)
@given(
    st.floats(15e-3, 35e-3),
    st.floats(35e-3, 60e-3),
    st.floats(-0.2, 0.3),
    st.floats(-0.1, 0.3),
    st.floats(0.0, 360.0),
)
def test_force_ratio_of_a_finger_is_its_velocity_ratio(cam_arm, valve_arm, pivot_angle, valve_angle, degrees):
    """Turned slowly the cam lifts the valve without loss: a load F takes the torque F s'."""
    geometry = {"cam_arm": cam_arm, "valve_arm": valve_arm, "pivot_angle": pivot_angle}
    geometry |= {"valve_angle": valve_angle, "base_radius": 30e-3}
    c = BUILT["finger"]
    angle = math.radians(degrees)

    def lift(at):
        return outputs_of(c, geometry, {}, {"cam_angle": at})["cam_lift"]

    closed = pivot_angle + valve_angle
    # The rotation at which the pad has lifted the valve by s.
    rotation = {"rotation": closed + math.asin(lift(angle) / valve_arm - math.sin(closed))}
    ratio = outputs_of(c, geometry, rotation, {"cam_angle": angle})["ratio"]
    found = outputs_of(c, geometry, rotation, {"cam_angle": angle, "cam_load": ratio})
    assert found["overlap"] == pytest.approx(0.0, abs=1e-15)
    slope = (lift(angle + 1e-5) - lift(angle - 1e-5)) / 2e-5
    # Central differences, at worst across a jump of s'''.
    assert found["cam_torque"] == pytest.approx(slope, abs=1e-9)


@settings(max_examples=30, deadline=None)
@given(st.floats(0.0, 360.0), st.floats(-200.0, 200.0))
def test_a_flat_tappet_on_its_cam_is_the_follower_of_a_camshaft(degrees, speed):
    """Where it stands at the lift of the cam: one contact, written twice."""
    angle = math.radians(degrees)
    driven = {"drive_angle": angle, "drive_speed": speed, "contact_load": 400.0, "friction_force": 20.0}
    shaft = outputs_of(CATALOGUE["camshaft"](), {}, {}, driven)
    place = {"position": shaft["cam_lift"], "velocity": shaft["surface_velocity"]}
    turned = {"cam_angle": angle, "cam_speed": speed, "cam_load": 400.0, "cam_friction": 20.0}
    tappet = outputs_of(BUILT["tappet"], {}, place, turned)
    assert tappet["overlap"] == pytest.approx(0.0, abs=1e-17)
    assert tappet["overlap_rate"] == pytest.approx(0.0, abs=1e-12)
    same = {
        "cam_radius": "radius_of_curvature",
        "radius_of_curvature": "radius_of_curvature",
        "entraining_velocity": "entraining_velocity",
        "sliding_velocity": "sliding_velocity",
        "contact_offset": "contact_offset",
        "profile_angle": "cam_angle",
        "cam_torque": "drive_torque",
        "cam_lift": "cam_lift",
    }
    for own, other in same.items():
        assert tappet[own] == pytest.approx(shaft[other], rel=1e-12, abs=1e-15)


# Rods


def test_the_static_rate_of_a_rod_is_exact_for_every_number_of_segments():
    for n in (1, 4):
        c, pushed = CATALOGUE["rod"](segments=n), {"lower_position": 1e-5}
        rod = Instance(c, {"bonded": 1.0, "damping_time": 0.0}, inputs=pushed)
        x = c.state.named(equilibrium(System({"rod": rod}, ())))
        forces = outputs_of(c, {"bonded": 1.0}, x, pushed)
        assert forces["lower_force"] == pytest.approx(207e9 * 50e-6 / 0.2 * 1e-5, rel=1e-9)
        assert forces["upper_force"] == pytest.approx(forces["lower_force"], rel=1e-9)


def test_a_loose_rod_rests_with_its_weight_on_the_body_below():
    """As far from the body above as that leaves it."""
    c, apart = CATALOGUE["rod"](), {"upper_position": 1e-3}
    rod = Instance(
        c, {"gravity": 9.81}, start={f"displacement[{i + 1}]": -1e-8 for i in range(4)}, inputs=apart
    )
    x = c.state.named(equilibrium(System({"rod": rod}, ())))
    forces = outputs_of(c, {"gravity": 9.81}, x, apart)
    assert forces["lower_force"] == pytest.approx(7850.0 * 50e-6 * 0.2 * 9.81, rel=1e-9)
    assert forces["upper_force"] == 0.0


def test_a_tappet_weighs_on_its_cam():
    pressed = {"cam_load": 0.1 * 9.81}
    assert rates_of(CATALOGUE["tappet"](), {"gravity": 9.81}, {}, pressed)["velocity"] == pytest.approx(0.0)
    assert rates_of(CATALOGUE["tappet"](), {"gravity": 9.81}, {}, {})["velocity"] == -9.81


@pytest.mark.parametrize(("segments", "error"), [(2, -0.0255), (4, -0.00641), (8, -0.00161)])
def test_the_first_frequency_of_a_fixed_free_rod(segments, error, record):
    """The upper end is apart. The exact rod has f = sqrt(E/rho)/(4 L)."""
    c = CATALOGUE["rod"](segments=segments)
    parameters = {"bonded": 1.0, "damping_time": 0.0}
    a = state_matrix(c, parameters)
    # Without the spring at the upper end.
    stiffness = 2.0 * segments**2 * 207e9 / (7850.0 * 0.2**2)
    a[2 * segments - 1, segments - 1] += stiffness
    rates = np.linalg.eigvals(a)
    first = np.min(np.abs(rates[np.abs(rates.imag) > 0.0])) / (2.0 * math.pi)
    found = first / (math.sqrt(207e9 / 7850.0) / 0.8) - 1.0
    quantity = f"first frequency of a fixed-free rod of {segments} segments: error"
    record("Train", quantity, found, error, "Qin and Zuo 2000, finite segments", tolerance=2e-3)


def test_a_loose_rod_only_pushes():
    c = BUILT["rod"]
    apart = outputs_of(c, {"clearance": 1e-4}, {}, {"lower_position": -1e-4, "upper_velocity": -1.0})
    assert apart["lower_force"] == apart["upper_force"] == 0.0


# Fingers


def kinetic_energy(q, v):
    """Of a finger (rotation, pivot's place), by the velocity of its centre of mass and its spin."""
    p = DEFAULTS["finger"]
    turned = q[0] - p.pivot_angle
    centre = -p.mass_arm * math.sin(turned) * v[0], p.mass_arm * math.cos(turned) * v[0] + v[1]
    about_centre = p.inertia - p.mass * p.mass_arm**2
    return 0.5 * (p.mass * (centre[0] ** 2 + centre[1] ** 2) + about_centre * v[0] ** 2)


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.3, 0.5), st.floats(-300.0, 300.0), st.floats(-5.0, 5.0), st.floats(-500.0, 500.0))
def test_a_finger_moves_as_lagrange_says(rotation, rate, velocity, force):
    """d/dt dT/dv - dT/dq = Q under a torque and a force on the pivot."""
    torque = 2e-3 * force
    state = {"rotation": rotation, "rotation_rate": rate, "pivot_velocity": velocity}
    found = rates_of(BUILT["finger"], {}, state, {"pivot_torque": torque, "pivot_force": force})
    q, v = np.array([rotation, 0.0]), np.array([rate, velocity])
    a = np.array([found["rotation_rate"], found["pivot_velocity"]])

    def momentum(t):
        """T is quadratic in v, so that its central differences are exact."""
        at, going = q + t * v + 0.5 * t * t * a, v + t * a
        return (
            np.array([kinetic_energy(at, going + e) - kinetic_energy(at, going - e) for e in np.eye(2)]) / 2
        )

    change = (momentum(1e-7) - momentum(-1e-7)) / 2e-7
    steps = 1e-5 * np.eye(2)
    by_place = np.array([kinetic_energy(q + e, v) - kinetic_energy(q - e, v) for e in steps]) / 2e-5
    # Central differences.
    size = abs(force) + 0.05 * rate**2 * 0.02 + 1.0
    assert change - by_place == pytest.approx([-torque, -force], abs=1e-5 * size)


# Kinematics and statics


@pytest.mark.parametrize(
    "part", ["tilted tappet", "roller tappet", "pad tappet", "pad finger", "roller finger", "rocker"]
)
def test_velocities_are_the_slopes_of_positions(part):
    """Along a motion through states and inputs at random, by central differences."""
    name, given_parameters = PARTS[part]
    c, random, h = BUILT[name], np.random.default_rng(3), 1e-7
    p = c.parameters.vector(given_parameters)
    names = (*c.inputs.names, *c.state.names)
    known = [("rotation", "rotation_rate")] * ("rotation" in names)
    known += [(one, rate_of(one)) for one in names if rate_of(one) != one and rate_of(one) in names]
    pairs = {"overlap": "overlap_rate", "tip_position": "tip_velocity", "rod_position": "rod_velocity"}
    for _ in range(10):
        x = c.state.nominal * random.uniform(-1.0, 1.0, c.state.size)
        u = c.inputs.nominal * random.uniform(-1.0, 1.0, c.inputs.size)
        values = {**c.state.named(x), **c.inputs.named(u)}
        if "cam_angle" in values:
            values["cam_angle"] = random.uniform(0.6 * math.pi, 1.4 * math.pi)  # in the lift

        def at(t, values=values):
            moved = values | {place: values[place] + t * values[rate] for place, rate in known}
            state, inputs = ({n: moved[n] for n in layout.names} for layout in (c.state, c.inputs))
            return outputs_of(c, c.parameters.named(p), state, inputs)

        before, now, after = at(-h), at(0.0), at(h)
        for place, rate in pairs.items():
            if place in now:
                slope = (after[place] - before[place]) / (2.0 * h)
                # Rounding of places of 0.05 m over 2e-7 s, and h^2 of the third derivative.
                assert now[rate] == pytest.approx(slope, rel=1e-5, abs=1e-6)


@pytest.mark.parametrize("part", ["tilted tappet", "roller tappet", "pad tappet"])
def test_a_tappet_passes_what_acts_across_its_path_from_cam_to_guide(part):
    name, given_parameters = PARTS[part]
    inputs = {"cam_angle": 2.3, "cam_speed": 100.0, "cam_load": 500.0, "cam_friction": 30.0}
    found = outputs_of(BUILT[name], given_parameters, {}, inputs)
    assert abs(found["side_force"]) > 1.0
    assert found["side_force"] == pytest.approx(-found["cam_force_x"], rel=1e-12)


@pytest.mark.parametrize(("part", "radius"), [("roller tappet", 9e-3), ("pad tappet", 40e-3)])
def test_on_the_base_circle_radii_are_those_of_two_cylinders(part, radius):
    """R0 r/(R0 + r)."""
    name, given_parameters = PARTS[part]
    R0 = DEFAULTS[name].base_radius
    found = outputs_of(BUILT[name], given_parameters, {}, {"cam_angle": 0.2})
    assert found["radius_of_curvature"] == pytest.approx(R0 * radius / (R0 + radius), rel=1e-12)


@pytest.mark.parametrize("rotation", [-0.1, 0.25])
def test_a_rocker_is_two_arms_on_a_pivot(rotation):
    """Velocities of rigid bodies: the contact moves along the tip with the pad's centre."""
    a, L, r, rate = 32e-3, 40e-3, 10e-3, 50.0
    angles = {"rod_angle": 0.1, "valve_angle": 0.2}
    state = {"rotation": rotation, "rotation_rate": rate}
    found = outputs_of(BUILT["rocker"], angles, state, {"rod_force": 900.0, "tip_load": 700.0})
    assert found["rod_position"] == pytest.approx(a * (math.sin(rotation - 0.1) + math.sin(0.1)), rel=1e-12)
    assert found["tip_position"] == pytest.approx(L * (math.sin(rotation - 0.2) + math.sin(0.2)), rel=1e-12)
    centre = -L * math.sin(rotation - 0.2) * rate  # its velocity along the tip
    pad, tip = centre - r * rate, 0.0
    assert found["tip_sliding_velocity"] == pytest.approx(tip - pad, rel=1e-12)
    assert found["tip_entraining_velocity"] == pytest.approx(-0.5 * (pad + tip - 2.0 * centre), rel=1e-12)
    assert found["pivot_force"] == 900.0 + 700.0
