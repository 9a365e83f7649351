"""Events inside macro steps: against exact instants, conservation, and the monolithic reference."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from models.core.system import Instance, Port, System
from models.flywheel import flywheel
from models.monolithic import equilibrium, solve
from models.oscillators.bouncing_mass import FallingMassParameters, SpringStopParameters
from models.slider_crank.slider_crank import slider_crank
from orchestrator.engine.step import REASONS
from orchestrator.masters import GaussSeidel, Iterated
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.stepping import ControlledSteps, FixedSteps, StepControl
from orchestrator.stepping.locator import Locator
from tests.models import exact_oscillators as exact

from .coupled import run_coupled, start_from

EVENT, TIME_EVENT = REASONS.index("event"), REASONS.index("time_event")


def controlled(relative, first=1e-4):
    return ControlledSteps(first, StepControl("predictor_corrector", relative, relative))


def hermite(relative, **options):
    return Iterated("hermite", 1e-2 * relative, **options)


def located(recorder, name):
    """The ends of steps that the output `name` set as an event."""
    number = recorder.names.index(name)
    return np.array([s.end for s in recorder.steps if s.reason == EVENT and s.source == number])


def bouncing(steps, master, stop, position=0.1, velocity=0.0, **parameters):
    """The recorder, the exact solution at its times, and the exact instants of touch and release."""
    system = build_system(load("bouncing-mass"))
    i = system.instances
    system = system.with_instances(
        {
            "mass": replace(i["mass"], start={"position": position, "velocity": velocity}),
            "stop": replace(i["stop"], parameters=parameters),
        }
    )
    recorder = run_coupled(system, master, steps, stop)
    mass, spring = FallingMassParameters(), SpringStopParameters(**parameters)
    truth = exact.bouncing_mass(recorder.times, mass, spring, position, velocity)
    return recorder, truth.motion, np.sort(np.concatenate([truth.touches, truth.releases]))


# Of an error: what the tolerance allows in each step, times nominal (0.1 m, 1 m/s), adds up over all steps
# at most; a velocity missed in one bounce is missed until the stop, in the position times what is left.
CASES = {
    "falling": {"stop": 1.0},
    "touching": {"stop": 1.0, "position": -0.01},
    "stiff": {"stop": 0.5, "stiffness": 1e8},
    "touching, stiff": {"stop": 0.3, "position": 0.0, "velocity": -1.0, "stiffness": 1e8},
    "damped": {"stop": 1.5, "damping": 20.0},
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("relative", [1e-6, pytest.param(1e-8, marks=pytest.mark.long)])
def test_touch_and_release_are_those_of_the_exact_motion(relative, case):
    recorder, truth, instants = bouncing(controlled(relative), hermite(relative), **CASES[case])
    found = located(recorder, "stop.contact_margin")
    assert len(found) == len(instants) >= 3
    added = relative * len(recorder.steps)
    error = np.abs(recorder["mass.position"] - truth[:, 0])
    assert error.max() < added * (0.1 + recorder.times[-1])
    # The motion's error over its velocity is the event's; the damped mass creeps to 0.1 m/s at the end.
    slowest = np.abs(np.interp(instants, recorder.times, truth[:, 1])).min()
    assert np.abs(found - instants).max() < 1e-9 + error.max() / slowest


@pytest.mark.long
def test_the_error_follows_the_tolerance_and_energy_is_kept_over_many_bounces():
    drifts, errors = [], []
    for relative in (1e-6, 1e-8):
        recorder, truth, instants = bouncing(controlled(relative), hermite(relative), 10.0)
        assert len(located(recorder, "stop.contact_margin")) == len(instants) == 62
        spring = np.minimum(0.0, recorder["mass.position"])
        energy = 0.5 * recorder["mass.velocity"] ** 2 + 9.81 * recorder["mass.position"] + 5e3 * spring**2
        drifts.append(np.ptp(energy) / energy[0])
        errors.append(np.abs(recorder["mass.position"] - truth[:, 0]).max())
        assert drifts[-1] < relative * len(recorder.steps)
    assert errors[1] < 0.1 * errors[0]
    assert drifts[1] < 0.1 * drifts[0]


@pytest.mark.parametrize(
    ("master", "limit"), [(hermite(1e-9), 4e-6), (GaussSeidel("quadratic"), 4e-3)], ids=str
)
def test_fixed_steps_end_at_events_and_return_to_the_grid(master, limit, record):
    """An event ends a step (tolerance 1 ns); the error is of the signals' order: 4 in 1 ms, or 3."""
    step, tolerance = 1e-3, 1e-9
    recorder, truth, instants = bouncing(FixedSteps(step, tolerance), master, 0.5)
    found = located(recorder, "stop.contact_margin")
    error = np.abs(recorder["mass.position"] - truth[:, 0]).max()
    assert len(found) == len(instants) == 4
    case = f"bouncing mass, {type(master).__name__}, {master.extrapolation} inputs, 1 ms"
    source = f"{case}: error of the position (m)"
    record("Coupling", source, error, 0.0, "piecewise solution", tolerance=limit)
    quantity, allowed = f"{case}: instants of touch and release (s)", tolerance + error / 1.39  # m/s there
    record("Coupling", quantity, found, instants, "piecewise solution", tolerance=allowed)
    others = np.array([s.end for s in recorder.steps if s.reason != EVENT])
    np.testing.assert_allclose(others / step, np.round(others / step), atol=1e-9)
    assert len(others) == 501


