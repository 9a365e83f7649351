"""A master in a file of its own is one like the others; masters are compared on any scenario."""

import csv
import itertools
import math
from typing import Any
from unittest.mock import Mock

import pytest

import tribocosim
from models.core.difference import Difference
from orchestrator.analyses.stability import survey as surveying
from orchestrator.errors import MistakeError, RunError
from orchestrator.masters import MASTERS
from orchestrator.run.comparison import VariableError
from orchestrator.scenario.files import load
from orchestrator.scenario.fmu_limits import FmuLimits
from orchestrator.study.masters import LONGER, Tried, _list_untried, compare_masters, judge
from tribocosim.cached_fmus import build_fmu
from tribocosim.reporting import SilentReporter

from .commands import called
from .commands import said as said_by

OWN = """
from dataclasses import dataclass
from orchestrator.masters import Jacobi

@dataclass(frozen=True)
class Own(Jacobi):
    gain: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.gain <= 0.0:
            raise ValueError(f"gain = {self.gain}: must be > 0")

class Lost(Jacobi):
    def step(self, coupling, time, step):
        super().step(coupling, time, step)

class Slip(Jacobi):
    def step(self, coupling, time, step):
        return super().step(coupling, time, [step][1])

class Plain:
    pass

number = 3
"""


@pytest.fixture(autouse=True)
def own(tmp_path, monkeypatch):
    (tmp_path / "own_master.py").write_text(OWN)
    monkeypatch.syspath_prepend(tmp_path)


def vary(changes: Any) -> Any:
    return tribocosim.load("two-masses").with_({"stop_time": 0.5, **changes}).check()


def test_an_own_master_runs_as_the_same_one_of_ours():
    short = tribocosim.load("two-masses").with_({"stop_time": 0.2, "reference.enabled": False})
    runs = [
        tribocosim.run(short.with_({"master.name": name}), figures=False).coupled
        for name in ("jacobi", "own_master:Own")
    ]
    assert runs[0].equals(runs[1])


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (["own_master:Other"], "cannot be imported"),
        (["own_master:Plain"], "lacks implicit"),
        (["own_master:number"], "lacks implicit"),
        (["os:system"], "a module of Python"),
        (["nothing"], "must be one of"),
        (["own_master:Own", "master.gain=-1"], "gain = -1.0: must be > 0"),
        (["own_master:Own", "master.size=1"], "has no such option"),
    ],
)
def test_what_is_no_master_is_refused(settings, said):
    with pytest.raises(MistakeError, match=said):
        load("two-masses", [f"master.name={settings[0]}", *settings[1:]])


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("Lost", "own_master:Lost: its step returned None; return a MasterStep"),
        ("Slip", "own_master:Slip: own_master.py, line 20: IndexError: list index out of range; correct"),
    ],
)
def test_mistakes_of_an_own_master_are_told_with_their_place(name, said):
    changes = {"stop_time": 0.2, "reference.enabled": False, "master.name": f"own_master:{name}"}
    with pytest.raises(RunError, match=said):
        tribocosim.run(tribocosim.load("two-masses").with_(changes), figures=False)


@pytest.mark.parametrize("restorable", [True, False])
def test_masters_are_compared_by_error_and_work(restorable, tmp_path, monkeypatch):
    """Half the step, at least a quarter of the error of these masters; masters that repeat steps only where
    the FMUs can be restored."""
    monkeypatch.setattr(FmuLimits, "restorable", restorable)
    own = ["own_master:Own"] if restorable else []
    monkeypatch.setattr("orchestrator.study.masters.MASTERS", {n: MASTERS[n] for n in ("jacobi", "newton")})
    told: list[str] = []
    seen = SilentReporter(lambda words, share: told.append(words))
    monkeypatch.setattr(seen, "line", lines := Mock())
    tried = compare_masters(vary, own, tmp_path / "out", False, build_fmu, seen)
    names = list(dict.fromkeys(one.master for one in tried))
    assert names == (["jacobi", "newton", *own] if restorable else ["jacobi"])
    left = "left out: newton, which repeat steps; an FMU cannot restore its state"
    assert (left in [one.args[0] for one in lines.call_args_list]) is not restorable
    assert any(
        words.startswith("masters, jacobi at ") and words.endswith("monolithic reference") for words in told
    )
    assert {one.signals for one in tried} == {"quadratic"}  # the scenario's
    for name in names:
        errors = [one.error for one in tried if one.master == name]
        assert len(errors) == len(LONGER)
        assert all(
            math.isfinite(error) and error > 3.0 * finer for error, finer in itertools.pairwise(errors)
        )
    with (tmp_path / "out" / "masters.csv").open() as file:
        assert len(list(csv.reader(file))) == 1 + len(tried)
    assert (tmp_path / "out" / "masters.png").is_file()
    assert "masters.csv" in (tmp_path / "out" / "masters.html").read_text("utf-8")


