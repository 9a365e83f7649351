"""The Python interface: the same results as the command, nothing global, and its page runs."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import tribocosim

from .orchestrator.commands import called

SHORT = {"stop_time": "4 ms", "reference.enabled": False}
PAGE = Path(__file__).parents[1] / "docs" / "how-to" / "use-from-python.md"


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> tribocosim.Result:
    out = tmp_path_factory.mktemp("api") / "run"
    return tribocosim.run(tribocosim.load("two-masses"), out)


def test_a_run_is_within_its_tolerance_and_says_so(result: tribocosim.Result) -> None:
    assert result.within
    assert result.verdict == result.summary["verdict"]
    assert result.errors.keys() == result.summary["errors"].keys()
    assert result.reference is not None
    assert result.coupled.sizes["time"] == result.reference.sizes["time"]
    assert {"units", "long_name"} <= next(iter(result.coupled.data_vars.values())).attrs.keys()


def test_a_folder_is_opened_again(result: tribocosim.Result) -> None:
    assert result.folder is not None
    again = tribocosim.open(result.folder)
    assert again.coupled.identical(result.coupled)
    assert again.summary == result.summary


def test_it_has_the_bits_of_the_command(tmp_path: Path) -> None:
    """And leaves no folder behind, nor another working directory."""
    before, files = os.getcwd(), set(tmp_path.iterdir())
    own = tribocosim.run(tribocosim.load("valve-train").with_(SHORT))
    assert own.folder is None
    assert (os.getcwd(), set(tmp_path.iterdir())) == (before, files)
    out = tmp_path / "command"
    settings = ("--set", "stop_time=4 ms", "--set", "reference.enabled=false", "--no-figures")
    assert called("run", "valve-train", *settings, "--out", str(out)).returncode == 4
    assert own.coupled.identical(tribocosim.open(out).coupled)


def test_runs_in_threads_have_the_bits_of_runs_in_turn() -> None:
    scenarios = [
        tribocosim.load("two-masses").with_({"stop_time": 0.5, "reference.enabled": False, "macro_step": h})
        for h in (1e-3, 5e-4)
    ]
    found: dict[int, tribocosim.Result] = {}
    threads = [
        threading.Thread(target=lambda i=i, s=s: found.update({i: tribocosim.run(s)}))
        for i, s in enumerate(scenarios)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for i, scenario in enumerate(scenarios):
        assert found[i].coupled.identical(tribocosim.run(scenario).coupled)


def test_changes_leave_the_scenario_as_it_is() -> None:
    plain = tribocosim.load("valve-train")
    changed = plain.with_({"components.camshaft.parameters.lift": "9 mm"})
    assert changed.check().components["camshaft"].parameters["lift"] == 9e-3
    assert plain.check().components["camshaft"].parameters.get("lift") != 9e-3
    assert tribocosim.load(plain.content).check() == plain.check()


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("components.camshaft.parameters.lif", "9 mm", "did you mean lift"),
        ("components.camshft.parameters.lift", "9 mm", "did you mean camshaft"),
        ("macro_step", "-1 s", "macro_step"),
    ],
)
def test_mistakes_are_named(path: str, value: str, message: str) -> None:
    with pytest.raises(tribocosim.MistakeError, match=message):
        tribocosim.load("valve-train").with_({path: value})


def test_a_run_that_fails_keeps_what_it_computed(tmp_path: Path) -> None:
    unstable = tribocosim.load("pushrod-train").with_({"macro_step": "20 us", **SHORT})
    with pytest.raises(tribocosim.RunError, match="unstable coupling"):
        tribocosim.run(unstable, tmp_path / "run")
    assert np.all(np.isfinite(tribocosim.open(tmp_path / "run").coupled["cam_contact.load"]))


def test_a_figure_has_the_variables_and_names_those_that_there_are_not(result: tribocosim.Result) -> None:
    name = next(iter(result.errors))
    figure = result.plot(name)
    labels = [line.get_label() for line in figure.axes[0].lines]
    assert labels == ["coupled", "reference"]
    with pytest.raises(tribocosim.MistakeError, match="no variable"):
        result.plot("nothing")


def test_importing_it_loads_little_and_switches_nothing() -> None:
    code = "import sys, tribocosim; print('matplotlib' in sys.modules, 'numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]


def test_the_page_runs(tmp_path: Path) -> None:
    code = "\n".join(re.findall(r"```python\n(.+?)```", PAGE.read_text("utf-8"), re.DOTALL))
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "within the tolerance" in done.stdout
    assert (tmp_path / "load.png").stat().st_size > 10_000


@pytest.mark.parametrize("name", ["valve-train", "valve-train-controlled"])
def test_a_session_makes_the_steps_of_the_run_to_the_bit(name: str) -> None:
    """Also after going back to a snapshot, and to the start."""
    scenario = tribocosim.load(name).with_(SHORT)
    run = tribocosim.run(scenario).coupled
    loads = dict(zip(run["time"].values.tolist(), run["contact.load"].values.tolist(), strict=True))

    def follow(session: tribocosim.session, until: float) -> int:
        seen = 0
        while session.time < until:
            session.step()
            if session.time in loads:
                assert session["contact.load"] == loads[session.time]
                seen += 1
        return seen

    with tribocosim.session(scenario) as session:
        follow(session, 1e-3)
        snapshot = session.save()
        assert follow(session, 4e-3) > 10
        session.restore(snapshot)
        assert session.time == snapshot.time
        assert follow(session, 4e-3) > 10
        session.reset()
        assert follow(session, 4e-3) > 10
        with pytest.raises(tribocosim.MistakeError, match="stop_time"):
            session.step()


def test_a_session_names_outputs_that_there_are_not() -> None:
    with (
        tribocosim.session(tribocosim.load("two-masses")) as session,
        pytest.raises(tribocosim.MistakeError, match="must be one of"),
    ):
        session["nothing"]
