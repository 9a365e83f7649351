"""Cams: the command's drawings lift the follower as asked, scenarios give their cam, segments make one."""

import json
import math
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from models.catalogue import CATALOGUE
from models.valve_train.cams.segments import join_sides, scale_rise
from models.valve_train.cams.table import table_lift
from orchestrator.analyses import load
from orchestrator.analyses._cam_profile import build_profile
from orchestrator.analyses._cam_source import find_settings
from orchestrator.analyses._cam_timing import find_timing
from orchestrator.analyses.cam import ANALYSIS
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.display import format_with_error
from orchestrator.scenario.files import load as load_scenario
from tribocosim.command_line import app

from .commands import called

TABLE = Path("orchestrator/scenario/shipped/my-cam.csv")
RADIUS = 10e-3


def draw(folder: Path, *arguments: str) -> xarray.Dataset:
    result = CliRunner().invoke(app, ["cam", *arguments, "--out", str(folder)])
    assert result.exit_code == 0, result.output
    return xarray.load_dataset(folder / "cam.nc", engine="h5netcdf")


def read_svg(path: Path) -> np.ndarray:
    """Points in m with y upwards; the drawing's units must be mm on paper."""
    root = ElementTree.parse(path).getroot()
    _, _, width, height = map(float, root.attrib["viewBox"].split())
    assert root.attrib["width"] == f"{width:.3f}mm"
    assert root.attrib["height"] == f"{height:.3f}mm"
    path_data = root.find("{*}path[@id='contour']").attrib["d"]
    assert path_data.endswith("Z")
    return 1e-3 * np.array([(float(x), -float(y)) for x, y in re.findall(r"([-\d.]+),([-\d.]+)", path_data)])


def read_dxf(path: Path) -> np.ndarray:
    """Points in m of the polyline, by the pairs of group code and value."""
    lines = path.read_text("utf-8").splitlines()
    pairs = list(zip(map(int, lines[::2]), lines[1::2], strict=True))
    assert pairs[-1] == (0, "EOF")
    begin, end = pairs.index((0, "POLYLINE")), pairs.index((0, "SEQEND"))
    assert (70, "1") in pairs[begin:end]
    x, y = ([float(v) for code, v in pairs[begin:end] if code == axis][1:] for axis in (10, 20))
    return 1e-3 * np.column_stack([x, y])


def lift_over(points: np.ndarray, angles: np.ndarray, radius: float | None) -> np.ndarray:
    """The lowest place of a flat or round follower above a turned cloud of points, which is independent of
    the contact's equations; the cam turns anticlockwise."""
    heights = []
    for angle in angles:
        c, s = math.cos(angle), math.sin(angle)
        x, y = c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]
        if radius is not None:
            below = np.abs(x) < radius
            y = y[below] + np.sqrt(radius**2 - x[below] ** 2)
        heights.append(y.max())
    return np.array(heights)


@pytest.mark.parametrize(("follower", "read"), [("flat", read_svg), ("roller", read_dxf)])
def test_the_drawn_contour_lifts_the_follower_as_the_table_says(tmp_path, record, read, follower):
    """The law is not symmetric, so that a mirrored drawing would fail."""
    options = ["--follower", follower, "--radius", "10 mm", "--base-radius", "24 mm"]
    table = draw(tmp_path, "polynomial_345", *options, "--set", "fall_angle=75 deg")
    points = read(tmp_path / f"cam.{read.__name__.removeprefix('read_')}")
    radius = RADIUS if follower == "roller" else None
    found = lift_over(points, table["angle"].values, radius) - 24e-3 - (radius or 0.0)
    error = np.abs(found - table["lift"].values).max()
    quantity = f"drawn contour, lift of the {follower} follower (m)"
    record("Cam", quantity, error, 0.0, "closed form", tolerance=1e-9)
    chords = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    assert (chords**2 / (8.0 * np.abs(table["radius_of_curvature"].values))).max() < 1e-6


def test_the_lubrication_characteristic_is_that_of_its_closed_form(tmp_path):
    """R0 + s + 2 s'' of a flat follower; its zeros are the reversals."""
    table = draw(tmp_path, "cycloidal")
    exact = load("cam").parameters["base_radius"].default + table["lift"] + 2.0 * table["curvature"]
    np.testing.assert_allclose(table["lubrication_characteristic"], exact, atol=1e-15)
    zeros = [float(z) for z in str(table["reversals"].item()).split(", ")]
    at_zeros = np.interp(np.radians(zeros), table["angle"], table["lubrication_characteristic"])
    np.testing.assert_allclose(at_zeros, 0.0, atol=1e-6)