@pytest.mark.parametrize(("event_time", "most"), [("when", 8), ("", 2 * 31)])
def test_of_counted_events_the_first_is_located(event_time, most):
    """Two of them in a step of 1 s, to 1 ns: with the last one's time as a guess, or by bisection (30 halves,
    closed in from both sides). Those within 100 tolerances of the last are stepped over."""
    time, tolerance, instants, made = 5.0, 1e-9, np.array([5.3137, 5.7]), []
    tells = SimpleNamespace(event_indicators=(), event_counter="count", event_time=event_time, next_event="")
    state = SimpleNamespace(
        values=np.zeros(2), history=SimpleNamespace(end_smooth=np.ones(2, bool), rated=np.zeros(2, bool))
    )
    wiring = SimpleNamespace(
        system=SimpleNamespace(instances={"ball": SimpleNamespace(component=tells)}),
        number={Port("ball", "count"): 0, Port("ball", "when"): 1},
        sources=(0, 1),
    )

    def attempt(length):
        past = instants[instants <= time + length]
        made.append(length)
        state.values = np.array([len(past), past.max(initial=0.0)])

    locator = Locator(SimpleNamespace(wiring=wiring, state=state), tolerance)
    start = SimpleNamespace(coupling=SimpleNamespace(values=np.zeros(2)))
    attempt(1.0)
    before, over, source = locator.locate(start, time, 1.0, attempt)
    assert time + before < instants[0] <= time + before + over <= time + before + tolerance * (1.0 + 1e-6)
    assert (source, made[-1]) == (0, before)
    assert len(made) <= most
    locator.last = instants[0] - 90.0 * tolerance
    attempt(1.0)
    assert locator.locate(start, time, 1.0, attempt) == (1.0, 0.0, -1)


def slider_crank_on_a_free_flywheel():
    """Driven by its inertia only: each impact takes an angular impulse from it."""
    return System(
        {
            "flywheel": Instance(
                flywheel(), {"motion": 0.0, "inertia": 0.5}, start={"speed": 2000.0 * np.pi / 30.0}
            ),
            "slider_crank": Instance(
                slider_crank(),
                {"form": 1.0, "restitution": 0.4, "clearance": 1e-4, "joint_friction": 0.0733},
                {"mode": 1.0, "psi": 0.000722},
            ),
        },
        [
            ("flywheel.angle", "slider_crank.crank_angle"),
            ("flywheel.speed", "slider_crank.crank_speed"),
            ("flywheel.acceleration", "slider_crank.crank_acceleration"),
            ("slider_crank.crank_torque", "flywheel.load_torque[1]"),
            ("slider_crank.crank_impact_impulse", "flywheel.load_impulse[1]"),
        ],
    )


@pytest.mark.long
def test_impacts_reach_the_flywheel_when_they_happen_and_chatter_does_not_stall():
    """Sixteen impacts in 4.2 ms end in sliding: of those closer than 100 tolerances one is located."""
    system, stop, tolerance = slider_crank_on_a_free_flywheel(), 0.013, 1e-9
    reference = solve(system, np.linspace(0.0, stop, 651), tolerance=1e-11)
    instants = np.array([event.time for event in reference.events])
    errors = {}
    for given in (tolerance, None):
        recorder = run_coupled(system, GaussSeidel("quadratic"), FixedSteps(2e-5, given), stop)
        assert recorder["slider_crank.event_count"][-1] == len(instants)
        on_grid = np.array([s.reason != EVENT for s in recorder.steps])
        missed = recorder["flywheel.speed"][on_grid] - reference["flywheel.speed"]
        errors[given] = np.abs(missed).max()
        if given:
            found = located(recorder, "slider_crank.event_count")
            assert np.diff(found).min() > 100.0 * tolerance
            apart = np.abs(found[:, None] - instants).min(axis=1)
            # As far as the crank angle is right: its error over the speed of the crank, 209 rad/s.
            angle = np.abs(recorder["flywheel.angle"][on_grid] - reference["flywheel.angle"]).max()
            assert apart.max() < tolerance + max(1e-7, angle / 209.0)
            assert 8 <= len(found) < len(instants)
    assert errors[tolerance] < 0.05 * errors[None]


