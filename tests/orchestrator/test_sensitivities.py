"""tribocosim sensitivities: elasticities of a steady cycle's figures of merit."""

import io
import math
from types import SimpleNamespace

import numpy as np
import pytest
import xarray
from rich.console import Console

from models.core.system import ModelError
from models.monolithic import cycle_tangents, variation
from orchestrator.errors import MistakeError, RunError
from orchestrator.reporter import Reporter
from orchestrator.scenario import build_scenario
from orchestrator.scenario.files import load, put, read_changed, to_full_toml
from orchestrator.scenario.system import list_parameters, list_quantities
from orchestrator.study.run import Where
from orchestrator.study.speeds import coupled, differences, figure_slopes, sensitivities
from orchestrator.study.speeds.coupled import CoupledSubject
from orchestrator.study.speeds.differences import (
    SHARE,
    SHARES,
    SensitivitySubject,
    differentiate,
    find_usable,
)
from orchestrator.study.speeds.figure_slopes import SPEED, FigureSlopes, find_run_slopes, find_slopes
from orchestrator.study.speeds.sensitivities import (
    Asked,
    choose_parameters,
    find_asked_sensitivities,
    find_sensitivities,
)
from orchestrator.study.speeds.sensitivities_report import publish
from orchestrator.study.speeds.subject import SpeedSubject
from orchestrator.study.store import DONE, FAILED
from orchestrator.texts import parse_toml
from tribocosim.reporting import SilentReporter

from ..third_party.c_fmus import fmu
from ..third_party.runs import never
from ..third_party.runs import scenario as foreign
from .commands import called

DRY = ("components.contact.parameters.film_model=dry",)


def test_a_power_law_has_its_exponent_and_an_error_of_fourth_order():
    factors = 1.0 + SHARE * np.array([0.0, *SHARES])
    found = differentiate({"power": 7.0 * factors**2.5, "none": 0.0 * factors}, 1)
    elasticity, error, *_ = found["power"]
    # The term of order h^4 is 2.5 1.5 0.5 0.5 1.5 / 30 h^4 = 5e-14; rounding over h is 2e-13.
    assert elasticity == pytest.approx([2.5], abs=1e-12)
    assert error == pytest.approx([2.5 * 1.5 * 0.5 / 6.0 * SHARE**2], rel=1e-3)
    assert "none" not in found
    corner = differentiate({"corner": 1.0 + np.maximum(factors - 1.0 - 0.5 * SHARE, 0.0)}, 1)["corner"]
    assert corner[1] > 0.05 * corner[0]


def test_differences_tell_both_sides_of_a_corner_and_the_noise():
    """Both steps are the same about a corner: the sides tell it. Noise of 1e-9 is 1e-6 of a slope."""
    factors = 1.0 + SHARE * np.array([0.0, *SHARES])
    corner = np.maximum(factors - 1.0, 0.0) - 3.0 * np.minimum(factors - 1.0, 0.0)
    elasticity, error, below, above = (float(one[0]) for one in differentiate({"g": 1.0 + corner}, 1)["g"])
    assert (elasticity, error, below, above) == pytest.approx((-1.0, 2.0, -3.0, 1.0), abs=1e-12)
    noise = np.random.default_rng(0).normal(scale=1e-9, size=(4000, len(factors)))
    noise[:, 0] = 0.0
    table = np.concatenate([[1.0], (factors + noise)[:, 1:].ravel()])
    elasticities, errors, *_ = differentiate({"g": table}, len(noise))["g"]
    within = np.abs(elasticities - 1.0) < 3.0 * errors
    assert np.mean(within) > 0.8
    assert np.median(errors) == pytest.approx(1e-6, rel=0.5)


def test_beyond_the_edge_of_a_range_a_difference_is_one_sided():
    factors = 1.0 + SHARE * np.array([0.0, *SHARES])
    table = {"power": np.where(factors > 1.0, np.nan, factors**2.5)}
    elasticity, error, below, above = (float(one[0]) for one in differentiate(table, 1)["power"])
    # Of second order, it is off by 1.5 0.5 / 3 h^2 of itself; the first order is off by 2.5 1.5 / 2 h.
    assert elasticity == below == pytest.approx(2.5, rel=0.26 * SHARE**2)
    assert error == pytest.approx(2.5 * 1.5 / 2.0 * SHARE, rel=1e-2)
    assert math.isnan(above)


def list_coupled(subject):
    """By figure what `differentiate` finds of all cases."""
    cases = [subject.evaluate({"case": float(k)}) for k in range(1 + len(SHARES) * len(subject.parameters))]
    return differentiate({n: np.array([one[n] for one in cases]) for n in cases[0]}, len(subject.parameters))