@pytest.mark.long
def test_scenarios_give_the_cam_and_follower_that_they_have():
    assert find_settings("my-cam")["lift_table"] == str(TABLE.resolve())
    assert find_settings("my-cam")["base_radius"] == 24e-3
    roller = find_settings("roller-finger")
    assert roller["follower"] == "finger_roller"
    assert load("cam").complete(roller)["cam_arm"] == roller["cam_arm"]
    one = find_settings("engine-16v", "tappet_intake_2a")
    assert one["law"] in load("cam").parameters["law"].quantity.choices
    crank = load_scenario("engine-16v").components["flywheel"].parameters["initial_speed"]
    assert one["speed"] == pytest.approx(0.5 * crank)
    assert find_settings("valve-train")["follower"] == "flat"


def test_the_speed_of_a_free_drive_is_that_of_its_start(tmp_path):
    """Its `initial_speed` has no effect."""
    own = "[components.flywheel]\nparameters.motion = 'free'\nstart.speed = '3000 rpm'\n"
    (tmp_path / "free.toml").write_text(f'extends = "valve-train"\n{own}')
    assert find_settings(str(tmp_path / "free.toml"))["speed"] == pytest.approx(100.0 * math.pi)


def test_the_cam_of_a_scenario_is_that_of_its_run(tmp_path):
    """Ramps join the table where the scenario says; options replace what it says."""
    own = tmp_path / "own.toml"
    ramps = 'ramp_height = "0.3 mm"\nevent_begin = "100 deg"\nevent_end = "265 deg"'
    own.write_text(f'extends = "my-cam"\n[components.camshaft.parameters]\n{ramps}\n')
    camshaft = load_scenario(own).components["camshaft"]
    component = camshaft.resolve()
    record = component.parameters.view(component.parameters.vector(camshaft.parameters))
    out = tmp_path / "out"
    table = draw(out, str(own), "--base-radius", "30 mm", "--speed", "3000 rpm")
    assert table.attrs["base_radius"] == pytest.approx(30e-3)
    assert table.attrs["speed"] == pytest.approx(100.0 * math.pi)
    lifts = [table_lift(angle, record).s for angle in table["angle"].values]
    np.testing.assert_allclose(table["lift"], lifts, atol=1e-15)
    assert math.degrees(float(table["event"])) == pytest.approx(265.0 - 100.0 + 50.0, abs=1e-9)
    # Drawings and results of a cam are not replaced unasked.
    again = CliRunner().invoke(app, ["cam", str(own), "--out", str(out)])
    assert again.exit_code != 0
    assert "--overwrite" in again.output


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
    resolved = load_scenario(str(tmp_path / "out" / "scenario.toml")).components["camshaft"]
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
        load_scenario(str(write(tmp_path, segments)))


def test_the_jerk_of_a_cam_is_that_of_its_closed_form(record):
    """Cycloidal: 4 pi^2 S/B^3 at the foot. The acceleration of the harmonic law jumps there."""
    analysis, omega = load("cam"), 100.0
    given = {"lift": 8e-3, "rise_angle": 1.5, "fall_angle": 1.2, "dwell_half_width": 0.0, "speed": omega}
    found = analysis.evaluate(analysis.complete(given))["largest_jerk"]
    exact = 4.0 * math.pi**2 * 8e-3 / 1.2**3 * omega**3
    record("Cam", "largest jerk of the cycloidal law", found, exact, "closed form", relative=1e-8)
    assert analysis.evaluate(analysis.complete({**given, "law": "harmonic"}))["largest_jerk"] == math.inf


def test_the_analysis_of_a_cam_agrees_with_the_closed_forms_of_the_default(record):
    analysis = load("cam")
    found = analysis.evaluate(analysis.complete({}))
    # (B + 2d) / (2 (B + d)) for cycloidal flanks; the trapezoidal rule between 720 points.
    record("Cam", "ample factor", found["ample_factor"], 0.507410661, "closed form", tolerance=1e-6)
    slope = 1e3 * math.radians(found["slope_at_reversals"])
    source = "independent evaluation"
    record("Cam", "slope of the lubrication characteristic (mm/deg)", slope, 2.1893, source, tolerance=5e-5)
    assert found["reversals"] == "144.00, 168.00, 192.00, 216.00"
    assert found["shape"] == "convex"


@pytest.mark.parametrize("base_radius", [12e-3, 13.7e-3, 8e-3])
def test_an_undercut_cam_has_the_signed_least_radius_that_its_refusal_names(base_radius):
    """Not the sample beside the zero of rho. The default cam's smallest rho is its R0 less 13.757 mm."""
    analysis = load("cam")
    found = analysis.evaluate(analysis.complete({"base_radius": base_radius}))
    shaft = CATALOGUE["camshaft"]()
    (fault,) = shaft.parameter_faults(shaft.parameters.vector({"base_radius": base_radius}))
    radius, needed = re.findall(r"[\d.-]+(?= mm)", fault)
    assert f"{1e3 * found['least_radius']:.3f}" == radius
    assert found["least_radius"] == pytest.approx(base_radius - 13.757e-3, abs=1e-6)
    assert found["shape"].endswith(f"base_radius > {needed} mm is needed")


