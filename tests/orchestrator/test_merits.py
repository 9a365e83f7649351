"""What a run says first of its trains, and figures of merit, from columns whose answers are known."""

import csv
import math
import re
from collections import defaultdict
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.contact.records import ATOM
from models.core.quantities import Quantity, Vector
from models.core.system import Instance, System
from models.monolithic.cycle import Cycle
from orchestrator.assessment.contacts import ContactSummary, lines
from orchestrator.assessment.figures_of_merit import measure
from orchestrator.assessment.merits import (
    HEAD,
    Merit,
    describe,
    describe_bearings,
    describe_trains,
    list_merits,
    read_motion,
    write_merits,
)
from orchestrator.assessment.motion import Motion
from orchestrator.assessment.trains import Angle, find_turns
from orchestrator.run.summary import Summary
from orchestrator.scenario.display import show
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.study.speeds.subject import to_motion

# A turn of the cam in 0.06 s: 8 mm of lift about the nose, half a sine over 120 deg.
ANGLE = np.linspace(0.0, 2.0 * np.pi, 7201)
LIFT = 8e-3 * np.maximum(0.0, np.cos(1.5 * (ANGLE - np.pi))) * (np.abs(ANGLE - np.pi) < np.pi / 3.0)
CLOSED = np.flatnonzero(LIFT > 1e-9)[-1] + 1


SYSTEM = build_system(load("coil-clash"))


def read_columns(**changed: Vector) -> Callable[[str], Vector]:
    """Columns of a train, else 0."""
    columns = {
        "time": 0.06 * ANGLE / (2.0 * np.pi),
        "camshaft.profile_angle": ANGLE,
        "camshaft.cam_angle": ANGLE,
        "camshaft.cam_lift": LIFT,
        "contact.load": 300.0 + 0.0 * ANGLE,
        "spring.force": np.where(LIFT > 4e-3, 400.0, 310.0),
        "valve.seat_dip": np.where(LIFT > 1e-9, -LIFT, 1e-6),
        "valve.position": LIFT,
        "valve.velocity": np.where(np.arange(ANGLE.size) == CLOSED - 1, -0.25, 0.0),
        "spring.least_gap": 1e-3 - 0.1 * LIFT,
        "contact.maximum_pressure": 5e8 * LIFT / 8e-3,
        "contact.film_ratio": 0.5 + 0.0 * ANGLE,
        "contact.friction_force": 12.0 + 0.0 * ANGLE,
        "camshaft.sliding_velocity": 2.0 + 0.0 * ANGLE,
    } | {name.replace("__", "."): values for name, values in changed.items()}

    return lambda name: columns.get(name, 0.0 * ANGLE)


def measure_valve(settings: list[str], lift: Vector) -> dict[str, float]:
    """Figures of a direct train's valve that lands where the cam's lift is this."""
    system = build_system(load("seat-and-lash", settings))
    columns = {"camshaft.cam_lift": lift, "valve_spring.seat_dip": np.where(LIFT > 1e-9, -LIFT, 1e-6)}
    columns["camshaft.cam_angle"] = columns["camshaft.profile_angle"] = ANGLE
    motion = Motion(system, 0.01 * ANGLE, lambda name: columns.get(name, 0.0 * ANGLE), None)
    return {name: found.value for part, name, _, found in measure(motion) if part == "valve_spring"}


