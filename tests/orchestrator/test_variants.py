"""Sweeps of several designs, side by side."""

import csv
import itertools
import signal
from contextlib import suppress
from dataclasses import replace
from io import StringIO
from pathlib import Path

import matplotlib
import numpy as np
import pytest
import xarray
from matplotlib.patches import Rectangle
from rich.console import Console

import tribocosim
from orchestrator.errors import MistakeError
from orchestrator.plots import valve_train
from orchestrator.plots.speeds import PANELS, draw_summary, draw_variants
from orchestrator.reporter import Reporter
from orchestrator.scenario.display import format_number
from orchestrator.study import run_overlay
from orchestrator.study.speeds.compare import VARIANTS, Choice, label, select_speeds
from orchestrator.study.speeds.separation import RPM
from orchestrator.study.speeds.sweep import Swept, select_columns
from orchestrator.study.speeds.variants import (
    Variant,
    choose_speeds,
    describe_frugal,
    describe_landing,
    list_variants,
    sweep_variants,
    tabulate,
)
from tribocosim.reporting import SilentReporter

from .commands import called


def make_swept(load: float, lost_from: float) -> Swept:
    """A least load (N) that falls with the speed (rad/s)."""
    speed = np.array([100.0, 200.0, 300.0])
    values = {"contact.least_load": load - speed, "contact.lost": (speed >= lost_from) * 0.1}
    table = xarray.Dataset({name: ("speed", v) for name, v in values.items()}, {"speed": speed})
    return Swept(0, table, {"separation": {"speed": 2500.4 if lost_from < 400.0 else None, "text": ""}})


def test_several_values_make_every_combination():
    found = list_variants(["a.lash=0.1 mm, 0.2 mm", "a.mass=1", "b.rate=[1, 2]", "b.law=x,y"])
    assert found[0] == Variant(
        "lash=0.1 mm, law=x", ("a.lash=0.1 mm", "a.mass=1", "b.rate=[1, 2]", "b.law=x")
    )
    assert [v.label for v in found[1:]] == ["lash=0.1 mm, law=y", "lash=0.2 mm, law=x", "lash=0.2 mm, law=y"]
    assert len({v.folder for v in found}) == 4
    assert list_variants(["a.mass=1"]) == [Variant("", ("a.mass=1",))]
    assert list_variants([]) == [Variant("", ())]
    with pytest.raises(MistakeError, match="the same value twice"):
        list_variants(["a.mass=1,1"])
    for written in ("0,2 mm", "0.1 mm,0,2 mm", "0,2 mm,0,3 mm"):
        with pytest.raises(
            MistakeError, match=r"'0,2 mm': .*write 0\.2 mm, with a point, or the unit of each"
        ):
            list_variants([f"a.lash={written}"])
    for written in ("0,0.1 mm", "0, 2 mm", "1 mm,2 mm", "1,2"):
        assert len(list_variants([f"a.lash={written}"])) == 2


def test_designs_are_judged_over_the_same_speeds():
    """Where all keep contact and are steady; one that does at none of the speeds of others is left out."""
    weak, strong, never = make_swept(400.0, 300.0), make_swept(500.0, 1e9), make_swept(300.0, 0.0)
    ripples = xarray.DataArray([0.0, 9e-4, 0.1], dims="speed")
    swept = {"weak": weak, "rippled": strong._replace(table=strong.table.assign(change=ripples))}
    judged = choose_speeds({**swept, "strong": strong, "never": never})
    assert (judged.low, judged.high) == ("955", "1910")
    assert [table.sizes["speed"] for table in judged.good] == [2, 2, 3, 0]
    (load,) = tabulate(judged)
    assert [worst and worst.value for worst in load.worst] == [200.0, 300.0, 300.0, None]
    assert load.list_cells() == ["least load, at 1910 r/min", "200", "300", "300", "–"]
    none = choose_speeds({"never": never})
    assert none[2:] == ("", "")
    (load,) = tabulate(none)
    assert [worst and worst.value for worst in load.worst] == [0.0]


