"""What is told of a hydraulic lash adjuster, from columns whose answers are known."""

import math

import numpy as np
import pytest
import xarray

from models.core import roles
from orchestrator.assessment.adjusters import ADJUSTER, UNHELD, describe_growth, describe_over_speed
from orchestrator.assessment.merits import describe_adjusters, list_merits, read_motion
from orchestrator.assessment.motion import Part
from orchestrator.plots import valve_train
from orchestrator.plots.data import FigureData
from orchestrator.scenario import parse_ends
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, list_outputs, list_parameters

SYSTEM = build_system(load("direct-acting-hla"))
AREA = 0.25 * np.pi * 9e-3**2
# Two turns of the cam in 0.12 s; it lifts from 90 to 270 degrees.
TIME = np.linspace(0.0, 0.12, 7201)
ANGLE = 4.0 * np.pi * TIME / 0.12
TURNED = np.mod(ANGLE, 2.0 * np.pi)
LIFTS = (0.5 * np.pi < TURNED) & (1.5 * np.pi > TURNED)
# The check valve is open for 9 degrees after the lift, and lets in what has leaked.
FILLS = (1.5 * np.pi < TURNED) & (1.55 * np.pi > TURNED)
LEAK = 1e-7


def read_columns(rows=slice(None), **changed):
    """Columns of the train at 1000 r/min, else 0."""
    bump = np.where(LIFTS, np.sin(TURNED - 0.5 * np.pi), 0.0)
    columns = {
        "time": TIME,
        "flywheel.angle": ANGLE,
        "tappet.profile_angle": ANGLE,
        "tappet.cam_lift": 8e-3 * bump,
        "adjuster.pressure": 9e6 * bump,
        "adjuster.force": 20.0 + 600.0 * bump,
        "adjuster.extension": -15e-6 - 70e-6 * bump,
        "adjuster.leak_flow": np.where(LIFTS, LEAK, -1e-12),
        "adjuster.valve_flow": np.where(FILLS, 20.0 * LEAK, 0.0),
        "valve_spring.seat_dip": np.where(LIFTS, -8e-3 * bump, 15e-6),
        "valve_spring.seat_force": np.where(LIFTS, 0.0, 310.0),
    } | {name.replace("__", "."): values for name, values in changed.items()}
    return lambda name: columns.get(name, 0.0 * TIME)[rows]


def find(**changed):
    part = Part(read_motion(SYSTEM, read_columns(**changed)), "adjuster")
    return {name: figure(part) for name, (_, figure) in ADJUSTER.items()}


def test_leak_and_intake_move_the_plunger_by_their_volume_over_its_area():
    """Half a turn of 30 ms at 1e-7 m3/s are 3e-9 m3, on 63.6 mm2 47.2 um; filled in 9 of 360 degrees."""
    found = find()
    assert found["leak_down"].value == pytest.approx(LEAK * 0.03 / AREA, rel=1e-3)
    assert 1e6 * found["leak_down"].value == pytest.approx(47.2, abs=0.1)
    assert found["intake"].value == pytest.approx(20.0 * LEAK * 0.0015 / AREA, rel=1e-2)
    assert found["check_valve_open"].value == pytest.approx(9.0 / 360.0, rel=1e-2)
    assert TURNED[found["intake"].row] == pytest.approx(1.5 * np.pi, abs=2e-3)


def test_the_figure_of_the_train_has_the_leak_and_the_openings_of_the_run():
    """Not those of its revolution, whose rows lack the end of the turn."""
    scenario = load("direct-acting-hla")
    quantities = list_outputs(scenario)
    data = FigureData(
        title="", time=TIME, coupled={name: read_columns()(name) for name in quantities}, reference_time=TIME,
        reference={}, quantities=quantities, parameters=list_parameters(scenario), system=SYSTEM,
        drivers={target: source for source, target in map(parse_ends, scenario.connections)}, tolerance={},
    )  # fmt: skip
    remarks = [ax.get_title(loc="right") for ax in valve_train.draw(data).axes]
    found = find()
    opened, leak = 100.0 * found["check_valve_open"].value, 1e6 * found["leak_down"].value
    assert any(text.endswith(f"check valve open in {opened:.3g} %") for text in remarks)
    assert any(text.startswith(f"leaks {leak:.3g} µm in the turn") for text in remarks)


