"""tribocosim sensitivities: elasticities of a steady cycle's figures of merit."""

import math

import numpy as np
import pytest
import xarray

from orchestrator.errors import MistakeError, RunError
from orchestrator.scenario.files import load, read_changed
from orchestrator.study.run import Where
from orchestrator.study.speeds import sensitivities
from orchestrator.study.speeds import subject as speeds
from orchestrator.study.speeds.sensitivities import (
    SHARE,
    SHARES,
    SensitivitySubject,
    choose_parameters,
    differentiate,
    find_sensitivities,
    find_usable,
)
from orchestrator.study.speeds.subject import SpeedSubject
from orchestrator.study.store import DONE
from tribocosim.reporting import SilentReporter

from .commands import called, said

DRY = ("components.contact.parameters.film_model=dry",)
# Of the parameters that move a dry train: exponents of the kilogram in their units.
WITH_MASS = {
    "valve_spring.preload": 1.0,
    "valve_spring.spring_rate": 1.0,
    "valve_spring.valve_mass": 1.0,
    "contact.youngs_modulus_1": 1.0,
    "contact.youngs_modulus_2": 1.0,
}


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


def test_more_of_every_mass_makes_as_much_more_of_every_force(monkeypatch, record):
    """In other units of mass a train moves alike: a figure's elasticities to all parameters with the kilogram
    in their unit add up to the kilogram's exponent in its own.

    Noise and the fourth order's error leave 8e-5, of the largest load, in which the contact vibrates.
    """
    monkeypatch.setattr(speeds, "SAMPLES", 720)
    base = SpeedSubject(read_changed("valve-train", DRY), "flywheel")
    subject = SensitivitySubject(base, 2000.0 * math.pi / 30.0, tuple(WITH_MASS))
    cases = [subject.evaluate({"case": float(k)}) for k in range(1 + len(SHARES) * len(WITH_MASS))]
    table = {name: np.array([case[name] for case in cases], dtype=float) for name in subject.results}
    found = {name: one[0] for name, one in differentiate(table, len(WITH_MASS)).items()}
    exponents = np.array(list(WITH_MASS.values()))
    expected = {
        "contact.least_load": 1.0,
        "contact.largest_load": 1.0,
        "contact.peak_pressure": 1.0,
        "valve_spring.surge_force": 1.0,
        "valve_spring.spring_margin": 0.0,
        "valve_spring.largest_lift": 0.0,
        "flywheel.largest_torque": 1.0,
    }
    sums = np.array([found[name] @ exponents for name in expected])
    quantity, source = "elasticities to all masses, forces and moduli, sum", "dimensional analysis"
    record("Train", quantity, sums, list(expected.values()), source, tolerance=3e-4)


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
        "sensitivities", "valve-train", "--speed", "2000 rpm", "--parameter", "valve_spring.preload",
        "--workers", "1", "--out", str(tmp_path / "found"), "--set", *DRY,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "valve_spring.preload" in done.stdout
    head, *rows = (tmp_path / "found" / "sensitivities.csv").read_text("utf-8").splitlines()
    assert head == "figure,value,unit,valve_spring.preload"
    by_figure = {row.split(",")[0]: row.split(",") for row in rows}
    # The spring's force is its preload and what lift and surge add, which the preload hardly changes.
    _, force, unit, elasticity = by_figure["valve_spring.largest_spring_force"]
    assert unit == "N"
    assert float(elasticity) == pytest.approx(330.0 / float(force), rel=1e-4)
    assert (tmp_path / "found" / "sensitivities.png").stat().st_size > 10_000


def test_a_mistake_is_one_sentence():
    done = called("sensitivities", "valve-train", "--speed", "2000")
    assert done.returncode == 2
    assert "speed" in said(done)


def test_each_number_that_an_oil_gives_varies_alone(monkeypatch, tmp_path):
    given = []

    def run(plan, *_):
        for case in range(1 + len(SHARES)):
            tables = plan.subject.find_case(case)[0].tables
            given.append(tables["components"]["contact"]["parameters"])
        raise RunError("as far as is needed")

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