def shaken(folder, **changes):
    """A mass of another tool's FMU on a spring and a damper, that shakes with 4 rad/s."""
    return foreign({"body": {"participant": fmu("shaken", 2, folder)}}, **{"macro_step": 0.01} | changes)


PERIOD = math.pi / 2.0


def test_the_amplitude_of_an_fmu_of_another_tool_changes_as_in_the_closed_form(tmp_path):
    """|x| = F/sqrt((k - m w^2)^2 + (d w)^2). Its steps of 0.1 ms leave 3e-8; a parabola through rows of 5 ms
    is off by 2e-7 of the amplitude."""
    names, w = ("body.stiffness", "body.damping"), 4.0
    scenario = shaken(tmp_path)
    base = CoupledSubject(parse_toml(to_full_toml(scenario)), "", build=never, period=PERIOD)
    subject = SensitivitySubject(base, math.nan, names)
    elasticities, errors, *_ = list_coupled(subject)["body.position.maximum"]
    stiff, square = 10.0 - w * w, (10.0 - w * w) ** 2 + (0.5 * w) ** 2
    exact = np.array([-10.0 * stiff, -((0.5 * w) ** 2)]) / square
    assert np.all(errors < 2e-5)
    assert elasticities == pytest.approx(exact, abs=2e-5)


def test_a_coupled_cycle_has_the_figures_of_that_of_the_kernels():
    """At 2000 r/min, in macro steps of 20 us: by friction and lift to 1e-5, by the least load to 1e-3."""
    tables, speed = read_changed("valve-train", DRY), 2000.0 * math.pi / 30.0
    participants = {f"components.{name}.participant": "in-process" for name in tables["components"]}
    put(tables, participants | {"macro_step": 2e-5})
    tables = parse_toml(to_full_toml(build_scenario(tables)))
    exact = SpeedSubject(tables, "flywheel").measure_at(speed, 1e-8, 1e-5)
    found = CoupledSubject(tables, "flywheel", periods=10).measure_at(speed, 1e-8, 1e-5)
    for figure, within in (("contact.friction_power", 1e-5), ("valve_spring.lift_area", 1e-5)):
        assert found[figure] == pytest.approx(exact[figure], rel=within)
    assert found["contact.least_load"] == pytest.approx(exact["contact.least_load"], rel=1e-3)
    assert found["change"] < 1e-5


def test_the_run_of_an_fmu_of_another_tool_has_a_table_with_errors(tmp_path):
    """dx/dt = -k x: the mean of a run of t is (1 - exp(-k t))/(k t), its least value exp(-k t)."""
    given = {"decay": {"participant": fmu("dahlquist", 2, tmp_path), "parameters": {"k": 0.5}}}
    (tmp_path / "decay.toml").write_text(to_full_toml(foreign(given)), encoding="utf-8")
    out = tmp_path / "out"
    done = called(
        "sensitivities", str(tmp_path / "decay.toml"), "--run", "--workers", "1", "--out", str(out),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    head, *rows = (out / "sensitivities.csv").read_text("utf-8").splitlines()
    assert head == "figure,value,unit,decay.k,decay.k error"
    by_figure = {row.split(",")[0]: [float(cell) for cell in row.split(",")[3:]] for row in rows}
    elasticity, error = by_figure["decay.x.minimum"]
    assert abs(elasticity + 0.5) < error < 1e-6
    # The trapezoidal rule is off by (k h)^2/12 of the mean.
    assert by_figure["decay.x.mean"][0] == pytest.approx(0.5 / math.expm1(0.5) - 1.0, abs=1e-5)
    assert "in a run of 1000 ms" in done.stdout
    assert "differences over 0.1% and 0.2%" in " ".join(done.stdout.split())
    assert "±" in (out / "sensitivities.html").read_text("utf-8")
    assert (out / "sensitivities.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({}, r"no flywheel prescribes .* period='20 ms', or take"),
        ({"period": "0.3 s"}, r"no steady cycle: body\.(position|velocity) still changes by .* run=True"),
        ({"period": "0 s"}, "period = 0 s .*must be > 0"),
        ({"period": "3"}, "period='3': write the unit, e.g. 3 ms, or 3 s"),
        ({"speed": "100 rpm"}, "no flywheel prescribes the speed"),
        ({"period": "1 s", "run": True}, "period='1 s': is that of a steady cycle"),
        ({"run": True, "parameters": ["body.position"]}, "body.position'.*: is an output"),
        ({"run": True, "parameters": ["body.stifness"]}, "did you mean body.stiffness"),
    ],
)
def test_what_has_no_coupled_sensitivities_is_named(monkeypatch, asked, said, tmp_path):
    monkeypatch.setattr(coupled, "MOST", 40)
    tables, where = parse_toml(to_full_toml(shaken(tmp_path))), Where(workers=1)
    with pytest.raises((MistakeError, RunError), match=said):
        find_asked_sensitivities(tables, Asked(**asked), tmp_path / "out", where, never, SilentReporter())
    assert not (tmp_path / "out").exists()