def test_extremes_stand_at_their_rows():
    found = find()
    for name, value in (("chamber_pressure", 9e6), ("shortening", 70e-6)):
        assert found[name].value == pytest.approx(value)
        assert TURNED[found[name].row] == pytest.approx(np.pi, abs=2e-3)
    assert found["shortening"].row > TIME.size // 2  # of the last turn
    assert (found["growth"].value, found["held_open"].value) == (pytest.approx(0.0, abs=1e-12), 0.0)
    assert found["seat_force_kept"].value == pytest.approx(310.0)
    assert found["largest_gap"].value == 0.0


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_lift_and_timing_are_lost_by_what_the_adjuster_shortens_in_both_senses(sense):
    """A lift of 8 mm (1 - cos)/2 that loses s at its top and foot: it passes 1 mm by s/(ds/dangle) later, and
    earlier as it closes; the valve keeps the angle where nothing is lost."""
    bump = np.where(LIFTS, 0.5 - 0.5 * np.cos(2.0 * (TURNED - 0.5 * np.pi)), 0.0)
    lost = np.where(LIFTS, 30e-6, 0.0)
    cam = {"tappet__cam_lift": 8e-3 * bump, "tappet__profile_angle": sense * ANGLE}
    valve = {"valve_spring__valve_lift": 8e-3 * bump - lost}
    found = find(**cam, **valve)
    assert found["lift_loss"].value == pytest.approx(30e-6)
    assert TURNED[found["lift_loss"].row] == pytest.approx(np.pi, abs=2e-3)
    slope = 8e-3 * math.sqrt(1.0 - (1.0 - 2.0 / 8.0) ** 2)
    for end, sign in (("opening", 1.0), ("closing", -1.0)):
        assert found[f"{end}_shift"].value == pytest.approx(sign * 30e-6 / slope, rel=2e-2)
    whole = find(**cam, valve_spring__valve_lift=8e-3 * bump)
    assert [whole[name].value for name in ("lift_loss", "opening_shift", "closing_shift")] == [0.0] * 3


def test_a_run_tells_of_pressure_leak_check_valve_and_seat():
    read = read_columns()
    (line,) = describe_adjusters(SYSTEM, list_merits(SYSTEM, {}, read), read)
    assert line == (
        "adjuster: highest chamber pressure 9 MPa at cam 180.0 deg of revolution 1; leaks 47.1 µm in a turn, "
        "and is at most 70 µm shorter; its check valve, open in 2.5 % of the turn, lets 47.2 µm in, most at "
        "cam 270.0 deg of revolution 2; does not pump up; the seat bears 310 N on the base circle"
    )
    read = read_columns(adjuster__valve_flow=0.0 * TIME)
    (line,) = describe_adjusters(SYSTEM, list_merits(SYSTEM, {}, read), read)
    assert "; its check valve stays closed; does not pump up" in line


def test_an_adjuster_that_pumps_up_is_told_by_its_growth_and_the_valve_it_holds_open():
    """It grows by 20 um in a turn; in the second one the valve does not reach its seat by 5 um."""
    grown = -15e-6 + 20e-6 * ANGLE / (2.0 * np.pi)
    found = find(adjuster__extension=grown)
    assert found["growth"].value == pytest.approx(20e-6, rel=1e-9)
    assert describe_growth(found["growth"].value, 0.0) == "pumps up by 20 µm in a turn"
    assert describe_growth(-20e-6, 0.0) == "sinks further by 20 µm from turn to turn"
    read = read_columns(
        adjuster__extension=grown,
        valve_spring__seat_dip=np.where(2.0 * np.pi > ANGLE, 15e-6, -5e-6),
        valve_spring__seat_force=0.0 * TIME,
    )
    (line,) = describe_adjusters(SYSTEM, list_merits(SYSTEM, {}, read), read)
    assert line.endswith(
        "has pumped up and holds the valve open by 5 µm; the seat bears 0 N on the base circle"
    )