def test_what_no_master_runs_is_said_once(tmp_path, monkeypatch):
    """A mistake in the scenario as by `run`; a failure of all runs is the command's."""
    file = tmp_path / "mine.toml"
    file.write_text('extends = "two-masses"\n[components.first.parameters]\nmass = -1\n')
    done = called("masters", str(file), "--out", str(tmp_path / "out"))
    assert done.returncode == 2
    assert said_by(done).startswith("tribocosim: mine.toml:3: components.first.parameters.mass = -1 kg")
    failing, silent = Mock(side_effect=RunError("first: is worn out")), SilentReporter()
    monkeypatch.setattr("orchestrator.study.masters.run_part", failing)
    with pytest.raises(RunError, match="no master runs two-masses; newton: first: is worn out"):
        compare_masters(vary, [], tmp_path / "out", False, build_fmu, silent)


def test_an_error_counts_with_the_uncertainty_of_the_reference_as_in_verdicts(tmp_path, monkeypatch):
    error = VariableError(8e-4, 8e-4, 8e-4, Difference(5e-4, 5e-4, 5e-4), tolerance=1e-3)
    made = Mock(errors={"first.position": error}, complete=True, do_steps=4, coupled_time_s=1.0)
    monkeypatch.setattr("orchestrator.study.masters.run_part", Mock(return_value=made))
    found = compare_masters(vary, [], tmp_path / "out", False, build_fmu, SilentReporter())
    assert [one.error for one in found] == pytest.approx([1.3] * len(found))


def test_an_interruption_in_a_run_of_a_master_ends_the_command(tmp_path, monkeypatch):
    began = Mock(side_effect=KeyboardInterrupt)
    monkeypatch.setattr("orchestrator.run.simulation.Session.begin", began)
    with pytest.raises(KeyboardInterrupt):
        compare_masters(vary, [], tmp_path / "out", False, build_fmu, SilentReporter())
    assert began.call_count == 1
    assert not (tmp_path / "out").exists()


def test_only_masters_that_the_fmus_can_take_are_ranked(monkeypatch):
    monkeypatch.setattr(FmuLimits, "restorable", False)
    table = tribocosim.analyse(tribocosim.load("two-masses").with_({"stop_time": 0.5}))
    assert set(table["master"].values) == {n for n, kind in MASTERS.items() if not kind.implicit}
    assert surveying.MASTERS is MASTERS


def test_the_verdict_on_masters_is_the_least_work_within_the_tolerance():
    """Without one it is the least error."""
    failed = Tried("newton", 1.0, message="no convergence")
    runs = [Tried("jacobi", 4.0, 1.2, "a.x", 50.0), Tried("jacobi", 2.0, 0.9, "a.x", 100.0), failed]
    more = [Tried("iterated", 4.0, 0.2, "a.x", 140.0)]
    assert judge([*runs, *more]).endswith("100: `--set master.name=jacobi --set macro_step='2 s'`")
    assert "no master keeps the tolerance" in judge([runs[0], failed])


def test_signals_that_were_not_tried_are_named_with_how_to_try_them():
    """Up to the degree that the participants follow."""
    runs = [Tried("jacobi", 1.0, 0.5, "a.x", 9.0, signals="quadratic")]
    assert _list_untried(runs, 3).endswith("`--set master.extrapolation=hermite` (or hold, linear)")
    assert "hermite" not in _list_untried(runs, 2)