def find_masses(subject):
    """By parameter the kilogram's exponent in its unit, of those that are not zero."""
    values = list_parameters(subject.scenario)
    units = {name: quantity.unit for name, quantity in list_quantities(subject.scenario).items()}
    return {name: values[name] * count_masses(units[name]) for name in values if count_masses(units[name])}


def count_masses(unit):
    above, _, below = unit.partition("/")
    heavy = {"kg", "N", "Pa", "W", "J"}
    return sum(u in heavy for u in above.split(".")) - sum(u in heavy for u in below.split("."))


@pytest.mark.parametrize(
    ("train", "rpm"),
    [
        ("valve-train", 2000.0),
        pytest.param("seat-and-lash", 1500.0, marks=pytest.mark.long),
        pytest.param("direct-acting-hla", 1000.0, marks=pytest.mark.long),
        pytest.param("pushrod-train", 1000.0, marks=pytest.mark.long),
    ],
)
def test_more_of_every_mass_makes_as_much_more_of_every_force(monkeypatch, record, train, rpm):
    """In other units of mass a train moves alike: in the direction of all parameters with the kilogram in
    their unit, a figure's elasticity is the kilogram's exponent in its own.

    The steps leave 1e-8; rows of the cycle are sought to 1e-3 of their distance, of a contact that vibrates.
    """
    monkeypatch.setattr(figure_slopes, "SAMPLES", 720)
    content = read_changed(train, DRY if train == "valve-train" else [])
    given = SpeedSubject(content, "flywheel")
    base = SpeedSubject(parse_toml(to_full_toml(given.scenario)), "flywheel")
    found = find_slopes(base, rpm * math.pi / 30.0, [find_masses(base)])
    units = {name: result.unit for name, result in base.results.items()}
    names = [name for name, one in found.items() if units[name] in ("N", "Pa", "N.m", "m") and one.value]
    names = [name for name in names if "twist" not in name and "film" not in name]
    elasticities = [float(found[name].slopes[0]) / found[name].value for name in names]
    expected = [float(count_masses(units[name])) for name in names]
    quantity, source = "elasticities to all masses, forces and moduli", "dimensional analysis"
    record("Train", quantity, np.array(elasticities), expected, source, tolerance=1e-6)


@pytest.mark.long
def test_slopes_are_those_of_fine_differences(monkeypatch):
    """By a polynomial of degree 5 through eleven cycles: between steps the margin of one is known to 4e-9.

    Measured: 6e-8 for the margin, 2e-8 for load and pressure.
    """
    monkeypatch.setattr(figure_slopes, "SAMPLES", 720)
    name, speed = "valve_spring.preload", 2000.0 * math.pi / 30.0

    def find(factor, directions=()):
        tables = read_changed("valve-train", DRY)
        preload = list_parameters(SpeedSubject(tables, "flywheel").scenario)[name]
        put(tables, {f"components.{name.replace('.', '.parameters.')}": preload * factor})
        return find_slopes(SpeedSubject(tables, "flywheel"), speed, [{one: preload} for one in directions])

    exact, shares = find(1.0, [name]), np.linspace(-0.04, 0.04, 11)
    monkeypatch.setattr(variation, "STATES", 1e-14)
    monkeypatch.setattr(cycle_tangents, "CLOSED", 1e-12)
    beside = [find(1.0 + share) for share in shares]
    for figure in ("contact.least_load", "contact.peak_pressure", "valve_spring.spring_margin"):
        curve = np.polynomial.Polynomial.fit(shares, [found[figure].value for found in beside], 5)
        assert exact[figure].slopes[0] == pytest.approx(curve.deriv()(0.0), rel=1e-6)