def test_the_least_friction_with_contact_up_to_the_highest_speed_is_told():
    """Not that of designs that lose contact, or are not steady, below it, though they have less."""

    def add(one: Swept, *power: float) -> Swept:
        return one._replace(table=one.table.assign({"contact.friction_power": ("speed", list(power))}))

    stiff, weak = add(make_swept(500.0, 1e9), 9.0, 60.0, 50.0), add(make_swept(400.0, 300.0), 9.0, 20.0, 30.0)
    ripples = xarray.DataArray([0.0, 0.1, 0.0], dims="speed")
    rippled = stiff._replace(table=weak.table.assign(change=ripples, **{"contact.lost": 0.0 * ripples}))
    swept = {"stiff": stiff, "weak": weak, "rippled": rippled, "stiffer": add(stiff, 9.0, 50.0, 70.0)}
    (said,) = describe_frugal(swept)
    assert said == (
        "least friction with contact up to 2865 r/min: stiff, at most 60 W, at 1910 r/min; "
        "not up to there: weak (contact lost from 2500.4 r/min); rippled (not steady at 1910 r/min)"
    )
    assert not list(describe_frugal({"never": add(make_swept(300.0, 0.0), 1.0, 1.0, 1.0)}))
    speeds = [cells for column in tabulate(choose_speeds(swept)) for cells in column.list_cells()]
    assert "friction power, at 955 r/min" in speeds
    (power,) = (c for c in tabulate(choose_speeds({"a": stiff, "b": swept["stiffer"]})) if "power" in c.head)
    assert power.list_cells() == ["friction power", "60 at 1910", "70 at 2865"]


def test_a_torque_that_lacks_friction_is_marked_in_its_row(tmp_path):
    torque = {"drive.mean_torque": ("speed", [0.1, 0.1, 0.1], {"units": "N.m", "long_name": "mean torque"})}
    one, said = make_swept(400.0, 1e9), StringIO()
    table = one.table.assign(torque).assign_attrs(outside="cam contact (contact)")
    designs = {Variant(label, ()): {} for label in ("a", "b")}
    reporter = Reporter(Console(file=said, width=100))
    sweep_variants(designs, tmp_path, reporter, lambda tables, folder: one._replace(table=table))
    assert "│ mean torque, N m *, at 955 r/min │" in said.getvalue()
    assert "\n* without the friction of cam contact (contact)\n" in said.getvalue()


def test_a_number_that_only_a_later_design_has_has_its_column():
    one, other = make_swept(400.0, 1e9), make_swept(500.0, 1e9)
    power = 0.1 * other.table["contact.least_load"].rename(None)
    with_power = other._replace(table=other.table.assign({"valve.seating_velocity": power}))
    columns = tabulate(choose_speeds({"one": one, "other": with_power}))
    (seating,) = (column for column in columns if column.head == "seating velocity")
    assert [worst and worst.value for worst in seating.worst] == [None, 40.0]
    drawn = draw_variants({"one": one.table, "other": with_power.table}).axes[1]
    assert drawn.get_title() == f"{PANELS[3][0]}: valve"


