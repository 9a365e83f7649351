"""What limited the steps of a run: numbers by their definitions, rules that speak only with ground."""

import json
import os
import re
import shutil
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from models.core.quantities import Quantity
from orchestrator.assessment.diagnosis import RULES, Facts, Steps, brief, diagnose_steps, full, read_steps
from orchestrator.assessment.diagnosis.report import LIMITING, answer, diagnose
from orchestrator.assessment.diagnosis.suggestions import SURVEYED, suggestions
from orchestrator.assessment.diagnosis.times import Spending, list_parts, read_spending
from orchestrator.assessment.friction.judge import judge_friction
from orchestrator.engine.effort import Spent
from orchestrator.engine.step import REASONS, Step
from orchestrator.errors import MistakeError, in_command_line
from orchestrator.plots import steps as figure
from orchestrator.plots.style import save_figure
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.run.record import ResultRecorder
from orchestrator.scenario.files import load, to_full_toml
from orchestrator.store.output_folder import RESULT, SCENARIO, find_run_state

from .commands import called
from .commands import said as said_by

OUTPUTS = (
    "flywheel.angle", "camshaft.surface_position", "contact.load", "valve_spring.velocity",
    "camshaft.drive_torque",
)  # fmt: skip
LOAD, ANGLE, TORQUE = 2, 0, 4


def made(length, reason="error", source=LOAD, iterations=1, rejected=0, error=0.1) -> Steps:  # type: ignore[no-untyped-def]
    """Steps from t = 0; what is not an array is the same for all."""
    length = np.asarray(length, dtype=float)
    n = len(length)
    numbers = np.array([REASONS.index(name) for name in np.broadcast_to(reason, n)])
    columns = {
        "time": np.cumsum(length),
        "macro_step": length,
        "iterations": np.broadcast_to(iterations, n),
        "rejected": np.broadcast_to(rejected, n),
        "error": np.broadcast_to(error, n),
        "source": np.broadcast_to(source, n),
        "reason": numbers,
        "parts": np.ones(n),
    }
    return Steps.of(columns, OUTPUTS)


def facts(steps: Steps, *changes: str, scenario: str = "valve-train-controlled") -> Facts:
    diagnosis = diagnose_steps(steps)
    assert diagnosis is not None
    return Facts(diagnosis, steps, load(scenario, changes))


def said(found: Facts) -> dict[str, str]:
    """What is suggested, by rule."""
    return {rule.__name__: text for rule in RULES if (text := rule(found))}


def random_steps(n: int, seed: int = 1) -> Steps:
    random = np.random.default_rng(seed)
    return made(
        10.0 ** random.uniform(-7.0, -4.0, n),
        random.choice(REASONS, n),
        random.integers(0, len(OUTPUTS), n),
        random.integers(1, 9, n),
        random.integers(0, 2, n),
        10.0 ** random.uniform(-9.0, 0.0, n),
    )


@pytest.mark.parametrize("seed", range(2))
def test_shares_are_a_partition(seed):
    """Every step has one reason, and every limit by error one variable: shares add up."""
    d = diagnose_steps(random_steps(300, seed))
    assert d is not None
    assert sum(share.steps for share in d.reasons.values()) == pytest.approx(1.0)
    assert sum(share.time for share in d.reasons.values()) == pytest.approx(1.0)
    assert sum(limit.steps for limit in d.limits.values()) == pytest.approx(d.share("error"))
    assert sum(limit.time for limit in d.limits.values()) == pytest.approx(d.reasons["error"].time)
    assert sum(d.rejections.values()) == d.rejected
    spans = sorted(span for limit in d.limits.values() for span in limit.spans)
    assert all(a[1] <= b[0] + 1e-15 for a, b in pairwise(spans))
    assert list(d.length.values()) == sorted(d.length.values())


