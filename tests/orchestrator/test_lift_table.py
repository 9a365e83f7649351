"""Lift tables: what is read from a file, what is refused, and that a run takes it."""

import math
from pathlib import Path

import numpy as np
import pytest

from orchestrator.analyses import load as load_analysis
from orchestrator.reporter import Reporter
from orchestrator.run.publish import _print_end
from orchestrator.run.summary import Summary
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


def read(folder: Path, *given, **more) -> LiftTable:
    """The table that is written so."""
    return read_lift_table(write(folder / "cam.csv", *given, **more))


def write_scenario(folder: Path, more: str = "", base: str = "my-cam", part: str = "camshaft") -> Path:
    """One that takes the table cam.csv beside it."""
    file = folder / "own.toml"
    file.write_text(f'extends = "{base}"\n[components.{part}]\nlift_table = "cam.csv"\n{more}')
    return file


def test_units_separators_comments_and_order_make_no_difference(tmp_path):
    plain = read(tmp_path)
    np.testing.assert_allclose(plain.angle, np.radians(ANGLES), rtol=1e-15)
    assert plain.rounding == pytest.approx(1e-7)
    metres, german = tmp_path / "metres.csv", tmp_path / "german.csv"
    rows = (f"{math.radians(a)!r};{s:.4f}e-3" for a, s in zip(ANGLES, lift(ANGLES), strict=True))
    metres.write_text("\n".join(["# a comment", "angle (rad);lift (m)", *rows]))
    german.write_text(write(german, "Winkel [deg];Hub [mm]", "{0:g};{1:.4f}").read_text().replace(".", ","))
    backwards = write(tmp_path / "backwards.csv", angles=ANGLES[::-1])
    for path in (metres, german, backwards):
        table = read_lift_table(path)
        np.testing.assert_allclose(table.angle, plain.angle, rtol=1e-14)
        np.testing.assert_allclose(table.lift, plain.lift, atol=1e-17)
        assert table.rounding == pytest.approx(1e-7)


def test_a_table_of_the_event_and_one_of_the_turn_give_the_same_cam(tmp_path):
    event = read(tmp_path).smooth().points
    angles = np.arange(0.0, 361.0)
    lifts = np.where(abs(angles - 180) < 80, lift(angles), 0)
    whole = read(tmp_path, angles=angles, lifts=lifts).smooth().points
    assert event.angle.size == whole.angle.size == 360
    order = np.argsort(event.angle % (2.0 * math.pi))
    np.testing.assert_allclose(event.lift[order], whole.lift, atol=1e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("place, lift [mm]\n1, 2", "has no unit"),
        ("angle [deg], lift [millimters]\n1, 2", "'millimters' is an unknown unit"),
        ("angle [" + 1000 * " " + ", lift [mm]\n1, 2", "1 row"),
        ("lift [mm], angle [deg]\n1, 2", "is no angle"),
        ("angle [deg], lift [mm]\n1, 2\n2, x", "line 3"),
        ("angle [deg], lift [mm]\n1, 2\n2, 3\n2, 4", "line 4"),
        ("cam angle [deg], lift [mm]\n1, 2\n400, 3", "spans 399 deg"),
        ("angle [deg], lift [mm]\n1, 2", "1 row"),
        ("angle lift\n1 2", "one column"),
        ("angle [deg], lift [mm]\n1, 2,439\n2, 3,1", "semicolons"),
        ("angle [deg], lift [m]\n1, 2\n20, 3", "0.1 to 100 mm"),
        ("angle [deg], lift [um]\n1, 2\n20, 3", "0.1 to 100 mm"),
        ("angle [deg], lift [mm]\n1, 2\n0, 3\n2, 3\n4, 3", "line 3"),
        ("PK\0\x03", "no text file"),
        ("cam angle [deg KW]; lift [mm]\n1; 2\n2; 3", "names the cam and the crank"),
        ("angle [deg], lift [mm]\n0, 0\n180, 5\n360, 0.5", "a turn later, with 0.5 mm"),
    ],
)
def test_what_is_no_lift_table_is_named_with_its_place(tmp_path, text, message):
    path = tmp_path / "cam.csv"
    path.write_text(text)
    with pytest.raises(AngleTableError, match=message) as raised:
        read_lift_table(path)
    assert str(path) in str(raised.value)


def test_spreadsheets_encodings_and_german_degrees_are_read(tmp_path):
    plain = read(tmp_path)
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
    table, plain = read_lift_table(path), read(tmp_path)
    turned = np.degrees(table.angle - plain.angle) - shift
    np.testing.assert_allclose(turned, 360.0 * round(float(turned[0]) / 360.0), atol=1e-10)
    np.testing.assert_array_equal(table.lift, plain.lift)


