"""Behaviour of a coupling before the run: against closed forms, and against what runs do."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from models.core.difference import difference
from models.core.evaluation import Evaluation
from models.core.system import Instance, Port
from models.monolithic.trajectory import compute_trajectory
from models.oscillators.two_masses import CoupledMassParameters
from models.valve_train.valve_spring import valve_spring
from orchestrator.analyses.stability.behaviour import (
    Behaviour,
    Couplings,
    find_hardest_point,
    find_stability_limit,
)
from orchestrator.analyses.stability.linear import ROWS, compute_spectral_radius
from orchestrator.analyses.stability.linear_participants import (
    LinearParticipant,
    build_shapes,
    compute_extrapolation_error,
    evaluate_ends,
)
from orchestrator.analyses.stability.linearisation import Point, linearise, linearise_at
from orchestrator.analyses.stability.macro_step import follow_errors, sample_trajectory
from orchestrator.analyses.stability.partition import Partition
from orchestrator.analyses.stability.survey import round_down
from orchestrator.errors import UnstableCouplingError
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.participants.protocol import BoundVariables
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start

from .coupled import assert_growth_changes_at, build_participants, measure_growth, run_coupled
from .two_masses import two_masses

SIGNALS = ("hold", "linear", "quadratic", "hermite")


def point(system, row=0, stop=1.0, watched=()):
    return linearise_at(system, compute_trajectory(system, np.linspace(0.0, stop, 11), 1e-9), row, watched)


def build_step_by_hand(h, degree, gauss_seidel, **parameters):
    """The macro step of both masses, from the variation of constants in closed form.

    Data: positions and velocities of both, force, and force, position and velocity before. Constants of an
    invertible A: the integral of exp(A s) B is A^-1 (Phi - 1) B, and of exp(A (h - s)) s B
    A^-2 (Phi - 1 - A h) B.
    """
    p = CoupledMassParameters(**parameters)
    k, d, kc, dc = p.stiffness / p.mass, p.damping / p.mass, p.coupling_stiffness, p.coupling_damping
    one = np.array([[0.0, 1.0], [-k - kc / p.mass, -d - dc / p.mass]])
    two = np.array([[0.0, 1.0], [-k, -d]])
    b1, b2 = np.array([[0.0, 0.0], [kc / p.mass, dc / p.mass]]), np.array([[0.0], [1.0 / p.mass]])

    def response(a, b):
        values, vectors = np.linalg.eig(a)
        phi = ((vectors * np.exp(values * h)) @ np.linalg.inv(vectors)).real
        inverse = np.linalg.inv(a)
        return phi, inverse @ (phi - np.eye(2)) @ b, inverse @ inverse @ (phi - np.eye(2) - a * h) @ b

    phi1, held1, ramp1 = response(one, b1)
    phi2, held2, ramp2 = response(two, b2)
    first, second, force, before, motion_before = (
        np.eye(8)[0:2], np.eye(8)[2:4], np.eye(8)[4:5], np.eye(8)[5:6], np.eye(8)[6:8]
    )  # fmt: skip
    slope = (second - motion_before) / h if degree else 0.0 * second
    first_new = phi1 @ first + held1 @ second + ramp1 @ slope
    motion_seen = second + h * slope
    force_new = np.array([[kc, dc]]) @ (first_new - motion_seen)
    if gauss_seidel:
        start, force_slope = (force, (force_new - force) / h) if degree else (force_new, 0.0 * force)
    else:
        start, force_slope = force, ((force - before) / h if degree else 0.0 * force)
    second_new = phi2 @ second + held2 @ start + ramp2 @ force_slope
    return np.vstack([first_new, second_new, force_new, force, second])


def compute_radius(matrix):
    return np.abs(np.linalg.eigvals(matrix)).max()


@pytest.mark.parametrize("kind", [Jacobi, GaussSeidel])
@pytest.mark.parametrize("signal", ["hold", "linear"])
def test_the_macro_step_read_out_of_a_master_has_the_spectral_radius_of_the_one_derived_by_hand(
    kind, signal, record
):
    """Independent method; eigenvalues agree to the differences' 1e-9 times their condition."""
    behaviour = Behaviour(point(two_masses()), kind(signal))
    for h in (1e-2, 5e-2, 0.2):
        by_hand = compute_radius(build_step_by_hand(h, int(signal == "linear"), kind is GaussSeidel))
        quantity, source = "spectral radius of a macro step, two masses", "derived by hand"
        found = behaviour.evaluate(h).radius
        record("Coupling", f"{quantity}, {h:g} s", found, by_hand, source, relative=1e-7)


