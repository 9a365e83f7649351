"""tribocosim calibrate: measured data and chosen parameters, with their units, and what is refused."""

import math
from pathlib import Path

import numpy as np
import pytest

from models.core.quantities import Quantity
from orchestrator.errors import MistakeError
from orchestrator.plots.calibration import Panel, draw_calibration, draw_parameters
from orchestrator.scenario.display import show_unit
from orchestrator.scenario.files import load
from orchestrator.study.calibration.measured import Measured, read_measured
from orchestrator.study.calibration.parameters import choose, list_starts


def test_all_rows_of_a_speed_that_wavers_are_used(tmp_path):
    """By 0.9 % to each side of its mean, which lies nearer to one."""
    rows = [f"{n}, {k}, {k}" for k, n in enumerate((991, 991, 991, 991, 1000, 1009))]
    (one,) = read(tmp_path, "n [rpm], cam [deg], contact.load [N]", *rows).experiments
    assert one.positions.size == 6
    assert one.speed == pytest.approx(995.5 * math.pi / 30.0)


OUTPUTS = {
    name: field.quantity
    for name, field in (
        (f"{part}.{field.name}", field)
        for part, table in load("valve-train").components.items()
        for field in table.resolve().outputs.fields
    )
}


def read(tmp_path: Path, *lines: str, signals: tuple[str, ...] = ()) -> Measured:
    (tmp_path / "data.csv").write_text("\n".join(lines) + "\n")
    return read_measured([tmp_path / "data.csv"], OUTPUTS, signals)[0]


def test_data_have_their_speeds_shafts_units_and_gaps(tmp_path):
    found = read(
        tmp_path, "n [rpm], cam [deg], valve_spring.valve_lift [mm], F [kN]",
        "1000, 10, 1.5,", "1001, 20, 2.5, 0.3", "2000, 10, 1.0, 0.5",
        signals=("F = contact.load, gain",),
    )  # fmt: skip
    force, lift = found.signals
    assert (force.variable, force.gain, lift.variable) == ("contact.load", True, "valve_spring.valve_lift")
    slow, fast = found.experiments
    assert slow.speed == pytest.approx(1000.5 * math.pi / 30.0)
    assert slow.shaft == "cam_angle"
    assert slow.positions == pytest.approx(np.radians([10.0, 20.0]))
    assert slow.values == pytest.approx(np.array([[math.nan, 300.0], [1.5e-3, 2.5e-3]]), nan_ok=True)
    assert fast.values[:, 0] == pytest.approx([500.0, 1e-3])
    assert found.count == 5


@pytest.mark.parametrize(
    ("lines", "signals", "why"),
    [
        (("angle [deg], x [mm]", "1, 2", "2, 3"), (), "no column is of an output"),
        (("angle [deg], x [mm]", "1, 2", "2, 3"), ("x = contact.loads",), "did you mean contact.load"),
        (("angle [deg], x [mm]", "1, 2", "2, 3"), ("y = contact.load",), "no such column"),
        (("angle [deg], contact.load [mm]", "1, 2", "2, 3"), (), "mm does not fit a force; write N or kN"),
        (("angle [deg], contact.load", "1, 2", "2, 3"), (), "has no unit"),
        (("angle [deg], contact.load [N]", "1, 2", "2, 3"), (), "has no speed"),
        (("angle [deg], contact.load [N]", "1, 2", "2, x"), (), "line 3"),
        (("# speed: 900 rpm", "angle [deg], contact.load [N]", "1, 2", "2, 2"), (), "is constant"),
        (("angle [deg], x [N]", "1, 2", "2, 3"), ("x = contact.load, noise 3 mm",), "noise"),
        (("angle [deg], x [N]", "1, 2", "2, 3"), ("x = contact.load, noise 3",), "write the unit, e.g. 3 N"),
        (("# speed: 900", "angle [deg], contact.load [N]", "1, 2", "2, 3"), (), "e.g. # speed: 900 rpm"),
        (("# speed: 900 rpm", "angle [deg], contact.load [N]", "1, 2", "2, inf"), (), "line 4"),
        (
            ("n [rpm], cam [deg], contact.load [N]", *(f"{1000 + 8 * k}, {k}, {k}" for k in range(4))),
            (),
            "speeds from 1000 to 1024 r/min have no gap",
        ),
        ((), (), "data.csv: is empty; the first line names the columns"),
        (("angle [deg], x [N]", "1, 2", "2, 3"), ("x = contact.load, drift",), "offset, gain"),
        (("contact.load [N]; p [bar]", "1; 2", "2; 3"), (), "no column of an angle or the time"),
    ],
)
def test_data_that_cannot_be_used_are_refused_with_what_is_wrong(lines, signals, why, tmp_path):
    with pytest.raises(MistakeError, match=why):
        read(tmp_path, *lines, signals=signals)


