"""Lift tables: what is read from a file, what is refused, and that a run takes it."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from orchestrator.analyses import load as load_analysis
from orchestrator.errors import MistakeError
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.angle_table import AngleTableError
from orchestrator.scenario.files import SHIPPED, load
from orchestrator.scenario.lift_table import LiftTable, read_lift_table
from orchestrator.scenario.warnings import list_warnings

ANGLES = np.arange(100.0, 261.0)


def lift(degrees):
    """A bell of 8 mm and 160 degrees."""
    return 8.0 * np.cos(math.pi * (degrees - 180.0) / 160.0) ** 6


def write(
    path: Path, header: str = "angle [deg], lift [mm]", row: str = "{0:g}, {1:.4f}", angles=ANGLES, lifts=None
) -> Path:
    lifts = lift(angles) if lifts is None else lifts
    rows = [row.format(a, s) for a, s in zip(angles, lifts, strict=True)]
    path.write_text("\n".join([header, *rows]), encoding="utf-8")
    return path


def write_scenario(folder: Path, more: str = "", base: str = "my-cam", part: str = "camshaft") -> Path:
    """One that takes the table cam.csv beside it."""
    file = folder / "own.toml"
    file.write_text(f'extends = "{base}"\n[components.{part}]\nlift_table = "cam.csv"\n{more}')
    return file


def test_units_separators_comments_and_order_make_no_difference(tmp_path):
    plain = read_lift_table(write(tmp_path / "plain.csv"))
    np.testing.assert_allclose(plain.angle, np.radians(ANGLES), rtol=1e-15)
    assert plain.rounding == pytest.approx(1e-7)
    others = (
        write(tmp_path / "metres.csv", "# a comment\nangle (rad); lift (m)", "{0:g}; {1:.4f}e-3"),
        write(tmp_path / "backwards.csv", angles=ANGLES[::-1]),
    )
    others[0].write_text(
        "# a comment\nangle (rad);lift (m)\n"
        + "\n".join(f"{math.radians(a)!r};{s:.4f}e-3" for a, s in zip(ANGLES, lift(ANGLES), strict=True))
    )
    german = tmp_path / "german.csv"
    german.write_text(write(german, "Winkel [deg];Hub [mm]", "{0:g};{1:.4f}").read_text().replace(".", ","))
    for path in (*others, german):
        table = read_lift_table(path)
        np.testing.assert_allclose(table.angle, plain.angle, rtol=1e-14)
        np.testing.assert_allclose(table.lift, plain.lift, atol=1e-17)
        assert table.rounding == pytest.approx(1e-7)


def test_a_table_of_the_event_and_one_of_the_turn_give_the_same_cam(tmp_path):
    event = read_lift_table(write(tmp_path / "event.csv")).smooth().points
    angles = np.arange(0.0, 361.0)
    lifts = np.where(abs(angles - 180) < 80, lift(angles), 0)
    whole = read_lift_table(write(tmp_path / "turn.csv", angles=angles, lifts=lifts)).smooth().points
    assert event.angle.size == whole.angle.size == 360
    order = np.argsort(event.angle % (2.0 * math.pi))
    np.testing.assert_allclose(event.lift[order], whole.lift, atol=1e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("angle, lift\n1, 2", "has no unit"),
        ("lift [mm], angle [deg]\n1, 2", "is no angle"),
        ("angle [deg], lift [mm]\n1, 2\n2, x", "line 3"),
        ("angle [deg], lift [mm]\n1, 2\n2, 3\n2, 4", "line 4"),
        ("angle [deg], lift [mm]\n1, 2\n400, 3", "spans 399 deg"),
        ("angle [deg], lift [mm]\n1, 2", "1 rows"),
        ("angle lift\n1 2", "one column"),
        ("angle [deg], lift [mm]\n1, 2,439\n2, 3,1", "semicolons"),
        ("angle [deg], lift [m]\n1, 2\n2, 3", "0.1 to 100 mm"),
        ("angle [deg], lift [um]\n1, 2\n2, 3", "0.1 to 100 mm"),
        ("angle [deg], lift [mm]\n1, 2\n0, 3\n2, 3\n4, 3", "line 3"),
        ("PK\0\x03", "no text file"),
    ],
)
def test_what_is_no_lift_table_is_named_with_its_place(tmp_path, text, message):
    path = tmp_path / "cam.csv"
    path.write_text(text)
    with pytest.raises(AngleTableError, match=message) as raised:
        read_lift_table(path)
    assert str(path) in str(raised.value)


def test_spreadsheets_encodings_and_german_degrees_are_read(tmp_path):
    plain = read_lift_table(write(tmp_path / "plain.csv"))
    text = write(tmp_path / "german.csv", "Winkel [Grad];Hub [mm]", "{0:g};{1:.4f}").read_text()
    for content in (text, text.replace("Grad", "°")):
        for encoding in ("cp1252", "utf-16", "utf-8-sig"):
            path = tmp_path / "encoded.csv"
            path.write_bytes(content.replace(".", ",").encode(encoding))
            np.testing.assert_array_equal(read_lift_table(path).lift, plain.lift)


@pytest.mark.parametrize("shift", [-150.0, 0.0, 100.0])
@pytest.mark.parametrize("direction", [1, -1])
def test_a_table_that_passes_zero_is_the_same_cam(tmp_path, shift, direction):
    angles = ANGLES[::direction]
    path = write(tmp_path / "turned.csv", angles=(angles + shift) % 360, lifts=lift(angles))
    table, plain = read_lift_table(path), read_lift_table(write(tmp_path / "plain.csv"))
    turned = np.degrees(table.angle - plain.angle) - shift
    np.testing.assert_allclose(turned, 360.0 * round(float(turned[0]) / 360.0), atol=1e-10)
    np.testing.assert_array_equal(table.lift, plain.lift)


def test_crank_angles_are_halved_and_doubted_without_their_name(tmp_path):
    named = write(tmp_path / "named.csv", "crank angle [deg], lift [mm]", "{0:g}, {1:.4f}")
    np.testing.assert_allclose(read_lift_table(named).angle, np.radians(ANGLES) / 2, rtol=1e-15)
    write(tmp_path / "cam.csv", angles=2.0 * (ANGLES - 90.0), lifts=lift(ANGLES))
    assert [line for line in list_warnings(load(write_scenario(tmp_path))) if "crank" in line]


@pytest.mark.parametrize(("rounding", "noise"), [(1e-3, 0.0), (1e-6, 2e-3)])
@given(row=st.integers(40, 120), error=st.sampled_from([-0.1, -0.02, 0.02, 0.1]))
@settings(max_examples=10, deadline=None)
@pytest.mark.long
def test_one_wrong_row_is_named_and_none_without_it(rounding, noise, row, error):
    """The row's deviation from the spline through the others is its error."""
    random = np.random.default_rng(row)
    lifts = lift(ANGLES) + noise * random.standard_normal(ANGLES.size)
    lifts = np.round(lifts / rounding) * rounding
    assert LiftTable(np.radians(ANGLES), 1e-3 * lifts, 0.0).smooth().doubtful is None
    lifts[row] += error
    angle, deviation = LiftTable(np.radians(ANGLES), 1e-3 * lifts, 0.0).smooth().doubtful
    assert angle == np.radians(ANGLES[row])
    assert deviation == pytest.approx(
        1e-3 * error, abs=1e-3 * (0.02 * abs(error) + 2.0 * rounding + 5.0 * noise)
    )


