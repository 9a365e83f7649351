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
from orchestrator.scenario.files import load, put, read_changed, to_full_toml
from orchestrator.scenario.system import list_parameters, list_quantities
from orchestrator.study.run import Where
from orchestrator.study.speeds import figure_slopes, sensitivities
from orchestrator.study.speeds.figure_slopes import SPEED, FigureSlopes, find_run_slopes, find_slopes
from orchestrator.study.speeds.sensitivities import (
    SHARE,
    SHARES,
    choose_parameters,
    differentiate,
    find_sensitivities,
    find_usable,
    publish,
)
from orchestrator.study.speeds.subject import SpeedSubject
from orchestrator.study.store import DONE, FAILED
from orchestrator.texts import parse_toml
from tribocosim.reporting import SilentReporter

from .commands import called

DRY = ("components.contact.parameters.film_model=dry",)


def test_a_power_law_has_its_exponent_and_an_error_of_fourth_order():
    factors = 1.0 + SHARE * np.array([0.0, *SHARES])
    found = differentiate({"power": 7.0 * factors**2.5, "none": 0.0 * factors}, 1)
    elasticity, error = found["power"]
    # The term of order h^4 is 2.5 1.5 0.5 0.5 1.5 / 30 h^4 = 5e-14; rounding over h is 2e-13.
    assert elasticity == pytest.approx([2.5], abs=1e-12)
    assert error == pytest.approx([2.5 * 1.5 * 0.5 / 6.0 * SHARE**2], rel=1e-3)
    assert "none" not in found
    corner = differentiate({"corner": 1.0 + np.maximum(factors - 1.0 - 0.5 * SHARE, 0.0)}, 1)["corner"]
    assert corner[1] > 0.05 * corner[0]


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


def test_at_the_edge_of_a_range_slopes_are_those_of_the_side_within(monkeypatch):
    def measure(share):
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
    monkeypatch.setattr(sensitivities, "run", run)
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
        {"speed": 200.0, "status": 0, "method": method},
    )
    text = io.StringIO()
    reporter = Reporter(Console(file=text, width=200))
    publish(dataset, load("valve-train"), tmp_path, reporter)
    rows = [line for line in text.getvalue().splitlines() if "contact.viscosity" in line or "speed " in line]
    assert ["~" in row for row in rows] == marked, text.getvalue()


def test_where_both_sides_differ_each_has_its_elasticity(tmp_path):
    """Of a load of 300 N that falls by 0.6 % with less of a parameter and by 0.2 % with more of it."""
    slopes = {"contact.least_load": FigureSlopes(300.0, np.array([60.0, 30.0]), np.array([-240.0, 0.0]))}
    dataset = sensitivities._divide(slopes, ["speed", "contact.viscosity"], speed=200.0)
    text = io.StringIO()
    publish(dataset, load("valve-train"), tmp_path, Reporter(Console(file=text, width=200)))
    assert "~0.6|-0.2" in text.getvalue()
    assert "less | more" in text.getvalue()
    head, row = (tmp_path / "sensitivities.csv").read_text("utf-8").splitlines()
    assert head.split(",")[3:] == ["speed", "contact.viscosity", "speed below", "speed above"]
    assert [float(cell) for cell in row.split(",")[3:]] == pytest.approx([0.2, 0.1, 0.6, -0.2])
