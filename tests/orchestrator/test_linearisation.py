"""Participants linearised by their responses: against their equations, and against what runs do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from models.core.system import Instance, System
from models.monolithic.trajectory import course
from models.oscillators.quarter_car import quarter_car_chassis, quarter_car_wheel
from orchestrator.analyses.stability.behaviour import Behaviour, find_stability_limit
from orchestrator.analyses.stability.linear import Linear
from orchestrator.analyses.stability.linearisation import Equations, linearise_at, linearise_points
from orchestrator.analyses.stability.responses import Responses, realise, to_continuous
from orchestrator.analyses.stability.trajectory import NotLinearError
from orchestrator.command_line import app
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.participants import in_process, open_fmu
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start

from .coupled import grown
from .small_fmus import small_fmu
from .two_masses import two_masses

SPACING = 5e-3


def quarter_car():
    return System(
        {"wheel": Instance(quarter_car_wheel()), "chassis": Instance(quarter_car_chassis())},
        [
            ("wheel.position", "chassis.wheel_position"),
            ("wheel.velocity", "chassis.wheel_velocity"),
            ("chassis.position", "wheel.chassis_position"),
            ("chassis.velocity", "wheel.chassis_velocity"),
        ],
    )


def sources(system, name):
    return {c.source.variable for c in system.connections if c.source.instance == name}


def along(system, stop, spacing):
    return course(system, 0.5 * spacing * np.arange(2 * round(stop / spacing) + 1), 1e-10)


def both(system, name, where, row, spacing, participant=None):
    """A participant by its responses and by its equations."""
    unit = participant or in_process(name, system.instances[name])
    try:
        measured = Responses(name, unit, system, spacing)
        return (
            measured.about(where, row, sources(system, name)),
            Equations(system, name).about(where, row, sources(system, name)),
            measured,
        )
    finally:
        unit.close()


def answers(linear, system, name, step):
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
    one, other = (answers(linear, system, name, step) for linear in (found, expected))
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
    where = along(system, 0.2, spacing)
    found, expected, measured = both(system, name, where, 40, spacing)
    poles, truth = (np.sort_complex(np.linalg.eigvals(linear.A)) for linear in (found, expected))
    np.testing.assert_allclose(poles, truth, atol=1e-6 * np.abs(truth).max())
    for step in (0.3 * spacing, spacing, 8.0 * spacing):
        assert_alike(found, expected, system, name, step, 1e-7)
    assert measured.residual < 1e-8


@pytest.fixture(scope="module")
def flexible():
    scenario = load("valve-train-flexible", ["stop_time=0.012"])
    system = resolve_start(scenario, build_system(scenario))
    return system, along(system, 0.01, 5e-6)


@pytest.mark.parametrize("name", ["camshaft", "valve_spring"])
def test_responses_of_the_valve_train_have_the_poles_of_its_equations(flexible, name):
    """The flexible camshaft and the spring with its coils, six states each: what their integrators leave
    (1e-13 of nominal) is 1e-7 of the answers to pulses of 5 us; 60 samples are 1/50 of the slowest period."""
    system, where = flexible
    found, expected, measured = both(system, name, where, 3000, 5e-6)
    poles, truth = (np.sort_complex(np.linalg.eigvals(linear.A)) for linear in (found, expected))
    np.testing.assert_allclose(poles, truth, atol=1e-4 * np.abs(truth).max())
    assert_alike(found, expected, system, name, 5e-6, 1e-7)
    assert_alike(found, expected, system, name, 40e-6, 1e-6)
    assert measured.residual < 1e-6


@pytest.mark.parametrize("master", [Jacobi("linear"), GaussSeidel("hermite"), Iterated("quadratic")], ids=str)
def test_both_ways_of_linearisation_give_one_spectral_radius(master):
    """Eigenvalues agree to the responses' 1e-7 times their condition."""
    system = two_masses()
    where = along(system, 0.2, SPACING)
    made = {n: Responses(n, in_process(n, i), system, SPACING) for n, i in system.instances.items()}
    by_responses = Behaviour(linearise_at(system, where, 20, [], made), master)
    by_equations = Behaviour(linearise_at(system, where, 20, []), master)
    for h in (1e-2, 5e-2, 0.2):
        assert by_responses.evaluate(h).radius == pytest.approx(by_equations.evaluate(h).radius, rel=1e-5)