def test_angles_of_the_crank_are_doubted_without_their_name(tmp_path):
    write(tmp_path / "cam.csv", angles=2.0 * (ANGLES - 90.0), lifts=lift(ANGLES))
    assert [line for line in list_warnings(load(write_scenario(tmp_path))) if "crank" in line]


@pytest.mark.parametrize(
    ("lifts", "message"),
    [
        (24.0 + lift(ANGLES), "if these are radii, subtract the base circle's from all rows; else add them"),
        (-lift(ANGLES), "its lifts are from -8 to 0 mm: must rise above 0 .*; change their sign, or"),
        (np.full(ANGLES.size, -1.0), "its lifts are from -1 to -1 mm"),
        (lift(ANGLES) + 39.3 * (ANGLES == 150.0), r"150 deg lifts by 41.\d+ mm, 38.8 mm off .* at most 8 mm"),
        (lift(ANGLES) - 39.3 * (ANGLES == 150.0), "150 deg lifts by -.* mm, -39.* mm off the others"),
        *((lift(ANGLES) + 39.3 * np.isin(ANGLES, (150.0, x)), "off the others") for x in (151.0, 220.0)),
        (lift(ANGLES) + 0.3 * (ANGLES == 150.0), "150 deg lifts by .* mm, 0.297 mm off the others"),
        (lift(ANGLES) + 393.0 * (ANGLES == 150.0), "at 150 deg, but .*; correct .*, or this row"),
    ],
)
def test_lifts_of_no_cam_are_refused_with_their_remedy(tmp_path, lifts, message):
    """Radii, lifts downwards, and a row that is off the others by more than 2 % of their lift."""
    with pytest.raises(AngleTableError, match=message):
        read(tmp_path, lifts=lifts).smooth()


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


def list_doubts(folder: Path, *given, **more) -> str:
    table = read(folder, *given, **more)
    return "; ".join(table.list_doubts(table.smooth()))


# The foot's jerk is continuous: 35x^4 - 84x^5 + 70x^6 - 20x^7 over 65 deg, 9.5 mm.
RISE, TOP = 65.0, 9.5


def lobe(degrees):
    x = np.clip(1.0 - np.abs(degrees) / RISE, 0.0, 1.0)
    return TOP * x**4 * (35.0 - 84.0 * x + 70.0 * x**2 - 20.0 * x**3)


@pytest.mark.parametrize("first", [290, 0, 320])
def test_a_gap_on_the_base_circle_is_round_whatever_row_is_first(tmp_path, first):
    angles = np.roll(np.arange(-70, 71), -((first + 70) % 360)) % 360
    lifts = lobe((angles + 180) % 360 - 180)
    table = read(tmp_path, row="{0:g}, {1:.2f}", angles=angles, lifts=lifts)
    points = table.smooth().points
    between = np.abs((np.degrees(points.angle) + 180.0) % 360.0 - 180.0) > 75.0
    assert np.abs(points.lift[between]).max() < 2e-6
    assert any("no rows between 70 and 290 deg" in note for note in table.list_notes())


@pytest.mark.parametrize("header", ["angle, lift", "angle [deg], lift [mm]", "crank angle [deg], lift [mm]"])
def test_radians_that_are_named_degrees_are_refused(tmp_path, header):
    with pytest.raises(AngleTableError, match=r"at least 13 deg; .* unit \[rad\] in the first line"):
        read(tmp_path, header, "{0:.5f}, {1:.3f}", angles=np.radians(2.0 * ANGLES), lifts=lift(ANGLES))


@pytest.mark.parametrize("missing", [4, 20])
def test_rows_missing_on_the_lobe_are_refused(tmp_path, missing):
    angles = np.array([a for a in np.arange(-90.0, 90.0) if not 30.0 <= a < 30.0 + missing])
    with pytest.raises(AngleTableError, match="rows are missing between 29 and"):
        read(tmp_path, angles=angles, lifts=lobe(angles)).smooth()
    angles = np.array([a for a in np.arange(-90.0, 90.0) if a != 30.0])
    table = read(tmp_path, angles=angles, lifts=lobe(angles))
    assert any("rows are missing between 29 and 31 deg" in note for note in table.list_notes())