def test_designs_have_what_a_spring_lash_oil_or_law_is_chosen_by(tmp_path):
    """Each number with its unit, speed and angle, and the values that vary as numbers. Of contacts each is
    named; of many the printed table has the worst. A separation that was not looked for has a bound, and
    speeds without a steady cycle are told."""
    pa, deg = (
        {"units": unit, "long_name": name} for unit, name in (("Pa", "largest pressure"), ("rad", "it"))
    )
    numbers = {"valve.largest_lift": [8e-3, 7e-3], "spring.least_gap": [2e-3, 1e-3], "change": [1e-6, 0.1]}
    numbers |= {"whole train.friction_power": [3.0, 4.0], "bearing.peak_pressure": [9e9, 9e9]}
    table = {name: ("speed", of, {"units": "m"} if max(of) < 0.1 else {}) for name, of in numbers.items()}
    for number, name in enumerate(("cam", "pad", "tip"), 1):
        table |= {
            f"{name}.{of}": ("speed", [0.5, 0.4]) for of in ("lost", "nose_film_ratio", "least_film_ratio")
        }
        table[f"{name}.peak_pressure"] = ("speed", [1e8 * number, 2e8 * number], pa)
        table[f"{name}.peak_pressure_angle"] = ("speed", np.radians([100.0, 130.0]), deg)
    swept = Swept(0, xarray.Dataset(table, {"speed": np.array([1000.0, 2000.0]) * np.pi / 30.0}), {})
    said = StringIO()
    designs = {variant: {} for variant in list_variants(["a.lash=0.1 mm,0.2 mm", "a.law=x,y", "a.n=1,2"])}
    sweep_variants(designs, tmp_path, Reporter(Console(file=said, width=100)), lambda *given: swept)
    with (tmp_path / VARIANTS).open(encoding="utf-8-sig", newline="") as file:
        *_, row = csv.DictReader(file)
    pressures = {"largest pressure of tip [MPa]": "600", "largest pressure of tip, at [r/min]": "2000"}
    known = pressures | {"it of pad [deg]": "130", "nose film ratio of cam": "0.4"}
    known |= {"largest lift [m]": "0.007", "least gap [m]": "0.001", "friction power": "4"}
    known |= {"design": "lash=0.2 mm, law=y, n=2", "lash [mm]": "0.2", "law": "y", "n": "2"}
    known |= {"contact lost from [r/min]": "≤ 1000", "no steady cycle at [r/min]": "2000"}
    assert {head: row[head] for head in known} == known
    assert "≤ 1000" in said.getvalue()
    assert "of bearing" not in said.getvalue()
    rows = [line.split("│") for line in said.getvalue().splitlines() if "600 at 130°" in line]
    assert len(rows) == 2  # eight designs stand in two tables
    assert all("largest pressure" in cells[1] for cells in rows)
    assert max(len(line) for line in said.getvalue().splitlines() if line.startswith("│")) <= 100


def test_a_separation_that_was_not_looked_for_is_a_range(tmp_path):
    """From the last speed with contact to the first without, in table and file."""
    text, losses = StringIO(), itertools.count()
    designs = {variant: {} for variant in list_variants(["a.mass=1,2,3"])}
    summaries = [{}, {}, {"separation": {"speed": 2500.4}}]

    def sweep(tables, folder):
        i = next(losses)
        return make_swept(400.0, [1e9, 300.0, 300.0][i])._replace(summary=summaries[i])

    sweep_variants(designs, tmp_path, Reporter(Console(file=text, width=100)), sweep)
    with (tmp_path / VARIANTS).open(encoding="utf-8-sig", newline="") as file:
        found = [row["contact lost from [r/min]"] for row in csv.DictReader(file)]
    assert found == ["", "1910 to 2865", "2500"]
    (row,) = (line for line in text.getvalue().splitlines() if "contact lost from" in line)
    assert [cell.strip() for cell in row.split("│")[2:5]] == ["–", *found[1:]]


def test_designs_that_land_on_the_ramps_are_told():
    """At all speeds that are judged, and with the speed and number of those that do not."""

    def add(**values):
        return one._replace(
            table=one.table.assign({f"v.{name}": ("speed", of) for name, of in values.items()})
        )

    one = make_swept(400.0, 1e9)
    swept = {"lash=0.1": add(ramp_left=[0.5, 0.7, 1.0], least_lift=[0.0, 0.0, 0.0])}
    swept["lash=0.3"] = add(ramp_left=[0.9, 1.2, 1.1], least_lift=[0.0, 0.0, 0.0])
    swept["lash=0"] = add(ramp_left=[np.nan] * 3, least_lift=[0.0, 0.0, 5e-6])
    (said,) = describe_landing(choose_speeds(swept), list(swept))
    faults = (
        "lash=0.3 (v lands at 1.2 of its ramp, at 1910 r/min); lash=0 (v stays open by 5 µm, at 2865 r/min)"
    )
    assert said == f"valves close, and land on the ramps, with lash=0.1; not with {faults}"
    assert not list(describe_landing(choose_speeds({"lash=0": swept["lash=0"]}), ["lash=0"]))


