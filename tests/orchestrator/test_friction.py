"""Friction and wear over a cam revolution: sums against closed forms, and the command."""

import csv
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg

from models.core.remedies import find_actions
from orchestrator.assessment.friction import judge
from orchestrator.assessment.friction.cycle import OF_CAM, OF_CONTACT, Cycle, last_revolution, summarise, wear
from orchestrator.assessment.friction.judge import (
    find_sliding,
    judge_friction,
    judge_losses,
    measure_others,
)
from orchestrator.assessment.friction.losses import (
    BEARING,
    BORE,
    CONTACT,
    GUIDE,
    PIN,
    PIVOT,
    ROLLING,
    SLIP,
    TIP,
    list_losses,
)  # fmt: skip
from orchestrator.assessment.friction.remarks import list_soft, remark_friction, remark_soft
from orchestrator.assessment.friction.report import WORN, Judged, remarks, tables, tabulate_others
from orchestrator.assessment.motion import Motion
from orchestrator.errors import MistakeError, Option, in_command_line
from orchestrator.plots.friction import draw_friction
from orchestrator.plots.style import RC
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from tribocosim.command_line.results import name_file

from .commands import called, said

SPEED, RADIUS, LENGTH = 100.0, 0.02, 12e-3


def eccentric(turns: float = 1.5, count: int = 3001) -> Cycle:
    """A round cam out of its centre, e = 5 mm: s = e (1 - cos psi), under a load of 400 N, mu = 0.05."""
    time = np.linspace(0.0, turns * 2.0 * math.pi / SPEED, count)
    angle = SPEED * time
    lift, slope = 5e-3 * (1.0 - np.cos(angle)), 5e-3 * np.sin(angle)
    one = np.ones_like(time)
    values = {
        "load": 400.0 * one,
        "asperity_load": 40.0 * one,
        "friction_force": 20.0 * one,
        "viscous_friction": 16.0 * one,
        "boundary_friction": 4.0 * one,
        "half_width": 1e-4 * one,
        "film_ratio": 2.0 + np.cos(angle),
        "cam_angle": angle,
        "cam_speed": SPEED * one,
        "sliding_velocity": SPEED * (RADIUS + lift),
        "cam_sliding": SPEED * (RADIUS + lift),
        "entraining_velocity": SPEED * (0.5 * (RADIUS + lift) + 5e-3 * np.cos(angle)),
        "radius_of_curvature": RADIUS + lift + 5e-3 * np.cos(angle),
        "contact_offset": slope,
        "cam_lift": lift,
    }
    assert set(values) == {*OF_CONTACT, *OF_CAM}
    return last_revolution("contact", time, values)


def test_torque_and_work_are_closed_forms():
    """F (R0 + s), of which the mean over a turn is F (R0 + e)."""
    cycle = eccentric()
    assert cycle["cam_angle"][-1] - cycle["cam_angle"][0] == pytest.approx(2.0 * math.pi, rel=1e-14)
    s = summarise(cycle)
    # The trapezoidal rule over a period, 2000 records, one interval of it cut: h^2.
    assert s["mean_torque"] == pytest.approx(20.0 * (RADIUS + 5e-3), rel=1e-6)
    assert s["work"] == pytest.approx(2.0 * math.pi * s["mean_torque"], rel=1e-14)
    assert s["mean_power"] == pytest.approx(SPEED * s["mean_torque"], rel=1e-12)
    assert s["largest_torque"] == pytest.approx(20.0 * (RADIUS + 10e-3), rel=1e-6)
    assert s["coefficient"] == pytest.approx(0.05, rel=1e-12)
    assert s["boundary_share"] == pytest.approx(0.2, rel=1e-12)
    assert s["asperity_share"] == pytest.approx(0.1, rel=1e-12)
    assert s["least_film_ratio"] == pytest.approx(1.0, abs=1e-5)


