"""tribocosim design: figures of merit, film, wires and ramps as limits, objectives and unknowns."""

import math
import re
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
import xarray

import tribocosim
from models.core.quantities import Vector
from models.core.system import ModelError
from models.monolithic.cycle import STEADY
from models.valve_train.followers.mechanisms import Flat
from orchestrator.assessment.motion import Found as Value
from orchestrator.assessment.motion import Motion
from orchestrator.scenario.files import load, read_changed
from orchestrator.scenario.system import build_system, list_parameters
from orchestrator.scenario.wire import insert_wire
from orchestrator.study.design import run as design_run
from orchestrator.study.design.answers import Answer, Column, follow_reversal
from orchestrator.study.design.brief import Limits, read_brief
from orchestrator.study.design.deliverables import deliver
from orchestrator.study.design.figures import Bound, Objective
from orchestrator.study.design.files import keep
from orchestrator.study.design.limits import (
    Limit,
    Model,
    closing_limit,
    duration_limit,
    film_limits,
    find_sizes,
    gap_limit,
    kinematic_limits,
)
from orchestrator.study.design.lobe import Lobe
from orchestrator.study.design.report import (
    describe_active,
    describe_clashes,
    describe_shape,
    describe_worse,
)
from orchestrator.study.design.run import describe_excess, find_own_limits
from orchestrator.study.design.search import Search, Seen
from orchestrator.study.design.slp import Active, Line, Problem, maximise
from orchestrator.study.design.train import open_train
from orchestrator.study.design.wanted import Found as Design
from orchestrator.study.design.wanted import Wanted
from orchestrator.study.design.wires import list_wires, wind

from .test_design import build_lobe, build_model, optimise, write_brief

SPEED = 2500.0 * math.pi / 30.0


def test_a_line_is_an_objective_and_a_limit() -> None:
    """The largest height of the middle, with an area at most: 1 % more of it is 1 % more height, to what is
    left between linear programmes."""
    lobe = build_lobe(count=12)
    place = np.zeros(12)
    height = lobe.bumps.at(np.array([math.pi]))[0]
    bound = Line("area", 0.0, lobe.bumps.areas, place, 1e-3, 1.0, 2.0)
    positive = Limit("positive", 0.0, lambda q, size: -q.curve.s)
    model = Model(lobe, [positive], {}, place, lambda x: lobe.kind.geometry, np.full(12, 1e-2),
                  Line("height", 0.0, height, place), [bound])  # fmt: skip
    big = np.full(12, 1.0)
    found = maximise(Problem(model.evaluate, place - big, place + big, model.scale), place)
    assert lobe.bumps.areas @ found.unknowns == pytest.approx(1e-3, rel=1e-6)
    gain = next(one.gain for one in found.active if one.name == "area")
    assert gain == pytest.approx(0.01 * found.local.objective, rel=1e-3)


def answer_of(low: Vector, high: Vector, gradient: Vector) -> Answer:
    return Answer(1.0, {"load": Column(low, high, low)}, {"load": gradient}, None)  # type: ignore[arg-type]


def optimise_cam(lobe: Lobe, *more: Limit) -> Vector:
    """The most area with the radius and lift of the own cam."""
    sizes = find_sizes(lobe, lobe.own, lobe.kind.geometry, 1.0)
    own = {name: sizes[name] for name in ("largest_lift", "least_radius")}
    base = lobe.kind.geometry.base_radius
    limits = [*kinematic_limits(own, 1.0, base), closing_limit(lobe.ramps, own["largest_lift"]), *more]
    found = optimise(build_model(lobe, limits), lobe.start)
    assert found.feasible
    return found.unknowns


