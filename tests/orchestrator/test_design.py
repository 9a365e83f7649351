"""tribocosim design: closed forms of optimal lifts, gradients, limits on a finer grid, files, refusals."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tribocosim
from models.core.quantities import Vector
from models.valve_train.cams.table import TURN
from models.valve_train.followers.mechanisms import Flat
from models.valve_train.worn_cam import PLACES
from orchestrator.assessment.motion import Motion
from orchestrator.assessment.trains import Angle
from orchestrator.errors import MistakeError
from orchestrator.scenario.cams import read_cam
from orchestrator.scenario.files import load, read_changed
from orchestrator.scenario.lift_table import format_lifts, read_lift_table
from orchestrator.scenario.system import list_parameters
from orchestrator.study.design.answers import Answer, Column
from orchestrator.study.design.brief import Limits, read_brief
from orchestrator.study.design.files import keep, read_kept
from orchestrator.study.design.limits import (
    Limit,
    Model,
    closing_limit,
    gap_limit,
    kinematic_limits,
    load_limit,
    pressure_limit,
)
from orchestrator.study.design.lobe import Lobe, find_event
from orchestrator.study.design.report import Check
from orchestrator.study.design.run import find_own_limits, find_own_separation, find_wanted, tabulate_best
from orchestrator.study.design.search import Search
from orchestrator.study.design.slp import Line, Optimum, Problem, maximise
from orchestrator.study.design.train import open_train
from orchestrator.study.design.wanted import Found, Wanted

from .commands import called, said


def build_lobe(scenario: str = "valve-train", count: int = 24) -> Lobe:
    kind = read_cam(load(scenario).components[{"valve-train": "camshaft"}.get(scenario, "finger")])
    return Lobe(kind, *find_event(kind, None), count)


def build_model(lobe: Lobe, limits: list[Limit], answers: Mapping[float, Answer] | None = None) -> Model:
    scale = np.full(lobe.count, 8e-3)
    area = Line("area", 0.0, lobe.bumps.areas, np.zeros(lobe.count))
    return Model(lobe, limits, answers or {}, lobe.start, lambda x: lobe.kind.geometry, scale, area)


def build_plain(count: int, up: float, down: float) -> Model:
    """Bounds of acceleration alone (m/rad2): on a base circle of a kilometre no cam undercuts."""
    lobe = build_lobe(count=count)
    sizes = {"largest_acceleration": up, "largest_deceleration": down}
    model = build_model(lobe, list(kinematic_limits(sizes, 1.0, 1e3)))
    return replace(model, geometry=lambda x: Flat(1e3))


def optimise(model: Model, start: Vector) -> Optimum:
    big = np.full(start.size, 1.0)
    return maximise(Problem(model.evaluate, start - big, start + big, model.scale), start)


def test_cycles_of_a_search_have_the_base_circle_of_the_scenario() -> None:
    """That of points has another default than that of the scenario's law."""
    train = open_train(read_changed("valve-train"), 12)
    of_cycles = list_parameters(train.subject.scenario)["camshaft.base_radius"]
    assert of_cycles == train.lobe.kind.geometry.base_radius


@pytest.mark.parametrize(("up", "down"), [(0.03, 0.03), (0.06, 0.02)])
def test_largest_area_under_bounds_of_acceleration_is_bang_bang(up: float, down: float) -> None:
    """Pontryagin: acceleration A outside, -D in the middle, over w = T A/(A + D); the area is
    (A (T^3 - w^3) - D w^3)/24. A cubic spline grows from zero to A over an interval h at each end, where
    acceleration counts most; that costs of the order of h/T, twice to three times of it."""
    errors = []
    for count in (12, 24):
        model = build_plain(count, up, down)
        span = model.lobe.end - model.lobe.begin
        width = span * up / (up + down)
        exact = (up * (span**3 - width**3) - down * width**3) / 24.0
        found = optimise(model, np.zeros(count))
        assert found.feasible
        errors.append(1.0 - found.local.objective / exact)
        # One per cent more of both bounds is one per cent of area: the lift is linear in them.
        gains = [one.gain for one in found.active]
        assert sum(gains) == pytest.approx(0.01 * found.local.objective, rel=1e-3)
    assert 0.0 < errors[1] < 0.6 * errors[0]
    assert errors[1] < 3.0 / 25.0


def test_rise_of_least_acceleration_is_two_parabolas() -> None:
    """The largest lift in the middle of an event of T under |s''| <= A is A T^2/16: parabolas of T/4."""
    model = build_plain(32, 1.0, 1.0)
    lobe, middle = model.lobe, np.zeros(32)
    span = lobe.end - lobe.begin
    height = lobe.bumps.at(np.array([0.5 * (lobe.begin + lobe.end)]))[0]

    def evaluate(x: Vector) -> Any:
        local = model.evaluate(x)
        return local._replace(objective=float(height @ x), gradient=height)

    big = np.full(lobe.count, 10.0)
    found = maximise(Problem(evaluate, middle - big, middle + big, np.full(lobe.count, 1.0)), middle)
    exact = span**2 / 16.0
    assert exact * (1.0 - 3.0 / 33.0) < found.local.objective < exact


