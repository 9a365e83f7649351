"""The multibody witness: it stands beside run and reference, agrees, and refuses what it does not know."""

import json
import math

import numpy as np
import pytest

from models.monolithic import solve
from orchestrator.run import comparison as judging
from orchestrator.run.comparison import Side, check_witness, compare_witness
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

from .commands import HERE
from .whole_runs import run_whole

WITNESS = "reference.witness=multibody"
# One revolution, and the widest steps of the reference's comparison.
RUN = [*HERE, WITNESS, "stop_time=1 revolution", "output_step=50 us"]
QUANTITIES = {
    "contact.load": 5e-5,
    "contact.film_thickness": 5e-6,
    "camshaft.drive_torque": 2e-5,
    "valve_spring.position": 1e-7,
    "guide moment": 2e-5,
}


def test_the_witness_agrees_with_reference_and_run(tmp_path, record):
    """Coupling errors stay below 1e-3, the reference's differences from the witness below 5e-5."""
    out = run_whole(tmp_path / "out", RUN)
    witness = json.loads((out / "summary.json").read_text())["witness"]
    assert witness["constraints"] == 26  # K's 21 less the contact, and the rigid shaft's 6
    assert witness["drift"] < 1e-7
    verdict = json.loads((out / "summary.json").read_text())["verdict"]
    assert "the multibody witness agrees" in verdict
    assert "no cycle was seen" not in verdict
    assert list(witness["quantities"]) == list(QUANTITIES)
    for name, tolerance in QUANTITIES.items():
        side = witness["quantities"][name]
        quantity = f"{name}: reference against multibody, relative RMS"
        found = side["reference_difference"]
        record("Multibody", quantity, found, 0.0, "multibody model", tolerance=tolerance)
        coupled = f"{name}: coupled run against multibody, relative RMS"
        record("Multibody", coupled, side["coupled_difference"], 0.0, "multibody model", tolerance=1e-3)
        assert side["multibody"] == pytest.approx(side["reference"], rel=1e-4, abs=1e-12)


@pytest.mark.parametrize(("difference", "agrees"), [(2e-4, True), (5e-2, False), (math.nan, False)])
def test_the_witness_judges_the_reference(difference, agrees):
    """A rocker of twice its inertia differs by 5e-2 in the cam's load."""
    span = (0.0, 1.0)
    sides = {"cam_contact.load": Side(span, span, span, 0.0, difference)}
    witness = judging.WitnessComparison("", 26, 1, 0.0, 0.0, sides)
    assert witness.agrees is agrees
    assert "sees no error in them" in witness.describe_agreement()
    assert ("contradicts" in witness.describe_agreement()) is not agrees
    assert ("cam_contact.load" in witness.describe_agreement()) is not agrees


@pytest.mark.parametrize(("known", "agrees"), [(1e-5, False), (1.5e-2, True), (math.nan, False)])
def test_the_witness_judges_no_finer_than_the_reference_is_known(known, agrees):
    """A valve that bounces over a quarter of its time: the two methods are 1.5e-2 apart, the witness 4e-2."""
    sides = {"contact.load": Side((0.0, 1.0), (0.0, 1.0), (0.0, 1.0), 0.0, 4e-2)}
    witness = judging.WitnessComparison("", 26, 1, 0.0, 0.0, sides, known)
    assert witness.agrees is agrees
    assert ("sensitive" in witness.describe_agreement()) is agrees


@pytest.mark.long
def test_a_run_in_small_steps_agrees_to_a_hundred_thousandth(tmp_path, record):
    out = run_whole(tmp_path / "out", [*RUN, "macro_step=2 us"])
    for name, side in json.loads((out / "summary.json").read_text())["witness"]["quantities"].items():
        quantity = f"{name}: coupled run in steps of 2 us against multibody, relative RMS"
        record("Multibody", quantity, side["coupled_difference"], 0.0, "multibody model", tolerance=1e-5)