def test_both_bodies_lose_the_volume_of_archards_law():
    cycle, k = eccentric(), 1e-17
    worn = wear(cycle, "load", k, LENGTH)
    # Sliding distance of a turn: 2 pi (R0 + e).
    assert worn.volume == pytest.approx(k * 400.0 * 2.0 * math.pi * (RADIUS + 5e-3), rel=1e-6)
    bins = worn.follower_place[1] - worn.follower_place[0]
    assert worn.follower_depth.sum() * bins * LENGTH == pytest.approx(worn.volume, rel=1e-12)
    # A circle: the arc over the angle is the radius, R0 + e.
    arc = (RADIUS + 5e-3) * 2.0 * math.pi / len(worn.cam_angle)
    assert worn.cam_depth.sum() * arc * LENGTH == pytest.approx(worn.volume, rel=1e-6)


def test_the_cam_wears_by_load_over_length_and_the_ratio_of_speeds():
    """The contact passes the cam at rho omega: k (W/L) (R0 + s)/rho."""
    worn = wear(eccentric(), "load", 1e-17, LENGTH)
    lift = 5e-3 * (1.0 - np.cos(worn.cam_angle))
    expected = 1e-17 * 400.0 / LENGTH * (RADIUS + lift) / (RADIUS + 5e-3)
    # Bins of 8.7 mrad see records 3.1 mrad apart with a width of 4 mrad.
    assert worn.cam_depth == pytest.approx(expected, rel=0.1)
    assert worn.cam_depth.mean() == pytest.approx(expected.mean(), rel=1e-6)


def test_a_tappet_whose_spin_halves_the_sliding_wears_its_cam_half_as_deep():
    """The contact passes the cam as before."""
    cycle = eccentric()
    slow = replace(cycle, values={**cycle.values, "sliding_velocity": 0.5 * cycle["sliding_velocity"]})
    half, whole = (wear(one, "load", 1e-17, LENGTH).cam_depth for one in (slow, cycle))
    np.testing.assert_allclose(half, 0.5 * whole, rtol=1e-12)


def test_the_cam_of_an_arc_wears_by_its_arc_length():
    """A pad on a round cam out of its centre: C of the cam moves about the pad's centre. The arc length per
    cam angle is R times the turn of the line of centres in the cam, by differences of its direction."""
    cycle, pad, e = eccentric(), 30e-3, 5e-3
    angle = np.linspace(0.0, 2.0 * math.pi, 20001)
    # The pad's centre is at height y above the axis of the cam, whose own centre is e from it.
    height = e * np.sin(angle) + np.sqrt((RADIUS + pad) ** 2 - (e * np.cos(angle)) ** 2)
    turned = np.unwrap(np.arctan2(height - e * np.sin(angle), -e * np.cos(angle))) - angle
    arc = RADIUS * np.abs(np.gradient(turned, angle))
    sliding = cycle["sliding_velocity"]
    moved = np.interp(np.mod(cycle["cam_angle"], 2.0 * math.pi), angle, arc) * SPEED
    values = {
        **cycle.values,
        "entraining_velocity": moved - 0.5 * sliding,
        "radius_of_curvature": np.full_like(sliding, RADIUS),
    }
    worn = wear(replace(cycle, values=values), "load", 1e-17, LENGTH)
    per_angle = np.interp(worn.cam_angle, angle, arc)
    lift = 5e-3 * (1.0 - np.cos(worn.cam_angle))
    expected = 1e-17 * 400.0 / LENGTH * (RADIUS + lift) / per_angle
    # As above: bins and records.
    assert worn.cam_depth == pytest.approx(expected, rel=0.1)
    # The volume over the arc length is Archard's.
    bins = per_angle * (worn.cam_angle[1] - worn.cam_angle[0])
    assert float(worn.cam_depth @ bins) * LENGTH == pytest.approx(worn.volume, rel=1e-4)


def test_a_result_without_a_revolution_is_refused_with_the_stop_time_that_would_do():
    with pytest.raises(MistakeError, match=r"stop_time.* 0\.06283 s"):
        eccentric(turns=0.9)


