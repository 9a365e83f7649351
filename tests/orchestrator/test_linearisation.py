"""Participants linearised by responses or directional derivatives: against equations, and what runs do."""

import csv

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from fmus.native.fmu import build
from fmus.native.machine_code import this_platform
from models.core.difference import difference
from models.core.system import Instance
from models.monolithic.trajectory import compute_trajectory
from orchestrator.analyses.stability.behaviour import Behaviour, find_stability_limit
from orchestrator.analyses.stability.linear import Linear
from orchestrator.analyses.stability.linearisation import Directional, linearise_at, linearise_points
from orchestrator.analyses.stability.responses import Responses, realise, to_continuous
from orchestrator.analyses.stability.trajectory import (
    NotLinearError,
    list_connected_inputs,
    list_continuous_outputs,
)
from orchestrator.engine.signals import DEGREES
from orchestrator.masters import MASTERS, GaussSeidel, Jacobi
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.participants.own_process import Limits
from orchestrator.participants.third_party import read_component
from orchestrator.scenario import MasterTable
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from tribocosim.command_line import app

from ..third_party.c_fmus import fmu as c_fmu
from .coupled import Wrapper, assert_growth_changes_at, run_coupled
from .linearised import (
    SPACING,
    list_outputs,
    load_flexible,
    masses_with_fmu,
    quarter_car,
    solve_trajectory,
    write_masses,
)
from .small_fmus import small_fmu
from .two_masses import two_masses


def linearise_twice(system, name, where, row, spacing, participant=None):
    """A participant by its responses and by its equations."""
    unit = participant or in_process(name, system.instances[name])
    try:
        measured = Responses(name, unit, system, spacing)
        found = measured.about(where, row, list_outputs(system, name))
        return found, linearise_at(system, where, row, []).linears[name], measured
    finally:
        unit.close()


def compute_answers(linear, system, name, step):
    """Outputs after five steps with a pulse in each connected input, in nominal sizes."""
    phi, gamma, _ = linear.step(step)
    state, found = gamma[:, : linear.B.shape[1]], [linear.D]
    for _ in range(5):
        found.append(linear.C @ state)
        state = phi @ state
    fed = [c.target.variable for c in system.connections if c.target.instance == name]
    columns = [system.inputs.layouts[name].index(variable) for variable in fed]
    sizes = system.inputs.layouts[name].nominal / system.outputs.layouts[name].nominal[:, None]
    return (np.array(found) * sizes)[:, :, columns]


def assert_alike(found, expected, system, name, step, tolerance):
    """To `tolerance` of the largest answer of each output, or of all where an output does not answer."""
    one, other = (compute_answers(linear, system, name, step) for linear in (found, expected))
    largest = np.abs(other).max(axis=(0, 2))
    for row, size in enumerate(largest):
        scale = size if size > 1e-12 * largest.max() else largest.max()
        np.testing.assert_allclose(one[:, row] / scale, other[:, row] / scale, atol=tolerance)


@pytest.mark.parametrize(
    ("system", "name", "spacing"),
    [
        (quarter_car(), "wheel", 1e-3),
        (quarter_car(), "chassis", 1e-3),
        (two_masses(), "first", SPACING),
        (two_masses(damping=2.0), "second", SPACING),
    ],
    ids=("wheel", "chassis", "first", "second"),
)
def test_responses_of_a_linear_participant_have_the_poles_of_its_equations(system, name, spacing):
    """The participants are linear; they integrate to 1e-10 of nominal, pulses are a hundredth of it, and 60
    samples are a fraction of the slowest motion: 1e-6 of the fastest pole, 1e-7 of the answers."""
    where = solve_trajectory(system, 0.2, spacing)
    found, expected, measured = linearise_twice(system, name, where, 40, spacing)
    poles, truth = (np.sort_complex(np.linalg.eigvals(linear.A)) for linear in (found, expected))
    np.testing.assert_allclose(poles, truth, atol=1e-6 * np.abs(truth).max())
    for step in (0.3 * spacing, spacing, 8.0 * spacing):
        assert_alike(found, expected, system, name, step, 1e-7)
    assert measured.residual < 1e-8


