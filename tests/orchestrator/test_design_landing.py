"""Landings of designed cams: ramps of a lift table, velocities and bounces that the search foresees."""

import math
from pathlib import Path

import numpy as np
import pytest

from models.core.quantities import Vector
from orchestrator.scenario.cams import read_cam
from orchestrator.scenario.files import load, read_changed
from orchestrator.study.design.brief import Limits
from orchestrator.study.design.figures import Bound, bow_landing, read_figures
from orchestrator.study.design.lobe import Lobe, find_event
from orchestrator.study.design.run import describe_own_ramp, find_own_limits
from orchestrator.study.design.search import Search
from orchestrator.study.design.slp import Line
from orchestrator.study.design.train import open_train
from orchestrator.study.design.wanted import Wanted

from .test_design_figures import SPEED


def test_a_bounce_that_no_slope_foresaw_bends_its_limit() -> None:
    """By what it was at the refused cam; half of the way there has half of it. A better one bends nothing."""
    line = Line("bounce", 0.0, np.zeros(2), np.ones(2), 0.0, 1.0, scale=1e-4)
    there, scale = np.array([1.3, 0.6]), np.full(2, 1e-2)
    bent = line.bend(there, 3e-5, scale)
    assert bent.at(there) == pytest.approx(3e-5)
    assert bent.rows(np.array([1.15, 0.8])).excess == pytest.approx([0.15])
    assert not line.bend(there, -3e-5, scale).gradient.any()
    assert line._replace(side=-1.0).bend(there, -3e-5, scale).at(there) == pytest.approx(-3e-5)


def write_ramped(folder: Path) -> Path:
    """A polynomial lift of 8.75 mm over 140 deg on ramps of 0.25 mm, of 0.01 mm/deg, blended over 5 deg."""
    powers, angles = np.array([2, 8, 14, 20, 26]), np.arange(360)
    falling = np.array([np.prod(powers - np.arange(n)[:, None], axis=0) for n in range(5)], dtype=float)
    share = np.linalg.solve(falling, [-1.0, 0.0, 0.0, 0.0, 0.0])
    away = np.abs(angles - 180.0)
    event = 8.75 * (1.0 + np.minimum(away / 70.0, 1.0)[:, None] ** powers @ share)
    fine = np.arange(0.0, 95.01, 0.01)
    blend = np.clip((95.0 - fine) / 5.0, 0.0, 1.0) * np.clip((fine - 65.0) / 5.0, 0.0, 1.0)
    slow = np.cumsum((blend**2 * (3.0 - 2.0 * blend))[::-1])[::-1]
    lift = event + np.interp(away, fine, 0.25 * slow / slow[0], right=0.0)
    file = folder / "ramped.csv"
    rows = (f"{a}, {s:.4f}" for a, s in zip(angles, lift, strict=True))
    file.write_text("\n".join(["angle [deg], lift [mm]", *rows]), "utf-8")
    return file


def test_a_designed_lift_falls_nowhere_before_its_nose(tmp_path: Path) -> None:
    """Ramps of a lift table are a part of its event. Where a second opening on them is what is wanted, the
    limits of the cam leave none, though it would stay above its feet."""
    table = write_ramped(tmp_path)
    train = open_train(read_changed("finger-follower", [f"components.finger.lift_table={table}"]), 20)
    lobe, speed = train.lobe, 100.0 * math.pi
    assert "replaces the ramps of finger, up to 0.2" in describe_own_ramp(train)
    assert not describe_own_ramp(open_train(read_changed("finger-follower"), 20))
    sizes = find_own_limits(train, Limits(), speed)
    search = Search(train, Wanted(sizes, {}, {}, 0.0, [speed], []), np.zeros((0, 2)), speed, 1.0, print)
    x = search.begin()
    # Further starts of a search keep the limits too.
    for start in (search.draw(x, 0.025, random) for random in map(np.random.default_rng, range(2))):
        assert not search.own_excesses(start)
        assert np.abs(start - x).max() > 0.02 * lobe.own.s.max()
    for side in (-1.0, 1.0):
        high, low = lobe.bumps.at(math.pi + side * np.radians([75.0, 67.5]))
        best = search.solve(search.own_model(x, Line("valley", 0.0, high - low, 0.0 * x)), x, 0.05, 1)
        assert best.feasible
        s = lobe.points(best.unknowns).lift
        nose = int(np.argmax(s))
        assert min(np.diff(s[: nose + 1]).min(), -np.diff(s[nose:]).max()) > -1e-8


def test_a_search_foresees_the_landing_of_a_cam_with_its_ramps_in_its_table(tmp_path: Path) -> None:
    """A step that adds area moves the landing along the ramp. Tangents by the instant at which the seat is
    met, and the slope of the new cam at the lift of the landing, foresee its velocity: cycles confirm it."""
    table = write_ramped(tmp_path)
    train = open_train(read_changed("seat-and-lash", [f"components.camshaft.lift_table={table}"]), 16)
    lobe, x, name = train.lobe, train.lobe.start, "valve_spring.seating_velocity"
    sizes = find_own_limits(train, Limits(), SPEED)

    def step(start: Vector, *bounds: Bound) -> tuple[Vector, list[float]]:
        """The best next lift, with its area and velocity of landing."""
        wanted = Wanted(sizes, {}, {}, 0.0, [SPEED], [], figures=bounds)
        search = Search(train, wanted, np.zeros((0, 2)), SPEED, float(lobe.bumps.areas @ x), print)
        there = search.solve(search.model(start, search.look(start)), start, 0.02, 1).unknowns
        landed = read_figures(search.to_motion(train.simulate(there, SPEED)), [name])[name].value
        return there, [search.area_line(there).value, landed]

    free, (area, landed) = step(x)
    assert landed > 0.25
    _, held = step(free, Bound(name, 1.0, 0.2))
    assert held[0] > area + 0.01
    # 0.2003 was found, and 0.244 by tangents alone.
    assert held[1] == pytest.approx(0.2, rel=5e-3)


def test_the_velocity_of_a_landing_has_the_derivatives_of_its_differences(tmp_path: Path) -> None:
    """Beyond the tangent at its place, where it is nothing."""
    table = write_ramped(tmp_path)
    kind = read_cam(load("finger-follower", [f"components.finger.lift_table={table}"]).components["finger"])
    lobe = Lobe(kind, *find_event(kind, None), 16)
    x = lobe.start
    bow = bow_landing(lobe, x, lobe.end - math.radians(20.0), 0.2)
    assert bow(x)[0] == pytest.approx(0.0, abs=1e-12)
    assert bow(x)[1] == pytest.approx(0.0, abs=1e-9)
    way = np.random.default_rng(1).normal(size=16) * 2e-5
    beyond, gradient = bow(x + way)
    difference = (bow(x + 1.001 * way)[0] - bow(x + 0.999 * way)[0]) / 2e-3
    assert gradient @ way == pytest.approx(difference, rel=1e-3)
    assert abs(beyond) > 1e-4
    # On the ramp, whose slope the event does not change.
    assert bow_landing(lobe, x, lobe.end + 0.1, 0.2)(x + way)[0] == 0.0