@pytest.mark.parametrize("kind", [Jacobi, GaussSeidel])
@pytest.mark.parametrize("signal", ["hold", "linear"])
def test_the_largest_stable_step_is_where_the_radius_derived_by_hand_crosses_one(kind, signal, record):
    """To the bisection of the scan's interval, 1.03^(1/64) in the step."""
    behaviour = Behaviour(point(two_masses()), kind(signal))
    limit = find_stability_limit(behaviour, 1e-2, 1.0, [])

    def excess(h):
        return compute_radius(build_step_by_hand(h, int(signal == "linear"), kind is GaussSeidel)) - 1.0

    exact = brentq(excess, 0.5 * limit, 2.0 * limit)
    quantity = "largest stable macro step, two masses (s)"
    record("Coupling", quantity, limit, exact, "derived by hand", relative=5e-4)


@pytest.mark.parametrize(
    "master",
    [
        *(
            pytest.param(kind(signal), marks=[pytest.mark.long] * (signal != "linear"))
            for kind in (Jacobi, GaussSeidel)
            for signal in ("linear", "quadratic", "hermite")
        ),
        *(pytest.param(Iterated(signal), marks=pytest.mark.long) for signal in ("linear", "quadratic")),
    ],
    ids=lambda master: f"{type(master).__name__}-{master.extrapolation}",
)
def test_runs_of_the_masses_grow_beyond_the_predicted_limit_and_decay_below_it(master):
    """What grows is no part of the start and begins at its rounding or truncation."""
    system = two_masses(coupling_stiffness=400.0)
    behaviour = Behaviour(point(system), master)
    limit = find_stability_limit(behaviour, 1e-3, 0.5, [])
    assert_growth_changes_at(limit, behaviour, system, lambda: build_participants(system))


@pytest.mark.long
def test_the_limit_is_where_stability_first_ends_though_it_returns():
    """An iterated master amplifies two masses where a step holds half a period of the light one. Radii from
    an independent calculation, to their last digit; growth as a run shows it."""
    first = {"mass": 0.3, "stiffness": 100.0, "damping": 0.1, "coupling_stiffness": 200.0}
    system = two_masses(**first, coupling_damping=0.0)
    instances = dict(system.instances)
    heavy = {"mass": 3.0, "stiffness": 20.0, "damping": 1.0}
    instances["second"] = replace(instances["second"], parameters=heavy)
    system, master = system.with_instances(instances), Iterated("linear")
    behaviour = Behaviour(point(system), master)
    for step, radius in ((0.0985, 1.007), (0.18, 1.026), (0.35, 1.289)):
        assert behaviour.evaluate(step).radius == pytest.approx(radius, abs=5e-4)
    seen = []
    limit = find_stability_limit(behaviour, 1e-3, 0.5, seen)
    assert behaviour.evaluate(0.12).stable
    assert limit < 0.0985
    assert all(at.stable for at in seen if at.step <= limit)
    for step in (0.99 * limit, 0.0985):
        count = int(10.0 / abs(np.log(behaviour.evaluate(step).radius)))
        growth = measure_growth(system, build_participants(system), master, step, count)
        assert (growth > 1.0) == (step > limit)


def estimate_errors(system, master, step, stop, watched=(), row=0):
    """Estimated and measured relative RMS error, of the watched or of all exchanged values."""
    where = compute_trajectory(system, 0.5 * step * np.arange(2 * round(stop / step) + 1), 1e-11)
    names = {n: [p.variable for p in watched if p.instance == n] for n in system.instances}
    behaviour = Behaviour(linearise_at(system, where, row, watched), master, Couplings(system, names))
    sources = behaviour.sources
    track = sample_trajectory(where, system, sources)
    found, defect = behaviour.macro_step(step), behaviour.find_defect(step)
    expected = follow_errors(found, defect, track, 2, behaviour.single.nominal).predict()
    run = run_coupled(system, master, step, stop)
    truth = where.outputs[::2, [system.outputs.index(port) for port in sources]]
    seen = [difference(run[str(port)], truth[:, i]).relative_rms for i, port in enumerate(sources)]
    asked = [i for i, port in enumerate(sources) if port in watched or not watched]
    return expected[asked], np.array(seen)[asked]


@pytest.mark.parametrize("kind", [Jacobi, GaussSeidel, Iterated])
@pytest.mark.parametrize("signal", SIGNALS)
def test_estimated_errors_of_the_masses_are_those_of_a_run(kind, signal, record):
    """The masses are linear. A quarter is left to the first steps, which a run repeats and an estimate does
    not know, and to rates that are differences of the trajectory."""
    expected, measured = estimate_errors(two_masses(), kind(signal), 2e-2, 4.0)
    quantity = "error estimated before a run, two masses"
    record("Coupling", quantity, expected, measured, "errors of the run", relative=0.25)


@pytest.fixture(scope="module")
def valve_train():
    scenario = load("valve-train")
    return resolve_start(scenario, build_system(scenario))


