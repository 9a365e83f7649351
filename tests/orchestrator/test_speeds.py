"""tribocosim speeds: cycles of a scenario over speed, continued where it stopped."""

import csv
import html
from dataclasses import replace
from io import StringIO
from types import SimpleNamespace

import numpy as np
import pytest
import xarray
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

import tribocosim
from models.catalogue import CATALOGUE
from models.core.system import ModelError
from models.monolithic.cycle import STEADY
from orchestrator.assessment.friction.shares import add_losses
from orchestrator.errors import MistakeError
from orchestrator.plots.speeds import find_orders
from orchestrator.reporter import Reporter
from orchestrator.scenario.files import load, read_changed, to_full_toml
from orchestrator.scenario.system import build_system, list_parameters
from orchestrator.store.output_folder import RESULT, STORE
from orchestrator.study.speeds import separation
from orchestrator.study.speeds import subject as speeds_subject
from orchestrator.study.speeds.compare import Choice, find_worst, parse_choice, select_speeds
from orchestrator.study.speeds.separation import RPM
from orchestrator.study.speeds.subject import SpeedSubject, describe_numbers
from orchestrator.study.speeds.sweep import read_table, report_cycles
from tribocosim.reporting import SilentReporter

from .commands import called, said

SWEEP = ("speeds", "valve-train", "--from", "1000 rpm", "--to", "3400 rpm", "--count", "3", "--workers", "1",
         "--second-film", "kushwaha", "--set", "components.camshaft.parameters.power_p=7")  # fmt: skip


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    out = tmp_path_factory.mktemp("speeds") / "train"
    done = called(*SWEEP, "--out", str(out))
    assert done.returncode == 0, done.stderr
    return out, done.stdout


def test_a_sweep_leaves_a_table_cycles_and_figures(swept):
    out, said_text = swept
    rows = list(csv.DictReader((out / "speeds.csv").read_text("utf-8-sig").splitlines()))
    assert [row["speed [r/min]"] for row in rows] == ["1000.0", "2200.0", "3400.0"]
    pressures = [float(row["contact.peak_pressure [MPa]"]) for row in rows]
    np.testing.assert_allclose(pressures, 1e-6 * read_table(out)["contact.peak_pressure"].values, rtol=1e-11)
    assert set(describe_numbers(load("valve-train"))) <= {name.split(" ")[0] for name in rows[0]}
    for name in ("speeds.png", "contact-load-map.png", "contact-load-campbell.png"):
        assert (out / name).stat().st_size > 10_000
    page = html.unescape((out / "report.html").read_text("utf-8"))
    assert f"tribocosim speeds {out / 'swept.toml'} --from " in page
    doubt = "camshaft.parameters.power_p: has an effect only where law is high_powers"
    soft = "contact: the film is thinner than the roughness, and the asperities are the default ones"
    for text in (said_text, page, (out / "summary.json").read_text("utf-8")):
        assert doubt in text
        assert soft in text
    again = load(out / "swept.toml")
    assert to_full_toml(again) == (out / "swept.toml").read_text("utf-8")
    assert list_parameters(again) == list_parameters(load("valve-train")) | {"camshaft.power_p": 7.0}
    with xarray.open_dataset(out / "cycles.nc", engine="h5netcdf") as cycles:
        assert dict(cycles.sizes) == {"speed": 3, "share": 721}
        lift = cycles["camshaft.cam_lift"]
        least = cycles["contact.load"].where(lift > 0.1 * lift.max()).min("share").values
    # The file has every tenth of the samples that the table is made of.
    found = np.array([float(row["contact.least_load [N]"]) for row in rows])
    assert (found <= least).all()
    np.testing.assert_allclose(found, least, rtol=0.02)