def test_bodies_that_leave_the_plunger_are_told_with_gap_angle_speed_and_time():
    """Where the adjuster has no force they may be further apart than it is long."""
    apart = (1.2 * np.pi < TURNED) & (1.4 * np.pi > TURNED) & (2.0 * np.pi < ANGLE)
    gap = np.where(apart, 0.3e-3 * np.sin(5.0 * (TURNED - 1.2 * np.pi)), 0.0)
    length = -15e-6 - 70e-6 * np.where(LIFTS, np.sin(TURNED - 0.5 * np.pi), 0.0)
    changed = {"adjuster__force": np.where(apart, 0.0, 400.0), "valve_spring__position": length + gap}
    found = find(**changed)
    assert found["largest_gap"].value == pytest.approx(0.3e-3, rel=1e-4)
    assert np.degrees(found["largest_gap_angle"].value) == pytest.approx(234.0, abs=0.1)
    read = read_columns(**changed)
    (line,) = describe_adjusters(SYSTEM, list_merits(SYSTEM, {}, read), read)
    assert line.endswith(
        "; bodies leave its plunger by up to 300 µm at cam 234.0 deg of revolution 2, 1000 r/min and "
        f"t = 0.099 s: {UNHELD}"
    )


def test_less_than_a_turn_tells_of_the_pressure_alone():
    part = Part(read_motion(SYSTEM, read_columns(slice(0, 3000))), "adjuster")
    known = {name for name, (_, figure) in ADJUSTER.items() if np.isfinite(figure(part).value)}
    assert known == {"chamber_pressure", "largest_extension", "largest_gap"}
    read = read_columns(slice(0, 3000))
    (line,) = describe_adjusters(SYSTEM, list_merits(SYSTEM, {}, read), read)
    assert line == "adjuster: highest chamber pressure 9 MPa at cam 180.0 deg"


KEPT = "highest chamber pressure 10 MPa at 2000 r/min, largest leak in a turn 40 µm at 1000 r/min"
OPEN = "pumped up, it holds the valve open at 2 speeds, the lowest 2000 r/min, by at most 2000 µm"
AWAY = (
    "bodies leave its plunger at 2 speeds, the lowest 2000 r/min, by at most 50 µm at 2000 r/min and 90.0 deg"
    f": {UNHELD}"
)


@pytest.mark.parametrize(
    ("lost", "held", "gap", "said"),
    [
        ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], 0.0, [f"a: {KEPT}; the valve closes at all speeds"]),
        ([0.0, 0.0, 0.1], [0.0, 3e-6, 2e-3], 0.0, [f"a: where contact is kept, {KEPT}; {OPEN}"]),
        ([0.0, 0.0, 0.1], [np.nan] * 3, 0.0, [f"a: where contact is kept, {KEPT}"]),  # no seat
        ([0.1, 0.1, 0.1], [0.0, 3e-6, 2e-3], 5e-5, [f"a: {OPEN}; {AWAY}"]),
        ([0.1, 0.1, 0.1], [np.nan] * 3, 0.0, []),
    ],
)
def test_a_sweep_tells_where_contact_is_kept_the_valve_stays_open_and_bodies_leave(lost, held, gap, said):
    """Where the valve floats, chamber pressures are those of impacts."""
    pressure = [9e6, 1e7, 2e8 if lost[-1] else 9e6]
    columns = {"a.chamber_pressure": pressure, "a.leak_down": [4e-5, 2e-5, 1e-5], "a.held_open": held}
    columns |= {"a.largest_gap": [0.0, gap, 0.5 * gap], "a.largest_gap_angle": [np.nan, 0.5 * np.pi, 1.0]}
    table = xarray.Dataset(
        {name: ("speed", values) for name, values in (columns | {"contact.lost": lost}).items()},
        {"speed": np.array([1000.0, 2000.0, 3000.0]) * np.pi / 30.0},
    )
    assert describe_over_speed(table) == said


def test_every_adjuster_promises_what_is_read_of_it():
    component = SYSTEM.instances["adjuster"].component
    assert set(component.find_role(roles.Adjuster).promised) <= set(component.outputs.names)
    assert "plunger_diameter" in component.parameters.names
    assert {"lower_position", "upper_position"} <= set(component.inputs.names)
