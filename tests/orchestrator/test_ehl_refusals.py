"""A contact with a solved film in runs, as FMU, and where inputs make no sense; the engine's walls."""

import numpy as np
import pytest

from fmus.build import build
from models.contact.ehl_line_contact import ehl_line_contact
from models.core.difference import difference
from models.core.remedies import Set
from models.core.system import Instance, ModelError
from models.monolithic import solve
from orchestrator.analyses.stability.linearisation import open_linearisations
from orchestrator.engine.substeps import Substepped
from orchestrator.errors import DiscardedStepError
from orchestrator.masters import GaussSeidel, Iterated
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.run.plan import ParticipantPlan
from orchestrator.run.simulation import simulate
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.capabilities import MONOLITHIC, REFINEMENT, choose_reference
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start
from orchestrator.store.json_codec import from_text

from .coupled import Alone, Recorder, build_participants, run_coupled
from .test_checkpoint import Kept

NODES, STEP, RADIUS = 101, 1e-5, 0.01
# The radius of curvature falls through zero after 0.1 ms.
FALLING = f"""
description = "A contact whose radius falls through zero"
stop_time = "0.3 ms"
macro_step = "10 us"
connections = ["mass.position -> contact.radius_of_curvature"]

[tolerance]
"contact.load" = 1e-3

[master]
name = "gauss_seidel"
extrapolation = "linear"

[components.mass]
component = "falling_mass"
start = {{ position = "1 mm", velocity = -10.0 }}

[components.contact]
component = "ehl_line_contact"
structure = {{ nodes = {NODES} }}
inputs = {{ approach = "-0.5 um", entraining_velocity = 1.0 }}
"""


@pytest.fixture(scope="module")
def falling(tmp_path_factory):
    file = tmp_path_factory.mktemp("falling") / "falling.toml"
    file.write_text(FALLING, "utf-8")
    return build_system(load(str(file)))


def contact(halvings: int) -> Alone:
    """Of a radius that is given."""
    instance = Instance(ehl_line_contact(nodes=NODES), inputs={"approach": 2e-6, "entraining_velocity": 1.0})
    unit = in_process("contact", instance)
    if halvings:
        unit = Substepped(unit, halvings=halvings)
    outputs = ["load", "minimum_film_thickness"]
    return Alone(unit, "radius_of_curvature", outputs, RADIUS)


@pytest.mark.long
def test_a_step_that_no_cut_can_save_is_made_as_far_as_it_goes_and_leaves_no_trace():
    """The radius falls through zero at a third of the step: its first quarter is made, and told. When the
    master took it back, what follows has the bits of a contact that was never asked, with retries or not."""
    asked, spared, plain = contact(2), contact(2), contact(0)
    for one in (asked, spared, plain):
        for k in range(3):
            one.advance(k * STEP, STEP, RADIUS)
    before = asked.unit.save()
    fault = r"radius_of_curvature = -.* m \(reduced radius R of the contact\): must be > 0"
    with pytest.raises(DiscardedStepError, match=fault) as caught:
        asked.advance(3.0 * STEP, STEP, RADIUS, -3.0 * RADIUS / STEP)
    assert caught.value.reached == pytest.approx(3.25 * STEP, rel=1e-12)
    asked.unit.restore(before)
    asked.unit.release(before)
    for k in range(3, 6):
        found = asked.advance(k * STEP, STEP, RADIUS)
        assert found == spared.advance(k * STEP, STEP, RADIUS)
        assert found == plain.advance(k * STEP, STEP, RADIUS)
    assert asked.saved() == spared.saved()
    for one in (asked, spared, plain):
        one.unit.close()


@pytest.mark.long
def test_a_run_ends_where_the_radius_vanishes_and_keeps_what_was_before(falling):
    found = Recorder()
    with pytest.raises(DiscardedStepError, match=r"contact: step from .*radius_of_curvature = -"):
        simulate(falling, build_participants(falling), GaussSeidel("linear"), STEP, 3e-4, [found])
    # It falls by 0.1 mm a step.
    assert -1e-12 < found["mass.position"][-1] < 1.01e-4
    loads, films = found["contact.load"], found["contact.minimum_film_thickness"]
    assert np.all(np.isfinite(loads))
    assert np.all(loads >= 0.0)
    assert np.all(films > 0.0)


def test_the_coupling_of_a_field_is_not_analysed():
    """Said at once, with what can be."""
    scenario = load("valve-train-ehl", ["components.contact.structure.nodes=51"])
    ours = dict.fromkeys(scenario.components, ParticipantPlan())
    with (
        pytest.raises(ScenarioError, match=r"components\.contact: .*ehl_contact") as refused,
        open_linearisations(scenario, build_system(scenario), ours),
    ):
        pass
    assert refused.value.actions == (Set("components.contact.component", "ehl_contact"),)
    formula = load("valve-train-ehl", ["components.contact.component=ehl_contact"])
    with open_linearisations(formula, build_system(formula), ours) as made:
        assert made == {}


@pytest.mark.parametrize(
    ("setting", "fault"),
    [
        ("parameters.roughness=0.2", r"roughness.*0\.2 m \(composite rms roughness.*<= 2\.2e-05"),
        ("parameters.field_tolerance=1e-12", r"field_tolerance.*1e-12 \(error of.*>= 1e-09 and <= 0\.1"),
        ("structure.nodes=100001", r"nodes = 100001: must be <= 4801 .*80 GB.*take 301"),
    ],
)
def test_slips_of_the_unit_and_sizes_beyond_reason_are_refused_with_the_range(setting, fault):
    with pytest.raises((ScenarioError, ModelError), match=fault):
        build_system(load("valve-train-ehl", [f"components.contact.{setting}"]))