def test_a_valve_that_lands_after_the_lash_has_no_ramp_left(tmp_path):
    """0.3 mm of ramp by a law, and 0.25 mm at 0.01 mm/deg in a table, of which 0.22 mm are straight; 0.1 mm
    of lash. A valve in flight lands when the cam has passed it."""
    degrees = np.arange(0.0, 360.0)
    ramp = 0.25 * np.clip((91.0 - np.abs(degrees - 180.0)) / 25.0, 0.0, 1.0)
    event = 8.75 * np.cos(0.5 * np.pi * np.clip(np.abs(degrees - 180.0) / 66.0, 0.0, 1.0)) ** 3
    rows = "".join(f"{a:g}, {s:.4f}\n" for a, s in zip(degrees, ramp + event, strict=True))
    (tmp_path / "cam.csv").write_text("cam angle [deg], lift [mm]\n" + rows)
    table = [f"components.camshaft.lift_table={tmp_path / 'cam.csv'}"]
    table.append("components.camshaft.parameters.base_radius=60 mm")
    lash = ["components.valve_spring.parameters.lash=0.1 mm"]
    for settings, height, near in (([], 0.3e-3, 1e-9), (table, 0.22e-3, 0.01)):
        found = measure_valve([*settings, *lash], LIFT + 0.15e-3)
        assert found["landing_lift"] == pytest.approx(0.15e-3, rel=0.08)  # a row is 10 um further
        assert found["ramp_left"] == pytest.approx(found["landing_lift"] / height, rel=near)
        flown = measure_valve([*settings, *lash], LIFT + 0.05e-3)
        assert math.isnan(flown["landing_lift"])
        assert math.isnan(flown["ramp_left"])


def told(**changed: Vector) -> str:
    """The line of the train."""
    read = read_columns(**changed)
    (line,) = describe_trains(SYSTEM, list_merits(SYSTEM, {}, read), read)
    return line


def test_a_run_says_first_whether_its_valve_follows_lands_and_what_it_bears():
    assert told() == (
        "valve: spring margin 75 % (least load on the open valve over the force of its springs); "
        "hardest seating 0.25 m/s at cam 239.9 deg; does not bounce; "
        "no clash of coils, 0.2 mm of travel left to coil bind; "
        "highest pressure 500 MPa in contact; least film ratio 0.5 in contact; "
        "at the nose 500 MPa, film ratio 0.5 in contact; "
        "friction 24 W in the mean of the run: 0 W in the motion, 24 W outside, of "
        "cam contact (contact), rolling (contact)"
    )


@pytest.mark.parametrize(("reached", "margin"), [(0.3e-3, ""), (4e-3, ""), (5e-3, "75 %"), (8e-3, "75 %")])
def test_a_run_that_ends_in_the_lift_has_the_margin_of_the_open_valve_or_none(reached, margin):
    """The valve bounces as the lash is taken up, to 0.3 mm: below a twentieth of the cam's 8.3 mm."""
    read = read_columns(contact__load=np.where(LIFT < 0.3e-3, 0.0, 300.0))
    end = np.flatnonzero(0.999 * reached <= LIFT)[0]
    merits = list_merits(SYSTEM, {}, lambda name: read(name)[:end])
    assert [merit.text for merit in merits if merit.figure == "spring_margin"] == [margin] * bool(margin)


@pytest.mark.parametrize(("ratio", "slope"), [(0.5, 1e-3), (1.5, 1e-3), (0.5, 0.01)])
def test_a_run_says_where_its_friction_depends_on_default_asperities(ratio, slope):
    system = build_system(load("coil-clash", [f"components.contact.parameters.asperity_slope={slope}"]))
    read = read_columns(contact__film_ratio=ratio + 0.0 * ANGLE)
    told = describe(system, list_merits(system, {}, read), read)
    soft = [line for line in told if line.startswith("contact: the film is thinner than the roughness")]
    assert len(soft) == (ratio < 1.0 and slope == 1e-3)


def test_coil_bind_by_a_default_is_said_beside_the_travel_that_is_left():
    system = build_system(load("seat-and-lash"))
    merits = [Merit("valve_spring", "least_gap", 12e-3, Quantity("m", "gap", display_unit="mm"))]
    (line,) = describe_trains(system, merits, read_columns())
    assert line.endswith("no clash of coils, 12 mm of travel left to coil bind by the component's default")