def test_a_run_that_lacks_a_degree_of_the_base_circle_is_a_revolution():
    """The scenario valve-train-bounce covers 359.04 degrees. Means are over what there is."""
    cycle = eccentric(turns=359.04 / 360.0)
    assert math.degrees(cycle.turned) == pytest.approx(359.04)
    assert summarise(cycle)["mean_torque"] == pytest.approx(20.0 * (RADIUS + 5e-3), rel=1e-3)
    (line,) = remarks(judged(cycle))
    assert "359" in line


def judged(cycle: Cycle, cycles: float = 1.0) -> Judged:
    return Judged(cycle, wear(cycle, "asperity_load", 1e-17, LENGTH), 1e-17, cycles, roughness=0.2e-6)


def test_a_follower_off_its_cam_is_remarked_and_has_no_film():
    cycle = eccentric()
    off = cycle["cam_angle"] - cycle["cam_angle"][0] > 1.5 * math.pi
    load = np.where(off, 0.0, cycle["load"])
    # Without load a film is a number of the formula alone; here it would be the least.
    ratio = np.where(off, 0.1, cycle["film_ratio"])
    found = judged(replace(cycle, values={**cycle.values, "load": load, "film_ratio": ratio}))
    assert found.summary["lost"] == pytest.approx(0.25, abs=1e-3)
    assert found.summary["least_film_ratio"] >= 1.0
    (line,) = remarks(found)
    assert "25" in line


def test_wear_that_takes_the_profile_away_is_remarked_with_the_revolutions_that_hold():
    once = judged(eccentric())
    most = WORN * 10e-3 / max(once.deepest)  # of the lift
    assert not list(remarks(judged(eccentric(), 0.99 * most)))
    (line,) = remarks(judged(eccentric(), 2.0 * most))
    assert find_actions(line) == (Option("cycles", f"{most:.1g}"),)