def test_a_cam_lifts_by_a_millimetre_for_the_duration_that_it_may() -> None:
    """Of the crank, that turns twice as far; the own cam and one without the limit lift for longer."""
    lobe = build_lobe(count=24)
    most = math.radians(240.0)
    free, held = optimise_cam(lobe), optimise_cam(lobe, duration_limit(lobe.angles, most))
    own, longer, duration = (
        find_sizes(lobe, curve, lobe.kind.geometry, 1.0)["largest_duration"]
        for curve in (lobe.own, lobe.curve(free), lobe.curve(held))
    )
    assert min(own, longer) > math.radians(250.0)
    assert duration == pytest.approx(most, abs=math.radians(0.1))
    edges = 0.5 * (lobe.begin + lobe.end) + np.array([-0.25, 0.25]) * most
    assert (lobe.bumps.at(edges) @ held).max() < 1.001e-3


@pytest.mark.parametrize("least", [1.5e-3, -0.5e-3])
def test_a_spring_keeps_its_travel_to_coil_bind(least: float) -> None:
    """Slow coils have what the lift leaves of 9 mm: the most area takes all but the least gap, or adds to it
    where coils of the own cam clash."""
    lobe = build_lobe(count=24)
    sizes = find_sizes(lobe, lobe.own, lobe.kind.geometry, 1.0)
    free = {"largest_lift": 12e-3, "largest_offset": 1.3 * sizes["largest_offset"]}
    more = list(kinematic_limits(free, 1.0, 20e-3))
    left = 9e-3 - lobe.curve(lobe.start).s
    answer = answer_of(left, left, -lobe.matrices[0])
    highest = []
    for limits in (more, [*more, gap_limit("gap", "load", 1.0, least)]):
        found = optimise(build_model(lobe, limits, {1.0: answer}), lobe.start)
        assert found.feasible
        highest.append(float(lobe.curve(found.unknowns).s.max()))
    assert highest[0] > 9.8e-3
    assert highest[1] == pytest.approx(9e-3 - least, abs=1e-6)


def test_coils_that_clash_with_a_designed_cam_are_warned_of() -> None:
    """At the speed where they do most, of springs whose coils touch all at once."""

    def warn(*settings: str) -> list[str]:
        system = build_system(load("coil-clash", settings))
        gaps = {100.0: [1e-3, -1e-4], 200.0: [1e-3, -1.2e-3], 300.0: [1e-3, 1e-4]}
        columns = {speed: np.array(gap) for speed, gap in gaps.items()}
        motions = {v: Motion(system, np.arange(2.0), lambda _, v=v: columns[v], None) for v in gaps}
        return list(describe_clashes(motions, "with this cam"))

    (said,) = warn()
    assert "components.spring: its coils clash with this cam, most at 1910 r/min, by up to 1.2 mm of" in said
    assert not warn("components.spring.parameters.gap[1] = 0.5 mm")


def test_a_film_stays_where_no_tangent_foresees_a_new_reversal() -> None:
    """Where the entraining velocity reverses a film is as thin as it will be; elsewhere one that had twice
    its limit keeps that share of the velocity."""
    lobe = build_lobe(count=24)
    entraining = lobe.touch(lobe.own, lobe.kind.geometry).entraining
    ratios = np.ones(lobe.angles.size)
    answer = answer_of(ratios, ratios, np.zeros((ratios.size, 24)))
    film = list(film_limits("here", "load", 1.0, 0.5, ratios, entraining))
    reverses = np.flatnonzero(np.diff(np.sign(entraining)))
    away = np.abs(np.arange(ratios.size)[:, None] - reverses).min(axis=1, initial=ratios.size) > 10
    sizes = find_sizes(lobe, lobe.own, lobe.kind.geometry, 1.0)
    limits = list(kinematic_limits({"largest_lift": sizes["largest_lift"]}, 1.0, 20e-3))
    shares = []
    for more in ([], film):
        found = optimise(build_model(lobe, [*limits, *more], {1.0: answer}), lobe.start)
        there = lobe.touch(lobe.curve(found.unknowns), lobe.kind.geometry).entraining
        shares.append(float((there / entraining)[away].min()))
    assert shares[0] < 0.2
    assert shares[1] == pytest.approx(0.5 ** (1.0 / 0.7), abs=1e-3)


