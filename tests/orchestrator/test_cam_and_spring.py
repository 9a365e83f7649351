"""Commands `cam`, `clearance` and `spring`: files of the trade, closed forms, orders, what is refused."""

import cmath
import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.system import Instance, System
from orchestrator.analyses import load
from orchestrator.analyses._cam_profile import build_profile
from orchestrator.analyses._cam_source import (
    find_lift_settings,
    find_settings,
    find_spring_settings,
    find_valve_settings,
)
from orchestrator.analyses._cam_timing import find_timing
from orchestrator.analyses._evaluate import compute_table
from orchestrator.analyses.cam import ANALYSIS
from orchestrator.analyses.clearance import ANALYSIS as CLEARANCE
from orchestrator.analyses.spring import ANALYSIS as SPRING
from orchestrator.analyses.spring import find_orders, write_orders
from orchestrator.assessment.figures_of_merit import measure
from orchestrator.assessment.motion import Motion
from orchestrator.assessment.trains import find_train
from orchestrator.errors import MistakeError
from orchestrator.scenario.angle_table import AngleTableError
from orchestrator.scenario.cam_files import is_contour
from orchestrator.scenario.files import load as load_scenario
from orchestrator.scenario.lift_table import read_lift_table
from orchestrator.scenario.system import build_system

from .commands import called

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


@pytest.mark.parametrize(("follower", "points"), [("flat", 720), ("roller", 720), ("flat", 120)])
def test_a_contour_that_is_read_lifts_its_follower_as_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, follower: str, points: int
) -> None:
    """A spline through radii each half degree is off by less than 0.1 um. Points of a table that are too far
    apart to be read have others between them in the file."""
    monkeypatch.setattr("orchestrator.analyses.cam.POINTS", points)
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
        (lambda lines: [*lines[:9], "1 2", *lines[10:]], "line 10, '1 2': must be one lift in inches"),
        (lambda lines: [*lines[:9], "nan", *lines[10:]], "line 10, 'nan': must be one lift in inches"),
        (lambda lines: [*lines[:395], "0.3"], "line 396, '0.3': must repeat line 36, '0.0+'"),
        (lambda lines: [], "has 0 lines"),
        (lambda lines: ["0.0"] * 396, "its lifts are from 0 to 0 mm"),
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


LOBE = {"law": "modified_trapezoid", "lift": 9e-3} | dict.fromkeys(
    ("rise_angle", "fall_angle"), math.radians(62.0)
)
DEGREE = math.radians(1.0)


def compute(**values):
    return compute_table(CLEARANCE, CLEARANCE.complete(LOBE | values))


def test_at_top_dead_centre_the_cam_leaves_what_its_lift_takes():
    """The nose comes lobe_centre/2 of the cam later."""
    table = compute(lobe_centre=100.0 * DEGREE, valve_ratio=1.5, lash=0.2e-3)
    profile = build_profile(CLEARANCE.complete(LOBE))
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


def test_a_scenario_gives_its_lash_and_the_ratio_of_its_rocker():
    """Arms of 32 mm and 40 mm turn by the same angle; a finger's lift is its valve's. A cam has neither. On
    an elastic stem the retainer has the lash."""
    assert find_valve_settings("valve-stem") == {"lash": 0.2e-3, "valve_ratio": 1.0}
    finger = find_valve_settings("finger-follower")
    assert finger == pytest.approx({"lash": 0.1e-3, "valve_ratio": 1.0})
    rocker = find_valve_settings("pushrod-train")
    train = find_train(build_system(load_scenario("pushrod-train")), "tappet")
    assert train.find_cam_lash(rocker["valve_ratio"] * train.largest_lift) == pytest.approx(
        train.largest_lift
    )
    assert rocker["valve_ratio"] == pytest.approx(1.25, rel=0.02)
    assert find_valve_settings("cycloidal") == {}


def test_the_command_says_where_a_shipped_cam_comes_closest(tmp_path: Path):
    sets = ("--set", "advance=80 deg", "--set", "pocket_depth=0 mm")
    done = called("clearance", "finger-follower", "--json", *sets, "--out", str(tmp_path))
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


RATE = 77.2e9 * 4e-3**4 / (8.0 * 26e-3**3 * 5.5)


