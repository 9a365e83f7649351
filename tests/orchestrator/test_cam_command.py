"""The command `cam`: its drawings lift the follower as asked, and scenarios give the cam that they have."""

import math
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from models.valve_train.cams.table import table_lift
from orchestrator.analyses import load
from orchestrator.analyses._cam_source import find_settings
from orchestrator.errors import MistakeError
from orchestrator.scenario.files import load as load_scenario
from tribocosim.command_line import app

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
    assert one["law"] in load("cam").parameters["law"].choices
    assert find_settings("valve-train")["follower"] == "flat"


def test_it_says_of_which_follower_and_speed_its_results_are():
    describe = load("cam").describe
    values = load("cam").complete(find_settings("roller-finger") | {"speed": "3000 rpm"})
    assert describe(values) == "finger roller follower of radius 9 mm, base circle radius 18 mm, 3000 r/min"


@pytest.mark.parametrize(
    ("source", "component", "message"),
    [
        ("cycloidl", None, "did you mean cycloidal?"),
        ("my-cm", None, "did you mean my-cam?"),
        ("no-such-thing", None, "or a file: a lift table .csv"),
        ("quarter-car", None, "no component has a cam"),
        ("engine-16v", None, "choose one with component"),
        ("engine-16v", "tappet_intake_2", "did you mean tappet_intake_2"),
        ("cycloidal", "camshaft", "is no scenario"),
        ("absent.toml", None, "no such scenario file"),
    ],
)
def test_what_has_no_cam_is_named(source, component, message):
    with pytest.raises(MistakeError, match=message):
        find_settings(source, component)


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
