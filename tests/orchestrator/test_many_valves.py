"""Shipped scenarios are within their tolerances; camshafts and cylinders of one engine are independent.

The coupled valve train against its monolithic reference: order, accuracy, stability, step control.

With steps of one length: eight milliseconds at 1000 r/min in the lift, components in process (FMUs agree with
them to the last bit, see tests/fmus). With step control: a flexible camshaft; what it takes is counted in
steps of single participants (doStep calls) for a relative RMS error of the load of 1e-6, weighed by time: a
tenth of what the best explicit master takes with equal steps, at 1000 r/min and at 3000 r/min, where the
follower leaves the cam.
"""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from models.core.difference import difference, time_weights
from models.core.system import System
from models.monolithic import equilibrium, solve
from models.monolithic.cycle import find_cycle
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.scenario import build_scenario
from orchestrator.scenario.files import list_shipped, load
from orchestrator.scenario.system import build_system
from orchestrator.stepping import ControlledSteps, StepControl

from .commands import called
from .coupled import run_coupled, start_from, with_start

FIRING_ORDER = 1, 3, 4, 2


def run_short(system, steps, names=None):
    """The records of so many steps of 2 us, of the system or of these instances alone."""
    if names:
        own = {name: i for name, i in system.instances.items() if name in names}
        kept = [c for c in system.connections if {c.source.instance, c.target.instance} <= names]
        system = System(own, [(str(c.source), str(c.target)) for c in kept])
    return run_coupled(system, GaussSeidel("quadratic"), 2e-6, 2e-6 * steps)


@pytest.mark.parametrize("kind", ["intake", "exhaust"])
def test_noses_come_in_firing_order_half_a_crank_turn_apart(kind):
    """A cam is at its nose (180 deg) when the crank has turned by 2 (180 - phase)."""
    parts = load("valve-train-16v").components
    phases = [parts[f"tappet_{kind}_{cylinder}a"].parameters["phase"] for cylinder in FIRING_ORDER]
    np.testing.assert_allclose(np.diff(-2.0 * np.degrees(phases)) % 720.0, 180.0)


@pytest.mark.long
def test_camshafts_move_as_they_do_alone_and_give_way_to_their_followers():
    """The crankshaft's speed is prescribed: the same bits as alone. Axes move away from followers, whose
    contacts only push; on the base circle a shaft that springs back leaves some."""
    system = build_system(load("valve-train-16v"))
    together = run_short(system, 100)
    for kind in ("intake", "exhaust"):
        alone = run_short(system, 100, {n for n in system.instances if kind in n or n == "flywheel"})
        for output in (
            f"cam_contact_{kind}_3a.load",
            f"tappet_{kind}_3a.position",
            f"{kind}_shaft.axis_y[6]",
        ):
            np.testing.assert_array_equal(together[output], alone[output])
            assert np.ptp(alone[output]) > 0.0
        loads = np.array([together[f"cam_contact_{kind}_{c}{s}.load"] for c in (1, 2, 3, 4) for s in "ab"])
        moved = np.array([together[f"{kind}_shaft.axis_y[{i}]"] for i in range(1, 9)])
        assert (loads >= 0.0).all()
        assert (loads.max(axis=1) > 0.0).all()
        assert (moved.min(axis=1) < 0.0).all()


@pytest.mark.parametrize(
    ("engine", "train"), [("valve-train-16v", "direct-acting-hla"), ("pushrod-engine", "qin2000-train")]
)
def test_trains_of_an_engine_start_in_the_cycle_that_they_have_alone(engine, train):
    """On a rigid shaft. All have the parts and lines of that train, and differ by their phases and starts."""
    whole, one = load(engine), load(train)
    suffixes = [name.removeprefix("tappet") for name in whole.components if name.startswith("tappet_")]
    lines, own = set(whole.connections), [line for line in one.connections if "flywheel" not in line]
    speed, phases = 1000.0 * np.pi / 30.0, {}
    for suffix in suffixes:
        assert lines.issuperset(re.sub(r"(\w+)\.", rf"\1{suffix}.", line) for line in own)
        parts = {name: whole.components[name + suffix] for name in one.components if name != "flywheel"}
        for name, part in parts.items():
            changed = {"start": part.start, "parameters": dict(part.parameters)}
            if name == "tappet":
                phase = changed["parameters"].pop("phase")
            assert part.model_copy(update=changed) == one.components[name].model_copy(update=changed)
            assert changed["parameters"] == one.components[name].parameters
        phases[phase] = parts
    for parts in phases.values():
        content = one.model_dump(exclude_none=True)
        content["components"] |= {name: part.model_dump(exclude_none=True) for name, part in parts.items()}
        content["components"]["flywheel"]["parameters"] = {"motion": "prescribed", "initial_speed": speed}
        system = build_system(build_scenario(content))
        closed = {"start": system.x0, "tolerance": 1e-10, "steady": 1e-7}
        end = find_cycle(system, 2.0 * np.pi / speed, ["flywheel.angle"], **closed).end
        end[system.state.names.index("flywheel.angle")] -= 2.0 * np.pi
        size = np.array(system.state.nominal) + np.abs(end)
        np.testing.assert_array_less(np.abs(system.x0 - end), 1e-6 * size)


