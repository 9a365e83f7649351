"""tribocosim wear: closed form of a circular cam, what a cycle wears off, continuation, refusals."""

import csv
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import tribocosim
from models.core.quantities import Vector
from models.core.remedies import find_actions
from models.monolithic.cycle import Cycle
from models.valve_train.cams.table import TURN
from models.valve_train.worn_cam import PLACES, SPACING, sample_cam, smooth
from orchestrator.errors import MistakeError, Option
from orchestrator.scenario import build_scenario
from orchestrator.scenario.cams import read_cam
from orchestrator.scenario.files import load, read_changed
from orchestrator.scenario.system import build_system
from orchestrator.study.wear.history import Age, History, follow
from orchestrator.study.wear.report import Interval, remark, to_text
from orchestrator.study.wear.run import parse_asked, parse_interval
from orchestrator.study.wear.train import CAM, FOLLOWER, LOSS, Rubbed, WearingTrain, open_train, put_points
from tribocosim.reporting import SilentReporter

from .commands import called, said

RADIUS, ECCENTRICITY, LENGTH = 25e-3, 5e-3, 12e-3
PRELOAD, DEPTH = 330.0, 0.3e-3


def list_settings(folder: Path) -> list[str]:
    """A round cam out of its centre, slow, dry and smooth, under a soft spring: a load of 330 to 332 N."""
    rows = (f"{a}, {1e3 * ECCENTRICITY * (1.0 - math.cos(math.radians(a))):.7f}\n" for a in range(360))
    table = folder / "circle.csv"
    table.write_text("cam angle [deg], lift [mm]\n" + "".join(rows))
    return [
        f"components.camshaft.lift_table={table}",
        "components.camshaft.parameters.base_radius=20 mm",
        "components.flywheel.parameters.initial_speed=200 rpm",
        "components.valve_spring.parameters.spring_rate=100 N/m",
        "components.contact.parameters.roughness=0.0",
        "components.contact.parameters.film_model=dry",
    ]


@pytest.fixture(scope="module")
def circle(tmp_path_factory: pytest.TempPathFactory) -> WearingTrain:
    settings = list_settings(tmp_path_factory.mktemp("circle"))
    return open_train(read_changed("valve-train", settings), None, None, DEPTH)


@pytest.fixture(scope="module")
def worn(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[str], str]:
    """The command's arguments, and what it prints."""
    folder = tmp_path_factory.mktemp("worn")
    changed = [word for text in list_settings(folder) for word in ("--set", text)]
    arguments = ["wear", "valve-train", *changed, "--until", "0.3 mm", "--tolerance", "0.05", "--out",
                 str(folder / "out")]  # fmt: skip
    done = called(*arguments)
    assert done.returncode == 0, done.stderr
    return arguments, done.stdout


def test_a_circular_cam_wears_as_its_closed_form(circle: WearingTrain, record: Callable[..., None]) -> None:
    """k (W/L) p/rho a cycle, with p = R0 + s = R - e cos psi and rho = R. Spring and inertia change the load
    by 0.2 %, the filter of 5.9 deg takes 0.5 % of the wave, e/R of the depth."""
    found = circle.rub(circle.unworn)
    closed = PRELOAD / LENGTH * (RADIUS - ECCENTRICITY * np.cos(PLACES)) / RADIUS
    words = "circular cam: wear of a cycle over the wear coefficient, over the cam (N/m)"
    record("Contact", words, found.rate[CAM], closed, "k W (R - e cos psi)/(L R)", relative=5e-3)
    assert found.distance == pytest.approx(TURN * RADIUS, rel=1e-6)


def test_both_bodies_lose_load_times_sliding_distance(circle: WearingTrain) -> None:
    """Depth times arc times length, of the cam as the filter sees its arc."""
    found = circle.rub(circle.unworn)
    arc = smooth(circle.fresh.arc, circle.filter)
    assert float(found.rate[CAM] @ arc) * SPACING * LENGTH == pytest.approx(found.work, rel=1e-5)
    along = np.diff(circle.along)
    assert float(found.follower @ along) * LENGTH == pytest.approx(found.work, rel=1e-12)