def test_printed_numbers_are_quotients_of_one_another():
    """The ratio is that of the printed film to the printed roughness, the power that of work and time."""
    (table,) = tables([judged(eccentric())])
    words, units, values = ([*column.cells] for column in table.columns)
    shown = dict(zip(words, values, strict=True))
    film, roughness = float(shown["least film of the oil under load"]), float(shown["roughness"])
    assert float(shown["least film of the oil under load over the roughness"]) == pytest.approx(
        film / roughness, rel=6e-3
    )
    work, torque = float(shown["friction work"]), float(shown["mean friction torque"])
    assert work == pytest.approx(2.0 * math.pi * torque, rel=1e-3)
    assert units[words.index("roughness")] == "µm"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A little more than a revolution at 1000 r/min, recorded coarsely."""
    out = tmp_path_factory.mktemp("friction") / "out"
    scenario = load(
        "valve-train",
        [
            *("stop_time=62 ms", "macro_step=20 us", "output_step=100 us", "reference.enabled=false"),
            *(f"components.{name}.participant=in-process" for name in load("valve-train").components),
        ],
    )
    run(scenario, out, lambda name, structure, kind: Path(), Reporter(), figures=False)
    return out


def said_by(folder, *options):
    """What the command prints, or its one message."""
    done = called("friction", str(folder), *map(str, options))
    return done.stdout if done.returncode == 0 else said(done)


def test_the_command_says_what_the_table_holds(folder, tmp_path):
    table, figure = tmp_path / "friction.nc", tmp_path / "friction.png"
    text = said_by(folder, "--table", table, "--figure", figure)
    assert figure.stat().st_size > 10_000
    with xarray.open_dataset(table, engine="h5netcdf") as found:
        assert f"{float(found.mean_torque):.4g}" in text
        # Energy: the torque over the angle is the power over the time.
        work = float(np.trapezoid(found.friction_torque, found.cam_angle))
        assert work == pytest.approx(float(found.work), rel=1e-6)
        assert 0.0 < float(found.mean_torque) <= float(found.largest_torque)
        assert (found.friction_force == found.viscous_friction + found.boundary_friction).all()
        assert found.cam_wear.attrs["units"] == "m"
    assert "all revolutions: 1e+08" in text


def test_tables_hold_the_same_as_csv_and_in_print(folder, tmp_path):
    said_by(folder, "--table", tmp_path / "f.nc")
    assert "f-cam-wear.csv" in said_by(folder, "--table", tmp_path / "f.csv")
    with xarray.open_dataset(tmp_path / "f.nc", engine="h5netcdf") as table:
        held = json.loads(said_by(folder, "--json"))["contact"]
        assert held["data_vars"]["mean_torque"]["data"] == float(table.mean_torque)
        assert held["data_vars"]["load"]["attrs"]["units"] == "N"
        for name, columns in (("f", ["load [N]"]), ("f-cam-wear", ["cam_wear [m]"])):
            rows = list(csv.DictReader((tmp_path / f"{name}.csv").read_text().splitlines()))
            for column in columns:
                values = table[column.split(" ")[0]].values
                np.testing.assert_array_equal([float(row[column]) for row in rows], values)


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--contact", "valve"),
        ("--wear-coefficient", "-1"),
        ("--cycles", "0"),
        ("--table", "a.txt"),
        ("--figure", "a.jpg"),
    ],
)
def test_mistakes_name_the_option(folder, option, value):
    assert f"{option} {value}" in said_by(folder, option, value)


def test_a_run_that_broke_off_before_a_revolution_is_to_be_resumed(folder, monkeypatch):
    def read_half(folder, wanted, read=judge._read):
        time, columns, units = read(folder, wanted)
        return time[:300], {name: column[:300] for name, column in columns.items()}, units

    monkeypatch.setattr(judge, "_read", read_half)
    with pytest.raises(MistakeError, match="must be a revolution; ") as caught:
        judge_friction(folder, None, 1e-17, 1.0)
    assert in_command_line(caught.value).endswith(f"tribocosim resume {folder}")


def test_each_of_several_contacts_has_a_file_of_its_own():
    assert name_file(Path("a/f.csv"), "second", True) == Path("a/f-second.csv")
    assert name_file(Path("a/f.csv"), "second", False) == Path("a/f.csv")


@pytest.mark.parametrize(
    ("scenario", "cams"),
    [
        ("slider-crank", {}),
        ("pushrod-train", {"cam_contact": "tappet"}),
        ("finger-follower-hla", {"cam_contact": "finger"}),
        ("bucket-friction", {"contact": "tappet"}),
        ("pushrod-engine", {f"cam_contact_{k}": f"tappet_{k}" for k in range(1, 9)}),
    ],
)
def test_contacts_under_cams_are_found(scenario: str, cams: dict[str, str]) -> None:
    """Not those of levers on valves."""
    assert find_sliding(build_system(load(scenario))) == cams


@pytest.mark.parametrize(
    ("scenario", "rubbing"),
    [("valve-train", 0.0), ("roller-friction", math.nan), ("finger-follower", 10.0), ("engine", 10.0)],
)
def test_contacts_elsewhere_than_under_a_cam_are_listed(scenario: str, rubbing: float) -> None:
    """400 N, of which asperities bear 40 N, slide by 0.5 m/s for 0.1 s under 20 N of friction: 10 W, 0.05,
    2 J of asperities' load times distance. The friction of a tip whose pad has it is not the contact's."""
    system, times = build_system(load(scenario)), np.linspace(0.0, 0.1, 11)
    values = {"load": 400.0, "asperity_load": 40.0, "friction_force": 20.0, "film_ratio": 0.025}

    def read(name: str) -> np.ndarray:
        variable = name.partition(".")[2]
        if "angle" in variable:
            return 62.8318530718 * times
        return np.full(times.size, values.get(variable, 0.5))

    found = measure_others(Motion(system, times, read, None), 1e-17)
    if not rubbing:
        assert not found
        return
    assert set(found) == ({"upper_wall", "lower_wall"} if scenario == "engine" else {"valve_contact"})
    for numbers in found.values():
        expected = [rubbing, rubbing / 200.0, 0.1, 0.025, 2e-17]
        assert list(numbers.values()) == pytest.approx(expected, nan_ok=True)
    cells = [*zip(*(column.cells for column in tabulate_others(found, 1e8).columns), strict=True)]
    powers = ("", "") if math.isnan(rubbing) else ("10", "0.05")
    assert cells == [(name, *powers, "10", "0.025", "2") for name in found]


def test_soft_default_asperities_are_said_where_the_film_is_thinner_than_the_roughness() -> None:
    """Those that a scenario gives are its own. Smooth or dry surfaces have a ratio of 0."""
    own = ["components.valve_contact.parameters.asperity_slope=0.01"]
    thin = {"cam_contact": 0.28, "valve_contact": 0.025}
    assert list_soft(build_system(load("finger-follower")), thin | {"cam_contact": 1.1}) == ["valve_contact"]
    (said,) = remark_soft(list_soft(build_system(load("finger-follower", own)), thin))
    assert said.startswith("cam_contact: ")
    assert "set roughness_parameter and asperity_slope" in said
    assert not list_soft(build_system(load("finger-follower")), dict.fromkeys(thin, 0.0))
    assert not list(remark_soft([]))


def test_torques_and_powers_say_what_they_leave_out_and_whose_asperities_are_soft() -> None:
    """By the least film ratio of all values: 0.98, or none that is below 1. Nothing without friction."""
    system, name = build_system(load("valve-train")), "contact.least_film_ratio"
    outside, soft = remark_friction(system, {name: np.array([np.nan, 1.2, 0.98]), "contact.load": 0.1})
    assert outside.startswith("friction outside the motion")
    assert soft.startswith("contact: the film is thinner than the roughness")
    assert list(remark_friction(system, {name: 1.0})) == list(remark_friction(system, {})) == [outside]


@pytest.mark.parametrize(
    ("scenario", "shares"),
    [
        ("valve-train", {CONTACT: "contact"}),
        ("roller-slip", {SLIP: "roller", PIN: "pin", TIP: "valve_contact"}),
        ("rocker-friction", {CONTACT: "cam_contact", PIVOT: "pivot", TIP: "pad"}),
        ("finger-follower", {CONTACT: "cam_contact", TIP: "valve_contact"}),
        ("bucket-friction", {CONTACT: "contact", BORE: "spin bore", BEARING: "bearing_1 bearing_2"}),
        ("roller-friction", {SLIP: "roller", PIN: "pin", TIP: "pad", GUIDE: "guide"}),
    ],
)
def test_losses_are_named_by_what_their_part_does(scenario: str, shares: dict[str, str]) -> None:
    """A roller's traction takes the place of the contact's friction, a pad's friction that of its own."""
    found = list_losses(build_system(load(scenario)))
    named = {(loss.part, loss.share) for loss in found if loss.share != ROLLING}
    assert named == {(part, share) for share, parts in shares.items() for part in parts.split()}
    assert [loss.part for loss in found if loss.share == ROLLING] in (["contact"], ["cam_contact"])