@pytest.mark.parametrize("located_", [True, False], ids=["controlled", "fixed"])
def test_no_step_leads_past_a_known_time(located_):
    """The ends of a ramp, 10 and 23 ms: the angle is its integral, 100 t + 50 t_r^2/(2 * 13 ms)."""
    system = build_system(load("valve-train"))
    wheel = replace(
        system.instances["flywheel"],
        parameters={"initial_speed": 100.0, "final_speed": 150.0, "ramp_start": 0.01, "ramp_duration": 0.013},
    )
    names = ("flywheel", "camshaft")
    kept = [c for c in system.connections if c.source.instance in names and c.target.instance in names]
    ramped = System(
        {"flywheel": wheel, "camshaft": system.instances["camshaft"]},
        [(str(c.source), str(c.target)) for c in kept],
    )
    steps = controlled(1e-6) if located_ else FixedSteps(7e-4, 1e-9)
    recorder = run_coupled(ramped, hermite(1e-6), steps, 0.03)
    ends = np.array([s.end for s in recorder.steps if s.reason == TIME_EVENT])
    assert {0.01, 0.023} <= set(np.round(ends, 12))
    breaks = np.array([s.end for s in recorder.steps])
    for time, due in zip(recorder.times[:-1], recorder["camshaft.next_event"][:-1], strict=True):
        after = breaks[np.searchsorted(breaks, time, side="right")]
        # What is due changes with the speed until the last step before it.
        assert after <= due + 1e-9
    r = np.clip(recorder.times - 0.01, 0.0, 0.013)
    late = 50.0 * np.maximum(0.0, recorder.times - 0.023)
    angle = 100.0 * recorder.times + 50.0 / 0.026 * r**2 + late
    # The flywheel integrates its own ramp, to 1e-10.
    np.testing.assert_allclose(recorder["flywheel.angle"], angle, atol=1e-8)


@pytest.mark.long
@pytest.mark.parametrize("flexible", [False, True], ids=["rigid", "flexible"])
def test_losses_and_landings_of_a_bouncing_follower_are_those_of_the_reference(flexible, record):
    """3400 r/min: every zero of the deflection, to the error of the deflection over its rate."""
    system, stop, relative = build_system(load("valve-train-bounce")), 0.0125, 1e-8
    i = dict(system.instances)
    shaft = i["camshaft"]
    i["camshaft"] = replace(shaft, parameters={**shaft.parameters, "flexible": float(flexible)})
    system = system.with_instances(i)
    system = start_from(system, equilibrium(system))
    times = np.linspace(0.0, stop, int(stop / 2e-6) + 1)
    reference = solve(system, times, tolerance=1e-11)
    spline = CubicSpline(times, reference["contact.deflection"])
    zeros = spline.roots(extrapolate=False)
    zeros = zeros[zeros > 0.0]
    master = hermite(relative, iterate=("camshaft", "contact", "valve_spring"))
    recorder = run_coupled(system, master, controlled(relative, 1e-6), stop)
    found = located(recorder, "contact.deflection")
    assert len(found) == len(zeros) >= 16
    error = np.abs(recorder["contact.deflection"] - spline(recorder.times)).max()
    # What each step may miss of 1 mm, the nominal size of the positions, adds up; bounces on the flexible
    # shaft, of 0.4 mm and not 20 um, spread what was missed before them (fivefold measured).
    assert error < (10.0 if flexible else 1.0) * 1e-3 * relative * len(recorder.steps)
    allowed = 1e-9 + error / np.abs(spline(zeros, 1)).min()
    quantity = f"follower at 3400 r/min, {'flexible' if flexible else 'rigid'} camshaft: contact changes (s)"
    record("Coupling", quantity, found, zeros, "monolithic solution", tolerance=allowed)