@pytest.mark.long
@given(seed=st.integers(0, 1000), decimals=st.integers(3, 9))
@settings(max_examples=10, deadline=None)
def test_uneven_and_coarse_tables_without_errors_but_rounding_are_not_doubted(seed, decimals):
    angles = np.unique(np.round(np.random.default_rng(seed).uniform(100.0, 260.0, 120), 6))
    for degrees in (angles, np.arange(100.0, 261.0, 5.0)):
        lifts = np.round(lift(degrees), decimals)
        table = LiftTable(np.radians(degrees), 1e-3 * lifts, 10.0 ** (-3 - decimals))
        assert table.smooth().doubtful is None


@pytest.mark.parametrize("least", [-0.05, 0.02, 17.0])
def test_a_table_that_does_not_count_from_the_base_circle_is_doubted(tmp_path, least):
    """As one of radii, or of a gauge that was not set to zero."""
    degrees = np.arange(0.0, 360.0, 2.0)
    lifts = np.where(np.abs(degrees - 180.0) < 80.0, lift(degrees), 0.0) + least
    write(tmp_path / "cam.csv", angles=degrees, lifts=lifts)
    warnings = list_warnings(load(write_scenario(tmp_path)))
    (doubt,) = [line for line in warnings if "base circle" in line]
    assert f"its least lift is {least:g} mm" in doubt
    assert not [line for line in warnings if "crank" in line]