def test_remarks_on_friction_stand_below_the_table_with_the_designs_of_which_they_hold(tmp_path):
    said, designs = StringIO(), {Variant(label, ()): {} for label in ("cold", "warm", "hot")}
    told = {"cold": ["outside"], "warm": ["outside", "soft"], "hot": ["outside", "soft"]}
    swept = {
        tmp_path / label: make_swept(400.0, 1e9)._replace(summary={"friction": texts})
        for label, texts in told.items()
    }
    sweep_variants(designs, tmp_path, Reporter(Console(file=said)), lambda tables, folder: swept[folder])
    assert said.getvalue().splitlines()[-3:-1] == ["outside", "with warm; hot: soft"]


def test_every_design_has_its_whole_name_in_a_narrow_table(tmp_path):
    labels = [f"lash=0.{i}5 mm" for i in range(4)]
    said = StringIO()
    reporter = Reporter(Console(file=said, width=80))
    designs = {Variant(label, ()): {} for label in labels}
    sweep_variants(designs, tmp_path, reporter, lambda tables, folder: make_swept(400.0, 1e9))
    (head,) = (line for line in said.getvalue().splitlines() if "worst" in line)
    assert all(label in head for label in labels)


def test_an_interrupted_sweep_leaves_out_the_designs_that_follow(tmp_path):
    """Also where a library made something else of Ctrl-C; designs that are complete have their table, whose
    names `compare` takes."""
    begun = []

    def sweep(tables, folder):
        begun.append(folder.name)
        with suppress(KeyboardInterrupt):  # as a library may do
            if len(begun) == 2:
                signal.raise_signal(signal.SIGINT)
        return make_swept(400.0, 1e9)

    designs = {Variant(name, ()): {} for name in ("1 N/mm", "b", "c")}
    with pytest.raises(KeyboardInterrupt):
        sweep_variants(designs, tmp_path, SilentReporter(), sweep)
    assert begun == ["1 N_mm", "b"]
    assert label(tmp_path / "1 N_mm", tmp_path / "b") == ("1 N/mm", "b")
    assert len((tmp_path / VARIANTS).read_text("utf-8").splitlines()) == 1 + 2


def test_lists_and_tables_are_values_and_equal_names_have_paths():
    found = list_variants(["a.rate=[1, 2],[3, 4]", 'oil={ name = "x, y", t = 1 }, { name = "z", t = 2 }'])
    assert found[0].settings == ("a.rate=[1, 2]", 'oil={ name = "x, y", t = 1 }')
    assert len(found) == 4
    assert list_variants(["a.mass=1,2", "b.mass=3,4"])[0].label == "a.mass=1, b.mass=3"


def test_one_speed_is_between_the_computed_ones():
    tables = [make_swept(load, 1e9).table for load in (400.0, 500.0)]
    assert [t["speed"].values.tolist() for t in select_speeds(tables, Choice(at=120.0))] == [[100.0]] * 2
    with pytest.raises(MistakeError, match="955 to 2865 r/min"):
        select_speeds(tables, Choice(at=942.0))


def test_a_line_of_a_sweep_has_the_units_that_figures_have():
    attributes = {"peak_pressure": {"units": "Pa"}, "least_film": {"units": "m", "display_units": "um"}}
    data = {f"contact.{name}": ("speed", [1.0], attributes[name]) for name in attributes}
    heads = [(head, factor) for head, _, factor in select_columns(xarray.Dataset(data))]
    assert heads == [("largest pressure MPa", pytest.approx(1e-6)), ("least film µm", pytest.approx(1e6))]


@pytest.mark.parametrize(
    ("value", "shown"),
    [(-0.0, "0"), (1713.4e6, "1713000000"), (17134.0, "17130"), (-0.024289, "-0.02429"), (np.nan, "–")],
)
def test_a_number_in_a_table_has_no_exponent_and_no_negative_zero(value, shown):
    assert format_number(value) == shown