def average_close(poles):
    """The poles, ascending, with the mean in place of two that are within 1 % of each other.

    Forwards and backwards whirl of the cam differ by 0.7 %: an answer of 0.3 ms cannot tell them apart.
    """
    found = np.sort_complex(poles)
    for i in range(found.size - 1):
        j = min(range(i + 1, found.size), key=lambda k: abs(found[k] - found[i]))
        if abs(found[j] - found[i]) < 0.01 * abs(found[i]):
            found[[i, j]] = 0.5 * (found[i] + found[j])
    return np.sort_complex(found)


# Of the shaft's two whirls a sample tells little more than of one, so that their fit leaves more.
@pytest.mark.long
@pytest.mark.parametrize(("name", "residual"), [("camshaft", 3e-5), ("valve_spring", 1e-6)])
def test_responses_of_the_valve_train_have_the_poles_of_its_equations(name, residual):
    """The flexible camshaft, ten states, and the spring with its coils, six: what their integrators leave
    (1e-13 of nominal) is 1e-7 of the answers to pulses of 5 us; 60 samples are 1/50 of the slowest period."""
    system, where = load_flexible()
    found, expected, measured = linearise_twice(system, name, where, 3000, 5e-6)
    poles, truth = (average_close(np.linalg.eigvals(linear.A)) for linear in (found, expected))
    np.testing.assert_allclose(poles, truth, atol=1e-4 * np.abs(truth).max())
    assert_alike(found, expected, system, name, 5e-6, 1e-7)
    assert_alike(found, expected, system, name, 40e-6, 1e-6)
    assert measured.residual < residual


def open_third_party(system, tmp_path_factory):
    """The second mass by an FMU that knows nothing of this project and holds its force."""
    path = small_fmu("sound", tmp_path_factory.mktemp("fmu"), restorable=True)
    return open_fmu("second", path, system.instances["second"])


@pytest.mark.long
@pytest.mark.parametrize("master", [Jacobi("linear"), GaussSeidel("quadratic")], ids=str)
def test_a_run_of_a_third_party_fmu_grows_beyond_the_limit_predicted_by_its_responses(
    master, tmp_path_factory
):
    """The FMU holds its input, and gets the mean of its signal."""
    system = masses_with_fmu()
    where = solve_trajectory(system, 0.2, SPACING)
    unit = open_third_party(system, tmp_path_factory)
    measured = Responses("second", unit, system, SPACING)
    behaviour = Behaviour(linearise_at(system, where, 20, [], {"second": measured}), master)
    unit.close()
    assert measured.held_inputs == ["force"]
    limit = find_stability_limit(behaviour, 1e-4, 0.5, [])

    def open_participants():
        first = in_process("first", system.instances["first"])
        return {"first": first, "second": open_third_party(system, tmp_path_factory)}

    assert_growth_changes_at(limit, behaviour, system, open_participants)


class Noisy(Wrapper):
    """A participant with noise in its outputs."""

    def connect(self, bound):
        self._outputs, self._noise = bound.outputs, np.random.default_rng(1)
        return self._inner.connect(bound)

    def read(self):
        self._inner.read()
        self._outputs += self._noise.standard_normal(len(self._outputs))


def test_a_participant_that_is_no_linear_system_is_named():
    system = two_masses()
    where = solve_trajectory(system, 0.2, SPACING)
    unit = Noisy(in_process("second", system.instances["second"]))
    measured = {"second": Responses("second", unit, system, SPACING)}
    with pytest.raises(NotLinearError, match="second"):
        linearise_points(system, where, [0, 20], [], measured)


@pytest.mark.parametrize("states", [1, 3, 6])
def test_a_linear_system_is_found_again_from_its_responses(states):
    """Round trip, to rounding times the condition of the responses."""
    lot = np.random.default_rng(states)
    decay = -np.diag(lot.uniform(1.0, 30.0, states))
    turn = lot.standard_normal((states, states))
    A = decay + 5.0 * (turn - turn.T)
    B, C = lot.standard_normal((states, 2)), lot.standard_normal((3, states))
    D = lot.standard_normal((3, 2))
    phi, gamma, _ = Linear(A, B, C, D, np.ones(states)).step(0.02)
    state, pulses = gamma[:, :2], []
    for _ in range(60):
        pulses.append(C @ state)
        state = phi @ state
    pulses[0] = pulses[0] + D
    found = realise(np.array(pulses), D, 0.02, np.ones(2), np.full((3, 2), 1e-14))
    assert found.residual < 1e-6
    poles, truth = (np.sort_complex(np.linalg.eigvals(m)) for m in (found.linear.A, A))
    np.testing.assert_allclose(poles, truth, atol=1e-4 * np.abs(truth).max())


