"""The multibody witness: it stands beside run and reference, agrees, and refuses what it does not know."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from orchestrator.run.witness import check_witness
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

from .whole_runs import IN_PROCESS, run_whole

WITNESS = "reference.witness=multibody"
# One revolution, and the widest steps of the reference's comparison.
RUN = [*IN_PROCESS, WITNESS, "stop_time=1 revolution", "output_step=50 us"]
QUANTITIES = {
    "contact.load": 5e-5,
    "contact.film_thickness": 5e-6,
    "camshaft.drive_torque": 2e-5,
    "valve_spring.position": 1e-7,
    "guide moment": 2e-5,
}


def test_the_witness_agrees_with_reference_and_run(tmp_path: Path, record: Callable[..., None]) -> None:
    """Coupling errors stay below 1e-3, the reference's differences from the witness below 5e-5."""
    out = run_whole(tmp_path / "out", RUN)
    witness = json.loads((out / "summary.json").read_text())["witness"]
    assert witness["constraints"] == 26  # K's 21 less the contact, and the rigid shaft's 6
    assert witness["drift"] < 1e-7
    assert list(witness["quantities"]) == list(QUANTITIES)
    for name, tolerance in QUANTITIES.items():
        side = witness["quantities"][name]
        quantity = f"{name}: reference against multibody, relative RMS"
        record(
            "Multibody", quantity, side["reference_difference"], 0.0, "multibody model", tolerance=tolerance
        )
        assert side["coupled_difference"] < 1e-3
        assert side["multibody"] == pytest.approx(side["reference"], rel=1e-4, abs=1e-12)


@pytest.mark.parametrize(
    ("scenario", "change", "message"),
    [
        ("pushrod-train", [], "knows one flywheel, one camshaft.*leave the witness out"),
        (
            "valve-train",
            ["reference.enabled=false"],
            "stands beside the reference; set reference.enabled = true",
        ),
        ("valve-train", ["start=given"], "begins at rest; set start = 'equilibrium'"),
        (
            "valve-train",
            ["components.flywheel.parameters.motion=free"],
            "constant speed; set motion = 'prescribed' without a ramp",
        ),
        (
            "valve-train",
            ["components.valve_spring.parameters.seat_stiffness=2e7"],
            "knows no seat; set valve_spring.seat_stiffness to 0",
        ),
        (
            "valve-train",
            ["connections=append"],
            "knows no friction on the cam; leave out the connection to camshaft.friction_force",
        ),
    ],
)
def test_what_the_witness_does_not_know_is_refused(scenario: str, change: list[str], message: str) -> None:
    changes = [text for text in change if text != "connections=append"]
    loaded = load(scenario, [WITNESS, *changes])
    if "connections=append" in change:
        more = [*loaded.connections, "contact.friction_force -> camshaft.friction_force"]
        loaded = loaded.model_copy(update={"connections": more})
    with pytest.raises(ScenarioError, match=message):
        check_witness(loaded, build_system(loaded))