def test_slopes_of_a_run_are_those_of_differences(monkeypatch):
    """Of a start in equilibrium and 1.08 turns, by preload and speed; at another speed the run ends at the
    same angle. Differences over 4e-4 are right to 4e-4."""
    monkeypatch.setattr(figure_slopes, "SAMPLES", 720)
    name, speed, share = "valve_spring.preload", 2500.0 * math.pi / 30.0, 2e-4

    def find(factor):
        tables, place = read_changed("valve-train", DRY), "components.flywheel.parameters"
        given = {"components.valve_spring.parameters.preload": 330.0 * factor, "stop_time": 0.026 / factor}
        put(tables, given | {f"{place}.{end}_speed": speed * factor for end in ("initial", "final")})
        return find_run_slopes(SpeedSubject(tables, "flywheel"), [{name: 330.0}, {SPEED: speed}])

    exact, above, below = (find(1.0 + side * share) for side in (0.0, 1.0, -1.0))
    for figure in ("contact.least_load", "contact.friction_power", "valve_spring.lift_area"):
        difference = (above[figure].value - below[figure].value) / (2.0 * share)
        assert exact[figure].slopes.sum() == pytest.approx(difference, rel=4e-4)
    # Of the coupled train, in macro steps of 20 us.
    tables = read_changed("valve-train", DRY)
    ends = {f"components.flywheel.parameters.{end}_speed": speed for end in ("initial", "final")}
    participants = {f"components.{name}.participant": "in-process" for name in tables["components"]}
    put(tables, ends | participants | {"stop_time": 0.026, "macro_step": 2e-5})
    base = CoupledSubject(parse_toml(to_full_toml(build_scenario(tables))), "flywheel", running=True)
    found = list_coupled(SensitivitySubject(base, speed, (name, SPEED)))
    for figure, within in (("contact.friction_power", 1e-5), ("contact.least_load", 0.02)):
        elasticities, errors, *_ = found[figure]
        assert elasticities == pytest.approx(exact[figure].slopes / exact[figure].value, rel=within)
        assert np.all(errors < 1e-4)


def test_at_the_edge_of_a_range_slopes_are_those_of_the_side_within(monkeypatch):
    def measure(share, names):
        if share > 0.0:
            raise ModelError("the shares of a rise add up to more than 1")
        return {"cam.figure": (3.0 + 2.0 * share, None)}

    monkeypatch.setattr(figure_slopes, "_find_times", lambda *_: None)
    monkeypatch.setattr(figure_slopes, "_move", lambda tangents, rows, direction, share, flywheel: share)
    monkeypatch.setattr(figure_slopes, "_measure", measure)
    tangents = SimpleNamespace(directions=[None], rows_at=lambda times: None)
    (found,) = figure_slopes.differentiate_figures(tangents, "flywheel").values()
    # Rounding of 3 over the step.
    assert found.slopes == pytest.approx([2.0], abs=1e-15 / figure_slopes.SHARE)
    assert found.corners == pytest.approx([0.0], abs=1e-15 / figure_slopes.SHARE)


def test_parameters_are_named_as_in_a_scenario_and_refused_where_they_cannot_vary():
    train = load("valve-train")
    every = choose_parameters(train, "flywheel", [])
    assert {"speed", "valve_spring.preload", "contact.viscosity"} <= set(every)
    assert not any(name.startswith("flywheel.") for name in every)
    path = "components.valve_spring.parameters.preload"
    assert choose_parameters(train, "flywheel", [path, "speed", path]) == ("valve_spring.preload", "speed")
    assert not any("[" in name for name in choose_parameters(load("my-cam"), "flywheel", []))
    for wrong, why in (
        ("valve_spring.lash", "is zero"),
        ("camshaft.law", "no values in between"),
        ("valve_spring.preloads", "did you mean valve_spring.preload"),
    ):
        with pytest.raises(MistakeError, match=why):
            choose_parameters(train, "flywheel", [wrong])


