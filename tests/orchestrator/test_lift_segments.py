"""Cams by segments of their acceleration."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.valve_train.cams.segments import join_sides, scale_rise
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load

from .commands import called

SIDE = '[["0 deg", 0], ["12 deg", 1], ["24 deg", 1], ["34 deg", -0.3], ["65 deg", -0.4]]'


def test_a_rise_of_constant_accelerations_is_that_of_its_closed_form(record) -> None:
    """Up to half the angle s = 2 S x^2: accelerations that jump, as far as steep segments are jumps."""
    steep, lift = 1e-7, 9e-3
    angle = np.array([0.0, steep, 0.5 - steep, 0.5 + steep, 1.0 - steep, 1.0])
    rise = scale_rise(angle, np.array([0.0, 5.0, 5.0, -2.0, -2.0, 0.0]), lift)
    middle = np.interp(0.5, rise.angle, rise.lift)
    quantity = "rise by two constant accelerations: lift at the middle (mm)"
    record("Cam", quantity, 1e3 * middle, 4.5, "S/2", tolerance=1e-5)
    quantity = "the same: largest s'' (mm/rad2)"
    record("Cam", quantity, 1e3 * rise.curvature.max(), 36.0, "4 S/B^2", tolerance=1e-4)


@given(
    up=st.lists(st.floats(0.1, 5.0), min_size=1, max_size=4),
    down=st.lists(st.floats(0.1, 5.0), min_size=1, max_size=4),
    turns=st.lists(st.floats(0.05, 0.3), min_size=8, max_size=8),
)
def test_a_rise_ends_at_rest_with_its_lift(up: list[float], down: list[float], turns: list[float]) -> None:
    """Any accelerations above zero, then any below; and it never falls."""
    acceleration = np.array([0.0, *up, *(-a for a in down)])
    angle = np.append(0.0, np.cumsum(turns))[: acceleration.size]
    rise = scale_rise(angle, acceleration, 8e-3)
    assert rise.lift[-1] == pytest.approx(8e-3, rel=1e-12)
    assert abs(rise.slope[-1]) < 1e-12
    assert (np.diff(rise.lift) > -1e-15).all()
    np.testing.assert_array_equal(np.sign(rise.curvature[np.isin(rise.angle, angle)]), np.sign(acceleration))


def test_a_fall_that_is_the_rise_is_its_mirror_image() -> None:
    rise = scale_rise(np.array([0.0, 0.2, 0.5, 1.0]), np.array([0.0, 1.0, -0.5, 0.0]), 8e-3)
    points = join_sides(rise, rise, math.pi, 0.1)
    np.testing.assert_allclose(points.angle + points.angle[::-1], 2.0 * math.pi, rtol=1e-14)
    np.testing.assert_array_equal(points.lift, points.lift[::-1])
    np.testing.assert_array_equal(points.slope, -points.slope[::-1])


def write(folder: Path, segments: str) -> Path:
    file = folder / "own.toml"
    cam = f"[components.camshaft]\nlift_segments = {{ {segments} }}\nparameters.base_radius = '26 mm'\n"
    file.write_text(f'extends = "valve-train"\nstop_time = "60 ms"\n{cam}')
    return file


@pytest.mark.long
def test_a_run_follows_the_segments(tmp_path: Path) -> None:
    file = write(tmp_path, f'lift = "9 mm", rise = {SIDE}')
    done = called("run", str(file), "--no-figures", "--native", "--out", str(tmp_path / "out"))
    assert done.returncode == 0, done.stdout + done.stderr
    resolved = load(str(tmp_path / "out" / "scenario.toml")).components["camshaft"]
    assert resolved.structure["table_points"] == 11  # two crossings, one nose


@pytest.mark.parametrize(
    ("segments", "message"),
    [
        (f"rise = {SIDE}", "lift"),
        ('lift = "9 mm", rise = [["0 deg", 1], ["12 deg", 1], ["24 deg", -1]]', "must begin with"),
        ('lift = "9 mm", rise = [["0 deg", 0], ["12 deg", 1], ["24 deg", 1]]', "one sign only"),
        ('lift = "9 mm", rise = [["0 deg", 0], ["12 deg", -1], ["24 deg", 1]]', "below zero"),
        (f'lift = "9 mm", dwell = "4 deg", rise = {SIDE}', "jumps at the nose"),
        (f'lift = "9 mm", rise = {SIDE}, fall = [["0 deg", 0], ["150 deg", 1], ["320 deg", -1]]', "nose|360"),
    ],
)
def test_segments_that_are_no_cam_are_named(tmp_path: Path, segments: str, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        load(str(write(tmp_path, segments)))