def test_spans_are_where_a_variable_limits_most_steps():
    """Two halves of a run, one limited by the load, the other by the angle: borders to one span of 1 %."""
    steps = made(np.full(1000, 1e-3), source=np.repeat([LOAD, ANGLE], 500))
    d = diagnose_steps(steps)
    assert d is not None
    assert d.limits["contact.load"].spans == (pytest.approx((0.0, 0.5), abs=0.01),)
    assert d.limits["flywheel.angle"].spans == (pytest.approx((0.5, 1.0), abs=0.01),)
    long = diagnose_steps(made([0.5, 0.5]))  # steps longer than spans
    assert long is not None
    assert long.limits["contact.load"].spans == ((0.0, 1.0),)


def test_the_densest_intervals_are_the_shortest_with_a_tenth_of_the_work():
    """Compared with all intervals that steps can make; and work is iterations times attempts."""
    steps = random_steps(150)
    d = diagnose_steps(steps)
    assert d is not None
    work = steps.iterations * (1 + steps.rejected)
    np.testing.assert_array_equal(steps.work, work)
    shortest = min(
        steps.end[j] - steps.start[i]
        for i in range(150)
        for j in range(i, 150)
        if work[i : j + 1].sum() >= 0.1 * work.sum() * (1.0 - 1e-9)
    )
    assert min(i.end - i.start for i in d.densest) == pytest.approx(shortest)
    for i in d.densest:
        inside = (steps.start >= i.start - 1e-15) & (steps.end <= i.end + 1e-15)
        assert i.work == pytest.approx(work[inside].sum() / work.sum())
        assert i.work >= 0.1 * (1.0 - 1e-9)


def test_even_steps_have_no_dense_interval_and_no_suggestion():
    found = facts(made(np.full(1000, 1e-5), "fixed", -1, error=0.0), scenario="valve-train")
    assert [i.density for i in found.diagnosis.densest] == pytest.approx([1.0] * len(found.diagnosis.densest))
    assert said(found) == {}
    assert brief(found.diagnosis, []) == []
    assert "work: spread evenly over the time" in full(found, [], "complete")


CONTROLLED = made(np.full(200, 1e-5), iterations=3)
EQUAL = made(np.full(100, 1e-5), "fixed", -1)
GROUNDS = {
    "stiff_connection": (CONTROLLED, ["master.name=gauss_seidel"], 'name = "iterated"'),
    "smaller_part": (CONTROLLED, ["master.iterate=[]"], 'iterate = ["camshaft", "valve_spring", "contact"]'),
    "higher_degree": (CONTROLLED, ["master.extrapolation=linear"], 'extrapolation = "hermite"'),
    "convergence": (
        made(np.full(100, 1e-5), ["convergence"] * 40 + ["error"] * 60, rejected=[1] * 40 + [0] * 60),
        ["master.acceleration=anderson"],
        'acceleration = "quasi_newton"',
    ),
    "many_iterations": (
        made(np.full(100, 1e-5), iterations=6),
        ["master.tolerance=1e-12"],
        "loosen master.tolerance (now 1e-12) to 3e-08",
    ),
    "suggest_longer_start": (
        made(np.r_[1e-6 * 2.0 ** np.arange(20), np.full(80, 1.0)], ["growth"] * 20 + ["error"] * 80),
        ["macro_step=1 us"],
        'macro_step = "524 ms"',
    ),
    "longest": (
        made(np.full(100, 1e-5), "maximum_step", error=0.01),
        ["step_control.maximum_step=1e-5"],
        "step_control.maximum_step = 10 us",
    ),
    "discontinuity": (made([1e-5, 1e-12, 1e-5], ["error", "discontinuity", "error"]), [], "contact.load"),
    "rough": (
        made(np.r_[np.full(90, 1e-4), np.full(10, 1e-6)], rejected=np.r_[np.zeros(90, int), np.full(10, 3)]),
        [],
        "30 attempts",
    ),
    "discards": (
        made(np.full(100, 1e-5), ["discard"] * 20 + ["error"] * 80, rejected=[1] * 20 + [0] * 80),
        [],
        "17 % of the attempts",
    ),
    "chatter": (made(np.full(100, 1e-5), ["event"] * 20 + ["error"] * 80), [], "contact.load"),
    "costly_estimator": (CONTROLLED, ["step_control.estimator=step_doubling"], '"predictor_corrector"'),
    "suggest_held_inputs": (EQUAL, ["master.extrapolation=hold"], "extrapolation"),
    "uneven_work": (
        made(np.full(100, 1e-5), "fixed", -1, np.r_[np.full(98, 2), 20, 20]),
        ["master.name=iterated"],
        "step_control",
    ),
}