# The first lift is over then; the contact is at its stiffest on the way.
LIFT = 45e-3


@pytest.fixture(scope="module")
def lift(valve_train):
    return compute_trajectory(valve_train, np.linspace(0.0, LIFT, 901), 1e-9)


@pytest.mark.parametrize(
    "master", [GaussSeidel("linear"), pytest.param(Jacobi("linear"), marks=pytest.mark.long)], ids=str
)
def test_the_valve_train_runs_below_the_predicted_limit_and_runs_away_beyond(valve_train, lift, master):
    """Observed at 0.8 and 1.25 of the limit. Jacobi's contact ends in bouncing, which the run's guard may
    bear: an error of the load's own size is a runaway too."""
    points = [linearise_at(valve_train, lift, row, []) for row in range(0, 901, 90)]
    _, limit = find_hardest_point(points, master, 1e-6, 1e-4)

    def error(step):
        found = run_coupled(valve_train, master, step, LIFT)
        truth = compute_trajectory(valve_train, found.times, 1e-9).outputs[
            :, valve_train.outputs.names.index("contact.load")
        ]
        return difference(found["contact.load"], truth).relative_rms

    assert error(0.8 * limit) < 1e-2
    try:
        beyond = error(1.25 * limit)
    except UnstableCouplingError:
        beyond = np.inf
    assert beyond > 1.0


@pytest.mark.long
def test_means_of_held_inputs_are_stable_at_longer_steps_than_hold(valve_train, lift, record):
    """All participants hold their inputs, about instants through the lift."""

    def find_limit(signal):
        points = [linearise_at(valve_train, lift, row, []) for row in range(0, 901, 90)]
        for one in points:
            for name, linear in one.linears.items():
                followed = np.zeros((ROWS, linear.B.shape[1]))
                followed[0] = 1.0
                one.linears[name] = replace(linear, followed=followed, _steps={})
        return find_hardest_point(points, GaussSeidel(signal), 1e-6, 1e-4)[1]

    gained = find_limit("linear") / find_limit("hold")
    quantity = "valve train of held inputs, gauss_seidel: stable step with means over that with hold"
    record("Coupling", quantity, gained, 6.03, "first measured", relative=0.01)


@pytest.mark.long
@pytest.mark.parametrize(
    "master",
    [
        GaussSeidel("quadratic"),
        pytest.param(Jacobi("linear"), marks=pytest.mark.long),
        pytest.param(GaussSeidel("hermite"), marks=pytest.mark.long),
        pytest.param(Iterated("hermite"), marks=pytest.mark.long),
    ],
    ids=lambda master: f"{type(master).__name__}-{master.extrapolation}",
)
def test_the_estimated_error_of_the_contact_load_is_that_of_a_run_within_a_factor_of_two(valve_train, master):
    """Linear about one instant of the lift, in place of all. Hermite signals miss most where the film has a
    corner, as entrainment reverses: the rates there have to be those that participants give."""
    watched = [Port("contact", "load")]
    expected, measured = estimate_errors(valve_train, master, 5e-6, LIFT, watched, row=2 * int(35e-3 / 5e-6))
    assert measured[0] / 2.0 < expected[0] < 2.0 * measured[0]


def test_a_linear_participant_moves_as_its_component_does():
    """The masses are linear, so that both agree to the integrator's 1e-10 a step, for cubic inputs too."""
    system = two_masses()
    instance = system.instances["first"]
    inputs = np.array([[0.3, -1.0], [2.0, 0.5], [-8.0, 30.0], [100.0, -50.0]])
    found = []
    at = point(system)
    for unit in (
        in_process("first", replace(instance, start={})),
        LinearParticipant("first", instance, at.linears["first"]),
    ):
        bound, outputs, rates = inputs.copy(), np.zeros(2), np.zeros(2)
        names = ["other_position", "other_velocity"], ["force", "position"]
        unit.connect(BoundVariables(names[0], bound, names[1], outputs, rates))
        unit.initialise(0.0, 1.0)
        for n in range(3):
            unit.write()
            unit.advance(0.1 * n, 0.1)
        unit.read()
        found.append([outputs.copy(), rates.copy()])
    # The position of the first mass is not exchanged: the linear one does not have it.
    np.testing.assert_allclose(np.array(found[1])[:, 0], np.array(found[0])[:, 0], rtol=1e-7)