# Half a revolution of a pushrod train; a valve that lands on its seat; one lift on an elastic shaft.
TRAINS = {
    "qin2000-train": {
        "cam_contact.load": 5e-5,
        "valve_contact.load": 5e-5,
        "cam_contact.film_thickness": 2e-5,
        "valve_contact.film_thickness": 2e-5,
        "drive torque without friction": 2e-5,
        "tappet.position": 1e-8,
        "valve_spring.position": 1e-7,
    },
    "valve-train": {"contact.load": 2e-4, "valve_spring.position": 1e-6},
    "valve-train-flexible": {
        "contact.load": 2e-5,
        "contact.film_thickness": 1e-6,
        "camshaft.drive_torque": 3e-5,
        "valve_spring.position": 1e-7,
        "guide moment": 1e-5,
    },
}
STOP = {"qin2000-train": 0.03, "valve-train": 0.03, "valve-train-flexible": 0.08}
SEAT = [f"components.valve_spring.parameters.{x}" for x in ("seat_stiffness=2e7", "seat_damping=300")]
CHANGES = {"qin2000-train": [], "valve-train": SEAT, "valve-train-flexible": []}


@pytest.mark.long
@pytest.mark.parametrize("scenario", TRAINS)
def test_the_witness_agrees_with_the_reference(scenario, record):
    """Trains with a pushrod, with a seat on which the closed valve rests, and on a shaft that bends."""
    loaded = load(scenario, [WITNESS, *CHANGES[scenario]])
    system = build_system(loaded)
    check_witness(loaded, system)
    reference = solve(system, np.linspace(0.0, STOP[scenario], 601), 1e-8, x0=system.x0)
    witness = compare_witness(system, reference, {name: reference[name] for name in system.outputs.names})
    for name, tolerance in TRAINS[scenario].items():
        found = witness.quantities[name].reference_difference
        quantity = f"{scenario}, {name}: reference against multibody, relative RMS"
        record("Multibody", quantity, found, 0.0, "multibody model", tolerance=tolerance)


VALVE, DRIVE = "components.valve_spring", "components.flywheel"
RUBBED = [*load("valve-train").connections, "contact.friction_force -> camshaft.friction_force"]
REFUSED = {
    ("finger-follower-hla", "stop_time=1"): "knows systems of flywheel, camshaft.*leave the witness out",
    ("two-masses", "stop_time=1"): "knows systems of flywheel, camshaft",
    ("qin2000-train", "components.rocker.parameters.pivot_damping=1e-3"): (
        "knows no friction of the pivot; set rocker.pivot_damping to 0"
    ),
    ("qin2000-train", "components.tappet.inputs.axis_y=1e-4"): (
        "takes no constant inputs; leave out tappet.axis_y = 0.0001"
    ),
    ("valve-train", "reference.enabled=false"): "beside the reference; set reference.enabled = true",
    ("valve-train", "start=given"): "begins at rest; set start = 'equilibrium'",
    ("valve-train", f"{DRIVE}.parameters.motion=free"): "constant speed; set motion = 'prescribed' without a",
    ("valve-train", f"{VALVE}.parameters.clash_stiffness=5e6"): (
        "knows no clash of coils; set valve_spring.clash_stiffness to 0"
    ),
    ("valve-train", f"connections={RUBBED}"): (
        "knows no friction on the cam; leave out the connection to camshaft.friction_force"
    ),
    ("valve-train", f"{VALVE}.inputs.gas_force=200"): (
        "takes no constant inputs; leave out valve_spring.gas_force = 200"
    ),
}


@pytest.mark.parametrize(("scenario", "change"), REFUSED)
def test_what_the_witness_does_not_know_is_refused(scenario, change):
    loaded = load(scenario, [WITNESS, change])
    with pytest.raises(ScenarioError, match=REFUSED[scenario, change]):
        check_witness(loaded, build_system(loaded))