def test_friction_of_a_sweep_has_its_shares_over_speed(swept, tmp_path):
    """Torques on the drive are powers over its speed, as a table and as a figure."""
    out, _ = swept
    table, figure = tmp_path / "friction.csv", tmp_path / "friction.png"
    done = called("friction", str(out), "--table", str(table), "--figure", str(figure))
    assert done.returncode == 0, done.stderr
    assert figure.stat().st_size > 10_000
    rows, found = list(csv.DictReader(table.read_text("utf-8-sig").splitlines())), read_table(out)
    steady = found["change"].values <= STEADY
    assert [row["design"] for row in rows] == ["train"] * steady.sum()
    assert ("left out" in done.stdout) == (not steady.all())
    found = found.isel(speed=np.flatnonzero(steady))
    for share, name in (("cam contact", "contact.friction_power"), ("rolling", "contact.rolling_power")):
        powers = [float(row[f"{share} [W]"]) for row in rows]
        np.testing.assert_allclose(powers, found[name].values, rtol=1e-12)
    for row in rows:
        shares = float(row["cam contact [N.m]"]) + float(row["rolling [N.m]"])
        assert float(row["sum [N.m]"]) == pytest.approx(shares, rel=1e-12)
        assert f"{1e3 * shares:.0f}" in done.stdout
        # All of this friction is outside the motion.
        whole = float(row["drive with all friction [N.m]"])
        assert whole == pytest.approx(float(row["drive [N.m]"]) + shares, rel=1e-12)
    whole = add_losses(found, build_system(load("valve-train")))["whole train.friction_power"].values
    np.testing.assert_allclose([float(row["sum [W]"]) for row in rows], whole, rtol=1e-12)
    wrong = called("friction", str(out), "--table", str(tmp_path / "friction.nc"))
    assert "must end in .csv" in said(wrong)


@pytest.mark.parametrize(
    "option", [("--contact", "contact"), ("--wear-coefficient", "1e-17"), ("--cycles", "50.0")]
)
def test_what_only_a_run_has_is_refused_of_a_sweep(option, swept):
    """Also where the value is the usual one."""
    done = called("friction", str(swept[0]), *option)
    assert done.returncode == 2
    assert f"{' '.join(option)}: has no effect" in said(done)


def test_friction_stress_and_orders_follow_from_the_cycles(swept):
    """Power is torque times speed; the stress is over the contact's elastic limit; orders are harmonics."""
    out, _ = swept
    table = read_table(out)
    speed = table["speed"].values
    power, torque = table["contact.friction_power"].values, table["contact.friction_torque"].values
    np.testing.assert_allclose(torque * speed, power, rtol=1e-9)
    peak = table["contact.peak_pressure"].values
    np.testing.assert_allclose(table["contact.stress_ratio"].values, peak / (1.67 * 1.2e9), rtol=1e-12)
    with xarray.open_dataset(out / "cycles.nc", engine="h5netcdf") as cycles:
        # The spring's surge between a follower on its cam and the seat of the spring, which hardly move.
        assert cycles.attrs["natural_frequencies"][0] == pytest.approx(504.5, rel=1e-3)
        assert cycles.attrs["damping_ratios"][0] == pytest.approx(0.02, rel=0.01)
        load = cycles["contact.load"].values[0]
        _, amplitude = find_orders(cycles["contact.load"])
    angle = np.linspace(0.0, 2.0 * np.pi, load.size)
    second = np.trapezoid(load * np.exp(-2j * angle), angle) / np.pi
    # Both ends of the cycle agree within 1e-5.
    assert amplitude[0, 1] == pytest.approx(abs(second), rel=1e-5)


def test_the_area_under_the_lift_is_that_of_the_cam(swept):
    """S (B + 2 d) of a cycloid's rise and fall with a dwell, less what the contact gives under its load."""
    out, said_text = swept
    table = read_table(out)
    p = CATALOGUE["camshaft"]().parameters
    rise, dwell = p.field("rise_angle").start, p.field("dwell_half_width").start
    exact = p.field("lift").start * (rise + 2.0 * dwell)
    area = table["valve_spring.lift_area"].values
    np.testing.assert_allclose(area, exact, rtol=5e-3)
    assert "valve_spring: the area under its lift is" in said_text


def test_it_tells_the_speed_of_separation(swept):
    """Between the last speed with contact and the first one without."""
    _, said_text = swept
    (line,) = (line for line in said_text.splitlines() if line.startswith("contact is lost from"))
    assert 2200.0 < float(line.split()[4]) < 3400.0
    rows = {line.split("│")[1].strip(): line for line in said_text.splitlines() if line.startswith("│")}
    assert "contact lost" in rows["3400"]
    assert "contact lost" not in rows["1000"]