@pytest.mark.parametrize(
    "setting", ["roughness=20 um", "viscosity=13", "length=1000 mm", "field_tolerance=1e-9"]
)
def test_extremes_that_exist_are_allowed(setting):
    """The roughest surfaces, the thickest oil, the longest roller, the least tolerance."""
    name = setting.split("=")[0]
    system = build_system(load("valve-train-ehl", [f"components.contact.parameters.{setting}"]))
    assert name in system.instances["contact"].parameters


@pytest.mark.plain
@pytest.mark.parametrize("roughness", [0.2e-6, 20e-6])
def test_the_film_ratio_before_the_first_step_is_that_of_the_film_shown(roughness):
    component = ehl_line_contact(nodes=51)
    p = component.parameters.vector({"roughness": roughness})
    u = component.inputs.vector({"approach": 2e-6, "entraining_velocity": 1.0})
    y = np.zeros(component.outputs.size)
    component.flat_output(0.0, component.state.start.copy(), u, p, y)
    shown = component.outputs.named(y)
    assert shown["film_ratio"] == shown["film_thickness"] / roughness > 0.0


@pytest.mark.long
def test_the_engines_walls_run_with_solved_films():
    """Sliding on the upper wall: its film under the wall's force; the lower one shows no load over a film of
    the least load; both within the clearance; half the step gives the same films."""
    scenario = load("engine-ehl")
    system = resolve_start(scenario, build_system(scenario))
    fine, coarse = (run_coupled(system, GaussSeidel("quadratic"), step, 2e-4) for step in (1e-6, 2e-6))
    floor = system.instances["lower_wall"].parameters["film_load_floor"]
    assert floor == 50.0
    for wall in ("upper_wall", "lower_wall"):
        film = coarse[f"{wall}.film_thickness"][1:]
        assert np.all(film > 0.0)
        assert np.all(film < 1e-4)
        # Measured up to 2.6e-3: films grow fast from starts that asperities press on.
        assert film[-1] == pytest.approx(fine[f"{wall}.film_thickness"][-1], rel=5e-3)
        force = coarse[f"slider_crank.{wall}_force"][1:]
        assert coarse[f"{wall}.load"][2:] == pytest.approx(force[1:], rel=1e-2)
    assert coarse["slider_crank.upper_wall_force"][-1] > floor
    assert coarse["slider_crank.lower_wall_force"][-1] == 0.0


STOP = 2e-4
ITERATED = Iterated("hermite", 1e-9)


@pytest.fixture(scope="module")
def valve_train():
    scenario = load("valve-train-ehl")
    return resolve_start(scenario, build_system(scenario))


@pytest.mark.long
def test_a_coupled_run_comes_to_the_monolithic_one():
    """Whose own uncertainty is far smaller; halved steps leave about a quarter of the error (measured 0.25:
    explicit signals, and a field whose own steps are of order 2)."""
    scenario = load("valve-train-ehl", ["components.contact.structure.nodes=51"])
    system = resolve_start(scenario, build_system(scenario))
    records = np.linspace(0.0, 4e-4, 21)
    truth = solve(system, records)
    runs = {step: run_coupled(system, GaussSeidel("quadratic"), step, 4e-4) for step in (1e-5, 5e-6)}
    for name in ("contact.load", "contact.minimum_film_thickness"):
        coarse, fine = (
            difference(run[name][:: round(2e-5 / step)], truth[name]).rms for step, run in runs.items()
        )
        assert truth.uncertainty[name].rms < fine / 3.0
        assert fine < coarse / 3.0


@pytest.mark.long
def test_a_run_with_the_field_goes_on_from_a_checkpoint_to_the_last_bit(valve_train):
    """Under a master that rolls it back several times in each step."""
    kept = run_coupled(valve_train, ITERATED, STEP, STOP, recorder=Kept())
    middle = len(kept.states) // 2
    rest = run_coupled(valve_train, ITERATED, STEP, STOP, resumed=from_text(kept.states[middle]))
    np.testing.assert_array_equal(rest.rows, kept.rows[middle + 1 :])
    assert sum(kept.iterations) > 2 * len(kept.steps)


@pytest.mark.long
@pytest.mark.parametrize("master", [GaussSeidel("linear"), ITERATED], ids=repr)
def test_the_fmu_of_the_field_runs_as_the_component_to_the_last_bit(master, valve_train, tmp_path):
    instance = valve_train.instances["contact"]
    file = build("ehl_line_contact", tmp_path, instance.component.structure)
    found = run_coupled(valve_train, master, STEP, STOP, contact=open_fmu("contact", file, instance))
    np.testing.assert_array_equal(found.rows, run_coupled(valve_train, master, STEP, STOP).rows)


def test_the_reference_of_a_film_with_temperatures_is_by_refinement():
    heated = "components.contact.structure.layers=8"
    assert choose_reference(load("valve-train-ehl", [heated])) == REFINEMENT
    assert choose_reference(load("valve-train-ehl")) == MONOLITHIC
    message = r"contact: a film with temperatures.*set reference\.method = 'refinement'"
    with pytest.raises(ScenarioError, match=message):
        choose_reference(load("valve-train-ehl", [heated, "reference.method=monolithic"]))