def test_a_parameter_of_a_law_beside_the_table_is_refused(tmp_path):
    with pytest.raises(ScenarioError, match=r"parameters\.lift: has no meaning beside lift_table"):
        load("my-cam", ["components.camshaft.parameters.lift=9 mm"])
    path = write(tmp_path / "cam.csv")
    own = load("valve-train-flexible", [f"components.camshaft.lift_table={path}"])
    assert own.components["camshaft"].structure["table_points"] == 360


def test_a_table_that_ends_above_the_base_circle_is_refused(tmp_path):
    with pytest.raises(AngleTableError, match="base circle"):
        read_lift_table(write(tmp_path / "cut.csv", angles=np.arange(120.0, 240.0))).smooth()


def test_a_scenario_takes_the_table_beside_it_and_needs_it_no_more(tmp_path):
    write(tmp_path / "cam.csv")
    table = load(write_scenario(tmp_path)).components["camshaft"]
    assert table.lift_table is None
    assert table.structure == {"table_points": 360}
    peak = max(value for name, value in table.parameters.items() if name.startswith("table_lift"))
    assert peak == pytest.approx(8e-3, abs=1e-7)
    assert load(SHIPPED / "my-cam.toml").components["camshaft"].parameters["base_radius"] == 24e-3


def test_a_table_replaces_the_law_of_the_scenario_that_it_extends(tmp_path):
    """Also in a finger and a tappet; other parameters stay, and unknown ones are named without all points."""
    write(tmp_path / "cam.csv")
    finger = ("finger-follower-hla", "finger")
    parameters = load(write_scenario(tmp_path, "", *finger)).components["finger"].parameters
    assert parameters["base_radius"] == 20e-3
    assert "lift" not in parameters
    file = write_scenario(tmp_path, "[components.finger.parameters]\ncolour = 3\n", *finger)
    with pytest.raises(
        ScenarioError, match=r"known: base_radius, smooth, table_angle\[1\.\.360\], .*mass_arm"
    ):
        load(file)


def test_the_jerk_of_a_cam_is_that_of_its_closed_form(record):
    """Cycloidal: 4 pi^2 S/B^3 at the foot. The acceleration of the harmonic law jumps there."""
    analysis, omega = load_analysis("cam"), 100.0
    given = {"lift": 8e-3, "rise_angle": 1.5, "fall_angle": 1.2, "dwell_half_width": 0.0, "speed": omega}
    found = analysis.evaluate(analysis.complete(given))["largest_jerk"]
    exact = 4.0 * math.pi**2 * 8e-3 / 1.2**3 * omega**3
    record("Cam", "largest jerk of the cycloidal law", found, exact, "closed form", relative=1e-8)
    assert analysis.evaluate(analysis.complete({**given, "law": "harmonic"}))["largest_jerk"] == math.inf


