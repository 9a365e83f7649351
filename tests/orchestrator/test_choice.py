"""`auto`: what it chooses keeps the tolerance, costs little more than the best choice, and is recorded."""

import pytest

import tribocosim
from benchmarks.hindsight import find_best, list_scenarios, run_chosen, solve_problem
from orchestrator.errors import MistakeError

# doSteps over the fewest of all other choices.
REGRET = 1.5


@pytest.mark.parametrize(
    "name",
    [
        "mass-spring-damper",
        pytest.param("two-masses", marks=pytest.mark.long),
        pytest.param("quarter-car", marks=pytest.mark.long),
        pytest.param("valve-train", marks=pytest.mark.long),
        pytest.param("finger-follower", marks=pytest.mark.long),
    ],
)
def test_the_choice_keeps_the_tolerance_and_costs_little_more_than_the_best(name, record):
    problem = solve_problem(list_scenarios()[name]())
    own, best = run_chosen(problem), find_best(problem)
    assert own.good, own
    assert best is not None
    case = f"{name}, auto: doSteps over those of the best choice in hindsight"
    record("Coupling", case, own.steps / best.steps, 0.0, "bound", tolerance=REGRET)


def test_the_result_has_the_choice_and_is_had_again_without_choosing(tmp_path):
    changes = {f"components.{name}.participant": "in-process" for name in ("chassis", "wheel")}
    asked = {"master": {"name": "auto"}, "stop_time": 0.5, "tolerance": {"chassis.position": 1e-3}, **changes}
    first = tribocosim.run(tribocosim.load("quarter-car").with_(asked), tmp_path / "first")
    assert first.within
    assert sum("auto chose gauss_seidel" in line for line in first.notices) == 1
    written = tribocosim.load(tmp_path / "first" / "scenario.toml")
    assert written.content["master"]["name"] == "gauss_seidel"
    again = tribocosim.run(written)
    assert again.coupled.equals(first.coupled)


@pytest.mark.parametrize(
    ("name", "changes", "reason"),
    [
        ("valve-train-ehl", {}, "cannot be analysed"),
        ("two-masses", {"reference": {"enabled": False}, "tolerance": {}}, "tolerance: missing"),
        ("seat-and-lash", {"stop_time": 0.02}, "contact lands at t = 0.019 s"),
        ("two-masses", {"master": {"name": "auto", "order": ["first", "second"]}}, "auto has no options"),
    ],
)
def test_what_cannot_be_chosen_is_refused_with_the_reason(name, changes, reason):
    with pytest.raises(MistakeError, match=reason):
        tribocosim.plan(tribocosim.load(name).with_({"master": {"name": "auto"}, **changes}))