CRANK = (
    "Kurbelwinkel [Grad]; Hub [mm]", "KW [°]; Hub [mm]", "CA [deg]; lift [mm]", "°KW; Hub / mm",
    "angle [deg CA]; lift [mm]", "crank_deg; lift_mm", "vilebrequin [degrés]; levée [mm]", "CAD; lift_mm",
    "Angolo manovella (gradi); alzata (mm)", "Winkel [°KW]; Hub in mm", "deg ATDC [deg]; lift [mm]",
    "Motorwinkel [Grad]; Hub [mm]", "angle moteur {deg}; levée <mm>", "engine angle; lift: mm",
    "° engine; lift",
)  # fmt: skip
CAM = (
    "Winkel [grad]; Hub [mm]", "ANGLE [DEG]; LIFT [MM]", "Angle [Degrees]; Lift [Millimeters]",
    "angle [º]; lift [mm]", "Nockenwinkel nach OT [Grad]; Hub [mm]", "cam angle (deg); valve lift (mm)",
    "angle; lift", "engine 2 cam angle <deg>; lift {mm}", "CamAngle_deg; lift: mm",
    "arbre à cames [°]; levée [mm]",
)  # fmt: skip


@pytest.mark.parametrize("header", [*CRANK, *CAM])
def test_angles_of_crank_or_cam_and_their_units_are_known_by_their_words(tmp_path, header):
    """Those of the crank are halved."""
    table, ratio = read(tmp_path, header, "{0:g}; {1:.4f}"), 2.0 if header in CRANK else 1.0
    np.testing.assert_allclose(table.angle, np.radians(ANGLES) / ratio, rtol=1e-14)
    assert table.lift.max() == pytest.approx(8e-3, rel=1e-12)
    if header in CAM:
        assert ("is taken" in " ".join(table.notes)) == (header == "angle; lift")
    else:
        assert table.named
        assert header.startswith("crank") or any("crank angles" in note for note in table.notes)


@pytest.mark.parametrize(
    "unit", ["[Inch]", "[IN]", '["]', "[inches]", "{in}", "<in>", ": in", "[in.]", "in."]
)
def test_words_of_inches_are_read(tmp_path, unit):
    table = read(tmp_path, f"angle [deg]; lift {unit}", lifts=lift(ANGLES) / 25.4, row="{0:g}; {1:.9f}")
    assert table.lift.max() == pytest.approx(8e-3, rel=1e-7)


def test_units_may_end_with_a_full_stop(tmp_path):
    for unit in ("mm.", "thou."):
        lifts = lift(ANGLES) / (0.0254 if unit == "thou." else 1.0)
        table = read(tmp_path, f"angle [deg.]; lift [{unit}]", lifts=lifts, row="{0:g}; {1:.9f}")
        assert table.lift.max() == pytest.approx(8e-3, rel=1e-7)


@pytest.mark.parametrize("name", ["shaft angle", "distributor angle", "albero", "AàC", "angle 2"])
def test_angles_of_an_unknown_shaft_are_said_to_be_taken_as_the_cams(tmp_path, name):
    (note,) = read(tmp_path, f"{name} [deg], lift [mm]").notes
    assert note.startswith(f"column 1, '{name} [deg]': names neither cam nor crank; taken as cam angles")
    assert not read(tmp_path, "Drehwinkel phi [deg], lift [mm]").notes


@pytest.mark.parametrize(
    ("step", "decimals", "said"),
    [
        (0.0254, 5, "0.0254 mm (0.001 in)"), (0.0254, 3, "0.0254 mm (0.001 in)"),
        (0.0127, 4, "0.0127 mm (0.0005 in)"), (0.00254, 5, "0.00254 mm (0.0001 in)"),
        (0.02, 3, "0.02 mm"), (0.01, 2, "0.01 mm"),
    ],
)  # fmt: skip
def test_the_step_of_rounded_lifts_is_found_whatever_their_decimals(tmp_path, step, decimals, said):
    """Of gauges in inches, whose lifts were written in mm; rows each 4 deg are too few."""
    angles = np.arange(-90.0, 91.0, 4.0)
    lifts = np.round(lobe(angles) / step) * step
    table = read(tmp_path, row=f"{{0:g}}, {{1:.{decimals}f}}", angles=angles, lifts=lifts)
    assert table.rounding == pytest.approx(1e-3 * step, rel=1e-9)
    (doubt,) = table.list_doubts(smoothed := table.smooth())
    assert f"lifts in steps of {said} the" in doubt
    assert smoothed.resolution >= 0.999e-3 * step


def test_what_a_table_leaves_open_is_said(tmp_path):
    """A third column, angles of two turns, and an event that cams seldom have."""
    third = write(tmp_path / "c.csv", "angle [deg]; intake [mm]; exhaust [mm]", "{0:g}; {1:.4f}; 1")
    assert "column 3, 'exhaust': is ignored" in read_lift_table(third).notes[0]
    turns = 2.0 * np.arange(0.0, 360.0)
    wide = read(tmp_path, angles=turns, lifts=lobe(turns / 2.0 - 180.0))
    assert "crank angles" in wide.notes[0]
    assert math.degrees(wide.angle[-1]) == pytest.approx(359.0)
    event = np.arange(-132.0, 133.0, 2.0)
    assert "lifts over 2" in list_doubts(tmp_path, angles=event, lifts=lobe(event / 2.0))
    assert not list_doubts(tmp_path, "cam angle [deg], lift [mm]", angles=event, lifts=lobe(event / 2.0))
    assert "gon" in read(tmp_path, "angle [grad], lift [mm]").notes[0]


