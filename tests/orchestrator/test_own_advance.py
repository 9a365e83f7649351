"""Components that only their own implicit steps move, in every part of the orchestrator.

They run as FMUs and from checkpoints, count energies, give up steps that do not converge, and are analysed by
their responses. Scenarios do not meet those of their states that are no variables.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fmus.build import build
from models.catalogue import CATALOGUE
from models.core.bonds import counting
from models.core.component import Component
from models.core.system import Instance, ModelError, System
from models.monolithic import solve
from models.oscillators.two_masses import sprung_mass
from orchestrator.analyses.stability.linearisation import open_linearisations
from orchestrator.analyses.stability.survey import survey
from orchestrator.analyses.stability.trajectory import compute_rates, solve_course
from orchestrator.engine.energy import Ledger, add_counting
from orchestrator.engine.step import DISCARD
from orchestrator.engine.substeps import Substepped
from orchestrator.errors import DiscardedStepError
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.run.plan import ParticipantPlan
from orchestrator.scenario import Scenario, ScenarioError, build_scenario
from orchestrator.scenario.checks import list_required_variables
from orchestrator.scenario.schema import describe_component
from orchestrator.scenario.system import build_system, resolve_start
from orchestrator.stepping import ControlledSteps, StepControl
from tests.models.fluid_layer import fluid_layer

from .coupled import Alone, run_coupled
from .studies import refuse_build

PLATE = sprung_mass()
LINES = [("plate.velocity", "layer.velocity"), ("layer.force", "plate.force")]
# A swing of 14 ms, from rest.
SPRING = {"mass": 0.05, "stiffness": 1e4, "damping": 0.0}
START = {"position": 1e-3}


def dragged(sheets: int = 20, changes: dict[str, Any] | None = None, **parameters: float) -> System:
    """A mass on a spring that shears a layer of fluid; `changes` are fields of the layer's component."""
    layer = replace(fluid_layer(sheets), **changes) if changes else fluid_layer(sheets)
    return System({"plate": Instance(PLATE, SPRING, START), "layer": Instance(layer, parameters)}, LINES)


STEP, STOP = 1e-4, 4e-3
ITERATED = Iterated("hermite", 1e-11)


def test_a_coupled_run_comes_to_the_monolithic_one_with_the_order_of_the_components_steps():
    """Two, of the midpoint rule: the reference integrates the same sheets by their derivative."""
    system = dragged(sheets=5)
    times = np.linspace(0.0, STOP, 3)
    exact = solve(system, times)["layer.force"][-1]
    coarse, fine = (
        abs(run_coupled(system, ITERATED, step, STOP)["layer.force"][-1] - exact) for step in (2e-4, 1e-4)
    )
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.1)


@pytest.mark.long
def test_energies_that_a_component_counts_in_its_own_steps_close_to_rounding():
    """The midpoint rule has the balance of a quadratic energy exactly, with powers taken at the middle."""
    system = add_counting(dragged(200), ["layer", "plate"])
    ledger = Ledger(system)
    run_coupled(system, ITERATED, STEP, STOP, ledger)
    layer = ledger.account().components["layer"]
    assert layer.dissipated > 1e-4
    # 40 steps of sums over 200 sheets, to 1e-12 of velocities of 0.1 m/s.
    assert abs(layer.unaccounted) < 40 * 1e-11 * layer.dissipated


def test_a_component_of_unknown_equations_does_not_count():
    with pytest.raises(ValueError, match="fluid_layer"):
        counting(dragged(changes={"opaque": True}).instances["layer"].component)


SOME = 20
# Four iterations converge over 0.2 ms, not over 1 ms as soon as the plate is fast.
STUBBORN = {"iterations": 4.0}
SHORT, LONG = 2e-4, 1e-3
REASON = "the implicit equations of the step did not converge"
REMEDY = r"reduce macro_step, use \[step_control\], or raise components\.layer\.retries"