def test_an_output_without_a_unit_has_plain_numbers_and_others_are_refused_with_what_to_write(tmp_path):
    """As FMUs of other tools often state none."""
    (tmp_path / "data.csv").write_text("time [s], body [mm]\n0, 1\n1, 2\n")
    outputs = {"chassis.position": Quantity("", "position")}
    with pytest.raises(MistakeError, match="states no unit; leave it out, with numbers in the FMU's: body"):
        read_measured([tmp_path / "data.csv"], outputs, ["body = chassis.position"])
    (tmp_path / "data.csv").write_text("time [s], body\n0, 1\n1, 2\n")
    found, _ = read_measured([tmp_path / "data.csv"], outputs, ["body = chassis.position, noise 0.5"])
    assert found.signals[0].noise == 0.5
    assert found.pool(0) == pytest.approx([1.0, 2.0])


def test_figures_have_display_units_and_no_correlation_of_one_parameter():
    lift = np.array([0.0, 2e-3])
    panel = Panel("lift", "m", show_unit("m", "mm"), None, "time", np.array([0.0, 1.0]), lift, lift)
    above, below = draw_calibration([panel], "").axes
    assert (above.get_ylabel(), below.get_ylabel()) == ("lift\n[mm]", "residual\n[mm]")
    assert above.lines[0].get_ydata() == pytest.approx([0.0, 2.0])
    assert below.get_xlabel() == "Time (s)"
    for count, panels in ((1, 1), (2, 3)):  # with the bar of colours
        figure = draw_parameters(["a.b"] * count, np.ones((count, 2)), np.eye(count), "")
        assert len(figure.axes) == panels


@pytest.mark.parametrize(
    ("wanted", "bounds", "why"),
    [
        (["valve_spring.spring_rat"], [], "did you mean valve_spring.spring_rate"),
        (["contact.film_model"], [], "no values in between"),
        (["valve_spring.preload"], ["valve_spring.lash = 0 .. 1"], "is not fitted"),
        (["valve_spring.preload"], ["valve_spring.preload = 400 N .. 500 N"], "which is outside"),
        (["valve_spring.preload"], ["valve_spring.preload = -5 N .. 500 N"], "may be from 0 N"),
        (["valve_spring.lash"], ["valve_spring.lash = 2 mm .. 1 mm"], "lower bound 2 mm must be below 1 mm"),
        (["valve_spring.preload"], ["valve_spring.preload = 3 mm .. 400 N"], "does not fit"),
        (["valve_spring.preload"], ["valve_spring.preload = 400 N"], "low .. high"),
    ],
)
def test_parameters_that_cannot_be_fitted_are_refused_with_what_is_wrong(wanted, bounds, why):
    with pytest.raises(MistakeError, match=why):
        choose(load("valve-train"), wanted, bounds)


def test_further_starts_are_between_the_bounds():
    parameters = choose(
        load("valve-train"), ["valve_spring.preload, valve_spring.spring_rate"],
        ["valve_spring.preload = 300 N .. 340 N"],
    )  # fmt: skip
    own, *others = (point * [one.size for one in parameters] for point in list_starts(parameters, 5))
    assert own == pytest.approx([330.0, 35e3])
    assert all(300.0 <= preload <= 340.0 and 17.5e3 <= rate <= 70e3 for preload, rate in others)
    assert len({tuple(point) for point in others}) == 4