def test_the_shares_are_the_work_of_their_parts(folder: Path) -> None:
    """On the drive, powers over its speed: of the one contact as the table of contacts has it."""
    losses, _ = judge_losses(folder, load(folder / "scenario.toml"))
    _, (contact,) = judge_friction(folder, None, 1e-17, 1.0)
    # The turn begins at a record; the contact's cycle at the angle, up to one record of 600 earlier.
    assert losses.shares[CONTACT] == pytest.approx(contact.summary["mean_power"], rel=1e-2)
    assert losses.total == losses.shares[CONTACT] + losses.shares[ROLLING]
    assert f"{losses.total / losses.speed:.4g}" in said_by(folder)
    assert "friction outside the motion: cam contact (contact), rolling (contact)" in said_by(folder)


def test_long_labels_stay_inside_the_figure() -> None:
    """Those of wear have three lines, in line with labels beside longer numbers."""
    cycle = eccentric()
    force = 4e-4 * cycle["friction_force"]
    cycle = replace(cycle, values={**cycle.values, "friction_force": force})
    with rc_context(RC):
        figure = draw_friction(cycle, wear(cycle, "load", 1e-17, LENGTH), 1e8, "train")
        FigureCanvasAgg(figure).draw()
        assert all(ax.yaxis.label.get_window_extent().x0 >= 0.0 for ax in figure.axes)