def test_at_a_kink_the_steeper_side_is_taken_and_named():
    """A valve at its seat: the seat pushes on one side only."""
    component = valve_spring(2)
    instance = Instance(component, {"seat_stiffness": 1e7})
    x, u = component.state.vector(), component.inputs.vector()
    found = linearise(instance, 0.0, x, u, ["position"])
    p = component.parameters.vector(instance.parameters)
    values = dict(zip(component.parameters.names, p, strict=True))
    row, column = component.state.index("velocity"), component.state.index("position")
    stiffness = 8.0 / 3.0 * values["spring_rate"] + 1e7
    assert found.A[row, column] == pytest.approx(-stiffness / values["valve_mass"], rel=1e-6)
    assert "position" in found.kinks
    lifted = linearise(instance, 0.0, component.state.vector({"position": 1e-3}), u, ["position"])
    assert lifted.kinks == ()


def test_the_whole_system_about_a_point_is_the_one_that_the_connections_make():
    """Independent method: differences of the system's own rates."""
    system = two_masses()
    evaluation = Evaluation(system)
    by_differences = np.column_stack(
        [evaluation.derivative(0.0, column).copy() for column in np.eye(system.state.size)]
    )
    np.testing.assert_allclose(point(system).matrix, by_differences, atol=1e-6)


@pytest.mark.parametrize("signal", SIGNALS)
def test_what_a_signal_misses_is_a_polynomial_known_in_closed_form(signal):
    """A signal of degree k is exact up to s^k. What it misses of the next power, amounts of its shapes, is
    that power less its extrapolation; one end value of a shape other than the first is zero."""
    degree, h = SIGNALS.index(signal), 0.1
    times, middles = h * np.arange(6), h * (np.arange(6) + 0.5)
    coefficients = build_shapes(h, degree) / np.cumprod([1.0, *range(1, ROWS)])

    def amounts(power):
        values, rates = times**power, power * times ** max(0, power - 1)
        return compute_extrapolation_error(
            values[:, None], rates[:, None], h, degree, (middles**power)[:, None]
        )

    for power in range(degree + 1):
        np.testing.assert_allclose(amounts(power)[4:], 0.0, atol=1e-14)
    # With the step's start as origin the signal knows nothing but zero of s^4; of lower ones it is a past.
    missed = np.polynomial.Polynomial(amounts(degree + 1)[-1, :, 0] @ coefficients)
    s = h * np.linspace(0.0, 1.0, 5)
    past = times[-2 - degree : -1] if signal != "hermite" else np.repeat(times[-3:-1], 2)
    expected = np.prod([times[-2] + s - known for known in past], axis=0)
    np.testing.assert_allclose(missed(s), expected, atol=1e-14)
    np.testing.assert_allclose(evaluate_ends(h, degree)[0, 0], 1.0)


def test_the_loop_of_the_valve_train_is_contact_and_valve(valve_train, lift):
    """A prescribed flywheel feels no load, so that the drive closes no loop; a free one does."""
    watched = [Port("contact", "load")]
    partition = Partition(valve_train, [linearise_at(valve_train, lift, 600, watched)], watched)
    assert [sorted({c.source.instance for c in loop}) for loop in partition.loops] == [
        ["contact", "valve_spring"]
    ]
    assert partition.participants[:2] == [["flywheel"], ["camshaft"]]
    assert set(partition.stiff) == {"contact", "valve_spring"}
    instances = dict(valve_train.instances)
    instances["flywheel"] = replace(
        instances["flywheel"], parameters={"motion": 0.0, "inertia": 0.1}, start={"speed": 104.7}
    )
    free = valve_train.with_instances(instances)
    where = compute_trajectory(free, np.linspace(0.0, 0.03, 301), 1e-9)
    loops = Partition(free, [linearise_at(free, where, 200, watched)], watched).loops
    assert [len({c.source.instance for c in loop}) for loop in loops] == [4]


def test_growth_of_the_system_itself_is_not_blamed_on_its_coupling():
    """A negative spring to the ground drives the masses off at a rate of its own, which every method follows:
    the radius is above one, and that is not called unstable."""
    system = two_masses()
    at = point(system)
    negative = np.array([[0.0, 0.0], [200.0, 0.0]])
    pushed = replace(at.linears["first"], A=at.linears["first"].A + negative)
    grows = Point(0.0, system, {**at.linears, "first": pushed})
    assert grows.growth == pytest.approx(
        np.linalg.eigvals(at.matrix + np.pad(negative, (0, 2))).real.max(), rel=1e-9
    )
    assert grows.growth > 5.0
    behaviour = Behaviour(grows, GaussSeidel("quadratic"))
    assert compute_spectral_radius(behaviour.macro_step(1e-2).matrix) == pytest.approx(
        np.exp(1e-2 * grows.growth), rel=1e-3
    )
    assert behaviour.evaluate(1e-2).stable


@pytest.mark.parametrize(("step", "written"), [(1.99e-5, 1.5e-5), (2e-5, 2e-5), (9.9e-4, 8e-4), (0.0, 0.0)])
def test_advised_steps_are_round(step, written):
    assert round_down(step) == written
