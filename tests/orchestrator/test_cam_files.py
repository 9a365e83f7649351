"""Files of the trade: what `cam` writes is read back within its rounding; bad files are refused; timing."""

import math
from pathlib import Path

import numpy as np
import pytest

from orchestrator.analyses import load
from orchestrator.analyses._cam_profile import build_profile
from orchestrator.analyses._cam_source import find_lift_settings, find_settings
from orchestrator.analyses._cam_timing import find_timing
from orchestrator.analyses.cam import ANALYSIS
from orchestrator.errors import MistakeError
from orchestrator.scenario.angle_table import AngleTableError
from orchestrator.scenario.cam_files import is_contour
from orchestrator.scenario.lift_table import read_lift_table

INCH = 25.4e-3
CAM = {"law": "modified_trapezoid", "lift": 9e-3, "base_radius": 34e-3, "rise_angle": math.radians(65.0)}
VALUES = ANALYSIS.complete(CAM)
PROFILE = build_profile(VALUES)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("cam")
    for ending, write in ANALYSIS.texts.items():
        (made / f"cam.{ending}").write_text(write(ANALYSIS.table(VALUES), VALUES))
    return made


@pytest.mark.parametrize(
    ("ending", "step"), [("mm.csv", 1e-9), ("in.csv", 1e-8 * INCH), ("s96", 1e-8 * INCH)]
)
def test_lifts_that_are_written_are_read_back_within_half_a_step(
    folder: Path, ending: str, step: float
) -> None:
    found = read_lift_table(folder / f"cam.{ending}")
    expected = [PROFILE.lift(a).s for a in found.angle]
    assert found.rounding == pytest.approx(step)
    assert found.lift == pytest.approx(expected, abs=0.5001 * step)
    assert np.degrees(found.angle) == pytest.approx(np.arange(360.0))


def test_an_s96_file_begins_opposite_to_the_nose_and_repeats_its_first_tenth(folder: Path) -> None:
    lines = (folder / "cam.s96").read_text().splitlines()
    assert "-0.00000000" not in lines
    assert len(lines) == 396
    assert lines[360:] == lines[:36] == ["0.00000000"] * 36
    assert float(max(lines)) == float(lines[180]) == pytest.approx(9.0 / 25.4, abs=1e-8)


def test_a_nose_at_zero_has_the_timing_of_one_at_half_a_turn(folder: Path, tmp_path: Path) -> None:
    """A lift table may have its nose anywhere. Its lifts have 6 decimals of a mm."""
    header, *rows = (folder / "cam.mm.csv").read_text().splitlines()
    assert not any("-" in row for row in rows), "nor is a lift -0"
    lifts = [row.partition(",")[2] for row in [*rows[180:], *rows[:180]]]
    turned = tmp_path / "turned.csv"
    turned.write_text("\n".join([header, *(f"{angle},{lift}" for angle, lift in enumerate(lifts))]))
    profile = build_profile(ANALYSIS.complete({"lift_table": str(turned)}))
    assert math.sin(0.5 * profile.nose) == pytest.approx(0.0, abs=1e-4)
    expected, found = find_timing(PROFILE, VALUES), find_timing(profile, VALUES)
    for name in ("duration_1mm", "opening_1mm", "closing_1mm", "lift_at_centre"):
        assert found[name] == pytest.approx(expected[name], abs=1e-4), name