def test_a_worn_follower_lowers_itself(circle: WearingTrain) -> None:
    """What wears off it is the same with its filter; an even depth is lost lift, everywhere the same."""
    both = replace(circle, follower_wears=True)
    found = both.rub(both.unworn)
    volume = float(found.rate[FOLLOWER] @ np.diff(both.along)) * LENGTH
    # Beyond four standard deviations the Gaussian has 6e-5.
    assert volume == pytest.approx(found.work, rel=1e-4)
    state = np.zeros((3, PLACES.size))
    state[LOSS] = 1e-4 * np.cos(PLACES)
    np.testing.assert_array_equal(both.lose(state), state[LOSS])
    state[FOLLOWER] = 2e-5
    # The overlap's derivative by the lift is a difference over 1e-7 m, of positions of 0.02 m.
    np.testing.assert_allclose(both.lose(state), state[LOSS] + 2e-5, atol=1e-14)
    # On the left of the follower only: where the cam touches it so.
    state[FOLLOWER] = np.where(both.along[1:] < 0.0, 2e-5, 0.0)
    lost = both.lose(state) - state[LOSS]
    assert lost[180] == pytest.approx(0.0, abs=1e-12)
    assert lost[540] == pytest.approx(2e-5, rel=1e-6)


def test_a_worn_circle_is_the_smaller_circle(
    worn: tuple[list[str], str], record: Callable[..., None]
) -> None:
    """It shrinks about the cam's axis: after the dose X by w X p/R, w = W/L, also with the worn cam in the
    motion. Each body loses k W times the distance 2 pi R (1 - w X/2R)."""
    arguments, text = worn
    with xarray.open_dataset(Path(arguments[-1]) / "wear.nc", engine="h5netcdf") as found:
        dose, line_load = found["dose"].values, PRELOAD / LENGTH
        closed = line_load * dose[-1] * (RADIUS - ECCENTRICITY * np.cos(PLACES)) / RADIUS
        words, depth = "circular cam worn by 0.3 mm: depth over the cam (m)", found["depth"].values[-1]
        record("Contact", words, depth, closed, "W X (R - e cos psi)/(L R)", relative=1e-2)
        assert float(found["deepest"][-1]) == pytest.approx(DEPTH, rel=1e-9)
        # Most at the nose, by p/R = 1.2.
        assert dose[-1] == pytest.approx(DEPTH / (1.2 * line_load), rel=1e-2)
        assert found.attrs["simulated_cycles"] <= 50
        assert found.attrs["error"] <= 0.05 * DEPTH
        shrunk = 1.0 - 0.5 * line_load * dose[-1] / RADIUS
        volume = PRELOAD * dose[-1] * TURN * RADIUS * shrunk
        assert float(found["volume"][-1]) == pytest.approx(volume, rel=5e-3)
        # Both ends of the interval of coefficients, 1e-18 to 1e-16 m2/N.
        assert float(found["most_cycles"][-1] / found["fewest_cycles"][-1]) == pytest.approx(100.0, rel=1e-12)
        assert float(found["fewest_cycles"][-1]) * 1e-16 == pytest.approx(dose[-1], rel=1e-12)
        low, high = (to_text(float(found[name][-1])) for name in ("fewest_cycles", "most_cycles"))
    answer = next(line for line in text.splitlines() if " after " in line)
    assert answer.startswith(f"0.3 mm at the nose after {low} to {high} cycles")
    assert "200 r/min of the cam" in answer