def test_gradients_are_those_of_differences() -> None:
    """Of all limits, along a random direction; central differences of smooth functions are right to 1e-6."""
    lobe = build_lobe("finger-follower")
    random = np.random.default_rng(3)
    rows, speed = lobe.angles.size, 300.0
    answer = Answer(
        speed,
        {"c.load": Column(*random.uniform(200.0, 300.0, (2, rows)), np.zeros(rows))},
        {"c.load": random.normal(size=(rows, lobe.count)) * 1e4},
        None,  # type: ignore[arg-type]
    )
    train_limits = find_own_limits(open_train(read_changed("finger-follower"), 24), Limits(), speed)
    limits = [
        *kinematic_limits({**train_limits, "wheel_radius": 0.1, "largest_jerk": 1e6}, speed, 20e-3),
        closing_limit(lobe.ramps, 8e-3),
        load_limit("load", "c.load", speed, 20.0, 300.0, np.ones(rows, dtype=bool)),
        gap_limit("gap", "c.load", speed, 250.0),
        pressure_limit("pressure", "c.load", speed, 6e8, 1e15, 50.0),
    ]
    model = build_model(lobe, limits, {speed: answer})
    x = lobe.start
    direction = random.normal(size=lobe.count) * 1e-4
    here = model.evaluate(x)
    ahead, behind = (model.evaluate(x + side * 1e-4 * direction) for side in (1.0, -1.0))
    for one, after, before in zip(here.limits, ahead.limits, behind.limits, strict=True):
        differences = (after.excess - before.excess) / 2e-4
        found = one.gradient @ direction
        # Magnitudes have kinks where they are zero.
        smooth = np.abs(after.excess + before.excess - 2.0 * one.excess) < 1e-8 * np.abs(differences).max()
        assert smooth.mean() > 0.8
        np.testing.assert_allclose(found[smooth], differences[smooth], atol=1e-3 * np.abs(differences).max())


def test_limits_hold_between_the_angles_at_which_they_are_looked_at() -> None:
    """By another way: the analysis of the written table, on a grid four times as fine."""
    lobe = build_lobe()
    own = find_own_limits(open_train(read_changed("valve-train"), 24), Limits(), 300.0)
    sizes = {**own, "largest_jerk": 300.0**3 * 0.15}
    limits = [
        *kinematic_limits(sizes, 300.0, lobe.kind.geometry.base_radius),
        closing_limit(lobe.ramps, 8e-3),
    ]
    found = optimise(build_model(lobe, limits), lobe.start)
    assert found.feasible
    assert found.local.objective > 1.05 * float(lobe.bumps.areas @ lobe.start)
    fine = np.linspace(lobe.begin, lobe.end, 4 * lobe.angles.size)
    s, dds, ddds = (lobe.bumps.at(fine, nu) @ found.unknowns for nu in (0, 2, 3))
    radius = lobe.kind.geometry.base_radius + s + dds
    # A row of limits is an eighth of a knot's interval: a cubic's peak between rows is 1e-3 of it higher.
    assert s.max() < (1.0 + 1e-4) * sizes["largest_lift"]
    assert s.min() > -1e-5 * s.max()
    # One nose: a lift that only has a largest value dips there, with more area.
    assert dds[np.abs(fine - 0.5 * (lobe.begin + lobe.end)) < (lobe.end - lobe.begin) / 6.0].max() < 1e-5
    assert radius.min() > 0.99 * sizes["least_radius"]
    assert np.abs(ddds).max() * 300.0**3 < 1.01 * sizes["largest_jerk"]


def test_limits_that_contradict_are_named_with_the_least_violation() -> None:
    """A lift of 8 mm needs at least s'' = 16 L/T^2 over half a turn; half of it reaches half the lift."""
    lobe = build_lobe()
    span = lobe.end - lobe.begin
    sizes = {"largest_acceleration": 8.0 * 8e-3 / span**2, "largest_deceleration": 8.0 * 8e-3 / span**2}
    least = Limit("least lift", 8e-3, lambda q, size: np.array([1.0 - q.curve.s.max() / size]))
    model = build_model(lobe, [*kinematic_limits(sizes, 1.0, 20e-3)])

    def evaluate(x: Vector) -> Any:
        local = model.evaluate(x)
        s = lobe.curve(x).s
        top = int(np.argmax(s))
        row = local.limits[0]._replace(
            name=least.name,
            excess=np.array([1.0 - s[top] / 8e-3]),
            gradient=-lobe.matrices[0][top : top + 1] / 8e-3,
            by_limit=np.array([s[top] / 8e-3]),
        )
        return local._replace(limits=[*local.limits, row])

    big = np.full(lobe.count, 1.0)
    start = lobe.start
    found = maximise(Problem(evaluate, start - big, start + big, model.scale), start)
    assert not found.feasible
    assert sum(rows.violation for rows in found.local.limits) == pytest.approx(0.5, abs=0.05)


