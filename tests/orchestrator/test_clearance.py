"""The command `clearance` and what a motion says of it: closed form at top dead centre, phases, figures."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.system import Instance, System
from orchestrator.analyses._cam_profile import build_profile
from orchestrator.analyses._evaluate import compute_table
from orchestrator.analyses.clearance import ANALYSIS
from orchestrator.assessment.figures_of_merit import measure
from orchestrator.assessment.motion import Motion

from .commands import called

CAM = {
    "law": "modified_trapezoid",
    "lift": 9e-3,
    "rise_angle": math.radians(62.0),
    "fall_angle": math.radians(62.0),
}
DEGREE = math.radians(1.0)


def compute(**values):
    return compute_table(ANALYSIS, ANALYSIS.complete(CAM | values))


def test_at_top_dead_centre_the_cam_leaves_what_its_lift_takes():
    """The nose comes lobe_centre/2 of the cam later."""
    table = compute(lobe_centre=100.0 * DEGREE, valve_ratio=1.5, lash=0.2e-3)
    profile = build_profile(ANALYSIS.complete(CAM))
    lift = 1.5 * profile.lift(math.pi - 50.0 * DEGREE).s - 0.2e-3
    assert table["lift_at_centre"].item() == pytest.approx(lift, rel=1e-9)
    assert table["clearance_at_centre"].item() == pytest.approx(4e-3 + 1e-3 * math.cos(20.0 * DEGREE) - lift)
    assert table["least_clearance"].item() <= table["clearance_at_centre"].item()


def test_an_advanced_intake_and_a_retarded_exhaust_come_closer():
    """A cam with a symmetrical lift has the mirrored clearance as an exhaust cam."""
    intake = compute(lobe_centre=110.0 * DEGREE, advance=10.0 * DEGREE, timing_spread=2.0 * DEGREE)
    exhaust = compute(lobe_centre=-110.0 * DEGREE, retard=10.0 * DEGREE, timing_spread=2.0 * DEGREE)
    assert intake["worst_phase"].item() == pytest.approx(-12.0 * DEGREE)
    assert exhaust["worst_phase"].item() == pytest.approx(12.0 * DEGREE)
    assert exhaust["clearance"].values[::-1] == pytest.approx(intake["clearance"].values, abs=1e-9)
    advanced = compute(lobe_centre=98.0 * DEGREE)
    assert intake["least_over_phases"].item() == pytest.approx(advanced["least_clearance"].item())


def test_the_command_says_where_a_shipped_cam_comes_closest(tmp_path: Path):
    sets = ("--set", "advance=80 deg", "--set", "pocket_depth=0 mm")
    done = called("clearance", "coil-clash", "--json", *sets, "--out", str(tmp_path))
    found = json.loads(done.stdout)
    assert "the valve meets the piston: least clearance -" in done.stderr
    assert done.returncode == 0
    assert found["least_over_phases"] < found["least_clearance"] < found["clearance_at_centre"]
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "clearance.csv",
        "clearance.nc",
        "clearance.png",
    ]


def test_a_motion_has_the_least_clearance_with_its_crank_angle_and_that_of_the_pocket():
    own = {"angle_ratio": 2.0, "top_angle": 1.0, "pocket_depth": 3e-3}
    system = System({"watch": Instance(CATALOGUE["piston_clearance"](), own)}, [])
    columns = {
        "watch.clearance": 1e-3 * np.array([9.0, 2.0, 0.5, 2.5]),
        "watch.radial_clearance": 1e-3 * np.array([-5.0, 1.0, 2.0, 0.9]),
        "watch.angle": 1.0 + 2.0 * math.pi + np.array([-0.3, -0.1, 0.05, 0.2]),
    }
    motion = Motion(system, np.arange(4.0), lambda name: columns[name], None)
    found = {name: value.value for _, name, _, value in measure(motion)}
    assert found["least_clearance"] == 0.5e-3
    assert found["least_clearance_angle"] == pytest.approx(0.1)
    assert found["least_radial_clearance"] == pytest.approx(0.9e-3)