@pytest.mark.parametrize("rule", [rule.__name__ for rule in RULES])
def test_a_rule_speaks_with_ground_and_is_silent_without(rule):
    steps, changes, words = GROUNDS[rule]
    equal = REASONS[steps.reason[0]] == "fixed"
    scenario = "valve-train" if equal else "valve-train-controlled"
    assert words in said(facts(steps, *changes, scenario=scenario))[rule]
    assert rule not in said(facts(EQUAL if equal else CONTROLLED))


@pytest.mark.parametrize("rule", [rule.__name__ for rule in SURVEYED])
def test_what_a_survey_has_chosen_is_not_advised_against(rule):
    steps, changes, words = GROUNDS[rule]
    scenario = "valve-train" if steps is EQUAL else "valve-train-controlled"
    found, chosen = (facts(steps, *changes, *more, scenario=scenario) for more in ([], ["master.chosen=so"]))
    assert words in " ".join(suggestions(found))
    assert words not in " ".join(suggestions(chosen))


def test_a_torque_that_moves_nothing_is_not_called_stiff():
    """A flywheel takes notice of it where its speed is free."""
    steps = made(np.full(1000, 1e-5), source=TORQUE)
    gauss_seidel, free = "master.name=gauss_seidel", "components.flywheel.parameters.motion=free"
    assert "stiff_connection" not in said(facts(steps, gauss_seidel))
    assert "camshaft.drive_torque" in said(facts(steps, gauss_seidel, free))["stiff_connection"]


@pytest.mark.parametrize(
    ("changes", "remedy"),
    [
        (["master.acceleration=anderson"], 'acceleration = "quasi_newton"'),
        (["master.acceleration=quasi_newton"], 'name = "newton"'),
        (["master.name=newton"], "maximum_iterations = 60"),
    ],
)
def test_the_remedy_is_one_that_the_master_does_not_have_yet(changes, remedy):
    steps = GROUNDS["convergence"][0]
    assert remedy in said(facts(steps, *changes))["convergence"]


def test_a_few_steps_that_grow_are_not_worth_a_word():
    growing = ["growth"] * 5 + ["error"] * 5
    assert "suggest_longer_start" not in said(facts(made(2.0 ** np.arange(10), growing)))


def test_every_reason_has_its_words_and_its_colour():
    """Also as the only one, where nothing else could stand for it."""
    for reason in REASONS:
        found = facts(made([1e-5, 2e-5], reason, iterations=2))
        assert list(found.diagnosis.reasons) == [reason]
        lines = full(found, [], "complete")
        assert "100 %" in lines[0] or LIMITING[reason] in lines[0]
        assert lines[6].split()[-4:] == ["100", "%", "100", "%"]
        kinds, _ = figure._assign_colours(found.steps)
        assert [chosen.all() for _, chosen in kinds] == [True], reason


