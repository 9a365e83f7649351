"""Valve seat, lash and loss of contact."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from models.catalogue import CATALOGUE
from models.core import roles
from models.core.evaluation import Evaluation, Interpreted
from models.core.system import Instance, System
from models.monolithic import equilibrium, solve
from models.valve_train.cams.law import law_lift
from models.valve_train.camshaft import camshaft
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

from .systems import DRY, outputs_of, rates_of, turn, valve_train

SEAT = {"seat_stiffness": 2e7, "seat_damping": 300.0}


def dropped(height, **parameters):
    """A valve without a cam, dropped on its seat."""
    start = {"position": height, "coil_position[1]": 0.625 * height, "coil_position[2]": 0.375 * height}
    return System({"valve": Instance(CATALOGUE["valve_spring"](), {**SEAT, **parameters}, start=start)}, [])


@pytest.mark.long
def test_valve_bounces_on_its_seat_and_loses_energy_each_time():
    times = np.linspace(0.0, 0.03, 3001)
    found = solve(dropped(2e-3), times, tolerance=1e-8)
    lift, seat = found["valve.valve_lift"], found["valve.seat_force"]
    assert np.all(seat >= 0.0)
    landings = np.flatnonzero((lift[:-1] > 0.0) & (lift[1:] <= 0.0))
    assert landings.size >= 3
    peaks = [lift[a:b].max() for a, b in itertools.pairwise(landings)]
    assert peaks[0] < 0.9 * 2e-3
    assert peaks[1] < peaks[0]
    # Energy never grows: no source but the tolerance per sample.
    assert np.max(np.diff(found.stored_energy)) < 1e-9
    assert np.all(np.diff(found.dissipated) > -1e-12)
    residual = found.stored_energy - found.stored_energy[0] + found.dissipated
    assert np.max(np.abs(residual)) < 1e-8


def test_valve_comes_to_rest_on_its_seat():
    """k dip = preload, less the spring's own give."""
    system = dropped(2e-3, lash=1e-4)
    lift = equilibrium(system)[system.state.names.index("valve.position")] - 1e-4
    assert -2e7 * lift == pytest.approx(330.0 + 35e3 * lift, rel=1e-9)


@pytest.mark.plain
@pytest.mark.parametrize("lash", [-0.1e-3, 0.0, 0.25e-3])
@pytest.mark.parametrize(
    ("name", "valve"),
    [
        *(("seat-and-lash", "valve_spring"), ("finger-follower", "valve_spring")),
        *(("pushrod-train", "valve_spring"), ("direct-acting-hla", "valve_spring")),
        *(("finger-follower-hla", "valve_spring"), ("coil-clash", "valve"), ("valve-stem", "retainer")),
    ],
)
def test_the_preload_is_the_force_on_the_closed_valve_for_any_lash(name, valve, lash):
    """Of coils at rest, which have all their travel to coil bind."""
    system = build_system(load(name, [f"components.{valve}.parameters.lash={lash}"]))
    x = system.x0.copy()
    x[system.state.names.index(f"{valve}.position")] = lash
    y = dict(zip(system.outputs.names, Interpreted(system).outputs(0.0, x), strict=True))
    springs = 0
    for part, instance in system.instances.items():
        if instance.component.has_role(roles.LoadedSpring, roles.CoilSpring):
            p = instance.component.parameters.named(system.p[system.parameters.of(part)])
            force = "spring_force" if f"{part}.spring_force" in y else "force"
            assert y[f"{part}.{force}"] == pytest.approx(p["preload"], rel=1e-12)
            travel = p["clash_clearance"] if "clash_clearance" in p else 9 * p["gap[1]"]
            assert y[f"{part}.least_gap"] == pytest.approx(travel, rel=1e-12)
            springs += 1
    assert springs == (2 if name == "valve-stem" else 1)


def test_seat_never_pulls():
    """A valve that leaves its seat fast while still dipping into it is not held back."""
    spring = CATALOGUE["valve_spring"]()
    y = outputs_of(spring, SEAT, {"position": -1e-6, "velocity": 1.0})
    assert y["seat_force"] == 0.0
    assert outputs_of(spring, SEAT, {"position": 1e-6, "velocity": -1.0})["seat_force"] == 0.0
    assert outputs_of(spring, SEAT, {"position": -1e-6})["seat_force"] == pytest.approx(20.0, rel=1e-12)


def test_lash_keeps_the_valve_closed_until_the_cam_has_taken_it_up():
    lash = 0.2e-3
    system = valve_train(600, valve_spring={**SEAT, "lash": lash}, contact=DRY)
    times = np.linspace(0.0, 0.5, 1801) * turn(600)
    found = solve(system, times, x0=equilibrium(system), tolerance=1e-7)
    before = found["camshaft.cam_lift"] < 0.15e-3
    assert np.all(found["contact.load"][before] == 0.0)
    # The seat carries preload: a dip of some 17 um.
    assert np.all(np.abs(found["valve_spring.valve_lift"][before]) < 25e-6)
    assert found["valve_spring.valve_lift"][-1] == pytest.approx(8e-3 - lash, abs=5e-6)