@pytest.mark.parametrize("follower", ["flat", "roller"])
def test_a_contour_that_is_read_lifts_its_follower_as_before(tmp_path: Path, follower: str) -> None:
    """A spline through radii each half degree is off by less than 0.1 um."""
    values = ANALYSIS.complete(CAM | {"follower": follower})
    file = tmp_path / "bought.csv"
    file.write_text(ANALYSIS.texts["contour.csv"](ANALYSIS.table(values), values))
    found = find_settings(str(file))
    assert found.pop("base_radius") == pytest.approx(CAM["base_radius"], abs=1e-9), "the least radius"
    assert found == {"contour": str(file)}
    (tmp_path / "wide.csv").write_text(file.read_text(), "utf-16")
    assert is_contour(tmp_path / "wide.csv")
    with pytest.raises(
        MistakeError, match="is a contour, whose lift is that of a follower; take the lift table"
    ):
        find_lift_settings(str(file))  # of `clearance` and `spring`, which ask for no follower
    back = build_profile(ANALYSIS.complete(CAM | {"follower": follower, "contour": str(file)}))
    angles = np.radians(np.arange(0.0, 360.0, 3.3))
    assert [back.lift(a).s for a in angles] == pytest.approx([PROFILE.lift(a).s for a in angles], abs=1e-7)
    with pytest.raises(MistakeError, match="base_radius = 30 mm: must be the contour's least radius, 34 mm"):
        load("cam").evaluate(ANALYSIS.complete({"contour": str(file), "base_radius": 30e-3}))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda lines: lines[:360], "has 360 lines; an .s96 file has 396 lifts"),
        (
            lambda lines: [*lines[:9], "1 2", *lines[10:]],
            "line 10, '1 2': must be one lift in inches",
        ),
        (lambda lines: [*lines[:9], "nan", *lines[10:]], "line 10, 'nan': must be one lift in inches"),
        (
            lambda lines: [*lines[:395], "0.3"],
            "line 396, '0.3': must repeat line 36, '0.0+'",
        ),
        (lambda lines: [], "has 0 lines"),
        (lambda lines: ["0.0"] * 396, "its largest lift is 0 mm: must be > 0"),
    ],
)
def test_bad_s96_files_are_refused_with_the_line(folder: Path, tmp_path: Path, change, said: str) -> None:
    lines = (folder / "cam.s96").read_text().splitlines()
    bad = tmp_path / "bad.S96"
    bad.write_text("\n".join(change(lines)))
    with pytest.raises(AngleTableError, match=said):
        read_lift_table(bad)
    with pytest.raises(AngleTableError, match="cannot be read"):
        read_lift_table(tmp_path / "none.s96")


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (["0,30", "90,30", "200,30"], "5 deg apart at most; the widest gap is 160 deg"),
        ([f"{a},{30 - a / 10}" for a in range(0, 360, 5)], "must have radii > 0 all around"),
    ],
)
def test_contours_with_gaps_or_without_radius_are_refused(tmp_path: Path, rows: list[str], said: str) -> None:
    bad = tmp_path / "contour.csv"
    bad.write_text("\n".join(["angle [deg],radius [mm]", *rows]))
    with pytest.raises(MistakeError, match=said):
        load("cam").evaluate(ANALYSIS.complete({"contour": str(bad), "base_radius": 30e-3}))


def test_durations_overlap_and_opening_follow_from_the_lift() -> None:
    found = find_timing(
        PROFILE, VALUES | {"lobe_centre": math.radians(100.0), "lobe_separation": math.radians(70.0)}
    )
    for name, height in (("050", 0.05 * INCH), ("1mm", 1e-3)):
        half = 0.25 * found[f"duration_{name}"]
        assert [PROFILE.lift(math.pi + side * half).s for side in (-1.0, 1.0)] == pytest.approx([height] * 2)
        assert found[f"overlap_{name}"] == pytest.approx(4.0 * half - math.radians(140.0))
    assert found["lobe_middle"] == pytest.approx(math.pi)
    half = 0.5 * found["duration_1mm"]
    assert found["opening_1mm"] == pytest.approx(math.radians(100.0) - half)
    assert found["closing_1mm"] == pytest.approx(math.radians(100.0) + half - math.pi)
    assert found["lift_at_centre"] == pytest.approx(PROFILE.lift(math.pi - math.radians(50.0)).s)
    low = find_timing(build_profile(VALUES | {"lift": 0.9e-3}), VALUES)
    assert math.isnan(low["duration_050"])
    assert math.isnan(low["duration_1mm"])
