"""The coupled valve train against its monolithic reference: order, accuracy, stability, step control.

With steps of one length: eight milliseconds at 1000 r/min in the lift, components in process (FMUs agree with
them to the last bit, see tests/fmus). With step control: a flexible camshaft; what it takes is counted in
steps of single participants (doStep calls) for a relative RMS error of the load of 1e-6, weighed by time: a
tenth of what the best explicit master takes with equal steps, at 1000 r/min and at 3000 r/min, where the
follower leaves the cam.
"""

from dataclasses import replace

import numpy as np
import pytest

from models.core.difference import difference, time_weights
from models.monolithic import equilibrium, solve
from orchestrator.errors import UnstableCouplingError
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.stepping import ControlledSteps, StepControl

from .coupled import run_coupled, start_from, with_start

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


def test_the_explicit_master_is_named_unstable_at_large_steps(valve_train):
    with pytest.raises(UnstableCouplingError, match=r"contact\.load"):
        run_coupled(valve_train, GaussSeidel("linear"), LARGE, DURATION)


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