class HeldInputs:
    """A participant that takes no Taylor coefficients, as an FMU without such inputs."""

    def __init__(self, unit):
        self._unit, self.name, self.restorable = unit, unit.name, True

    def __getattr__(self, name):
        return getattr(self._unit, name)

    def connect(self, bound):
        return self._unit.connect(bound._replace(inputs=bound.inputs[:1]))


def foreign(system, tmp_path_factory):
    """The second mass by an FMU that knows nothing of this project and holds its force."""
    path = small_fmu("sound", tmp_path_factory.mktemp("foreign"), restorable=True)
    return open_fmu("second", path, system.instances["second"])


@pytest.mark.parametrize("master", [Jacobi("linear"), GaussSeidel("quadratic")], ids=str)
def test_a_run_of_a_third_party_fmu_grows_beyond_the_limit_predicted_by_its_responses(
    master, tmp_path_factory
):
    """Observed 4 % to both sides, over steps enough for a factor of exp(10). The FMU holds its input, which
    its responses tell: the limit of the component in its place is another."""
    system = two_masses(coupling_stiffness=400.0)
    parameters = {"mass": 1.0, "stiffness": 10.0, "damping": 0.5}
    instances = dict(system.instances)
    instances["second"] = replace(instances["second"], parameters=parameters)
    system = system.with_instances(instances)
    where = along(system, 0.2, SPACING)
    unit = foreign(system, tmp_path_factory)
    made = {
        "first": Equations(system, "first"),
        "second": (measured := Responses("second", unit, system, SPACING)),
    }
    behaviour = Behaviour(linearise_at(system, where, 20, [], made), master)
    unit.close()
    assert measured.held_inputs == ["force"]
    limit = find_stability_limit(behaviour, 1e-4, 0.5, [])
    component = find_stability_limit(Behaviour(linearise_at(system, where, 20, []), master), 1e-4, 0.5, [])
    assert not 0.9 < limit / component < 1.1
    for share in (0.96, 1.04):
        rate = np.log(behaviour.evaluate(share * limit).radius)
        units = {
            "first": in_process("first", system.instances["first"]),
            "second": foreign(system, tmp_path_factory),
        }
        factor = grown(system, units, master, share * limit, int(10.0 / abs(rate)))
        units["second"].close()
        assert (factor > 1.0) == (share > 1.0)


class Noisy(HeldInputs):
    """Its outputs are drawn by lot."""

    def read(self):
        self._unit.read()
        self._outputs += self._lot.standard_normal(len(self._outputs))

    def connect(self, bound):
        self._outputs, self._lot = bound.outputs, np.random.default_rng(1)
        return super().connect(bound)


def test_a_participant_that_is_no_linear_system_is_named():
    system = two_masses()
    where = along(system, 0.2, SPACING)
    unit = Noisy(in_process("second", system.instances["second"]))
    made = {"first": Equations(system, "first"), "second": Responses("second", unit, system, SPACING)}
    with pytest.raises(NotLinearError, match=r"second: its responses .*residual .*'in-process'"):
        linearise_points(system, where, [0, 20], [], made)


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


SCENARIO = """
stop_time = "1 s"
macro_step = "5 ms"
start = "given"
connections = [
    "first.force -> second.force",
    "second.position -> first.other_position",
    "second.velocity -> first.other_velocity",
]

[tolerance]
"first.force" = 1e-2

[components.first]
component = "coupled_mass"
participant = "in-process"
start = {{ position = 1.0 }}

[components.second]
component = "sprung_mass"
participant = "{path}"
"""


def command(tmp_path, path):
    scenario = tmp_path / "masses.toml"
    scenario.write_text(SCENARIO.format(path=path.as_posix()), "utf-8")
    return CliRunner().invoke(app, ["analyse", str(scenario), "--out", str(tmp_path / "out")])


def test_the_command_tells_how_each_participant_was_linearised(tmp_path):
    shown = command(tmp_path, small_fmu("sound", tmp_path, restorable=True))
    assert shown.exit_code == 0, shown.output
    output = " ".join(shown.output.split())
    assert "By their equations: first" in output
    assert "saved and restored states: second (residual" in output
    assert "second holds its inputs force over a step" in output


def test_an_fmu_that_cannot_save_its_state_is_named_with_a_remedy(tmp_path):
    shown = command(tmp_path, small_fmu("sound", tmp_path))
    assert shown.exit_code == 2
    output = " ".join(shown.output.split())
    assert "components.second.participant" in output
    assert "canGetAndSetFMUstate = false" in output
    assert "components.second.participant='in-process'" in output
    assert not (tmp_path / "out").exists()
