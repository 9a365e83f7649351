"""Cycles of one train at many values: the same as of scenarios with these values, in any order."""

import math
from dataclasses import replace

import numpy as np
import pytest

from models.monolithic.cycle import STEADY
from orchestrator.errors import MistakeError
from orchestrator.scenario.files import read_changed
from orchestrator.study.speeds import finder, subject
from orchestrator.study.speeds.finder import CycleFinder
from orchestrator.study.speeds.subject import SpeedSubject, describe_numbers, measure_cycle

SPEED = 2000.0 * math.pi / 30.0
DRY = ("components.contact.parameters.film_model=dry",)
STIFFER = {"valve_spring.preload": 350.0, "valve_spring.spring_rate": 33e3}


@pytest.fixture
def dry(monkeypatch):
    for module in (finder, subject):
        monkeypatch.setattr(module, "SAMPLES", 720)
    return CycleFinder(SpeedSubject(read_changed("valve-train", DRY), "flywheel"))


def test_a_cycle_is_that_of_the_scenario_with_these_values(dry):
    """Both end within 1e-5 of their nominal sizes where they began: loads follow within some 1e-5."""
    settings = [f"components.{name.replace('.', '.parameters.')}={value}" for name, value in STIFFER.items()]
    alone = SpeedSubject(read_changed("valve-train", (*DRY, *settings)), "flywheel")
    expected = measure_cycle(alone.find_cycle_at(SPEED), "flywheel")
    found = dry.measure(STIFFER, SPEED)
    for name in ("contact.least_load", "contact.largest_load", "valve_spring.spring_margin"):
        assert found[name] == pytest.approx(expected[name], rel=1e-4), name
    assert found["contact.least_load"] > dry.measure({}, SPEED)["contact.least_load"] + 5.0
    assert found["periods"] < expected["periods"]


def test_figures_depend_on_nothing_that_was_found_before(dry):
    first = dry.measure(STIFFER, SPEED)
    dry.measure({"valve_spring.valve_mass": 0.2}, SPEED)
    dry.measure({}, 1.1 * SPEED)
    assert (
        str(first)
        == str(dry.measure(STIFFER, SPEED))
        == str(CycleFinder(dry.subject).measure(STIFFER, SPEED))
    )


@pytest.mark.parametrize(("speed", "losing"), [(SPEED, 0), (3300.0 * math.pi / 30.0, 2)])
def test_figures_of_near_trains_are_those_of_their_own_cycles(dry, speed, losing):
    """To 0.5 % of their spread and 2e-5 of the part's largest figure of this unit, with and without loss of
    contact; cycles of their own are sought from rest, a hundred times as exactly."""
    sharp, random = CycleFinder(dry.subject, 1e-10, 1e-8), np.random.default_rng(1)
    near, own = list[dict[str, float]](), list[dict[str, float]]()
    for preload, rate, mass in 1.0 + random.normal(0.0, [0.04, 0.02, 0.01], (4, 3)):
        values = {"preload": 330.0 * preload, "spring_rate": 35e3 * rate, "valve_mass": 0.22 * mass}
        values = {f"valve_spring.{name}": value for name, value in values.items()}
        near.append(dry.measure(values, speed))
        own.append(measure_cycle(sharp.begin(values, speed), "flywheel"))
    assert sum(one["contact.lost"] > 0.0 for one in own) == losing
    assert all(one["change"] <= STEADY for one in near)
    for name, result in describe_numbers(dry.subject.scenario).items():
        if name.endswith("_angle"):  # at which sample a flat extreme stands
            continue
        found, exact = (np.array([one[name] for one in trains]) for trains in (near, own))
        part = name.partition(".")[0]
        alike = [n for n, r in describe_numbers(dry.subject.scenario).items() if r.unit == result.unit]
        size = max(abs(one[n]) for one in own for n in alike if n.startswith(f"{part}."))
        allowed = 5e-3 * exact.std(ddof=1) + 2e-5 * size
        assert np.array_equal(np.isnan(found), np.isnan(exact)), name
        assert np.isnan(exact).all() or np.abs(found - exact).max() <= allowed, name


def test_where_slopes_lead_nowhere_a_train_is_found_without_them(dry, monkeypatch):
    def mislead(search, *_):
        return replace(search, lead=lambda begin, end: np.nan * end)

    monkeypatch.setattr(finder, "learn_slopes", mislead)
    assert str(dry.measure(STIFFER, SPEED)) == str(measure_cycle(dry.find(STIFFER, SPEED), "flywheel"))


def test_a_parameter_that_there_is_none_of_is_named(dry):
    with pytest.raises(MistakeError, match=r"valve_spring\.preloads: .*did you mean valve_spring\.preload"):
        dry.find({"valve_spring.preloads": 300.0}, SPEED)
    with pytest.raises(MistakeError, match=r"flywheel\.final_speed: is the speed of the cycle"):
        dry.find({"flywheel.final_speed": 300.0}, SPEED)


def test_work_that_adds_up_leaves_a_cycle_steady():
    """The gas of an engine gives work in each cycle; the motion of the valve does not depend on its sum."""
    cycle = SpeedSubject(read_changed("exhaust-valve", ()), "flywheel").find_cycle_at(SPEED)
    assert cycle.steady
    assert cycle["gas.indicated_work"][-1] > 100.0
