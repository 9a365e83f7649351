"""Angles and whole cycles of a motion, over which its means are taken."""

import math
from collections import defaultdict

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.system import Instance, System
from orchestrator.assessment.contacts import ContactSummary
from orchestrator.assessment.merits import describe_trains, list_merits, write_merits
from orchestrator.assessment.motion import Motion
from orchestrator.assessment.trains import Angle, find_degrees
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

from .test_merits import ANGLE, LIFT


def test_what_came_after_the_last_row_of_a_run_that_broke_off_has_its_own_angle():
    """Also where an event left two rows at the last time."""
    for more in (0, 1):
        rows = {"time": np.array([0.0, 1.0, 2.0, 2.0]), "cam.angle": np.array([0.0, 1.0, 3.0, 3.0])}
        read = {name: row[: 3 + more] for name, row in rows.items()}.__getitem__
        found = find_degrees(Angle("cam_angle", "cam.angle"), [0.5, 2.0, 2.5], read)
        np.testing.assert_allclose(np.radians(found), [0.5, 3.0, 4.0])


@pytest.mark.parametrize(
    ("turns", "window"),
    [(1.0, "the run"), (1.6, "its last revolution"), (2.6, "its last 2 revolutions"), (0.6, "less than")],
)
def test_means_of_a_periodic_motion_do_not_depend_on_where_the_run_stops(turns, window, tmp_path):
    """A train whose drive stores energy with the lift: whole revolutions give it back. Of less it is said.
    Contact that is lost before them does not count, whatever was observed from the start on."""
    angle = np.linspace(0.0, 2.0 * math.pi * turns, round(7200 * turns) + 1)
    lift = np.interp(angle, ANGLE, LIFT, period=2.0 * math.pi)
    system = build_system(load("valve-train"))
    columns = defaultdict(lambda: 0.0 * angle) | {
        "time": 0.06 * angle / (2.0 * math.pi),
        "flywheel.angle": angle,
        "camshaft.cam_angle": angle,
        "flywheel.supplied_torque": 1.0 + 1e3 * np.gradient(lift, angle),
        "contact.friction_force": 12.0 + 1e3 * lift,
        "camshaft.sliding_velocity": 2.0 + np.sin(angle),
        "valve_spring.valve_lift": np.where(lift > 0.0, lift, -3e-6),
    }
    columns["contact.load"] = np.where(abs(angle / (2.0 * math.pi) - 0.5) < 0.05, 0.0, 400.0)
    observed = ContactSummary(0.0, 400.0, 0.0, 0.1 / turns, 1e8, 2.0, 1e9, 0.0, 1e-7, 3.0, 0.01, 1e-5)
    merits = list_merits(system, {"contact": observed}, columns.__getitem__)
    write_merits(system, merits, [], columns.__getitem__, tmp_path / "summary.csv")
    assert (f"over {window}" in (tmp_path / "summary.csv").read_text("utf-8-sig")) == (turns > 1.0)
    (line,) = describe_trains(system, merits, columns.__getitem__)
    assert f"W in the mean of {window}" in line or (turns < 1.0 and window in line)
    found = {f"{merit.part}.{merit.figure}": merit.value for merit in merits}
    assert found["contact.lost"] == pytest.approx(0.1 / turns if turns <= 1.0 else 0.0, abs=3e-4)
    assert ("contact is lost in 10 % of the run;" in line) == (turns == 1.0)
    # 8 mm of half a sine over 120 deg; friction by hand, as the sine of the velocity is odd about the nose.
    area, seat = 8e-3 * 4.0 / 3.0, 3e-6 * 4.0 * math.pi / 3.0
    power = 24.0 + 2e3 * area / (2.0 * math.pi)
    known = {
        "valve_spring.lift_area": area - seat,
        "flywheel.mean_torque": 1.0,
        "contact.friction_power": power,
    }
    known["contact.friction_torque"] = power * 0.06 / (2.0 * math.pi)
    agreed = [found[name] == pytest.approx(value, rel=1e-5) for name, value in known.items()]
    assert all(agreed) if turns >= 1.0 else not all(agreed)


TWO_STROKE = {"cycle_turns": 1.0} | {f"pressure_angle[{i}]": float(i) for i in range(1, 5)}
TWO_STROKE |= {f"point_pressure[{i}]": 1e5 for i in range(1, 5)}


@pytest.mark.parametrize(
    ("turns", "given", "window"),
    [
        (4.6, {}, "its last 2 cycles of 2 revolutions"),
        (3.9, {}, "its last cycle of 2 revolutions"),
        (1.9, {}, "the run, which is less than a cycle of 2 revolutions"),
        (1.9, TWO_STROKE, "its last revolution"),
    ],
)
def test_the_cycle_of_a_crank_without_cam_is_that_of_its_gas(turns, given, window):
    """A table of gas says of how many turns, a cycle by its law is of four strokes."""
    gas = CATALOGUE["cylinder_gas"](**({"pressure_points": 4} if given else {}))
    system = System({"gas": Instance(gas, given)}, ())
    angle = np.linspace(0.0, 2.0 * math.pi * turns, 1000)
    assert Motion(system, angle, lambda name: angle, Angle("crank_angle", "crank.angle")).window == window