@pytest.mark.parametrize(("event", "ramps", "doubted"), [(150.0, 0.0, 0), (132.0, 25.0, 0), (200.0, 0.0, 1)])
def test_long_ramps_are_no_angles_of_the_crank(tmp_path, event, ramps, doubted):
    """An event of 150 deg of the cam is the longest that is usual, one of 200 deg of the crank the shortest.
    With ramps of 0.25 mm one of 132 deg lifts over 182 deg."""
    angles = np.arange(-180.0, 180.0)
    slow = np.clip(1.0 + (0.5 * event - np.abs(angles)) / ramps, 0.0, 1.0) if ramps else 0.0
    lifts = lobe(2.0 * RISE / event * angles) + 0.25 * slow
    assert ("crank" in list_doubts(tmp_path, angles=angles, lifts=lifts)) == doubted


@pytest.mark.parametrize("phase", [0.0, 90.0, 200.0])
def test_runout_of_the_base_circle_is_no_lift(tmp_path, phase):
    """15 um of eccentricity: the event is that of the lobe, within the height from which it counts."""
    angles = np.arange(0.0, 360.0)
    lifts = lobe((angles + 180.0) % 360.0 - 180.0) + 0.015 * np.cos(np.radians(angles - phase))
    doubts = list_doubts(tmp_path, row="{0:g}, {1:.3f}", angles=angles, lifts=lifts)
    assert "its base circle has a runout" in doubts
    assert "crank" not in doubts
    begin, end = read_lift_table(tmp_path / "cam.csv").smooth().event
    assert 110.0 < math.degrees(end - begin) < 130.0


@pytest.mark.parametrize("velocity", [0.008, 0.025])
def test_a_ramp_of_the_table_is_found_and_doubted_beside_another(tmp_path, velocity):
    """0.25 mm at so many mm/deg before both feet of the lobe, whose steepest rise is 0.32 mm/deg."""
    angles = np.arange(-180.0, 180.0)
    own = 0.25 - velocity * np.clip(np.abs(angles) - RISE + 0.25 / velocity / 3.0, 0.0, 0.25 / velocity)
    smoothed = (table := read(tmp_path, "cam angle, lift", angles=angles, lifts=lobe(angles) + own)).smooth()
    # It is found up to where the spline bends into the lobe: 73 and 77 % of it, by rows of a degree.
    assert smoothed.ramp == pytest.approx(0.25e-3, rel=0.4)
    added = "to which `ramp_height` adds 0.2 mm: set ramp_height = 0"
    assert added in " ".join(table.list_doubts(smoothed, 2e-4))
    assert added not in " ".join(table.list_doubts(smoothed))
    file = write_scenario(tmp_path, '[components.camshaft.parameters]\nramp_height = "0.2 mm"\n')
    assert added in " ".join(list_warnings(load(file)))
    for lobe_alone in (read(tmp_path, angles=angles, lifts=lobe(angles)), read(tmp_path)):
        assert not lobe_alone.list_doubts(lobe_alone.smooth(), 2e-4)


def test_a_run_repeats_beside_its_verdict_what_is_doubted_of_its_table(tmp_path, capsys):
    write(tmp_path / "cam.csv", lifts=lift(ANGLES) - 0.1 * (np.abs(ANGLES - 150.0) < 0.1))
    notices = list_warnings(load(write_scenario(tmp_path)))
    (doubt,) = [line for line in notices if line.startswith("warning: components.camshaft: the row at 150")]
    summary = Summary("x", "", "", {}, 1e-5, True, {}, complete=True, verdict="within", notices=notices)
    _print_end(summary, tmp_path, [], Reporter())
    told = " ".join(capsys.readouterr().out.split())
    assert told.index("x: within") < told.index("warning: components.camshaft: doubted as said above")
    assert not any(line in told for line in notices), doubt


def test_a_table_that_ends_above_the_base_circle_is_refused(tmp_path):
    with pytest.raises(AngleTableError, match="base circle"):
        read(tmp_path, angles=np.arange(120.0, 240.0)).smooth()


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
    replaced = load(write_scenario(tmp_path, base="seat-and-lash")).components["camshaft"].parameters
    assert "ramp_height" not in replaced  # of the law's ramps
    file = write_scenario(tmp_path, "[components.finger.parameters]\ncolour = 3\n", *finger)
    with pytest.raises(
        ScenarioError, match=r"known: base_radius, smooth, table_angle\[1\.\.360\], .*mass_arm"
    ):
        load(file)


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