@pytest.fixture(scope="module")
def some_layer_file(tmp_path_factory):
    return build("tests.models.fluid_layer:fluid_layer", tmp_path_factory.mktemp("layer"), {"sheets": SOME})


@pytest.fixture(params=["in-process", "fmu"])
def layers(request, some_layer_file):
    """With a plate whose speed is given."""
    instance = dragged(SOME, **STUBBORN).instances["layer"]

    def build():
        inside = request.param == "in-process"
        unit = in_process("layer", instance) if inside else open_fmu("layer", some_layer_file, instance)
        return Alone(unit, "velocity", ["force", "wall_force", "impulse"], 0.0)

    made = build(), build()
    yield made
    for one in made:
        one.unit.close()


def test_a_step_that_does_not_converge_is_discarded_and_leaves_the_state_as_it_was(layers):
    """What follows has the bits of a participant that was never asked for it."""
    failing, sound = layers
    for layer in layers:
        layer.advance(0.0, SHORT, 0.1)
    with pytest.raises(
        DiscardedStepError, match=f"^layer: step from t = 0.0002 s by 0.1 s.*{REASON}; .*{REMEDY}"
    ):
        failing.advance(SHORT, 0.1, 1.0)
    for k in range(1, 5):
        assert failing.advance(k * SHORT, SHORT, 0.1) == sound.advance(k * SHORT, SHORT, 0.1)
    assert failing.saved() == sound.saved()


@pytest.mark.parametrize(
    ("master", "estimator"),
    [
        (Jacobi("quadratic"), "step_doubling"),
        (GaussSeidel("linear"), "step_doubling"),
        (Iterated("hermite", 1e-11), "predictor_corrector"),
    ],
    ids=repr,
)
def test_step_control_shortens_steps_that_do_not_converge(master, estimator):
    """To the result that a component without a limit gives, within what the tolerance allows."""
    control = StepControl(estimator, relative=1e-2, absolute=1e-2, maximum_step=LONG)

    def controlled(**parameters):
        return run_coupled(dragged(SOME, **parameters), master, ControlledSteps(LONG, control), STOP)

    stubborn, willing = controlled(**STUBBORN), controlled()
    assert any(step.rejected and step.reason == DISCARD for step in stubborn.steps)
    assert not any(step.reason == DISCARD for step in willing.steps)
    assert stubborn["plate.position"][-1] == pytest.approx(willing["plate.position"][-1], abs=1e-2 * 1e-3)


def test_retries_halve_steps_that_do_not_converge_under_steps_of_one_length():
    system = dragged(SOME, **STUBBORN)
    layer = Substepped(in_process("layer", system.instances["layer"]), halvings=4)
    recorder = run_coupled(system, Iterated("hermite", 1e-11), LONG, STOP, layer=layer)
    assert recorder.ended == (True, "")


@pytest.mark.parametrize("master", [Jacobi("linear"), Iterated("hermite")], ids=repr)
def test_steps_of_one_length_end_with_what_to_do(master):
    with pytest.raises(DiscardedStepError, match=f"layer: step .*{REASON}; {REMEDY}"):
        run_coupled(dragged(SOME, **STUBBORN), master, LONG, STOP)


FEW = 5


def stepped_layer(sheets: int = FEW) -> Component:
    """The layer, as if its sheets had no differential equations."""
    return replace(fluid_layer(sheets), opaque=True)


@pytest.fixture(autouse=True)
def catalogued(monkeypatch):
    monkeypatch.setitem(CATALOGUE, "fluid_layer", fluid_layer)  # type: ignore[arg-type]
    monkeypatch.setitem(CATALOGUE, "stepped_layer", stepped_layer)  # type: ignore[arg-type]