@pytest.mark.parametrize("count", [3, 9])
def test_a_figure_has_a_colour_for_each_design(count):
    """Of many they differ by a tenth of a colour's range; points of cycles that are not steady are open."""
    tables = {f"design {i}": make_swept(400.0 + i, 1e9).table for i in range(count)}
    figure = draw_variants(tables)
    (panel,) = figure.axes
    colours = [matplotlib.colors.to_rgb(line.get_color()) for line in panel.lines]
    apart = [np.abs(np.subtract(*pair)).max() for pair in itertools.combinations(colours, 2)]
    assert (len(colours), min(apart) > 0.1) == (count, True)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == list(tables)
    assert "open points" not in figure.get_suptitle()
    unsteady = tables["design 0"].assign(change=("speed", [0.0, 0.1, 0.0]))
    for drawn in (draw_variants({"a": unsteady}), draw_summary({"a": unsteady})):
        (_, points) = drawn.axes[0].lines
        assert (points.get_marker(), points.get_xdata()) == ("o", pytest.approx([RPM * 200.0]))
        assert "open points: no steady cycle" in drawn.get_suptitle()


def test_the_torques_of_a_design_differ_by_their_line_and_lost_contact_is_shaded():
    """The largest lift changes by 1 um of 8 mm: its panel is level, at least 1 % of the lift high."""
    given = {
        "drive.least_torque": [-8.0, -9.0],
        "drive.mean_torque": [0.1, 0.2],
        "drive.largest_torque": [8.0, 9.0],
        "valve.largest_lift": [8e-3, 8.001e-3],
        "contact.lost": [0.0, 0.1],
    }
    table = xarray.Dataset({name: ("speed", of) for name, of in given.items()}, {"speed": [100.0, 200.0]})
    figure = draw_variants({"a": table})
    torque, lift = figure.axes
    assert {line.get_linestyle() for line in torque.lines} == {"--", ":", "-"}
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words == ["a", "least", "mean", "largest"]
    assert all(panel.patches for panel in figure.axes)
    assert np.ptp(lift.get_ylim()) > 0.08


def test_runs_are_not_compared_by_what_is_zero_in_both(tmp_path):
    """The table leaves it out; what it returns has it."""
    for name, load in (("soft", 0), ("stiff", 5)):
        (tmp_path / name).mkdir()
        head = "part,figure of merit,value,unit,angle [deg],time [ms]"
        rows = f"{head}\nseat,largest seat force,{load},N,,\nshaft,largest twist,0,deg,0,\n"
        (tmp_path / name / "summary.csv").write_text(rows)
    folders, text = (tmp_path / "soft", tmp_path / "stiff"), StringIO()
    found = run_overlay.compare_runs(*folders, None, Reporter(Console(file=text, width=110)))
    assert list(found["merits"]) == ["seat: largest seat force", "shaft: largest twist"]
    assert "seat: largest seat force" in text.getvalue()
    assert "twist" not in text.getvalue()