def test_a_film_at_its_limit_is_foreseen_from_its_own_cam() -> None:
    """The derivatives of both its limits hold at the cam of the cycle, to any side."""
    lobe = build_lobe(count=24)
    entraining = lobe.touch(lobe.curve(lobe.start), lobe.kind.geometry).entraining
    ratios = 0.5 + 0.0 * lobe.angles
    random = np.random.default_rng(1)
    answer = answer_of(ratios, ratios, random.normal(size=(ratios.size, 24)))
    model = build_model(lobe, list(film_limits("here", "load", 1.0, 0.5, ratios, entraining)), {1.0: answer})
    x, step = lobe.start, 1e-7 * random.normal(size=24)
    here = model.evaluate(x)
    for side in (-1.0, 1.0):
        there = model.evaluate(x + side * step)
        for one, other in zip(here.limits, there.limits, strict=True):
            np.testing.assert_allclose(
                other.excess - one.excess, side * one.gradient @ step, rtol=1e-2, atol=1e-9
            )


def test_a_dip_of_the_film_that_moves_with_its_reversal_keeps_its_depth() -> None:
    """Film |u| + 0.1 over rows, with u = row - place: at a row beside the dip the derivative by the place is
    the slope of the dip, and none once it follows the reversal."""
    velocity = np.arange(-20.0, 21.0) + 0.4
    slide = follow_reversal(np.abs(velocity) + 0.1, velocity, 8)
    by_place = -np.sign(velocity)  # of the film; that of the velocity is -1
    beside = (np.abs(velocity) > 1.0) & (np.abs(velocity) < 7.0)
    np.testing.assert_allclose((by_place - slide * -1.0)[beside], 0.0, atol=1e-12)
    assert not slide[np.abs(velocity) > 8.0].any()


def test_a_refused_cam_lowers_what_is_foreseen_by_what_it_fell_short() -> None:
    """Loads that were higher than foreseen raise nothing."""
    own = answer_of(np.full(3, 100.0), np.full(3, 120.0), np.full((3, 1), 1e3))
    low = np.array([105.0, 110.0, 130.0])
    there = answer_of(low, low + 25.0, np.zeros((3, 1)))
    found = own.worsen(there, np.array([0.01])).columns["load"]
    np.testing.assert_allclose(found.low, [95.0, 100.0, 100.0])
    np.testing.assert_allclose(found.high, [120.0, 125.0, 145.0])


def test_a_refused_speed_of_separation_corrects_the_speeds_that_stay() -> None:
    """The model has 1 and 19 rad/s, the refused cam 20, and lost contact there; it may be its lowest."""
    near, far = (answer_of(np.full(3, one), np.full(3, one), np.zeros((3, 1))) for one in (100.0, 60.0))
    train = SimpleNamespace(read=lambda cycle, columns: far.columns)
    model = Model(
        build_lobe(count=12), [], {1.0: near, 19.0: near}, np.zeros(1), MagicMock(), np.ones(1), MagicMock()
    )
    cycles = {1.0: Seen(1.0, MagicMock(), {}, 1.0), 20.0: Seen(18.0, MagicMock(), {}, 18.0)}
    search = SimpleNamespace(train=train, columns=["load"])
    for seen in (cycles, {20.0: cycles[20.0]}):
        found = Search.correct(search, model, np.zeros(1), seen).answers  # type: ignore[arg-type]
        assert found[19.0] is near
        np.testing.assert_allclose(found[1.0].columns["load"].low, 60.0 if 1.0 in seen else 100.0)


