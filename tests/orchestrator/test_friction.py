"""Friction and wear over a cam revolution: sums against closed forms, and the command."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import xarray

from orchestrator.errors import MistakeError
from orchestrator.friction.command import cams_of, friction
from orchestrator.friction.cycle import OF_CAM, OF_CONTACT, Cycle, last_revolution, summary, wear
from orchestrator.friction.table import written
from orchestrator.plots.friction import drawn
from orchestrator.plots.style import saved
from orchestrator.report import Reporter
from orchestrator.run import run
from orchestrator.scenario_files import load

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
        "radius_of_curvature": RADIUS + lift + 5e-3 * np.cos(angle),
        "contact_offset": slope,
    }
    assert set(values) == {*OF_CONTACT, *OF_CAM}
    return last_revolution("contact", time, values)


def test_torque_and_work_are_closed_forms():
    """F (R0 + s), of which the mean over a turn is F (R0 + e)."""
    cycle = eccentric()
    assert cycle["cam_angle"][-1] - cycle["cam_angle"][0] == pytest.approx(2.0 * math.pi, rel=1e-14)
    s = summary(cycle)
    # The trapezoidal rule over a period, 2000 records, one interval of it cut: h^2.
    assert s.mean_torque == pytest.approx(20.0 * (RADIUS + 5e-3), rel=1e-6)
    assert s.work == pytest.approx(2.0 * math.pi * s.mean_torque, rel=1e-14)
    assert s.mean_power == pytest.approx(SPEED * s.mean_torque, rel=1e-12)
    assert s.largest_torque == pytest.approx(20.0 * (RADIUS + 10e-3), rel=1e-6)
    assert s.coefficient == pytest.approx(0.05, rel=1e-12)
    assert s.boundary_share == pytest.approx(0.2, rel=1e-12)
    assert s.asperity_share == pytest.approx(0.1, rel=1e-12)
    assert s.least_film_ratio == pytest.approx(1.0, abs=1e-5)


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


def test_a_result_without_a_whole_revolution_is_refused():
    with pytest.raises(MistakeError, match="must be at least 360; make the stop_time longer"):
        eccentric(turns=0.9)


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


def test_the_command_says_what_the_table_holds(folder, tmp_path):
    said: list[str] = []
    table, figure = tmp_path / "friction.nc", tmp_path / "friction.png"
    friction(folder, None, 1e-17, 1e8, table, figure, said.append)
    assert figure.stat().st_size > 10_000
    with xarray.open_dataset(table, engine="h5netcdf") as found:
        assert f"mean friction torque {float(found.mean_torque):.4g} N m" in said[0]
        # Energy: the torque over the angle is the power over the time.
        work = float(np.trapezoid(found.friction_torque, found.cam_angle))
        assert work == pytest.approx(float(found.work), rel=1e-6)
        assert 0.0 < float(found.mean_torque) <= float(found.largest_torque)
        assert (found.friction_force == found.viscous_friction + found.boundary_friction).all()
        assert found.cam_wear.attrs["units"] == "m"
    assert any("after 1e+08 revolutions" in line for line in said)


def test_mistakes_name_the_option_and_the_remedy(folder, tmp_path):
    def asked(folder=folder, contact=None, k=1e-17, cycles=1.0, table=None, figure=None):
        friction(folder, contact, k, cycles, table, figure, lambda line: None)

    with pytest.raises(MistakeError, match="give the output folder of a finished run"):
        asked(folder=tmp_path)
    with pytest.raises(MistakeError, match="--contact valve: must be one of contact"):
        asked(contact="valve")
    with pytest.raises(MistakeError, match="--wear-coefficient -1 m2/N: must be > 0"):
        asked(k=-1.0)
    with pytest.raises(MistakeError, match="--cycles 0: must be > 0"):
        asked(cycles=0.0)
    with pytest.raises(MistakeError, match=r"must end in \.nc"):
        asked(table=tmp_path / "a.csv")
    with pytest.raises(MistakeError, match=r"must end in \.png"):
        asked(figure=tmp_path / "a.pdf")


def test_every_contact_under_a_cam_is_found():
    assert cams_of(load("valve-train")) == {"contact": "camshaft"}
    assert len(cams_of(load("valve-train-16v"))) == 16
    assert cams_of(load("slider-crank")) == {}


def test_table_and_figure_of_any_cycle(tmp_path):
    cycle = eccentric()
    worn = wear(cycle, "asperity_load", 1e-17, LENGTH)
    assert written(cycle, worn, 1e-17, tmp_path / "a" / "x.nc").is_file()
    assert saved(lambda: drawn(cycle, worn, 1e6, "eccentric"), tmp_path / "x.png").is_file()