def test_the_command_prints_what_moves_a_train_and_leaves_table_and_figure(tmp_path):
    done = called(
        "sensitivities", "valve-train", "--parameter", "valve_spring.preload",
        "--workers", "1", "--out", str(tmp_path / "found"), "--set", *DRY,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "valve_spring.preload" in done.stdout
    assert "at 1000 r/min" in done.stdout  # the scenario's own speed
    head, *rows = (tmp_path / "found" / "sensitivities.csv").read_text("utf-8").splitlines()
    assert head == "figure,value,unit,valve_spring.preload"
    by_figure = {row.split(",")[0]: row.split(",") for row in rows}
    # The spring's force is its preload and what lift and surge add, which the preload hardly changes.
    _, force, unit, elasticity = by_figure["valve_spring.largest_spring_force"]
    assert unit == "N"
    assert float(elasticity) == pytest.approx(330.0 / float(force), rel=1e-4)
    assert (tmp_path / "found" / "sensitivities.png").stat().st_size > 10_000
    assert "sensitivities.csv" in (tmp_path / "found" / "sensitivities.html").read_text("utf-8")


def test_each_number_that_an_oil_gives_varies_alone(monkeypatch, tmp_path):
    given = []

    def run(plan, *_):
        for case in range(1 + len(SHARES)):
            tables = plan.subject.find_case(case)[0].tables
            given.append(tables["components"]["contact"]["parameters"])
        raise RunError("as far as is needed")

    def refuse(*_):
        raise MistakeError("no derivative is known")

    monkeypatch.setattr(sensitivities, "find_slopes", refuse)
    monkeypatch.setattr(differences, "run", run)
    oil = ("components.contact.oil=SAE 5W-30", "components.contact.temperature=90 degC")
    tables, where = read_changed("valve-train", oil), Where(workers=1)
    with pytest.raises(RunError, match="as far"):
        find_sensitivities(tables, 200.0, ["contact.viscosity"], tmp_path, where, SilentReporter())
    ratios = [one["viscosity"] / given[0]["viscosity"] for one in given]
    assert ratios == pytest.approx([1.0, *(1.0 + SHARE * np.array(SHARES))], rel=1e-14)
    assert len({one["pressure_viscosity"] for one in given}) == 1


def test_an_unsteady_motion_has_no_sensitivities():
    change = np.array([1e-9, 1e-9, 0.3])
    cycles = xarray.Dataset({"status": ("case", [DONE] * 3), "change": ("case", change)})
    assert find_usable(cycles, SilentReporter()).tolist() == [True, True, False]
    with pytest.raises(RunError, match="no steady cycle"):
        find_usable(cycles.isel(case=[2, 0]), SilentReporter())
    failed = cycles.assign(status=("case", [FAILED] * 3), message=("case", ["no equations"] * 3))
    with pytest.raises(RunError, match="own cycle was not found: no equations"):
        find_usable(failed, SilentReporter())


def test_a_parameter_that_no_figure_changes_with_is_named(monkeypatch, tmp_path):
    monkeypatch.setattr(sensitivities, "find_slopes", lambda *_: {})
    tables, where = read_changed("valve-train", DRY), Where(workers=1)
    with pytest.raises(RunError, match=r"no figure of merit changes with contact\.viscosity"):
        find_sensitivities(tables, 200.0, ["contact.viscosity"], tmp_path, where, SilentReporter())


@pytest.mark.parametrize(("method", "marked"), [("tangents", [False, True]), ("differences", [True, True])])
def test_what_differs_by_more_than_5_per_cent_is_marked(tmp_path, method, marked):
    """Tangents tell by how much both sides differ, differences of steps a third of what these do."""
    dataset = xarray.Dataset(
        {
            "elasticity": (("figure", "parameter"), [[2.0, 1.0]]),
            "error": (("figure", "parameter"), [[2.0 * 0.03, 0.06]]),
            "value": ("figure", [300.0]),
        },
        {"figure": ["contact.least_load"], "parameter": ["contact.viscosity", "speed"]},
        {"speed": 200.0, "status": 0, "method": method, "friction": ""},
    )
    dataset = dataset.assign(below=dataset["elasticity"], above=dataset["elasticity"])
    text = io.StringIO()
    reporter = Reporter(Console(file=text, width=200))
    publish(dataset, load("valve-train"), tmp_path, reporter)
    rows = [line for line in text.getvalue().splitlines() if "contact.viscosity" in line or "speed " in line]
    assert ["~" in row for row in rows] == marked, text.getvalue()


def test_where_both_sides_differ_each_has_its_elasticity(tmp_path):
    """Of a load of 300 N that falls by 0.6 % with less of a parameter and by 0.2 % with more of it."""
    slopes = {"contact.least_load": FigureSlopes(300.0, np.array([60.0, 30.0]), np.array([-240.0, 0.0]))}
    slopes["contact.least_film_ratio"] = FigureSlopes(0.5, np.zeros(2), np.zeros(2))
    base = SpeedSubject(read_changed("valve-train"), "flywheel")
    dataset = sensitivities._divide(base, slopes, ["speed", "contact.viscosity"], speed=200.0)
    text = io.StringIO()
    publish(dataset, load("valve-train"), tmp_path, Reporter(Console(file=text, width=200)))
    assert "~0.6|-0.2" in text.getvalue()
    assert "less | more" in text.getvalue()
    assert "contact: the film is thinner than the roughness" in text.getvalue()
    head, row = (tmp_path / "sensitivities.csv").read_text("utf-8").splitlines()
    assert head.split(",")[3:] == ["speed", "contact.viscosity", "speed below", "speed above"]
    assert [float(cell) for cell in row.split(",")[3:]] == pytest.approx([0.2, 0.1, 0.6, -0.2])