@pytest.mark.parametrize(
    "steps", [pytest.param(3, marks=pytest.mark.plain), pytest.param(100, marks=pytest.mark.long)]
)
def test_cylinders_turn_in_firing_order_and_as_they_do_alone(steps):
    """Throws follow one another by half a turn; the shaft's speed is prescribed: the same bits as alone."""
    whole = build_system(load("engine-16v"))
    assert len(whole.instances) == 1 + 2 + 4 * 16 + 2 * 4
    cylinders = {name for name in whole.instances if name.startswith(("flywheel", "gas_", "piston_"))}
    together = run_short(whole, steps, cylinders if steps < 100 else None)
    for behind, cylinder in enumerate(FIRING_ORDER):
        angle = together["flywheel.angle"] - np.pi * behind
        np.testing.assert_allclose(together[f"flywheel.throw_angle[{cylinder}]"], angle, atol=1e-12)
    alone = run_short(whole, steps, {"flywheel", "gas_3", "piston_3"})
    for output in ("gas_3.gas_pressure", "piston_3.piston_offset"):
        np.testing.assert_array_equal(together[output], alone[output])
        assert np.ptp(alone[output]) > 0.0


# Those with solved films or sixteen valves and pistons take many minutes.
LENGTHY = {"engine-ehl", "valve-train-ehl", "valve-train-ehl-sweep", "engine-16v"}


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(set(list_shipped()) - LENGTHY))
def test_a_run_is_within_its_tolerance_of_the_reference(name, tmp_path, record):
    done = called("run", name, "--no-figures", "--out", str(tmp_path / name))
    assert done.returncode == 0, done.stderr
    summary = json.loads((tmp_path / name / "summary.json").read_text("utf-8"))
    for variable, allowed in summary["tolerance"].items():
        quantity = f"scenario {name}: relative RMS error of {variable}"
        error = summary["errors"][variable]["relative_rms"]
        record("Coupling", quantity, error, 0.0, "monolithic solution", tolerance=allowed)


DURATION = 8e-3
SAMPLES = 100


@pytest.fixture(scope="module")
def valve_train():
    """The system on its way at a cam angle of 104 degrees.

    It started in equilibrium at 80 degrees, and the jerk steps at the beginning of the lift (90) and at the
    nose (178.7) are outside of what is compared: where a derivative jumps inside a macro step, the slope of
    a higher order scatters with the place of the jump in the step.
    """
    system = build_system(load("valve-train"))
    system = with_start(system, {"flywheel": {"angle": np.radians(80.0)}})
    system = start_from(system, equilibrium(system))
    return start_from(system, solve(system, np.linspace(0.0, 4e-3, 11), tolerance=1e-12).state[-1])


@pytest.fixture(scope="module")
def reference(valve_train):
    return solve(valve_train, np.linspace(0.0, DURATION, SAMPLES + 1), tolerance=1e-12)


def error(system, reference, master, step, name="contact.load"):
    """Relative RMS of one variable against the reference."""
    recorder = run_coupled(system, master, step, DURATION)
    stride = round(DURATION / SAMPLES / step)
    truth = reference.outputs[:, system.outputs.names.index(name)]
    return difference(recorder[name][::stride], truth).relative_rms


@pytest.mark.parametrize(
    ("master", "order", "ceiling"),
    [
        (Jacobi("linear"), 2, 3e-5),
        (Jacobi("quadratic"), 3, 2e-6),
        (GaussSeidel("linear"), 2, 7e-6),
        (GaussSeidel("quadratic"), 3, 2e-6),
    ],
    ids=lambda value: f"{type(value).__name__}-{value.extrapolation}" if hasattr(value, "step") else None,
)
def test_order_of_convergence_of_the_contact_load(valve_train, reference, master, order, ceiling, record):
    """Slope on the finest pair within 0.1, and a ceiling on the error there."""
    coarse, fine = (error(valve_train, reference, master, step) for step in (1e-6, 5e-7))
    case = f"valve train, {type(master).__name__}, {master.extrapolation} inputs"
    slope, quantity = np.log2(coarse / fine), f"{case}: relative RMS error of the load, 0.5 µs"
    record("Coupling", f"{case}: order", slope, order, "order of the signals", tolerance=0.1)
    record("Coupling", quantity, fine, 0.0, "monolithic solution", tolerance=ceiling)


LARGE = 4e-5  # 1.7 rad of the 6.7 kHz contact mode per step


def test_the_iterated_master_converges_at_the_step_where_the_explicit_one_is_unstable(
    valve_train, reference, record
):
    found = error(valve_train, reference, Iterated("linear"), LARGE)
    quantity = "valve train, Iterated, linear inputs, 40 µs: relative RMS error of the load"
    record("Coupling", quantity, found, 0.0, "monolithic solution", tolerance=0.05)