def test_orders_of_harmonic_lifts_are_their_amplitudes():
    angle = np.arange(4096) * 2.0 * math.pi / 4096
    found = find_orders(4e-3 * (1.0 - np.cos(angle)) + 0.3e-3 * np.sin(7.0 * angle + 0.4))
    expected = np.zeros(40)
    expected[[0, 6]] = 4e-3, 0.3e-3
    assert found == pytest.approx(expected, abs=1e-15)  # rounding


@pytest.mark.parametrize("ratio", [0.005, 0.02])
def test_an_order_at_resonance_excites_the_force_of_a_damped_rod(ratio):
    """K = k' q cot q of a rod, k' = k (1 + 2i zeta w/w0), q = pi w/w0 sqrt(k/k'): at w0 its size is k/zeta.

    What is beyond the first mode is of the order of zeta.
    """
    table = compute_table(SPRING, SPRING.complete({"damping_ratio": ratio}))
    complex_rate = RATE * (1.0 + 2.0j * ratio)
    q = math.pi * cmath.sqrt(RATE / complex_rate)
    surge = abs(complex_rate * q / cmath.tan(q)) * table["lift_amplitude"].values
    assert table["surge_by_order"].values == pytest.approx(surge, rel=2.0 * ratio)


def test_orders_meet_the_spring_at_its_frequency_over_their_number():
    table = compute_table(SPRING, SPRING.complete({}))
    frequency = table["surge_frequency"].item()
    speeds = table["meeting_speed"].values * np.arange(1, 41) / (2.0 * math.pi)
    assert speeds == pytest.approx([frequency] * 40)
    worst, shown = int(table["critical_order"].item()), table["surge_by_order"].values
    inside = (table["meeting_speed"].values <= SPRING.parameters["high"].default) & (
        table["meeting_speed"].values >= SPRING.parameters["low"].default
    )
    assert shown[worst - 1] == shown[inside].max() == table["surge_force"].item()
    rows = list(csv.reader(write_orders(table, {}).splitlines()))
    assert float(rows[worst][0]) == worst
    assert float(rows[worst][2]) == pytest.approx(table["critical_speed"].item() * 30.0 / math.pi, rel=1e-5)


def test_the_table_ends_at_the_solid_length_with_the_rate_of_a_cylinder():
    table = compute_table(SPRING, SPRING.complete({}))
    assert table["rate"].values == pytest.approx([RATE] * 200)
    assert table["solid_length"].item() == pytest.approx(7.5 * 4e-3)
    assert table["full_force"].item() - table["installed_force"].item() == pytest.approx(8e-3 * RATE)


def test_a_scenario_without_a_wire_has_no_spring_to_wind():
    with pytest.raises(MistakeError, match="valve-train: its springs have no wire"):
        find_spring_settings("valve-train")
    assert "law" in find_spring_settings("valve-train", given=["diameter=4 mm"])


def test_a_scenario_gives_wire_and_cam(tmp_path: Path):
    file = tmp_path / "wound.toml"
    file.write_text(
        'extends = "coil-clash"\n[components.spring.wire]\ndiameter = "3.8 mm"\nactive_coils = 5.5\n'
        'mean_diameter = ["26 mm", "20 mm"]\nfree_length = "52 mm"\ninstalled_length = "40 mm"\n'
        "peened = false\n"
    )
    found = find_spring_settings(str(file))
    assert found["mean_diameter"] == "26 mm, 20 mm"
    assert (found["law"], found["lift"]) == ("modified_trapezoid", 8e-3)
    with pytest.raises(MistakeError, match=r"--component valve|component='valve'"):
        find_spring_settings(str(file), "valve")
    assert "free_length" not in find_spring_settings(str(file), given=["pitch=8 mm"]), (
        "one replaces the other"
    )
    done = called("spring", str(file), cwd=tmp_path)
    assert (done.returncode, "end_coils 2, free_length 52 mm" in done.stdout) == (0, True), (
        "defaults are told"
    )
    made = sorted(path.name for path in (tmp_path / "results" / "wound-spring").iterdir())
    assert made == ["spring.nc", "spring.orders.csv", "spring.png"]