def test_the_worn_lift_is_a_table_that_scenarios_read(worn: tuple[list[str], str]) -> None:
    folder = Path(worn[0][-1])
    with xarray.open_dataset(folder / "wear.nc", engine="h5netcdf") as found:
        loss = found["loss"].values[-1]
    cam = read_cam(load("valve-train", [
        f"components.camshaft.lift_table={folder / 'worn-cam.csv'}",
        "components.camshaft.parameters.base_radius=20 mm",
    ]).components["camshaft"])  # fmt: skip
    read = np.array([cam.lift(angle).s for angle in PLACES])
    # The table has seven digits of a millimetre.
    np.testing.assert_allclose(read, ECCENTRICITY * (1.0 - np.cos(PLACES)) - loss, atol=2e-9)
    rows = list(csv.DictReader((folder / "wear.csv").read_text("utf-8").splitlines()))
    assert float(rows[-1]["deepest [m]"]) == pytest.approx(DEPTH, rel=1e-9)
    assert (folder / "wear.png").stat().st_size > 10_000


def test_the_same_command_keeps_the_cycles_of_the_history(worn: tuple[list[str], str]) -> None:
    arguments, text = worn
    folder = Path(arguments[-1])
    assert "already holds a result" in said(called(*arguments))
    before = {file.name: file.stat().st_mtime_ns for file in (folder / "cycles").iterdir()}
    for name in ("wear.nc", "wear.csv", "wear.png", "wear.html", "worn-cam.csv"):
        (folder / name).unlink()  # as after an interruption
    again = called(*arguments)
    assert "spring_rate = 100 N/m" in (folder / "wear.html").read_text("utf-8")
    passing = ("% done", "compiling")  # as the machine is fast, and has kernels
    first = [line for line in text.splitlines() if not any(word in line for word in passing)]
    assert again.stdout.splitlines()[1:] == first[1:]
    assert {file.name: file.stat().st_mtime_ns for file in (folder / "cycles").iterdir()} == before


def test_a_worn_cam_is_not_replaced_by_what_wears_off_it(tmp_path: Path) -> None:
    settings = list_settings(tmp_path)
    table = (tmp_path / "circle.csv").rename(tmp_path / "worn-cam.csv")
    content = table.read_bytes()
    changed = [word for text in [f"components.camshaft.lift_table={table}", *settings[1:]]
               for word in ("--set", text)]  # fmt: skip
    done = called("wear", "valve-train", *changed, "--until", "0.3 mm", "--out", str(tmp_path))
    assert done.returncode == 2
    assert "already holds a result (worn-cam.csv)" in said(done)
    assert table.read_bytes() == content
    assert list(tmp_path.iterdir()) == [table]