def test_a_written_lift_table_is_the_designed_lift(tmp_path: Path) -> None:
    """Rows of 1e-10 m, half a degree apart. The jerk jumps at the ends of the event: there s'' of the
    smooth spline is off by less than a tenth of the jump over a row, elsewhere by less."""
    lobe = build_lobe()
    points = lobe.points(lobe.start)
    file = tmp_path / "designed.csv"
    file.write_text(format_lifts(points), "utf-8")
    read = read_lift_table(file).smooth().points
    assert read.angle.size == PLACES.size
    np.testing.assert_allclose(read.lift, points.lift, atol=2e-9)
    jump = float(np.abs(lobe.curve(lobe.start).ddds[0])) * TURN / PLACES.size
    assert np.abs(read.curvature - points.curvature).max() < 0.1 * jump
    assert pytest.approx(float(read.angle[-1])) == TURN * 719 / 720


def test_a_search_goes_on_from_what_it_has_kept(tmp_path: Path) -> None:
    """Of the same brief alone; what is kept is a scenario that runs."""
    path = write_brief(tmp_path, 'scenario = "valve-train"\n[limits]\nleast_radius = "5 mm"')
    asked = read_brief(str(path), ["components.flywheel.parameters.initial_speed=1500 rpm"])
    train = open_train(asked.tables, 24)
    keep(tmp_path, asked, train, Found(train.lobe.start, 1.0, {}, 1.0))
    kept = read_kept(tmp_path, asked)
    assert kept is not None
    np.testing.assert_array_equal(kept, train.lobe.start)
    assert read_kept(tmp_path, read_brief("valve-train")) is None
    written = load(tmp_path / "designed.toml")
    assert list_parameters(written)["flywheel.initial_speed"] == pytest.approx(50.0 * math.pi)
    cam = read_cam(written.components["camshaft"])
    assert cam.lift(math.pi).s == pytest.approx(float(train.lobe.points(kept).lift[360]), abs=1e-9)
    assert cam.geometry.base_radius == train.lobe.kind.geometry.base_radius


def write_brief(folder: Path, text: str) -> Path:
    path = folder / "brief.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('scenario = "valve-tran"', "did you mean valve-train"),
        ("coeficients = 30", "did you mean coefficients"),
        ("coefficients = 60", "must be <= 40"),
        ('[limits]\nleast_radios = "4 mm"', "did you mean least_radius"),
        ('[limits]\nlargest_lift = "4 kg"', "limits.largest_lift"),
        ('[limits]\nlargest_lift = "-4 mm"', "must be > 0"),
        ('speeds = ["fast"]', "not a number with a unit"),
        ('[parameters]\n"camshaft.base_radios" = ["18 mm", "24 mm"]', "did you mean camshaft.base_radius"),
        ('[parameters]\n"camshaft.base_radius" = ["23 mm", "24 mm"]', "must be between them"),
        ('cam = "camshaf"', "did you mean camshaft"),
        ("speeds = [1600]", '1600: write the number with its unit, such as "1000 rpm"'),
        ("speeds = [[1]]", "write the number with its unit"),
        ('highest_speed = "4000"', "4000: write the number with its unit"),
        ("[limits]\nlargest_pressure_angle = 22", 'such as "22 deg"'),
        ('event = ["250 deg", "110 deg"]', "must end after its begin"),
        ('event = ["0 deg", "400 deg"]', "within a turn"),
        ('event = ["110 deg", 250]', 'such as "110 deg"'),
        ('[parameters]\n"flywheel.initial_speed" = ["500 rpm", "3000 rpm"]', "is the speed of the cycle"),
    ],
)
def test_mistakes_in_a_brief_are_named(tmp_path: Path, text: str, words: str) -> None:
    path = write_brief(tmp_path, text if "scenario" in text else f'scenario = "valve-train"\n{text}')
    asked = called("design", str(path), "--out", str(tmp_path / "out"))
    assert asked.returncode == 2
    assert words in said(asked)
    assert not (tmp_path / "out").exists()


def test_a_limit_without_unit_may_be_written_as_the_message_has_it() -> None:
    assert Limits.model_validate({"least_film_ratio": "0.8"}).least_film_ratio == 0.8