def test_two_runs_lie_over_each_other_with_their_names(tmp_path, monkeypatch):
    short = {"stop_time": "60 ms", "macro_step": "20 us", "reference.enabled": False}
    for name, preload in (("soft", 250.0), ("stiff", 400.0)):
        own = {**short, "components.valve_spring.parameters.preload": preload}
        tribocosim.run(tribocosim.load("valve-train").with_(own), tmp_path / name)
    one, other = (run_overlay.read_run(tmp_path / name) for name in ("soft", "stiff"))
    folders = [str(tmp_path / name) for name in ("soft", "stiff")]
    done = called("compare", *folders, "--out", str(tmp_path / "both"))
    assert done.returncode == 0
    (row,) = (line for line in done.stdout.splitlines() if "contact: largest load" in line)
    assert " at " in row
    assert [float(cell.split()[0]) for cell in row.split("│")[3:5]] == pytest.approx(
        [one.coupled["contact.load"].max(), other.coupled["contact.load"].max()], rel=1e-3
    )
    drawn = (tmp_path / "both.png").read_bytes()
    held = called("compare", *folders[::-1], "--out", str(tmp_path / "both"))
    assert held.returncode == 2
    assert "both.png: is already there" in held.stderr
    assert (tmp_path / "both.png").read_bytes() == drawn
    assert called("compare", *folders[::-1], "--out", str(tmp_path / "both"), "--overwrite").returncode == 0
    assert (tmp_path / "both.png").read_bytes() != drawn
    refused = called("compare", *folders, "--out", str(tmp_path / "both.txt"))
    assert refused.returncode == 2
    assert "must be a PNG file" in refused.stderr
    both = replace(one, names=("soft", "stiff"), reference=other.coupled, reference_time=other.time)
    load = next(ax for ax in valve_train.draw(both).axes if ax.get_ylabel() == "Load (N)")
    lines = {line.get_label(): line.get_ydata() for line in load.lines}
    assert np.mean(lines["stiff"] - lines["soft"]) == pytest.approx(150.0, abs=1.0)
    with pytest.raises(MistakeError, match="holds no finished run"):
        run_overlay.read_run(tmp_path)
    missing = replace(other, coupled={k: v for k, v in other.coupled.items() if k != "contact.load"})
    monkeypatch.setattr(run_overlay, "read_run", {Path("one"): one, Path("other"): missing}.get)
    told = (
        r"^other: is a run of another train than one, without its contact\.load; compare runs of one train$"
    )
    with pytest.raises(MistakeError, match=told):
        run_overlay.overlay(Path("one"), Path("other"), tmp_path / "x.png", ("one", "other"))


def test_panels_are_scaled_by_the_speeds_with_contact():
    """Also where it is lost at most of the speeds; no line leads from one kind to the other."""
    loads = [610.0, 600.0, 590.0, 7e3, 6e4, 7e4, 2e5, 2e5]
    table = xarray.Dataset(
        {"contact.largest_load": ("speed", loads), "contact.lost": ("speed", np.array(loads) > 1e3)},
        {"speed": np.linspace(50.0, 500.0, 8)},
    )
    drawn = draw_summary({"train": table}).axes[0]
    assert 610.0 < drawn.get_ylim()[1] < 7e3
    drawn_loads = np.asarray(drawn.lines[0].get_ydata(), dtype=np.float64)
    assert np.array_equal(drawn_loads, [*loads[:3], np.nan, *loads[3:]], equal_nan=True)


def test_each_design_says_which_friction_its_torque_leaves_out():
    """Once, where it is the same."""
    torque = xarray.Dataset({"flywheel.mean_torque": ("speed", [1.0, 2.0])}, {"speed": [50.0, 100.0]})
    one, other = torque.assign_attrs(outside="rolling (contact)"), torque.assign_attrs(outside="")
    without = "without the friction of rolling (contact)"
    for second, lines in ((one, without), (other, f"first: {without}\nsecond: with all friction")):
        (text,) = draw_summary({"first": one, "second": second}).axes[0].texts
        assert text.get_text() == lines


@pytest.mark.parametrize("separation", [None, 1150.0, 1450.0])
def test_contact_is_lost_from_the_marked_speed_on(separation):
    """From the separation, also where it is nearer to the speed before; else from half-way."""
    table = xarray.Dataset(
        {
            "contact.largest_load": ("speed", [600.0, 610.0, 9e3, 9e3]),
            "contact.lost": ("speed", [0.0, 0.0, 0.1, 0.1]),
        },
        {"speed": np.array([500.0, 1000.0, 1500.0, 2000.0]) / RPM},
    )
    drawn = draw_summary({"train": table}, {"train": separation}).axes[0]
    shaded = [patch for patch in drawn.patches if isinstance(patch, Rectangle)]
    begins = min(patch.get_x() for patch in shaded)
    assert begins == pytest.approx(separation or 1250.0)
    assert max(patch.get_x() + patch.get_width() for patch in shaded) == pytest.approx(2000.0)