def test_contact_is_lost_and_regained_at_3400_rpm():
    system = valve_train(3400, contact=DRY)
    times = np.linspace(0.0, 2.0, 1441) * turn(3400)
    found = solve(system, times, x0=equilibrium(system), tolerance=1e-8)
    load, separated = found["contact.load"], found["contact.separated"]
    assert np.all(np.isfinite(found.outputs))
    assert load.min() == 0.0
    assert np.any(separated == 1.0)
    # It bounces back: a gap opens, and the impact's load exceeds any load of the speeds with contact.
    assert np.max(found["valve_spring.position"] - found["camshaft.surface_position"]) > 1e-6
    assert load.max() > 900.0
    assert np.all(load >= 0.0)
    # Impacts of 1e4 N/ms on a contact mode of 6.7 kHz magnify the steps' errors, but both methods agree.
    assert found.uncertainty["contact.load"].relative_rms < 1e-4


def test_equilibrium_balances_the_preload():
    """On the base circle the contact carries preload and the spring force of its own deflection."""
    system = valve_train(1000)
    x = equilibrium(system)
    found = solve(system, np.array([0.0, 1e-3]), x0=x, tolerance=1e-9)
    load, position = found["contact.load"], found["valve_spring.position"]
    assert load == pytest.approx(330.0 + 35e3 * position, rel=1e-9)
    assert load[0] == pytest.approx(330.0, abs=0.05)
    assert math.isclose(found["contact.film_thickness"][0], found["contact.steady_film_thickness"][0])
    # At rest it stays.
    assert load[1] == pytest.approx(load[0], abs=1e-6)


def test_equilibrium_keeps_a_film_that_nothing_determines():
    system = valve_train(0.0)
    x = equilibrium(system)
    found = solve(system, np.array([0.0, 1e-3]), x0=x)
    assert found["contact.film_thickness"] == pytest.approx([1e-6, 1e-6], rel=1e-14)
    assert found["contact.load"] == pytest.approx(330.0 + 35e3 * found["valve_spring.position"], rel=1e-9)


@pytest.mark.parametrize("angle", [-5.0, 0.0, 7.0])
def test_gas_presses_each_valve_by_its_area(angle):
    areas = {"valve_area[1]": 2e-4, "valve_area[2]": 7e-4}
    y = outputs_of(CATALOGUE["cylinder_gas"](valves=2), areas, {}, {"crank_angle": angle})
    for i, area in enumerate(areas.values(), 1):
        assert y[f"valve_force[{i}]"] == y["gas_pressure"] * area


def test_gas_holds_a_valve_on_its_seat():
    """k dip = preload + p A, less the spring's own give."""
    valve, gas = dropped(0.0).instances["valve"], Instance(CATALOGUE["cylinder_gas"]())
    system = System({"valve": valve, "gas": gas}, [("gas.valve_force[1]", "valve.gas_force")])
    found = dict(zip(system.outputs.names, Evaluation(system).outputs(0.0, equilibrium(system)), strict=True))
    y, force = found["valve.position"], found["gas.valve_force[1]"]
    assert force == pytest.approx(3521360.445 * math.pi * 0.015**2, rel=1e-9)  # of the reference results
    assert -2e7 * y == pytest.approx(330.0 + 35e3 * y + force, rel=1e-9)


# Lash, seat and ramps: the component `valve` on a cam by a linear contact, under a spring without mass
LASH, PRELOAD, RATE = 0.2e-3, 330.0, 35e3
BODY = {"mass": 0.22, "lash": LASH, **SEAT}
# Ramp (mm), speed (r/min): first contact (deg), its closing velocity (m/s), landing (deg), its velocity
# (m/s), peak force of the seat (N), bounces (um). Without ramp the take-up chatters at 3000 r/min, and the
# landing depends on every contact: there both solutions differ by 3e-4, elsewhere by 2e-5.
TAKE_UPS = {
    (0.0, 1000.0): (103.65670, 0.234329, 255.90954, 0.24812, 727.83, ()),
    (0.0, 3000.0): (103.65671, 0.702993, 256.0471, 0.81004, 1712.5, (97.3, 48.9, 20.7, 5.0)),
    (0.3, 1000.0): (82.79407, 0.072000, 275.76181, 0.071978, 453.62, ()),
    (0.3, 3000.0): (82.79397, 0.216002, 275.75512, 0.225285, 677.67, ()),
}
# A part of half a period of the contact, 75 us: it chatters while it takes the lash up.
LONGEST_STEP = 1e-6