@pytest.mark.parametrize(
    ("width", "numbers", "left"), [(60, 5, []), (50, 3, ["seating, lands at lift: see speeds.csv"])]
)
def test_a_table_of_speeds_names_the_columns_that_it_has_no_room_for(width, numbers, left):
    """No number is cut."""
    names = ("least_load", "largest_load", "spring_margin", "seating_velocity", "landing_lift")
    columns = {f"contact.{name}": ("speed", [1234.5, 2345.6]) for name in names}
    columns |= {"contact.lost": ("speed", [0.0, 0.0]), "change": ("speed", [0.0, 1.0])}
    text = StringIO()
    table = xarray.Dataset(columns, {"speed": np.array([1000.0, 2000.0]) / RPM})
    report_cycles(Reporter(Console(file=text, width=width)), table)
    lines = text.getvalue().splitlines()
    (row,) = (line for line in lines if line.startswith("│2000"))
    assert row.split("│")[-2] == "not steady"
    assert row.count("2346") == numbers
    assert [line.partition("too narrow for ")[2] for line in lines if "too narrow" in line] == left


def test_contacts_that_are_lost_are_named_below_a_narrow_table():
    """Each once; a lost speed takes one line."""
    numbers = {"cam.lost": [0.0, 0.1, 0.1], "tip.lost": [0.0, 0.0, 0.2], "change": [0.0, 0.0, 0.0]}
    table = xarray.Dataset(
        {n: ("speed", v) for n, v in numbers.items()}, {"speed": np.array([1, 2, 3]) / RPM}
    )
    text = StringIO()
    report_cycles(Reporter(Console(file=text, width=60)), table)
    assert len([line for line in text.getvalue().splitlines() if line.startswith("│")]) == 3
    assert "contact is lost in cam at 2 r/min\ncontact is lost in cam, tip at 3 r/min" in text.getvalue()


@pytest.mark.parametrize(
    ("loads", "end"), [((400.0, 250.0), 3600), ((400.0, 390.0), 6000), ((300.0, 300.0), 2600)]
)
def test_a_sweep_that_keeps_contact_says_where_to_go_on(loads, end):
    """L = 450 - 50 (n/1000 r/min)^2 is gone at 3000 r/min; 20 % more is swept, at most three times the speed,
    and 30 % more where the load does not fall."""
    numbers = {"a.least_load": loads, "b.least_load": (500.0, np.nan), "a.lost": (0.0, 0.0)}
    table = xarray.Dataset(
        {n: ("speed", list(v)) for n, v in numbers.items()},
        {"speed": [1e3 / separation.RPM, 2e3 / separation.RPM]},
    )
    said = separation.find_separation(None, table, None)
    assert said.speed is None
    assert said.text.endswith(f"go on from 2000 to {end} r/min")


@pytest.mark.parametrize(
    ("options", "place"), [((), "at 2200"), (("--lost",), "at 3400"), (("--at", "1100 rpm"), "")]
)
def test_two_sweeps_are_compared(options, place, swept, tmp_path):
    """With itself: all numbers twice. At 3400 r/min contact is lost."""
    out, _ = swept
    done = called("compare", str(out), str(out), "--out", str(tmp_path / "both.png"), *options)
    assert done.returncode == 0, done.stderr
    (line,) = (line for line in done.stdout.splitlines() if "contact.largest_load" in line)
    cells = [cell.strip() for cell in line.split("│")]
    assert cells[3].endswith(place)
    assert ("at" in cells[3]) == bool(place)  # the speed that is asked for stands above the table
    assert done.stdout.count("contact is lost from") >= 1
    assert (tmp_path / "both.png").stat().st_size > 10_000


def make_sweep(speeds: list[float], lost_from: float) -> xarray.Dataset:
    """A largest load that grows with the speed (rad/s), and contact that is lost from a speed on."""
    speed = np.array(speeds)
    values = {"contact.least_load": -speed, "contact.lost": (speed >= lost_from) * 0.1}
    values["contact.least_load_angle"] = speed / 100.0
    return xarray.Dataset({name: ("speed", column) for name, column in values.items()}, {"speed": speed})