def test_a_cam_that_has_lost_contact_at_its_own_speed_gives_no_limit() -> None:
    class Lost:
        def is_lost(self, speed: float) -> bool:
            return speed > 100.0

    asked = read_brief("valve-train")
    with pytest.raises(MistakeError, match=r"lost contact at the scenario's own speed, 1909\.86 r/min"):
        find_own_separation(asked, Lost(), 200.0)  # type: ignore[arg-type]
    found = find_own_separation(asked, Lost(), 50.0)  # type: ignore[arg-type]
    assert found == pytest.approx(100.0, rel=2e-3)


def test_the_least_load_of_the_own_cam_is_that_while_it_lifts(tmp_path: Path) -> None:
    """A train with lash has none on the base circle, which is no limit."""
    brief = '[limits]\nseparation_speed = "3000 rpm"\nleast_load = "own"\nleast_film_ratio = "free"'
    asked = read_brief(str(write_brief(tmp_path, f'scenario = "valve-train"\n{brief}')))
    train = open_train(asked.tables, 24)
    times = np.linspace(0.0, 0.06, 361)
    angle = TURN * times / times[-1]
    lift = np.array([train.lobe.kind.lift(a).s for a in angle])
    columns = {
        "camshaft.angle": angle, "contact.load": np.where(lift > 0.0, 300.0 - 2e4 * lift, 0.0),
        "camshaft.cam_lift": lift,
    }  # fmt: skip

    class Cycles:
        def __getitem__(self, speed: float) -> Motion:
            found = {**columns, "contact.maximum_pressure": np.full(361, 5e8 - 1e5 * speed)}
            return Motion(train.finder.system, times, found.__getitem__, Angle("cam_angle", "camshaft.angle"))

        def is_lost(self, speed: float) -> bool:
            return False

    found = find_wanted(asked, train, Cycles(), None)  # type: ignore[arg-type]
    assert found.least_load == pytest.approx(300.0 - 2e4 * lift.max())
    # Down to idle, where the nose is pressed most.
    assert np.multiply([*found.idle, *found.speeds], 30.0 / math.pi) == pytest.approx([300.0, 1500.0])
    assert found.pressures == pytest.approx({"contact": 5e8 - 1e5 * found.idle[0]})


def test_the_search_gains_what_its_linear_programme_promised(monkeypatch: pytest.MonkeyPatch) -> None:
    """The area is linear in the lift. The tangents foresee loads and least films of the cycle there. All
    limits are kept, by cycles."""
    train = open_train(read_changed("valve-train"), 12)
    lobe, speed = train.lobe, 2500.0 * math.pi / 30.0
    sizes = find_own_limits(train, Limits(), speed)
    own = float(np.trapezoid(lobe.own.s - lobe.ramps.s, lobe.angles))
    wanted = Wanted(sizes, {"contact": 5e8}, {}, 0.0, [speed], [], film=1.0)
    search = Search(train, wanted, np.zeros((0, 2)), speed, own, print)
    seen = search.look(x := search.begin())
    model = search.model(x, seen)
    there = search.solve(model, x, 0.02, 1).unknowns
    promised = float(lobe.bumps.areas @ (there - x)) / own
    assert promised > 0.01
    cycle, answer = search.look(there)[speed].cycle, model.answers[speed]
    for name in ("contact.load", "contact.film_ratio"):
        before, after = answer.columns[name], train.read(cycle.__getitem__, [name])[name]
        rows = np.flatnonzero(before.low <= np.quantile(before.low, 0.5)) if "film" in name else slice(None)
        change, found = (after.low - before.low)[rows], (answer.gradients[name] @ (there - x))[rows]
        assert np.mean((found - change) ** 2) < 0.15**2 * np.mean(change**2)
    monkeypatch.setattr("orchestrator.study.design.search.MOST_ROUNDS", 4)
    best: list[Any] = []
    improved = search.improve(x, lambda *one: best.append(one))
    so_far = tabulate_best(search, Check(None, {speed: search.to_motion(seen[speed].cycle)}), *best[-1])
    assert (so_far.sizes["cam"], so_far.attrs["area"]) == (2, improved.found.area)  # of an interrupted search
    assert not improved.found.beyond
    assert improved.found.area > float(lobe.bumps.areas @ x) / own + promised


@pytest.mark.long
@pytest.mark.parametrize("brief", ["direct-cam", "pushrod-cam"])
def test_a_designed_cam_has_more_area_at_the_same_speed_of_separation(tmp_path: Path, brief: str) -> None:
    """Of a shipped brief, measured by the scenario that was written."""
    found = tribocosim.design(brief, out=tmp_path / "design")
    before, after = found.attrs["separation"]
    assert found.attrs["feasible"]
    assert after > 0.997 * before
    assert found.attrs["area"] > 1.03
    lift = found["value"].sel(figure="valve_spring.lift_area").values[:, 0]
    assert lift[1] > 1.03 * lift[0]
    assert tribocosim.load(tmp_path / "design" / "designed.toml").check()