def test_the_speed_of_separation_is_an_unknown() -> None:
    """A limit that shrinks by the speed's logarithm by 2, with 6 % to spare, allows exp(3 %)."""
    lobe = build_lobe(count=12)
    place = np.append(lobe.start, 0.0)
    rows = lobe.angles.size
    limit = Limit("separation", 1.0, lambda q, size: np.full(rows, -0.06), "", 1.0, np.full(rows, 2.0))
    model = Model(lobe, [limit], {}, place, lambda x: lobe.kind.geometry, np.append(np.full(12, 1e-2), 1.0),
                  Line("separation_speed", 1.0, np.eye(13)[-1], place), stretched=True)  # fmt: skip
    big = np.full(13, 0.5)
    found = maximise(Problem(model.evaluate, place - big, place + big, model.scale), place)
    assert found.unknowns[-1] == pytest.approx(0.03, abs=1e-9)


WIRE = {
    "component": "valve_spring",
    "wire": {"diameter": "4 mm", "mean_diameter": "25 mm", "active_coils": 6.0, "free_length": "50 mm",
             "installed_length": "40 mm"},
    "parameters": {},
}  # fmt: skip


def test_a_wire_as_an_unknown_gives_its_spring() -> None:
    """The rate grows with the fourth power of the diameter; what a wire cannot be is told."""
    wires = dict(list_wires({"components": {"spring": WIRE, "cam": {}}}))
    own = wind(wires, {name: one.size for name, one in wires.items()} | {"cam.lift": 0.008})
    assert own.pop("cam.lift") == 0.008
    direct = insert_wire(WIRE).parameters
    assert own["spring.spring_rate"] == pytest.approx(direct["spring_rate"], rel=1e-12)
    thick = wind(wires, {"spring.wire.diameter": 4.4e-3})
    ratio = thick["spring.spring_rate"] / own["spring.spring_rate"]
    assert ratio == pytest.approx(1.1**4, rel=1e-9)
    with pytest.raises(ModelError, match="spring: "):
        wind(wires, {"spring.wire.diameter": 9e-3})


def test_parameters_beside_the_lift_have_their_answers() -> None:
    """A newton of preload is one of load along the event, about which it vibrates. A larger base circle
    is that of the follower too."""
    train = open_train(read_changed("valve-train"), 16)
    own = list_parameters(train.scenario)
    bounds = {"camshaft.base_radius": (0.018, 0.024), "valve_spring.preload": (200.0, 600.0)}
    train = train.with_parameters(bounds)
    assert train.given == {name: own[name] for name in bounds}
    x = np.append(train.lobe.start, list(train.given.values()))
    cycle = train.simulate(x, SPEED)
    answer = train.answer(train.differentiate(x, cycle, True), cycle, SPEED, ["contact.load"])
    found = answer.gradients["contact.load"]
    assert found.shape == (train.lobe.angles.size, 18)
    assert found[:, -1].mean() == pytest.approx(1.0, abs=5e-3)
    assert np.mean(np.abs(found[:, -1] - 1.0) < 0.05) > 0.9
    wanted = Wanted({}, {}, {}, 0.0, [SPEED], [])
    search = Search(train, wanted, np.array(list(bounds.values())), SPEED, 1.0, print)
    x[-2] = 0.022
    assert search.geometry(x) == Flat(0.022)


def test_a_cycle_does_not_depend_on_the_speeds_that_were_looked_at_before(monkeypatch) -> None:
    """A lash adjuster that grows at 2800 r/min would stay grown for tens of cycles."""
    monkeypatch.setattr("orchestrator.study.speeds.finder.SAMPLES", 720)

    def look(speeds: list[float]) -> Mapping[float, Vector]:
        train = open_train(read_changed("roller-finger"), 30)
        found = {}
        for speed in speeds:
            search = Search(train, Wanted({}, {}, {}, 0.0, [speed], []), np.zeros((0, 2)), speed, 1.0, print)
            found[speed] = search.look(train.lobe.start)[speed].cycle["valve_spring.position"]
        return found

    up, down = look([slow := 168.0, fast := 293.0]), look([fast, slow])
    assert up[fast].max() > up[slow].max() + 2e-4
    for speed in (slow, fast):
        assert down[speed] == pytest.approx(up[speed], abs=STEADY * np.ptp(up[speed]))