def test_continuous_time_of_a_double_integrator_is_one():
    """A Jordan block: its logarithm is exact."""
    h = 0.1
    A, B = to_continuous(np.array([[1.0, h], [0.0, 1.0]]), np.array([[0.5 * h * h], [h]]), h)
    np.testing.assert_allclose(A, [[0.0, 1.0], [0.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(B, [[0.0], [1.0]], atol=1e-12)


@pytest.mark.long
@pytest.mark.parametrize(
    ("build_fmu", "told"),
    [
        (lambda folder: small_fmu("sound", folder, restorable=True), "restored states: second (residual"),
        (lambda folder: c_fmu("sprung", 3, folder), "By their directional derivatives: second."),
    ],
    ids=["responses", "derivatives"],
)
def test_the_command_tells_how_each_participant_was_linearised(build_fmu, told, tmp_path):
    scenario = write_masses(tmp_path, build_fmu(tmp_path).as_posix())
    shown = CliRunner().invoke(app, ["analyse", scenario, "--out", str(tmp_path / "out")])
    assert shown.exit_code == 0, shown.output
    for line in ("By their equations: first", told, "second holds its inputs force over a step"):
        assert line in " ".join(shown.output.split())


@pytest.mark.long
def test_the_command_prints_and_writes_tables_and_a_figure_and_its_advice_keeps_the_tolerance(tmp_path):
    """What is written reads back. Observed: a run as advised is within the scenario's tolerance."""
    masses, out = write_masses(tmp_path), tmp_path / "out"
    arguments = ["analyse", masses, "--out", str(out), "--at", "0.5 s", "--set", "macro_step=0.02"]
    shown = CliRunner().invoke(app, arguments)
    assert shown.exit_code == 0, shown.output
    assert "Advised: macro_step" in shown.output
    assert "Worth iterating: first, second" in shown.output
    with xarray.open_dataset(out / "stability.nc", engine="h5netcdf") as table:
        # All masters with all signals in the best order, and the scenario's, in another.
        assert table.sizes["method"] == len(MASTERS) * len(DEGREES) + 1
        assert table.of_scenario.sum() == 1
        assert 0.5 in table.point_time
        rows = list(csv.DictReader((out / "stability.csv").read_text().splitlines()))
        limits = [float(row["largest_stable_step [s]"]) for row in rows]
        assert limits == list(table.largest_stable_step.values)
        best = table.isel(method=int(np.argmax(table.advised.values)))
        options = {"name": best.master.item(), "extrapolation": best.extrapolation.item()}
        step, order = best.advised_step.item(), best.order.item().split()
    assert (out / "stability.png").read_bytes().startswith(b"\x89PNG")
    assert "already holds a result" in CliRunner().invoke(app, arguments).output
    scenario = load(masses)
    system = build_system(scenario)
    master = MasterTable(**options, **({"order": order} if order else {})).build()
    found = run_coupled(system, master, step, scenario.stop_time)
    truth = compute_trajectory(system, found.times, 1e-10).outputs[
        :, system.outputs.names.index("first.force")
    ]
    assert difference(found["first.force"], truth).relative_rms <= scenario.tolerance["first.force"]
    assert step > 0.01


@pytest.mark.parametrize(("outputs", "inputs"), [(0, 1), (1, 0), (0, 0)])
def test_what_has_no_response_is_a_system_without_states(outputs: int, inputs: int) -> None:
    """Of an FMU that only gives, or only takes."""
    found = realise(
        np.zeros((6, outputs, inputs)), np.zeros((outputs, inputs)), 0.1, np.ones(inputs),
        np.zeros((outputs, inputs)),
    )  # fmt: skip
    assert found.residual == 0.0
    assert found.linear.A.shape == (0, 0)


def derive_twice(system, name, where, row, path):
    """An FMU by its directional derivatives, and the component by its equations."""
    unit = open_fmu(name, path, system.instances[name])
    try:
        exchanged = [*list_connected_inputs(name, system), *list_continuous_outputs(name, system)]
        assert unit.find_states(exchanged) is not None
        found = Directional(name, unit, system).about(where, row, list_outputs(system, name))
    finally:
        unit.close()
    return found, linearise_at(system, where, row, []).linears[name]


def assert_same_matrices(found, expected, system, name, tolerance):
    """Each matrix, in nominal units, to `tolerance` of its largest element: for the component's states
    without modes, as the FMU has them, and the inputs that are driven."""
    component = system.instances[name].component
    smooth = [i for i, field in enumerate(component.state.fields) if not field.quantity.discrete]
    driven = [component.inputs.index(variable) for variable in list_connected_inputs(name, system)]
    x, u, y = expected.scale[smooth], component.inputs.nominal[driven], component.outputs.nominal[:, None]
    np.testing.assert_array_equal(found.scale, x)
    pairs = [
        (found.A * x / x[:, None], expected.A[np.ix_(smooth, smooth)] * x / x[:, None]),
        (found.B[:, driven] * u / x[:, None], expected.B[np.ix_(smooth, driven)] * u / x[:, None]),
        (found.C * x / y, expected.C[:, smooth] * x / y),
        (found.D[:, driven] * u / y, expected.D[:, driven] * u / y),
    ]
    for one, other in pairs:
        np.testing.assert_allclose(one, other, rtol=0.0, atol=tolerance * np.abs(other).max(initial=0.0))


# What is linear is differenced to 1e-9; over 1e-8 m of approach, a thousandth of the contact's deflection, of
# which the load is a power, 1e-6 is left.
NATIVES = {
    "quarter_car": (2, {"wheel": 1e-8, "chassis": 1e-8}),
    "two_masses": (3, {"first": 1e-8, "second": 1e-8}),
    "camshaft and contact": (2, {"camshaft": 1e-8, "contact": 1e-6}),
    "valve_spring": (3, {"valve_spring": 1e-8}),
}


@pytest.mark.long
@pytest.mark.parametrize("case", NATIVES)
def test_native_fmus_have_the_matrices_of_their_equations(case):
    """To differences of the equations. All derivatives of their inputs are followed."""
    fmi, tolerances = NATIVES[case]
    row, small = 40, {"quarter_car": quarter_car, "two_masses": lambda: two_masses(damping=2.0)}
    if case in small:
        where = solve_trajectory(system := small[case](), 0.2, SPACING)
    else:
        row, (system, where) = 3000, load_flexible()
    for name, tolerance in tolerances.items():
        component = system.instances[name].component
        file = build(component.name, structure=component.structure, platforms=[this_platform()], fmi=fmi)
        found, expected = derive_twice(system, name, where, row, file)
        assert_same_matrices(found, expected, system, name, tolerance)
        fed_to = component.inputs.index(list_connected_inputs(name, system)[0])
        np.testing.assert_array_equal(found.followed[:, fed_to], 1.0)


@pytest.mark.parametrize("version", [2, 3])
def test_a_third_party_fmu_has_the_matrices_of_its_law(version, tmp_path):
    """m a = f - k x - d v: to the rounding of its own differences, of values below 10. It holds its input."""
    system = masses_with_fmu()
    where = solve_trajectory(system, 0.2, SPACING)
    found, _ = derive_twice(system, "second", where, 40, c_fmu("sprung", version, tmp_path))
    np.testing.assert_allclose(found.A, [[0.0, 1.0], [-10.0, -0.5]], atol=1e-13)
    np.testing.assert_allclose(found.B, [[0.0], [1.0]], atol=1e-13)
    np.testing.assert_allclose(found.C, np.eye(2), atol=1e-13)
    np.testing.assert_array_equal(found.D, 0.0)
    np.testing.assert_array_equal(found.followed[:4, 0], [1.0, 0.0, 0.0, 0.0])


def test_an_fmu_in_its_own_process_has_the_same_matrices(tmp_path):
    system, path = masses_with_fmu(), c_fmu("sprung", 3, tmp_path)
    where = solve_trajectory(system, 0.2, SPACING)
    found = []
    for limits in (None, Limits()):
        unit = open_fmu("second", path, system.instances["second"], limits=limits)
        found.append(Directional("second", unit, system).about(where, 40, list_outputs(system, "second")))
        unit.close()
    for here, there in zip(*((one.A, one.B, one.C, one.D, one.followed) for one in found), strict=True):
        np.testing.assert_array_equal(here, there)


@pytest.mark.parametrize("name", ["vanderpol", "feedthrough"])
def test_an_fmu_that_gives_no_derivatives_is_not_linearised_by_them(name, tmp_path):
    path = c_fmu(name, 2, tmp_path)
    unit = open_fmu(name, path, Instance(read_component(path)))
    assert unit.find_states([]) is None
    unit.close()