@pytest.mark.parametrize(
    ("ramp", "speed"),
    [pytest.param(*key, marks=[pytest.mark.long] * (key != (0.3, 3000.0))) for key in TAKE_UPS],
)
def test_a_cam_takes_up_the_lash_and_puts_the_valve_down(ramp, speed, record):
    omega = speed * math.pi / 30.0
    cam = camshaft().parameters.view(camshaft().parameters.vector({"ramp_height": 1e-3 * ramp}))
    valve = CATALOGUE["valve"]()
    given, dx = valve.parameters.vector(BODY), np.zeros(2)

    def derivative(t, x):
        lift = law_lift(omega * t, cam)
        overlap = lift.s - x[0]
        pushed = 3.85e8 * overlap + 300.0 * (lift.ds * omega - x[1])
        u = {
            "load": max(0.0, pushed) if overlap > 0.0 else 0.0,
            "spring_force[1]": PRELOAD + RATE * (x[0] - LASH),
        }
        valve.flat_derivative(t, x, valve.inputs.vector(u), given, dx)
        return dx.copy()

    at_rest = LASH - PRELOAD / (SEAT["seat_stiffness"] + RATE)
    turned = np.radians([60.0, 360.0]) / omega
    found = solve_ivp(derivative, turned, [at_rest, 0.0], rtol=1e-10, atol=1e-14, max_step=LONGEST_STEP)
    degrees, (position, velocity) = np.degrees(omega * found.t), found.y
    taken_up = crossings(degrees, [law_lift(math.radians(a), cam).s for a in degrees] - position)[0]
    landings = crossings(degrees, LASH - position, after=180.0)
    force = [
        outputs_of(valve, BODY, {"position": y, "velocity": v})["seat_force"]
        for a, y, v in zip(degrees, position, velocity, strict=True)
        if a > landings[0]
    ]
    first, closing, landing, landed, peak, bounces = TAKE_UPS[ramp, speed]
    name, source = f"{ramp:g} mm of ramp, {speed:g} r/min", "independent evaluation"
    record("Train", f"{name}: first contact (deg)", taken_up, first, source, tolerance=2e-4)
    approach = law_lift(math.radians(taken_up), cam).ds * omega
    record("Train", f"{name}: its closing velocity (m/s)", approach, closing, source, tolerance=1e-5)
    record("Train", f"{name}: landing (deg)", landings[0], landing, source, tolerance=1.5e-4)
    impact = -np.interp(landings[0], degrees, velocity)
    record("Train", f"{name}: landing velocity (m/s)", impact, landed, source, relative=3e-4)
    record("Train", f"{name}: peak force of the seat (N)", max(force), peak, source, relative=5e-4)
    heights = [
        1e6 * (position[(degrees > a) & (degrees < b)].max() - LASH)
        for a, b in itertools.pairwise([*landings, 360.0])
    ]
    seen = [height for height in heights if height > 1.0]
    assert len(seen) == len(bounces)
    if seen:
        record("Train", f"{name}: heights of the bounces (um)", seen, bounces, source, tolerance=0.1)


def crossings(angles, values, after=0.0):
    """Angles at which values rise through zero, by linear interpolation."""
    at = np.flatnonzero((values[:-1] <= 0.0) & (values[1:] > 0.0) & (angles[:-1] > after))
    return angles[at] - values[at] * np.diff(angles)[at] / np.diff(values)[at]


@pytest.mark.plain
def test_burned_gas_expands_by_its_own_exponent():
    """p V^n at two angles between the end of heat release and the blowdown; V by crank and rod."""
    gas = CATALOGUE["cylinder_gas"]()
    p = gas.parameters.defaults()

    def state(degrees):
        theta, ratio = math.radians(degrees), p.rod_length / p.crank_radius
        down = ratio + 1.0 - math.cos(theta) - math.sqrt(ratio**2 - math.sin(theta) ** 2)
        volume = 1.0 + 0.5 * (p.compression_ratio - 1.0) * down
        angle = p.firing_angle + theta
        return outputs_of(gas, {}, {}, {"crank_angle": angle})["gas_pressure"] + p.crankcase_pressure, volume

    (first, small), (last, large) = state(70.0), state(125.0)
    # Wiebe's share is 1 - e^-19 at 70 degrees.
    assert math.log(first / last) / math.log(large / small) == pytest.approx(p.expansion_exponent, rel=1e-6)


@pytest.mark.plain
@pytest.mark.parametrize("degrees", [30.0, 200.0, 400.0])
def test_indicated_work_is_pressure_times_the_pistons_motion(degrees):
    """dW/dt = -p A dx/dt, x = r cos + sqrt(l^2 - r^2 sin^2) by central differences."""
    gas = CATALOGUE["cylinder_gas"]()
    p, theta, h = gas.parameters.defaults(), math.radians(degrees), 1e-6

    def place(angle):
        r, l = p.crank_radius, p.rod_length
        return r * math.cos(angle) + math.sqrt(l**2 - (r * math.sin(angle)) ** 2)

    turning = {"crank_angle": theta, "crank_speed": 200.0}
    velocity = 200.0 * (place(theta + h) - place(theta - h)) / (2.0 * h)
    power = -outputs_of(gas, {}, {}, turning)["gas_pressure"] * p.bore_area * velocity
    assert rates_of(gas, {}, {}, turning)["indicated_work"] == pytest.approx(power, rel=1e-7)