def test_a_first_lift_has_the_limits_of_corners_that_bumps_cannot_follow() -> None:
    """Bumps over the corners of the modified trapezoid's acceleration undercut its least radius; with less
    jerk they keep it, for less than the 3 % of area that the last weight takes."""
    train = open_train(read_changed("pushrod-train"), 30)
    sizes = find_own_limits(train, Limits(), 200.0)
    lobe = train.lobe
    area = float(np.trapezoid(lobe.own.s - lobe.ramps.s, lobe.angles))
    search = Search(train, Wanted(sizes, {}, {}, 0.0, [200.0], []), np.zeros((0, 2)), 200.0, area, print)
    assert set(search.own_excesses(lobe.start)) == {"least_radius"}
    begun = search.begin()
    assert not search.own_excesses(begun)
    assert lobe.bumps.areas @ begun > 0.97 * area


@pytest.mark.parametrize(
    ("angle", "place"), [(120.0, "61 deg before the nose, on a"), (175.0, "5 deg .* two noses")]
)
def test_a_dip_is_said_with_its_place(angle: float, place: str) -> None:
    lobe = build_lobe()
    dip = 1.6e-3 * np.exp(-(((np.degrees(lobe.angles) - angle) / 3.0) ** 2))
    dipped = lobe.own._replace(s=lobe.own.s - dip)
    (text,) = describe_shape(lobe, dipped, dipped, [0.01, 0.02])
    assert re.search(f"the lift dips by .* µm {place}", text)


def test_limits_of_the_cam_that_contradict_are_told_before_its_cycles() -> None:
    """A nose may be 2 % higher, and no lower than the highest that it may be."""
    train, told = open_train(read_changed("valve-train"), 12), list[str]()
    own = find_own_limits(train, Limits(), 200.0)
    lift = own["largest_lift"]
    for least, largest in ((1.02, 1.03), (1.2, 1.0)):
        sizes = own | {"least_lift": least * lift, "largest_lift": largest * lift}
        wanted = Wanted(sizes, {}, {}, 0.0, [200.0], [])
        search = Search(train, wanted, np.zeros((0, 2)), 200.0, 1.0, told.append)
        begun = search.begin()
        assert bool(told) is bool(search.own_excesses(begun)) is (least > largest)
    (text,) = told
    assert re.search("no lift was found .* beyond .*least lift by", text)


def test_what_no_limit_holds_is_said_where_it_became_worse() -> None:
    """With the key that holds it: more than a quarter, or a quarter of 0.1 mm where there was no bounce."""
    values = {"valve.seating_velocity": (0.2, 1.2), "valve.bounce": (0.0, 30e-6),
              "valve.spring_margin": (0.4, 0.31), "contact.largest_load": (1400.0, 2200.0),
              "contact.peak_pressure": (5e8, 7e8), "contact.least_load": (180.0, 90.0),
              "contact.least_film_ratio": (1.0, 0.5)}  # fmt: skip
    rows = np.array(list(values.values())).T[:, None]
    table = xarray.Dataset(
        {"value": (("cam", "speed", "figure"), rows), "unit": ("figure", ["SI"] * 7),
         "factor": ("figure", np.ones(7))},
        {"speed": [100.0], "figure": list(values)},
    )  # fmt: skip
    before = {"largest_acceleration": 1.0, "largest_deceleration": 1.0, "largest_jerk": 2e7,
              "least_radius": 4e-3, "largest_duration": 4.0}  # fmt: skip
    sizes = [before, before | {"largest_jerk": 6e7, "least_radius": 2e-3}]
    train: Any = SimpleNamespace(train=SimpleNamespace(contacts=["contact"], list_parts=lambda role: []))
    wanted = Wanted({"least_radius": 2e-3}, {"contact": 8e8}, {}, 0.0, [100.0], [100.0],
                    figures=[Bound("valve.seating_velocity", 1.0, 1.3)])  # fmt: skip
    said = list(describe_worse(table, train, wanted, sizes))
    assert said[0] == (
        "largest jerk of the cam goes from 20000000 to 60000000 m/s³: no limit holds it; "
        'limits.largest_jerk = "own" would'
    )
    keys = [re.search(r"; (\S+) = ", text) for text in said]
    assert [one[1] for one in keys if one] == [
        "limits.largest_jerk", "limits.largest_bounce", 'figures."contact.largest_load".most',
        "limits.least_load", "limits.least_film_ratio",
    ]  # fmt: skip


