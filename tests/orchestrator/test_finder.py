"""Cycles of one train at many values: the same as of scenarios with these values, in any order."""

import math

import pytest

from orchestrator.errors import MistakeError
from orchestrator.scenario.files import read_changed
from orchestrator.study.speeds import finder, subject
from orchestrator.study.speeds.finder import CycleFinder
from orchestrator.study.speeds.subject import SpeedSubject, measure_cycle

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
