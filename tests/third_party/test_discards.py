"""A participant that discards long steps gets shorter ones by itself; the others keep the macro step."""

import os
import signal
from dataclasses import replace

import numpy as np
import pytest

from orchestrator.run.pipeline import resume, run
from orchestrator.scenario.files import load

from .c_fmus import fmu
from .models import MODELS
from .runs import CASES, Reporter, never, ran, recorded, scenario


class Heard(Reporter):
    def __init__(self):
        super().__init__()
        self.lines = []

    def line(self, text):
        self.lines.append(str(text))


@pytest.mark.parametrize(("version", "process"), CASES)
@pytest.mark.parametrize(
    ("name", "own"),
    [
        # Each of 50 steps is discarded after 2 ms, what is left of it again and again; the last is made.
        pytest.param("hasty", 1, id="that arrives somewhere"),
        # Each is halved twice, from the state that was saved.
        pytest.param("spoiling", 4, id="that spoils its state"),
    ],
)
def test_a_run_with_an_fmu_that_discards_long_steps_goes_to_its_end(name, own, version, process, tmp_path):
    tables = {
        "decay": {"participant": fmu(name, version, tmp_path), "process": process},
        "other": {"participant": fmu("dahlquist", version, tmp_path), "process": process},
    }
    one, out = scenario(tables, master={"name": "jacobi"}), tmp_path / "out"
    heard = Heard()
    summary = run(one, out, never, heard, figures=False)
    assert summary.complete, summary.message
    found = np.genfromtxt(out / "coupled.csv", delimiter=",", names=True)
    np.testing.assert_allclose(found["decayx"], np.exp(-found["time"]), rtol=1e-13)
    assert (len(found), summary.macro_steps) == (101, 100)
    spent = summary.effort["decay"], summary.effort["other"]
    assert [part.do_steps for part in spent] == [100, 100]
    assert (spent[0].own_steps - spent[0].failed, spent[1].own_steps) == (50 + 50 * own, 0)
    assert sum("decay discards a step: the run begins again" in line for line in heard.lines) == 1
    assert any(line.startswith("decay: discarded ") for line in map(str, summary.tell()))
    # What was chosen is kept: the run of the result's scenario is the same, at once.
    again = load(out / "scenario.toml")
    assert again.components["decay"].retries == 10
    heard.lines.clear()
    run(again, tmp_path / "again", never, heard, figures=False)
    assert not any("begins again" in line for line in heard.lines)
    assert (tmp_path / "again" / "coupled.csv").read_bytes() == (out / "coupled.csv").read_bytes()


def test_a_resumed_run_begins_again_too(tmp_path):
    """It was interrupted where its bar is shown first, after 64 of 200 steps."""
    tables, out = {"decay": {"participant": fmu("hasty", 2, tmp_path)}}, tmp_path / "out"
    one = scenario(tables, macro_step=5e-3, checkpoint_every=1e-9)

    def stop(words, share):
        if 0.3 < share < 0.4:
            os.kill(os.getpid(), signal.SIGINT)

    stopped = run(one, out, never, Reporter(tell=stop), figures=False)
    assert stopped.exit_status == 130
    heard = Heard()
    assert resume(out, never, heard, figures=False).complete
    assert sum("begins again" in line for line in heard.lines) == 1
    assert len(recorded(out)["time"]) == 201


def test_an_fmu_that_neither_saves_its_state_nor_tells_its_time_is_not_tried_again(tmp_path, monkeypatch):
    discarding = MODELS["discarding"]
    lost = replace(discarding, abilities="", step=f"m->reached = -1; {discarding.step}")
    monkeypatch.setitem(MODELS, "lost", lost)
    one, heard = scenario({"decay": {"participant": fmu("lost", 2, tmp_path)}}), Heard()
    summary = run(one, tmp_path / "out", never, heard, figures=False)
    assert (summary.exit_status, summary.discarding, summary.macro_steps) == (3, "", 50)
    assert "no shorter step can follow, as it neither saves its state nor tells" in str(summary.message)
    assert not any("begins again" in line for line in heard.lines)


@pytest.mark.parametrize("given", [{}, {"retries": 3}])
def test_an_fmu_that_does_not_come_back_goes_on_from_where_it_arrived(given, tmp_path):
    """It saves a part of its state only, which is told."""
    tables = {"one": {"participant": fmu("forgetful hasty", 2, tmp_path), **given}}
    summary, found = ran(scenario(tables, checkpoint_every=30), tmp_path / "out")
    np.testing.assert_allclose(found["one.passed"], found["time"], rtol=1e-13)
    assert summary.complete
    assert [line for line in summary.tell() if "does not come back to the state that it saved" in str(line)]


def test_zero_retries_are_none(tmp_path):
    tables = {"decay": {"participant": fmu("hasty", 2, tmp_path), "retries": 0}}
    summary, _ = ran(scenario(tables), tmp_path / "out")
    assert "step from t = 0.5 s by 0.01 s returned Discard" in str(summary.message)
    assert summary.discarding == "decay"