def test_files_of_the_trade_hold_the_design(tmp_path: Path) -> None:
    """Lifts of half-degree rows come back within 0.05 um, also by the contour; `.s96` rounds to 1e-8 in."""
    asked = read_brief("valve-train")
    train = open_train(asked.tables, 24)
    keep(tmp_path, asked, train, Design(train.lobe.start, 1.0, {}, 1.0))
    said = [str(one) for one in deliver(tmp_path, train, train.lobe.start)]
    assert "deg of the crank at 1 mm" in said[0]
    apart = {one.partition(" ")[0]: float(one.partition("within ")[2].split()[0]) for one in said[1:]}
    assert set(apart) == {"cam.s96", "cam.mm.csv", "cam.in.csv", "cam.contour.csv"}
    assert max(apart.values()) < 0.05


def test_a_limit_that_is_not_reached_has_its_margin_and_one_that_a_run_breaks_is_named() -> None:
    reached = Active("pressure", 0, 0.0, 0.004)
    assert describe_active(reached, math.nan, Objective()) == "pressure limits"
    assert describe_active(reached._replace(spare=0.09), math.nan, Objective()) == (
        "pressure is not reached, 9 % to spare, and limits next"
    )
    assert describe_excess(6e8, 5.5e8) == ": exceeds the limit of 550.0 MPa by 9.1 %"
    assert (describe_excess(5e8, 5.5e8), describe_excess(5e8, math.inf)) == (", limit 550.0 MPa", "")


@pytest.mark.parametrize(
    ("complete", "pressure", "kept"), [(True, 5e8, True), (True, 6e8, False), (False, 5e8, False)]
)
def test_a_design_whose_coupled_run_fails_or_breaks_a_limit_does_not_keep_all(
    complete, pressure, kept, monkeypatch, tmp_path
):
    ended = SimpleNamespace(complete=complete, message="", contacts={"a": SimpleNamespace(pressure=pressure)})
    found = {"load": None, "read_changed": {}, "find_flywheel": "", "run_part": ended}
    found["SpeedSubject"] = SimpleNamespace(find_motion_at=lambda speed: None)
    for name, value in found.items():
        monkeypatch.setattr(design_run, name, lambda *_, value=value: value)
    monkeypatch.setitem(design_run.CONTACT, "peak_pressure", (None, lambda part: Value(5e8)))
    wanted = Wanted({}, {"a": 5.5e8}, {}, 0.0, [], [])
    assert design_run.couple(tmp_path, 100.0, wanted, None, None)[1] is kept


@pytest.mark.long
def test_a_designed_cam_needs_less_torque_with_the_same_area(tmp_path: Path) -> None:
    brief = write_brief(tmp_path, 'scenario = "valve-train"\nminimise = "contact.friction_power"\n'
                        'coefficients = 16\nspeeds = ["1600 rpm"]\nstarts = 1\n[limits]\n'
                        'least_lift_area = 0.99\nseparation_speed = "3000 rpm"')  # fmt: skip
    found = tribocosim.design(str(brief), out=tmp_path / "design")
    assert found.attrs["feasible"]
    assert found.attrs["area"] > 0.985
    power = found["value"].sel(figure="contact.friction_power").values[:, 0]
    assert power[1] < 0.99 * power[0]