def test_ramps_are_added_to_a_table(tmp_path):
    """The scenario's and the analysis' cam is the table's with the ramp's height on the nose."""
    write(tmp_path / "cam.csv")
    file = write_scenario(tmp_path, '[components.camshaft.parameters]\nramp_height = "0.3 mm"\n')
    parameters = load(file).components["camshaft"].parameters
    assert parameters["ramp_height"] == pytest.approx(0.3e-3)
    begin, end = (math.degrees(parameters[name]) for name in ("event_begin", "event_end"))
    assert lift(begin) == pytest.approx(8e-3, rel=0.5)
    assert begin - 180.0 == pytest.approx(180.0 - end, abs=1e-9)
    analysis = load_analysis("cam")
    found = analysis.evaluate(
        analysis.complete({"lift_table": str(tmp_path / "cam.csv"), "ramp_height": 3e-4})
    )
    assert found["largest_lift"] == pytest.approx(8.3e-3, abs=1e-7)
    # 20 deg of constant velocity and 5 deg of blending on both sides.
    assert math.degrees(found["event"]) == pytest.approx(end - begin + 50.0, abs=1e-9)


@pytest.mark.parametrize(
    ("part", "message"),
    [("camshaft", "cannot be read"), ("contact", "ehl_contact has none; .* or take camshaft, tappet")],
)
def test_a_scenario_names_a_table_that_it_cannot_take(tmp_path, part, message):
    with pytest.raises(MistakeError, match=message):
        load(write_scenario(tmp_path, "", "valve-train", part))


def test_the_analysis_of_a_cam_agrees_with_the_closed_forms_of_the_default(record):
    analysis = load_analysis("cam")
    found = analysis.evaluate(analysis.complete({}))
    # (B + 2d) / (2 (B + d)) for cycloidal flanks; the trapezoidal rule between 720 points.
    record("Cam", "ample factor", found["ample_factor"], 0.507410661, "closed form", tolerance=1e-6)
    slope = 1e3 * math.radians(found["slope_at_reversals"])
    source = "independent evaluation"
    record("Cam", "slope of the lubrication characteristic (mm/deg)", slope, 2.1893, source, tolerance=5e-5)
    assert found["reversals"] == "144.00, 168.00, 192.00, 216.00"
    assert found["shape"] == "convex"


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"follower": "roller", "offset": 0.1}, "offset"),
        ({"follower": "finger_pad", "valve_arm": 5e-3}, "cannot lift the valve"),
        ({"follower": "finger_pad", "cam_arm": 0.0}, "must not be zero"),
        ({"lift_table": "absent.csv"}, "cannot be read"),
        (
            {"base_radius": 12e-3, "follower": "roller", "radius": 5e-3, "other": "flat"},
            "cannot touch the cam",
        ),
    ],
)
def test_the_analysis_of_a_cam_names_what_it_cannot_take(values, message):
    analysis = load_analysis("cam")
    with pytest.raises(MistakeError, match=message):
        analysis.evaluate(analysis.complete(values))


def test_a_table_without_lift_is_named(tmp_path):
    table = tmp_path / "flat.csv"
    table.write_text("angle [deg], lift [mm]\n" + "".join(f"{a}, -1.0\n" for a in range(0, 360)))
    analysis = load_analysis("cam")
    with pytest.raises(MistakeError, match="largest lift is -1 mm: must be > 0"):
        analysis.evaluate(analysis.complete({"lift_table": str(table)}))


def test_a_flat_follower_needs_a_convex_cam():
    """R0 + s + s'' > 0 everywhere, else the contour crosses itself: convex just above the radius it names."""
    analysis = load_analysis("cam")

    def describe(base_radius):
        return analysis.evaluate(analysis.complete({"base_radius": base_radius}))["shape"]

    needed = 1e-3 * float(re.search(r"base_radius > ([\d.]+) mm", describe(8e-3))[1])
    assert describe(0.999 * needed).startswith("undercut")
    assert describe(1.001 * needed) == "convex"
