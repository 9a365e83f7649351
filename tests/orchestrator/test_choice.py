"""`auto`: what it chooses keeps the tolerance, costs little more than the best choice, and is recorded."""

from unittest.mock import Mock

import pytest

import tribocosim
from benchmarks.hindsight import find_best, list_scenarios, run_chosen, solve_problem
from orchestrator.analyses.stability import choice
from orchestrator.errors import MistakeError, RefusedError, RunError, Set, UnstableCouplingError
from orchestrator.scenario.files import load

# doSteps over the fewest of all other choices.
REGRET = 1.5


@pytest.mark.parametrize(
    "name",
    [
        "mass-spring-damper",
        "nonlinear-loop",
        pytest.param("two-masses", marks=pytest.mark.long),
        pytest.param("quarter-car", marks=pytest.mark.long),
        pytest.param("valve-train", marks=pytest.mark.long),
        pytest.param("finger-follower", marks=pytest.mark.long),
    ],
)
def test_the_choice_keeps_the_tolerance_and_costs_little_more_than_the_best(name, record):
    problem = solve_problem(list_scenarios()[name]())
    own, _ = run_chosen(problem)
    assert own.good, own
    best = find_best(problem, own)
    assert best is not None
    case = f"{name}, auto: doSteps over those of the best choice in hindsight"
    record("Coupling", case, own.steps / best.steps, 0.0, "bound", tolerance=REGRET)


@pytest.mark.long
@pytest.mark.parametrize("speed", [1000, 4000])
def test_the_steps_of_the_roller_finger_serve_at_all_its_speeds(speed):
    scenario = tribocosim.load("roller-finger")
    changes = {f"components.{name}.participant": "in-process" for name in scenario.content["components"]}
    changes["components.flywheel.parameters.initial_speed"] = f"{speed} rpm"
    assert tribocosim.run(scenario.with_(changes)).within


def leave_master(name, **changes):
    """A shipped scenario in this process without its master, with these changes."""
    content = dict(tribocosim.load(name).content)
    del content["master"]
    tables = {one: table | {"participant": "in-process"} for one, table in content["components"].items()}
    return tribocosim.Scenario(content | {"components": tables} | changes)


def test_a_scenario_without_a_master_gets_one_and_its_result_is_had_again_without_choosing(tmp_path):
    asked = leave_master("quarter-car", stop_time=0.5, output_step=7e-3, tolerance={"chassis.position": 1e-3})
    first = tribocosim.run(asked, tmp_path / "first")
    assert first.within
    assert sum("auto chose gauss_seidel" in line for line in first.notices) == 1
    assert not any("output_step" in line for line in first.notices)
    written = tribocosim.load(tmp_path / "first" / "scenario.toml")
    assert written.content["master"]["name"] == "gauss_seidel"
    again = tribocosim.run(written)
    assert again.coupled.equals(first.coupled)


@pytest.mark.parametrize(
    ("name", "changes", "why"),
    [
        ("two-masses", {"reference": {"enabled": False}, "tolerance": {}}, "there is no tolerance"),
        (
            "two-masses",
            {"connections": ["first.force * 2.0 -> second.force"]},
            "the connection 'first.force * 2.0 -> second.force' changes values",
        ),
    ],
)
def test_a_scenario_for_which_none_can_be_chosen_runs_as_it_is_and_says_so(name, changes, why):
    asked = leave_master(name, **changes)
    plan = tribocosim.plan(asked)
    assert (plan.scenario.master.name, plan.scenario.macro_step) == ("gauss_seidel", 2e-3)
    said = f"no master is named, and none is chosen ({why}"
    assert sum(str(line).startswith(said) for line in plan.notices) == 1


def test_what_lands_hard_is_tried_with_steps_that_are_made_again():
    """Its error is measured against a motion that is solved to 1e-11, as in the other problems."""
    problem = solve_problem(load("seat-and-lash", ["stop_time=0.02"]))
    made, tried = run_chosen(problem)
    assert "made again" in made.choice
    assert "contact lands at t = 0.019 s" in made.choice
    assert made.good
    assert tried > made.steps


@pytest.mark.parametrize(
    ("name", "changes", "reason"),
    [
        ("valve-train-ehl", {}, "cannot be analysed"),
        ("two-masses", {"reference": {"enabled": False}, "tolerance": {}}, "tolerance: missing"),
        ("two-masses", {"master": {"name": "auto", "order": ["first", "second"]}}, "auto has no options"),
    ],
)
def test_what_cannot_be_chosen_is_refused_with_the_reason(name, changes, reason):
    with pytest.raises(MistakeError, match=reason):
        tribocosim.plan(tribocosim.load(name).with_({"master": {"name": "auto"}, **changes}))


UNSTABLE = UnstableCouplingError("t.w: unstable", ("halve ", Set("macro_step", "1 ms")), "auto")


@pytest.mark.parametrize(
    ("error", "said"),
    [(UNSTABLE, "auto': t.w: unstable; halve .*, or name"), (RefusedError("pid: refused"), "^pid: refused$")],
)
def test_a_choice_that_fails_names_no_remedy_that_led_there(error, said, monkeypatch):
    """What a participant refuses is no matter of the master, nor does `auto` help `auto`."""
    monkeypatch.setattr(choice, "survey_scenario", Mock(side_effect=error))
    with pytest.raises((MistakeError, RunError), match=said) as raised:
        tribocosim.plan(tribocosim.load("two-masses").with_({"master": {"name": "auto"}}))
    assert "or auto" not in str(raised.value)