def test_a_run_tells_the_friction_of_all_shares():
    """Of a roller finger: rolling, slip, pin, tip and guide. The pad has the friction of its contact."""
    system = build_system(load("roller-friction"))
    merits = [
        Merit(part, figure, 1.0, Quantity("W", "power"))
        for part in system.instances
        for figure in ("friction_power", "rolling_power")
    ]
    (line,) = describe_trains(system, merits, read_columns())
    assert "friction 5 W in the mean of the run" in line


HOP = np.zeros(ANGLE.size)
HOP[CLOSED + 100 : CLOSED + 200] = 30e-6


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"contact__load": 9.0 * (abs(ANGLE - np.pi) > np.pi / 60.0)}, "contact is lost in 1.67 % of"),
        ({"valve__seat_dip": np.where(LIFT > 1e-9, -LIFT, 1e-6) - HOP}, "bounces by 29 µm"),
        ({"valve__seat_dip": -0.114e-3 - LIFT}, "; never closes, held open by 0.114 mm;"),
        ({"spring__clash_force": 45.0 * LIFT / 8e-3}, "coils of spring clash with up to 45 N"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_train_is_named(changed, said):
    """6 deg of the turn are 1.67 %."""
    assert said in told(**changed)


def test_coils_that_clash_are_warned_of_unless_they_close_one_after_the_other():
    """Half a sine over 120 deg has half its 8 mm of lift 40 deg before its nose."""
    read = read_columns(spring__least_gap=4e-3 - LIFT)

    def warn(system: System) -> list[str]:
        return [line for line in describe(system, list_merits(system, {}, read), read) if "coil bind" in line]

    (said,) = warn(SYSTEM)
    assert said.startswith(
        "warning: components.spring: its coils clash from cam 140.1 deg on; at cam 180.0 deg the tightest "
        "are 4 mm of travel beyond coil bind; fewer coils"
    )
    assert "coils of spring clash; " in told(spring__least_gap=4e-3 - LIFT)
    gaps = [f"components.spring.parameters.gap[1] = {gap} mm" for gap in (0.5, 0.9278)]
    assert [len(warn(build_system(load("coil-clash", [gap])))) for gap in gaps] == [0, 1]


@pytest.mark.parametrize(
    ("first", "turned", "turns"), [(0.0, 1.0, []), (0.0, 2.0, [1, 2]), (0.3, 2.0, [0, 1])]
)
def test_places_of_a_run_of_several_revolutions_have_theirs(first, turned, turns):
    """Whole ones count from 1, as in the figure of the train."""
    rows = {"time": np.arange(3.0), "cam.angle": 2.0 * np.pi * (first + turned * np.array([0.0, 0.5, 1.0]))}
    assert find_turns(Angle("cam_angle", "cam.angle"), [0.5, 1.5], rows.__getitem__) == turns


def test_one_run_has_the_same_figures_in_print_in_its_table_and_as_a_cycle(tmp_path):
    """To the six digits of the table."""
    read = read_columns(valve__seat_dip=np.where(LIFT > 1e-9, -LIFT, 1e-6) - HOP)
    merits = list_merits(SYSTEM, {}, read)
    write_merits(SYSTEM, merits, [], read, tmp_path / "summary.csv")
    rows = csv.DictReader((tmp_path / "summary.csv").read_text("utf-8-sig").splitlines())
    table = {(row["part"], row["figure of merit"]): float(row["value"]) for row in rows}
    assert table["all parts", "mean friction power"] == pytest.approx(24.0, rel=1e-5)
    inputs, outputs = (
        np.transpose([read_motion(SYSTEM, read).column(name) for name in layout.names])
        for layout in (SYSTEM.inputs, SYSTEM.outputs)
    )
    cycle = Cycle(SYSTEM, read("time"), inputs, outputs, SYSTEM.x0, 0.0, 1)
    found = {(part, figure): one.value for part, figure, _, one in measure(to_motion(cycle, "flywheel"))}
    said, (line,) = [], describe_trains(SYSTEM, merits, read)
    for merit in merits:
        assert found[merit.part, merit.figure] == merit.value
        shown = show(merit.quantity).factor * merit.value
        assert table[merit.part, merit.quantity.description] == pytest.approx(shown, rel=5e-6)
        said += [merit.figure] if merit.text in line else []
    first = {"spring_margin", "seating_velocity", "bounce", "least_gap", "peak_pressure", "friction_power"}
    assert first <= set(said)


def test_films_of_bearings_are_told_and_doubted_near_the_bush():
    far = {"bearing_1.eccentricity_ratio": 0.5, "bearing_2.eccentricity_ratio": 0.97}
    films = {f"{name.split('.')[0]}.minimum_film_thickness": 25e-6 * (1.0 - e) for name, e in far.items()}
    system, rows = build_system(load("shaft-in-bearings")), np.array([0.0, 1.0, 2.0])
    films["bearing_2.minimum_film_thickness"] *= np.array([3.0, 1.0, 2.0])
    loads = {
        "bearing_2.load": np.array([90.0, 450.0, 700.0]),
        "flywheel.angle": np.radians([0.0, 210.0, 300.0]),
    }

    def read(name):
        return 1.0 * rows if name == "time" else (far | films | loads).get(name, 0.0) + 0.0 * rows

    near, safe = describe_bearings(system, list_merits(system, {}, read), read)
    assert near.startswith(
        "bearing_2: least film 0.75 µm at cam 210.0 deg under 450 N, largest eccentricity 0.97 of the "
        "clearance, above 0.95: rough"
    )
    assert safe.startswith(
        "bearing_1: least film 12.5 µm at cam 0.0 deg under 0 N, largest eccentricity 0.5 of the clearance;"
    )


@pytest.mark.parametrize(
    ("name", "model", "degrees", "said"),
    [
        ("journal_bearing", "grooved", 100.0, "10 deg beside .* '0 deg'"),
        ("journal_bearing", "grooved", -52.0, "38 deg beside .* '0 deg'"),
        ("journal_bearing", "grooved", -48.0, ""),
        ("journal_bearing", "finite", 100.0, ""),
        ("pin_bearing", "grooved", 11.0, "11 deg beside .* '90 deg'"),
        ("pin_bearing", "grooved", 90.0, ""),
    ],
)
def test_a_groove_in_the_load_zone_is_told_with_what_to_change(name, model, degrees, said):
    """The journal's load points along -y, the pin's along x; one groove is opposite to the other."""
    films = ("short", "finite", "grooved")
    parameters = {"film_model": float(films.index(model)), "groove_angle": math.radians(degrees)}
    system, rows = System({"bearing": Instance(CATALOGUE[name](), parameters)}, []), np.arange(3.0)
    columns = {"bearing.force_y": 400.0 + 0.0 * rows, "bearing.minimum_film_thickness": 1e-6 * (2.0 + rows)}

    def read(name):
        return rows if name == "time" else columns.get(name, 0.0 * rows)

    (line,) = describe_bearings(system, list_merits(system, {}, read), read)
    groove = f"at the least film the load points {said}, at a right angle" if said else "^((?!groove).)*$"
    assert re.search(groove, line)


@pytest.mark.parametrize(
    ("film", "said"),
    [
        (2e-10, "; no film of smooth surfaces at t = 3 s, least film ratio 0.01 under the fluid's share of"),
        (1e-9, "; least film 0.001 µm at t = 3 s"),
    ],
)
def test_a_film_below_an_atom_is_none(film, said):
    summary = ContactSummary(1.0, 2.0, 1.0, 0.0, 1e8, 2.0, 1e9, 0.0, film, 3.0, 0.01, 1e-5)
    assert said in lines({"contact": summary}, True)[0]
    whole = Summary("", "", "", {}, 1e-5, True, {}, contacts={"contact": summary})
    assert whole.content()["contacts"]["contact"]["film"] == (film if film > ATOM else 0.0)
    # The first steps of a run that was ended say nothing of its contacts.
    tells = [
        replace(whole, complete=complete, macro_steps=n).tell()
        for complete, n in ((False, 499), (False, 500), (True, 9))
    ]
    assert list(map(bool, tells)) == [False, True, True]


def measure_over(cycle: Cycle, angle: np.ndarray) -> dict[str, float]:
    """The figures of a cycle whose parts are read over this angle (rad)."""

    def column(name: str) -> np.ndarray:
        return angle if name == "shaft.angle" else cycle[name]

    motion = Motion(cycle.system, cycle.times, column, Angle("shaft_angle", "shaft.angle"))
    return {f"{part}.{name}": found.value for part, name, _, found in measure(motion)}


def valve_cycle(lift: np.ndarray, pressed: float = 1.0, position: float = 0.0) -> Cycle:
    """A made cycle of a valve with a seat, by lifts from a position; its spring presses with a share."""
    component = CATALOGUE["valve_spring"]()
    system = System({"valve": Instance(component, {"seat_stiffness": 1e7})}, ())
    times = np.linspace(0.0, 1.0, lift.size)
    outputs = np.zeros((lift.size, component.outputs.size))

    def put(name: str, values: np.ndarray | float) -> None:
        outputs[:, component.outputs.index(name)] = values

    put("position", position + lift)
    put("velocity", np.gradient(lift, times))
    put("valve_lift", lift)
    put("seat_dip", -lift)
    put("spring_force", pressed * (330.0 + 35e3 * (position + lift)))
    inputs = np.full((lift.size, component.inputs.size), 165.0)
    return Cycle(system, times, inputs, outputs, system.x0, 0.0, 1)


def test_numbers_of_a_made_cycle():
    """A valve that lands with 20 mm/s, bounces by 0.1 mm, and is pressed with half of its spring's force."""
    share = np.linspace(0.0, 1.0, 3601)
    lift = np.interp(
        share, [0.0, 0.2, 0.5, 0.9, 0.92, 0.94, 1.0], [-1e-6, -1e-6, 8e-3, -1e-6, 1e-4, -1e-6, -1e-6]
    )
    found = measure_over(valve_cycle(lift), 2.0 * math.pi * share)
    assert found["valve.largest_lift"] == pytest.approx(8e-3)
    assert found["valve.seating_velocity"] == pytest.approx(8e-3 / 0.4, rel=1e-3)
    assert found["valve.bounce"] == pytest.approx(1e-4, rel=1e-3)
    assert found["valve.spring_margin"] == pytest.approx(165.0 / (330.0 + 35e3 * 8e-3))
    assert found["valve.surge_force"] == pytest.approx(0.0, abs=1e-9)
    free = measure_over(valve_cycle(lift, pressed=0.0), 2.0 * math.pi * share)
    assert math.isnan(free["valve.spring_margin"])
    shut = valve_cycle(np.full(share.size, -1e-6), position=2e-4)
    assert math.isnan(measure_over(shut, 2.0 * math.pi * share)["valve.spring_margin"])


def test_losses_on_the_flanks_and_over_the_nose_are_told_apart():
    """A harmonic lift slows the valve in its upper half. A loss belongs to where it begins."""
    kinds = {"cam": CATALOGUE["camshaft"](), "contact": CATALOGUE["ehl_contact"]()}
    system = System({name: Instance(kind, {}) for name, kind in kinds.items()}, ())
    share = np.linspace(0.0, 1.0, 3601)
    angle = 2.0 * math.pi * share
    made = {"cam.cam_lift": 4e-3 * (1.0 - np.cos(angle)), "cam.cam_angle": angle}

    def lose(*spans):
        lost = np.any([(share >= begin) & (share < end) for begin, end in spans], axis=0)
        outputs = np.zeros((share.size, sum(kind.outputs.size for kind in kinds.values())))
        cycle = Cycle(system, share, np.zeros((share.size, system.inputs.size)), outputs, system.x0, 0.0, 1)
        for name, values in (made | {"contact.load": np.where(lost, 0.0, 500.0)}).items():
            cycle[name][:] = values
        found = measure_over(cycle, angle)
        return found["contact.lost"], found["contact.lost_on_nose"]

    # A loss ends between two samples.
    close = 0.6 / 3600
    on_flank, on_nose, across = (0.15, 0.20), (0.45, 0.55), (0.24, 0.30)
    assert lose() == (0.0, 0.0)
    assert lose(on_flank) == pytest.approx((0.05, 0.0), abs=close)
    assert lose(across) == pytest.approx((0.06, 0.0), abs=close)
    assert lose(on_nose) == pytest.approx((0.1, 0.1), abs=close)
    assert lose(on_flank, on_nose) == pytest.approx((0.15, 0.1), abs=2 * close)


def test_numbers_of_a_made_cycle_of_a_bearing():
    """Extremes, and the mean of a loss that rises from 0 to 6 W and stays there as long."""
    component = CATALOGUE["journal_bearing"]()
    times = np.linspace(0.0, 1.0, 201)
    outputs = np.zeros((times.size, component.outputs.size))
    made = {
        "load": 500.0 * times,
        "minimum_film_thickness": 3e-6 - 1e-6 * times,
        "film_ratio": 7.5 - 2.5 * times,
        "eccentricity_ratio": 0.88 + 0.04 * times,
        "maximum_pressure": 8e6 * times,
        "power_loss": np.minimum(12.0 * times, 6.0),
    }
    for name, values in made.items():
        outputs[:, component.outputs.index(name)] = values
    system = System({"bearing": Instance(component, {})}, ())
    inputs = np.zeros((times.size, component.inputs.size))
    found = measure_over(Cycle(system, times, inputs, outputs, system.x0, 0.0, 1), 2.0 * math.pi * times)
    assert found == pytest.approx(
        {
            "bearing.bearing_load": 500.0,
            "bearing.least_film": 2e-6,
            "bearing.least_film_ratio": 5.0,
            "bearing.largest_eccentricity": 0.92,
            "bearing.load_from_groove": math.nan,
            "bearing.peak_pressure": 8e6,
            "bearing.friction_power": 4.5,
        },
        nan_ok=True,
    )


def test_each_number_has_its_unit_angle_time_and_speed(tmp_path):
    """A turn of 60 ms in ten parts, 1000 r/min: row 3 is at 108 deg and 18 ms."""
    columns: dict[str, Vector] = defaultdict(lambda: np.zeros(11))
    columns["time"] = np.linspace(0.0, 0.06, 11)
    columns["flywheel.angle"] = columns["camshaft.cam_angle"] = np.linspace(0.0, 2.0 * np.pi, 11)
    columns["valve_spring.spring_force"] = np.where(np.arange(11) == 3, 500.0, 300.0)
    columns["valve_spring.valve_lift"] = np.where(np.arange(11) == 5, 8e-3, 0.0)

    system, read = build_system(load("valve-train")), columns.__getitem__
    write_merits(system, list_merits(system, {}, read), ["warning: a row"], read, tmp_path / "summary.csv")
    text = (tmp_path / "summary.csv").read_bytes()
    assert text.startswith(b"\xef\xbb\xbf")  # by which a spreadsheet knows UTF-8
    head, *rows = csv.reader(text.decode("utf-8-sig").splitlines())
    assert tuple(head) == HEAD
    found = {(row[0], row[1]): row[2:] for row in rows}
    assert rows[-2][:4] == ["all parts", "mean friction power", "0", "W"]
    assert rows[-1] == ["run", "warning", *[""] * 7, "warning: a row"]
    force = found["valve_spring", "largest spring force"]
    assert force == ["500", "N", "108.00", "cam", "18", "1000", "", ""]
    lift = found["valve_spring", "largest lift"]
    assert (float(lift[0]), lift[1]) == (pytest.approx(8.0), "mm")