def scenario(layer: str, layer_start: dict[str, float] | None = None, **changes: object) -> Scenario:
    """With these start values of the layer."""
    own = {"participant": "in-process"}
    tables = {
        "name": "dragged",
        "stop_time": 10e-3,
        "macro_step": 4e-4,
        "tolerance": {"plate.position": 1e-3},
        "start": "given",
        "components": {
            "plate": {"component": "sprung_mass", "parameters": SPRING, "start": START, **own},
            "layer": {"component": layer, "structure": {"sheets": FEW}, "start": layer_start or {}, **own},
        },
        "connections": [f"{source} -> {target}" for source, target in LINES],
    }
    return build_scenario(tables | changes)


@pytest.mark.long
def test_the_course_of_a_coupled_system_is_that_of_its_equations():
    """Outputs and rates. The layer's steps of 10 us are of second order: 5e-10 of its force."""
    times, quiet = np.arange(401) * 1e-5, lambda share: None
    equations, steps = dragged(FEW), dragged(FEW, {"opaque": True})
    one, other = solve_course(equations, times, 1e-13, quiet), solve_course(steps, times, 1e-13, quiet)
    assert list(other.states) == ["plate"]
    names = ["plate.position", "plate.velocity", "layer.force"]
    columns = [equations.outputs.names.index(name) for name in names]
    for first, second in (
        (one.outputs, other.outputs),
        (compute_rates(one, equations), compute_rates(other, steps)),
    ):
        size = np.abs(first[:, columns]).max(axis=0)
        assert np.all(np.abs(first - second)[:, columns].max(axis=0) <= 1e-9 * size)


@pytest.mark.long
def test_a_survey_goes_by_the_responses_of_what_has_no_equations():
    """And finds what one by the equations finds: the limit of stability, and the error at the step."""
    found = []
    for layer in ("fluid_layer", "stepped_layer"):
        one = scenario(layer)
        system, ours = build_system(one), dict.fromkeys(one.components, ParticipantPlan())
        with open_linearisations(one, system, ours) as participants:
            assert list(participants) == ["layer"] * (layer == "stepped_layer")
            found.append(survey(one, system, ours, participants).own)
    # Responses are a linear system's to 1e-2 at worst (DOUBTFUL).
    assert found[1].limit == pytest.approx(found[0].limit, rel=1e-2)
    error = [own.errors[4e-4]["plate.position"] for own in found]
    assert error[1] == pytest.approx(error[0], rel=1e-2)


def test_a_reference_that_cannot_be_solved_is_refused_before_anything_is_written(tmp_path):
    out = tmp_path / "out"
    with pytest.raises(
        ModelError, match=r"layer: fluid_layer with sheets = 5 .* \(reference\.enabled = false\)"
    ):
        run(scenario("stepped_layer"), out, refuse_build, Reporter(), figures=False)
    assert not out.exists()


@pytest.mark.parametrize(
    ("state", "said"),
    [
        # Also where it is set to what it starts with: it is not the user's to set.
        ("sheet_velocity[2]", r"layer\.start\.sheet_velocity\[2\]: .*sets this state itself.*leave it out"),
        ("sheet_velocity", "no such state; known: impulse"),
    ],
)
def test_an_internal_state_has_no_start_in_a_scenario_nor_in_its_answers(state, said):
    with pytest.raises(ScenarioError, match=said):
        scenario("fluid_layer", {state: 0.0})


def test_the_schema_knows_no_internal_state_and_the_least_size_of_each_component():
    table = describe_component("fluid_layer")["properties"]
    assert list(table["start"]["properties"]) == ["impulse"]
    assert "patternProperties" not in table["start"]
    assert table["structure"]["properties"]["sheets"]["minimum"] == 0
    spring = describe_component("valve_spring")["properties"]["structure"]["properties"]
    assert spring["coil_masses"]["minimum"] == 1


def test_an_equilibrium_leaves_internal_states_as_they_start():
    """And gives participants start values of the others alone, as only these are variables of an FMU."""
    one = scenario("fluid_layer", start="equilibrium")
    resting = resolve_start(one, build_system(one))
    assert list(resting.instances["layer"].start) == ["impulse"]
    assert "sheet_velocity_start[1]" not in list_required_variables("layer", resting, "equilibrium")