def test_an_undercut_nose_under_a_roller_has_a_negative_least_radius():
    """A roller's cam undercuts where its pitch curve bends tighter than the roller; hollow flanks do not
    count. rho = rho_p - r of a pitch curve at x: rho_p = (x^2 + x'^2)^1.5 / (x^2 + 2 x'^2 - x x'')."""
    analysis = load("cam")
    given = {"follower": "roller", "base_radius": 8e-3, "radius": 18e-3, "rise_angle": 0.8}
    values = analysis.complete(given)
    found, lift = analysis.evaluate(values), build_profile(values).lift
    s, ds, dds = np.array([lift(a) for a in np.linspace(0.0, 2.0 * math.pi, 4001)]).T
    x = 26e-3 + s
    pitch = (x**2 + ds**2) ** 1.5 / (x**2 + 2.0 * ds**2 - x * dds)
    assert found["least_radius"] == pytest.approx(pitch[pitch > 0.0].min() - 18e-3, rel=1e-4)
    assert found["least_radius"] < 0.0
    assert found["shape"].startswith("undercut")


def test_a_flat_follower_needs_a_convex_cam():
    """R0 + s + s'' > 0 everywhere, else the contour crosses itself: convex just above the radius it names."""
    analysis = load("cam")

    def describe(base_radius):
        return analysis.evaluate(analysis.complete({"base_radius": base_radius}))["shape"]

    needed = 1e-3 * float(re.search(r"base_radius > ([\d.]+) mm", describe(8e-3))[1])
    undercut = describe(0.999 * needed)
    assert undercut.startswith("undercut")
    results = {"shape": undercut, "table_doubts": "none"}
    assert load("cam").warn(results) == [undercut]
    assert describe(1.001 * needed) == "convex"


@pytest.mark.parametrize(
    "name",
    [
        "seat-and-lash", "exhaust-valve", "coil-clash", "valve-stem", "direct-acting-hla", "pushrod-train",
        "finger-follower", "finger-follower-hla", "roller-finger", "shaft-in-bearings",
    ],
)  # fmt: skip
def test_shipped_trains_of_engines_have_cams_of_engines_and_one_hot_oil(name):
    """Road cams lift by 0.050 in over 180 to 250 deg of the crank; K's own does over 251, with a dwell."""
    values = ANALYSIS.complete(find_settings(name))
    duration = find_timing(build_profile(values), values)["duration_050"]
    assert 180.0 < math.degrees(float(duration)) < 250.0
    scenario = load_scenario(name)
    assert scenario.oil, "its temperature is that of all parts"
    assert scenario.temperature == pytest.approx(373.15)
    assert not any("viscosity" in table.parameters and table.oil for table in scenario.components.values())


@pytest.mark.parametrize(
    ("value", "error", "shown"),
    [
        (-861.5, 60.0, "-860 +/- 60"),
        (-861.5, 183.2, "-860 +/- 190"),
        (-861.5, 44.1, "-862 +/- 45"),
        (-861.5, 600.0, "-900 +/- 600"),
        (4.43, 4.21, "4.4 +/- 4.3"),
        (-0.012, 13.0, "0 +/- 13"),
        (9.0, 1e-4, "9.00000 +/- 0.00010"),
        (1.23e6, 2e5, "1230000 +/- 200000"),
        (9.0, 1e-9, "9"),
        (9.0, 0.0, "9"),
        (math.inf, math.inf, "inf"),
    ],
)
def test_a_value_has_its_error_and_moves_by_a_tenth_of_it_at_most(value, error, shown):
    assert format_with_error(value, error) == shown


def test_numbers_of_a_lift_table_are_printed_with_their_errors(tmp_path):
    """Of accelerations that of s'', which the same table states; reversals are zeros of s + R0 + 2 s''."""
    done = called("cam", "my-cam", "--json", "--out", str(tmp_path / "cam"))
    data = json.loads(done.stdout)
    shown = {words[0]: words[1:] for line in done.stderr.splitlines() if (words := line.split())}
    error = data["curvature_uncertainty"]
    square = find_settings("my-cam")["speed"] ** 2
    for name, least in (("largest_acceleration", error * square), ("least_radius", 1e3 * error)):
        printed, sign, stated = shown[name][:3]
        assert float(printed) == pytest.approx(
            data[name] * (1e3 if "radius" in name else 1.0), abs=0.1 * least
        )
        assert sign == "+/-"
        assert least <= float(stated) < 1.2 * least
    slip = math.degrees(2.0 * error / data["slope_at_reversals"])
    assert slip < float(shown["reversals"][2].rstrip(",")) < 1.2 * slip