def test_wear_that_stops_on_the_way_ends_the_history(
    circle: WearingTrain, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing wears once the lift has lost a third of the limit."""
    unworn, fresh = circle.unworn, circle.rub(circle.unworn)
    losses = [0.0]

    def simulate(_: WearingTrain, loss: Vector, start: Vector | None = None) -> Cycle:
        losses.append(float(loss.max()))
        return unworn

    def rub(_: WearingTrain, cycle: Cycle) -> Rubbed:
        return replace(fresh, rate=fresh.rate * (losses[-1] < DEPTH / 3.0))

    monkeypatch.setattr(WearingTrain, "simulate", simulate)
    monkeypatch.setattr(WearingTrain, "rub", rub)
    found = follow(circle, 0.05, tmp_path, SilentReporter())
    assert found.fault == "the worn cam's film carries all of the load"
    assert DEPTH / 3.0 <= found.ages[-1].deepest < DEPTH
    assert not found.ages[-1].rubbed.rate.any()


@pytest.mark.parametrize(("error", "exceeds"), [(0.0099, False), (0.0101, True)])
def test_an_error_above_the_tolerance_is_remarked(circle: WearingTrain, error: float, exceeds: bool) -> None:
    rubbed = circle.rub(circle.unworn)
    ages = [Age(dose, dose * rubbed.rate, dose * rubbed.follower, 0.0, rubbed) for dose in (0.0, 1e-9)]
    history = History(circle, ages, error * ages[-1].deepest, 4)
    words = " ".join(map(str, remark(history, Interval(1e-18, 1e-16), 0.01)))
    assert ("exceeds the tolerance of 1 %" in words) == exceeds
    assert "without wear in" not in words


def test_contacts_of_the_train_that_are_left_out_are_remarked(
    circle: WearingTrain, monkeypatch: pytest.MonkeyPatch
) -> None:
    finger = replace(circle, system=build_system(load("finger-follower")), contact="cam_contact")
    assert (circle.others, finger.others) == ([], ["valve_contact"])
    monkeypatch.setattr(WearingTrain, "others", finger.others)
    rubbed = circle.rub(circle.unworn)
    ages = [Age(dose, dose * rubbed.rate, dose * rubbed.follower, 0.0, rubbed) for dose in (0.0, 1e-9)]
    words = " ".join(map(str, remark(History(circle, ages, 0.0, 4), Interval(1e-18, 1e-16), 0.01)))
    assert "without wear in valve_contact: " in words


def test_the_points_of_a_law_are_the_law() -> None:
    """A scenario's cam with ramps, between its points too: the shortest wave of s'' has 72 of them."""
    cam = read_cam(load("seat-and-lash").components["camshaft"])
    fresh = sample_cam(cam)
    assert fresh.points.angle.size == PLACES.size
    tables = put_points(read_changed("seat-and-lash"), "camshaft", fresh)
    through = read_cam(build_scenario(tables).components["camshaft"])
    for angle in np.linspace(0.0, TURN, 1237):
        law, table = cam.lift(angle), through.lift(angle)
        assert table.s == pytest.approx(law.s, abs=1e-10)
        assert table.dds == pytest.approx(law.dds, abs=1e-5)


def test_without_wear_there_is_no_limit_and_cycles_scale_with_the_coefficient() -> None:
    assert Interval(0.0, 1e-17).cycles(1e-9) == (1e8, math.inf)
    once, twice = Interval(1e-18, 1e-16).cycles(1e-9), Interval(2e-18, 2e-16).cycles(1e-9)
    assert once == pytest.approx([2.0 * value for value in twice])


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        ({"until": "0.127"}, Option("until", "0.127 mm")),
        ({"until": "0.127 kg"}, Option("until")),
        ({"until": "-1 mm"}, Option("until")),
        ({"until": "1 mm", "tolerance": 0.0}, Option("tolerance", 0.0)),
        ({"until": "1 mm", "coefficient": "1e-16,1e-18"}, Option("wear_coefficient", "1e-16,1e-18")),
        ({"until": "1 mm", "coefficient": "0"}, Option("wear_coefficient", "0")),
        ({"until": "1 mm", "coefficient": "1 mm"}, Option("wear_coefficient", "1 mm")),
        ({"until": "1 mm", "speed": "1000 mm"}, Option("speed")),
    ],
)
def test_mistakes_name_the_option(arguments: dict[str, Any], option: Option) -> None:
    with pytest.raises(MistakeError) as caught:
        parse_asked(**arguments)
    assert option in find_actions(caught.value)


def test_a_call_from_python_takes_a_speed() -> None:
    with pytest.raises(MistakeError) as caught:
        tribocosim.wear("valve-train", speed="1000 mm")
    assert Option("speed") in find_actions(caught.value)


def test_a_coefficient_may_be_one_number_or_have_a_unit() -> None:
    assert parse_interval("1e-17") == Interval(1e-17, 1e-17)
    found = parse_interval("1e-9 mm3/(N*m), 1e-7 mm3/(N*m)")
    assert (found.low, found.high) == pytest.approx((1e-18, 1e-16))


@pytest.mark.long
def test_wear_where_the_film_reverses_needs_few_cycles(tmp_path: Path) -> None:
    """The direct train wears beside its reversals, where the film is thinnest; the worn cam moves them."""
    found = tribocosim.wear("valve-train", "0.127 mm", out=tmp_path / "out")
    assert found.attrs["simulated_cycles"] <= 50
    assert found.attrs["error"] <= 0.01 * 0.127e-3
    assert not found.attrs["fault"]
    fine = tribocosim.wear("valve-train", "0.127 mm", tolerance=0.002)
    change = float(found["dose"][-1] / fine["dose"][-1]) - 1.0
    # The estimate bounds what a finer tolerance changes.
    assert abs(change) <= found.attrs["error"] / 0.127e-3