@pytest.mark.parametrize(
    ("choice", "first", "second"),
    [
        ({}, [100.0, 200.0], [150.0]),  # 300 is lost in the first, 250 has it as its nearest
        ({"lost": True}, [100.0, 200.0, 300.0], [150.0, 250.0, 300.0]),
        ({"low": 180.0}, [200.0], []),
        ({"high": 120.0}, [100.0], []),
        ({"at": 290.0}, [300.0], [300.0]),
    ],
)
def test_designs_are_compared_where_both_keep_contact(choice, first, second):
    tables = [make_sweep([100.0, 200.0, 300.0], 300.0), make_sweep([90.0, 150.0, 260.0, 300.0], 1e9)]
    tables[1] = tables[1].assign_coords(speed=[90.0, 150.0, 250.0001, 300.0])
    found = select_speeds(tables, Choice(**choice))
    assert [list(np.round(table["speed"].values)) for table in found] == [first, second]


@pytest.mark.parametrize(
    ("texts", "said"),
    [
        (("3000 rpm", "1000 rpm", None), "must not be more than"),
        ((None, "1000 rpm", "900 rpm"), "is one speed"),
        (("fast", None, None), "fast"),
    ],
)
def test_speeds_of_a_comparison_that_make_no_sense(texts, said):
    with pytest.raises(MistakeError, match=said):
        parse_choice(*texts, lost=False)


def test_the_worst_has_its_speed_and_angle():
    """Of loads and of the area under the lift it is the least."""
    table = make_sweep([100.0, 200.0], 1e9).assign({"valve.lift_area": ("speed", [1e-3, 2e-3])})
    load = find_worst(table, "contact.least_load", 1.0)
    assert (load.describe(True), load.describe(False)) == ("-200 at 1910, 115°", "-200 at 115°")
    assert find_worst(table, "valve.lift_area", 1e3).describe(True) == "1 at 955"


def test_a_run_and_a_sweep_are_not_compared(tmp_path):
    run, sweep = tmp_path / "run", tmp_path / "sweep"
    (sweep / STORE).mkdir(parents=True)
    run.mkdir()
    (run / RESULT).touch()
    for folders in ((run, sweep), (sweep, run)):
        done = called("compare", *map(str, folders))
        assert done.returncode == 2
        assert said(done).endswith(
            f"{sweep}: is a sweep over speed, and {run} a run; compare two sweeps, or two runs"
        )


def test_a_sweep_that_broke_off_has_no_page(tmp_path):
    """No stage begins before it says so."""
    (tmp_path / STORE).mkdir()
    refused = called("report", str(tmp_path))
    assert (refused.returncode, refused.stdout) == (2, "")
    assert said(refused).endswith(f"{tmp_path}: its sweep broke off; the same command continues it")


def test_a_second_film_formula_is_sought_from_where_contact_is_lost_first(monkeypatch):
    """Of a train that is lost above a speed known for each formula, in contacts only; the verdict names the
    speeds without a steady cycle."""
    tables = read_changed("valve-train", [])
    limits = {"dowson_toyoda": 3306.0, "dry": 1234.0, "moes_venner": 9999.0}
    speeds = np.linspace(1000.0, 3600.0, 27) / separation.RPM

    def find_cycle(subject, speed):
        film = subject.tables["components"]["contact"]["parameters"]["film_model"]
        return SimpleNamespace(
            motion=(film, speed), steady=film != separation.OTHER or separation.RPM * speed < 3450.0
        )

    def is_lost(motion, number):
        film, speed = motion
        return separation.RPM * speed >= limits[film] + 100.0 * (number == "lost_on_nose")

    monkeypatch.setattr(SpeedSubject, "find_cycle_at", find_cycle)
    monkeypatch.setattr(separation, "to_motion", lambda cycle, flywheel: cycle.motion)
    monkeypatch.setattr(separation, "is_separated", is_lost)
    subject, first = SpeedSubject(tables, "flywheel"), separation.Separation(3241.7, 3341.7, "")
    for film, limit in limits.items():
        found = separation.find_second(subject, speeds, first, film, SilentReporter())
        if limit > 3600.0:
            assert (found.speed, found.text) == (
                None,
                f"with film_model = {film} contact is kept at all these speeds; judged without a steady "
                "cycle at 2 speeds from 3500 to 3600 r/min",
            )
        else:
            assert limit <= found.speed <= limit + 0.11
            assert limit + 100.0 <= found.nose_speed <= limit + 100.11
    usual = subject, speeds, separation.Separation(3241.7, None, ""), "dowson_toyoda", SilentReporter()
    assert separation.find_second(*usual).text == (
        "with film_model = dowson_toyoda contact is lost from 3306.1 r/min (+2.0 %)"
    )

    def fail(subject, speed):
        raise ModelError("no rest", "correct the parameters")

    monkeypatch.setattr(SpeedSubject, "find_cycle_at", fail)
    assert separation.find_second(*usual).text.endswith(
        "was found: at 3300 r/min no rest; choose another --second-film"
    )