def test_the_references_own_uncertainty_is_far_below_the_coupling_errors(reference, record):
    found = reference.uncertainty["contact.load"].relative_rms
    quantity = "valve train: relative RMS of the load between two methods of the monolithic solution"
    record("Coupling", quantity, found, 0.0, "CVODE against DOP853 or Radau", tolerance=1e-7)


def test_a_train_that_turns_backwards_mirrors_torque_and_friction():
    """Its cam is symmetric: loads and films are the same, velocities of the surfaces and torques opposite.

    To rounding: 1e-11 of each value's largest size was measured over a revolution.
    """
    system = build_system(load("valve-train"))

    def turn(sign):
        flywheel = system.instances["flywheel"]
        speed = sign * flywheel.parameters["initial_speed"]
        both = {"initial_speed": speed, "final_speed": speed}
        turned = replace(flywheel, parameters={**flywheel.parameters, **both})
        other = system.with_instances({**system.instances, "flywheel": turned})
        other = with_start(other, {"flywheel": {"angle": sign * np.radians(85.0)}})
        return run_coupled(start_from(other, equilibrium(other)), GaussSeidel("quadratic"), 1e-5, 5e-3)

    forth, back = turn(1.0), turn(-1.0)
    for name, sign in {
        "contact.load": 1.0,
        "contact.film_thickness": 1.0,
        "valve_spring.position": 1.0,
        "camshaft.drive_torque": -1.0,
        "camshaft.entraining_velocity": -1.0,
        "contact.friction_force": -1.0,
    }.items():
        size = np.max(np.abs(forth[name]))
        assert size > 0.0
        np.testing.assert_allclose(back[name], sign * forth[name], atol=1e-9 * size, rtol=0.0)


def flexible_train(rpm):
    """In equilibrium at a cam angle of 80 degrees, ten before the lift."""
    system = build_system(load("valve-train-flexible"))
    speed = np.pi / 30.0 * rpm
    flywheel = system.instances["flywheel"]
    parameters = {**flywheel.parameters, "initial_speed": speed, "final_speed": speed}
    instances = {**system.instances, "flywheel": replace(flywheel, parameters=parameters)}
    system = system.with_instances(instances)
    system = with_start(system, {"flywheel": {"angle": np.radians(80.0), "speed": speed}})
    return start_from(system, equilibrium(system))


def run(system, master, steps, stop):
    """Error of the contact load at up to 5000 of the communication points, and steps of participants."""
    recorder = run_coupled(system, master, steps, stop)
    rows = np.unique(np.linspace(0, len(recorder.times) - 1, 5000).astype(int))
    times = recorder.times[rows]
    reference = solve(system, times, tolerance=1e-12)
    truth = reference.outputs[:, system.outputs.names.index("contact.load")]
    assert reference.uncertainty["contact.load"].relative_rms < 1e-7
    found = difference(recorder["contact.load"][rows], truth, weights=time_weights(times))
    return found.relative_rms, recorder.statistics.do_steps


def controlled(tolerance):
    """What is iterated reaches the states by its integral over a step: it need not be as sharp as they."""
    master = Iterated(
        "hermite",
        100.0 * tolerance,
        acceleration="quasi_newton",
        iterate=("camshaft", "valve_spring", "contact"),
    )
    return master, ControlledSteps(1e-6, StepControl("predictor_corrector", tolerance, tolerance))


def test_a_hundred_thousandth_in_a_fifth_of_the_steps_of_the_explicit_master(record):
    """Eight milliseconds at 1000 r/min with the beginning of the lift inside."""
    system = flexible_train(1000.0)
    explicit, many = run(system, GaussSeidel("quadratic"), 2e-6, 8e-3)
    error, few = run(system, *controlled(5e-9), 8e-3)
    assert explicit > 1e-5
    case = "valve train, step control, Hermite, start of the lift, 1000 r/min"
    for quantity, value, source, tolerance in (
        ("relative RMS error of the load", error, "monolithic solution", 1e-5),
        ("share of the doStep calls", few / many, "Gauss-Seidel, quadratic, fixed steps", 0.2),
    ):
        record("Coupling", f"{case}: {quantity}", value, 0.0, source, tolerance=tolerance)


@pytest.mark.long
@pytest.mark.parametrize(
    ("rpm", "tolerance", "step"), [(1000.0, 2.15e-9, 1.25e-6), (3000.0, 1.5e-11, 2.02e-7)]
)
def test_a_millionth_over_a_whole_turn_in_a_tenth_of_the_steps(rpm, tolerance, step):
    """The explicit master's step is one with which it does not reach a millionth yet."""
    system, turn = flexible_train(rpm), 60.0 / rpm
    explicit, many = run(system, GaussSeidel("quadratic"), step, turn)
    error, few = run(system, *controlled(tolerance), turn)
    assert error <= 1e-6 < explicit
    assert 10 * few <= many