@pytest.mark.parametrize(("length", "unit", "spans"), [(5.0, "s", "0 .. 1000"), (0.05e-3, "ms", "0 .. 10")])
def test_times_are_in_a_unit_that_suits_the_run(length, unit, spans):
    found = facts(made(np.full(200, length), iterations=np.r_[np.full(190, 1), np.full(10, 50)]))
    lines = full(found, [], "complete")
    (row,) = (i for i, line in enumerate(lines) if "limits most steps" in line)
    assert lines[row].endswith(f"({unit})")
    assert lines[row + 1].endswith(spans)
    assert any(line.startswith("work: ") and f" {unit} (" in line for line in lines)
    drawn = figure.draw_steps(found.steps, "run")
    assert f"Time ({unit})" in [ax.get_xlabel() for ax in drawn.axes]


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A short run with controlled steps, from its start in motion."""
    out = tmp_path_factory.mktemp("run") / "out"
    parts = ("flywheel", "camshaft", "valve_spring", "contact")
    changes = [f"components.{name}.participant=in-process" for name in parts]
    scenario = load("valve-train-controlled", ["stop_time=1 ms", "reference.enabled=false", *changes])
    run(scenario, out, lambda name, structure, kind: Path(), Reporter())
    return out


def test_a_run_tells_in_its_summary_what_its_steps_were(finished):
    summary = json.loads((finished / "summary.json").read_text())
    steps, message = read_steps(finished)
    assert message == "complete"
    assert steps.end[-1] == 1e-3
    assert steps.length.sum() == pytest.approx(1e-3)
    assert summary["steps"]["steps"] == summary["macro_steps"] == len(steps)
    assert summary["do_steps"] == summary["steps"]["do_steps"] >= 4 * len(steps)
    efforts = summary["effort"].values()
    assert sum(one["do_steps"] for one in efforts) == summary["do_steps"]
    assert all(one["restored"] for one in efforts if one["do_steps"] > len(steps)), efforts
    assert 0.0 < sum(one["stepping_s"] for one in efforts) < summary["coupled_time_s"]
    assert sum(share["steps"] for share in summary["steps"]["reasons"].values()) == pytest.approx(1.0)
    # Sources are numbers among the names that the result itself gives.
    assert set(summary["steps"]["limits"]) <= set(steps.outputs)
    assert (finished / "figures" / "steps.png").exists()


def test_the_command_says_it_again_and_draws(finished, tmp_path):
    lines = called("diagnose", str(finished), "--figure", str(tmp_path / "steps.png")).stdout.splitlines()
    assert [line.partition(": ")[0] for line in lines[:3]] == ["Time", "Step", "Change"]
    assert lines[4].startswith("valve-train-controlled (complete): ")
    assert any(line.startswith("what set the step") for line in lines)
    assert (tmp_path / "steps.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    "text", ["no JSON", "[]", '{"coupled_time_s": null}', '{"effort": {"a": {"do_steps": null}}}']
)
def test_a_run_whose_summary_is_damaged_is_diagnosed_without_times(text, finished, tmp_path):
    copy = shutil.copytree(finished, tmp_path / "copy")
    (copy / "summary.json").write_text(text)
    done = called("diagnose", str(copy))
    assert done.returncode == 0
    assert "where the time went" not in done.stdout


def test_parts_of_the_time_add_up_to_the_whole(finished):
    """A complete run, with figures."""
    spending, found = read_spending(finished / "summary.json"), load(finished / "scenario.toml")
    parts = list_parts(found, spending)
    assert sum(part.seconds for part in parts) == pytest.approx(spending.wall_s, rel=1e-9)
    assert {"figures and report", "result files", "steps of contact"} <= {part.name for part in parts}


def test_the_answer_names_what_the_user_can_change():
    """The choice of a master is no reference; keys exist; an error of zero is room."""
    spent = {"contact": Spent(1000, 0, 0.0, 0.0, 0.01, 0.0)}
    times = {"stability and errors of every method": 6.0, "result file": 3.0, "monolithic reference": 1.0}
    spending = Spending(10.1, 0.1, 1000, times, spent, errors={"contact.load": 0.0})
    found = facts(made(np.full(9, 1e-5)))
    time, _, change = answer(found, spending, list_parts(found.scenario, spending), [])
    assert "59 % went into the choice of a master (`scenario.toml`" in time
    assert f"--set step_control.relative={10.0 * found.scenario.step_control.relative:.2g}" in change
    command = re.search("`tribocosim masters (.+?)`", change)
    assert command
    assert load(command[1]) == load("valve-train-controlled")
    fixed = facts(made(np.full(9, 5e-6), "fixed"), scenario="valve-train")
    remedies = {part.name: part.remedy for part in list_parts(fixed.scenario, spending)}
    (key,) = re.findall("`(.+?)`", remedies["result files"])
    assert load("valve-train", [f"{key}=100 us"]).record_every > fixed.scenario.record_every


def test_a_killed_run_is_diagnosed_from_its_journals(finished, tmp_path):
    """Round trip: the same steps from the journals of a run that left no result."""
    steps, _ = read_steps(finished)
    folder = find_run_state(tmp_path)
    folder.mkdir()
    recorder = ResultRecorder(folder, dict.fromkeys(steps.outputs, Quantity("N", "a load")), 1)
    recorder.begin(steps.outputs)
    values = np.zeros(len(steps.outputs))
    recorder.observe(0.0, values.copy, Step(0.0, 0.0, 0))
    for row in zip(
        steps.end, steps.length, steps.iterations, steps.rejected, steps.error, steps.source, steps.reason,
        steps.parts, strict=True,
    ):  # fmt: skip
        recorder.observe(row[0], values.copy, Step(*row))
    recorder.end(False, "killed")
    found, message = read_steps(tmp_path)
    assert "was killed" in message
    assert found.outputs == steps.outputs
    for name in ("end", "length", "iterations", "rejected", "error", "source", "reason", "parts"):
        np.testing.assert_array_equal(getattr(found, name), getattr(steps, name))
    (tmp_path / SCENARIO).write_text(to_full_toml(load("valve-train-controlled")), "utf-8")
    found = diagnose(tmp_path)
    assert "was killed" in found.lines[3]
    assert found.suggestions[-1].startswith(f"`tribocosim resume {tmp_path}` ends the run and compares it")


def test_what_is_no_run_is_a_mistake(tmp_path):
    with pytest.raises(MistakeError, match="holds no result and no unfinished run"):
        read_steps(tmp_path)
    (tmp_path / RESULT).write_bytes(b"not HDF5")
    with pytest.raises(MistakeError, match="is no result of this version"):
        read_steps(tmp_path)


def test_a_wrong_folder_or_figure_is_told_before_anything_else(finished, tmp_path, monkeypatch):
    with pytest.raises(MistakeError, match=r"did you mean .*/out\?$"):
        diagnose(finished / "summary.json")
    monkeypatch.chdir(tmp_path)
    own = shutil.copytree(finished, tmp_path / "results" / "valve-train-controlled")
    os.utime(shutil.copytree(finished, tmp_path / "results" / "older") / SCENARIO, (0, 0))
    (tmp_path / "own train.toml").write_text(f'name = "{load(own / SCENARIO).name}"\nextends = "valve-train"')
    for subject in ("valve-train-controlled", "own train.toml", own / SCENARIO):
        assert diagnose(Path(subject)).lines == diagnose(own).lines
    (tmp_path / "my train.toml").write_text('extends = "valve-train"')
    with pytest.raises(MistakeError) as caught:
        diagnose(Path("my train.toml"))
    assert in_command_line(caught.value).endswith("make one with tribocosim run 'my train.toml'")
    with pytest.raises(MistakeError, match=r"did you mean results/valve-train-controlled\?$"):
        diagnose(Path("results/valve-trian-controlled"))
    with pytest.raises(MistakeError, match=r"did you mean results/valve-train-controlled\?$"):
        judge_friction(Path("results/valve-train-controled"), None, 1e-17, 1.0)
    (tmp_path / "file").touch()
    for path in (tmp_path / "steps.txt", tmp_path / "file" / "x.png"):
        assert str(path) in said_by(called("diagnose", str(finished), "--figure", str(path)))
    (own / SCENARIO).unlink()
    with pytest.raises(MistakeError, match=SCENARIO):
        diagnose(own)


@pytest.mark.parametrize("n", [1, pytest.param(10_000, marks=pytest.mark.long)])
def test_the_figure_is_drawn_for_few_and_for_many_steps(n, tmp_path):
    """All steps are in the histograms: their bars add up to 100 %."""
    drawn = figure.draw_steps(steps := random_steps(n), "random")
    widths = [patch.get_width() for patch in drawn.axes[1].patches]
    assert sum(widths) == pytest.approx(100.0)
    path = save_figure(lambda: figure.draw_steps(steps, f"{n} random steps"), tmp_path / "steps.png")
    assert path.stat().st_size > 10_000