def test_without_an_equilibrium_a_second_film_begins_with_the_cycle_of_the_first(monkeypatch):
    """The first one's own failure stays one."""
    begun = []

    def resolve(scenario, system):
        if scenario.components["contact"].parameters["film_model"] == "moes_venner":
            raise ModelError("no equilibrium")
        return system

    def find_cycle(system, period, turning, start, samples, **options):
        begun.append(start)
        return SimpleNamespace(end=[period])

    monkeypatch.setattr(speeds_subject, "resolve_start", resolve)
    monkeypatch.setattr(speeds_subject, "find_cycle", find_cycle)
    film = "components.contact.parameters.film_model"
    first, second = (
        SpeedSubject(read_changed("valve-train", [f"{film}={name}"]), "flywheel")
        for name in ("dowson_toyoda", "moes_venner")
    )
    replace(second, near=first).find_cycle_at(100.0)
    assert begun == [None, [2.0 * np.pi / 100.0]]
    with pytest.raises(ModelError, match="no equilibrium"):
        second.find_cycle_at(100.0)


@pytest.mark.long
def test_the_second_formula_gives_the_speed_of_its_own_sweep(tmp_path):
    """To the closeness of both searches."""
    ends, where = ("3200 rpm", "3400 rpm", 2), {"workers": 1}
    both = tribocosim.speeds("valve-train", *ends, **where)
    changed = tribocosim.load("valve-train").with_(
        {"components.contact.parameters.film_model": separation.USUAL}
    )
    alone = tribocosim.speeds(changed, *ends, **where, second_film=separation.USUAL)
    assert both.attrs["second_separation_speed"] == pytest.approx(alone.attrs["separation_speed"], abs=0.2)
    assert both.attrs["separation_speed"] < both.attrs["second_separation_speed"]
    assert alone.attrs["second_separation"] == ""


def test_the_usual_second_formula_is_another_one():
    """None where the contacts have no other, or no formula."""
    for film, second in (("kushwaha", separation.USUAL), (separation.USUAL, separation.OTHER)):
        changed = read_changed("valve-train", [f"components.contact.parameters.film_model={film}"])
        assert separation.choose_film(SpeedSubject(changed, "flywheel"), None) == second
        assert separation.choose_film(SpeedSubject(changed, "flywheel"), film) is None
    solved = read_changed("valve-train", ["components.contact.component=ehl_line_contact"])
    assert separation.choose_film(SpeedSubject(solved, "flywheel"), None) is None
    bearings = read_changed("bucket-friction")  # whose films have other names
    assert separation.choose_film(SpeedSubject(bearings, "flywheel"), None) == separation.OTHER


@given(st.lists(st.booleans(), min_size=1, max_size=12), st.data())
def test_the_first_loss_is_at_the_end_of_the_nearest_range(lost, data):
    near = data.draw(st.integers(0, len(lost) - 1))
    first = separation.find_first(lost.__getitem__, near, len(lost))
    if first is None:
        assert not any(lost[near:])
    else:
        assert lost[first]
        assert all(lost[first:near])
        assert not any(lost[near:first])
        assert first > near or first == 0 or not lost[first - 1]


def test_a_train_without_contacts_has_no_separation():
    table = xarray.Dataset({"shaft.twist": ("speed", [0.1, 0.2])}, {"speed": [100.0, 200.0]})
    assert separation.find_separation(SpeedSubject({}, "flywheel"), table, SilentReporter()) is None


def test_bisection_ends_within_a_tenth_of_a_revolution():
    found = separation.bisect_separation(lambda speed: speed >= 123.4, 100.0, 200.0)
    assert 0.0 <= found - 123.4 <= separation.CLOSE
