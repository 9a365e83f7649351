"""The Python interface: the same results as the command, nothing global, and its page runs."""

import json
import os
import re
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import tribocosim
from models.core.remedies import in_command_line

from .orchestrator.commands import called

SHORT = {"stop_time": "4 ms", "reference.enabled": False}
PAGE = Path(__file__).parents[1] / "docs" / "how-to" / "use-from-python.md"


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> tribocosim.Result:
    out = tmp_path_factory.mktemp("api") / "run"
    return tribocosim.run(tribocosim.load("two-masses"), out)


def test_a_run_is_within_its_tolerance_and_opened_again(result: tribocosim.Result) -> None:
    assert result.within
    assert result.verdict == result.summary["verdict"]
    assert result.errors.keys() == result.summary["errors"].keys()
    assert result.reference is not None
    assert result.coupled.sizes["time"] == result.reference.sizes["time"]
    assert result.folder is not None
    again = tribocosim.open(result.folder)
    assert again.coupled.identical(result.coupled)
    assert again.summary == result.summary


def test_a_plan_is_run_and_stepped_as_often_as_wanted_with_the_same_bits() -> None:
    scenario = tribocosim.load("two-masses").with_({"stop_time": "50 ms", "reference.enabled": False})
    plan, single = tribocosim.plan(scenario), tribocosim.run(scenario)
    with pytest.raises(tribocosim.MistakeError, match=r"^two-masses: no contact takes its sliding_velocity"):
        single.friction()
    for _ in range(2):
        assert tribocosim.execute(plan).coupled.identical(single.coupled)
        with tribocosim.session(plan) as session:
            session.step_until(session.stop_time)
            assert session["second.position"] == float(single.coupled["second.position"][-1])


@pytest.mark.long
def test_friction_is_that_of_the_command(tmp_path: Path) -> None:
    turn = tribocosim.load("valve-train").with_({"stop_time": "1 revolution", "reference.enabled": False})
    out, file = tmp_path / "run", tmp_path / "friction.nc"
    found = tribocosim.run(turn, out).friction()
    assert called("friction", str(out), "--table", str(file)).returncode == 0
    with xarray.open_dataset(file, engine="h5netcdf") as written:
        assert written.load().equals(found)
    with pytest.raises(tribocosim.MistakeError, match="did you mean contact"):
        tribocosim.open(out).friction("contct")


def test_it_has_the_bits_of_the_command(tmp_path: Path) -> None:
    """And leaves no folder behind, nor another working directory."""
    before, files = os.getcwd(), set(tmp_path.iterdir())
    own = tribocosim.run(tribocosim.load("valve-train").with_(SHORT))
    assert own.folder is None
    assert (os.getcwd(), set(tmp_path.iterdir())) == (before, files)
    out = tmp_path / "command"
    settings = ("--set", "stop_time=4 ms", "--set", "reference.enabled=false", "--no-figures")
    assert called("run", "valve-train", *settings, "--out", str(out)).returncode == 0
    assert own.coupled.identical(tribocosim.open(out).coupled)
    assert own.verdict.endswith("the run is shorter than a revolution of its cam: no cycle was seen")


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


def test_a_misspelt_name_gets_a_suggestion() -> None:
    with pytest.raises(AttributeError, match="did you mean analyse"):
        tribocosim.analyze  # noqa: B018


api: Any = tribocosim
MISUSES: dict[str, tuple[Callable[[], object], str]] = {
    "progress": (
        lambda: api.run("quarter-car", progress="x"),
        "progress = 'x': must be a function of a stage",
    ),
    "one argument": (
        lambda: api.run("quarter-car", progress=lambda stage: None),
        "progress = .*stage and a share",
    ),
    "switch": (lambda: api.run("quarter-car", overwrite="no"), "overwrite = 'no': must be True or False"),
    "no plan": (lambda: api.execute("quarter-car"), "plan = 'quarter-car': must be a Plan"),
    "folder": (lambda: api.run("quarter-car", ""), "out = '': must not be empty"),
    "a word for a list": (
        lambda: api.calibrate("quarter-car", "a.csv", "mass"),
        "parameters = 'mass': must be a l",
    ),
    "instants": (lambda: api.analyse("quarter-car", at=[1e-3]), r"at = \[0\.001\]: must be a list, each"),
    "no unit": (lambda: api.speeds("valve-train", 1000), "low = 1000: must be a text; e.g. '500 rpm'"),
    "workers": (lambda: api.speeds("valve-train", workers=0), "workers=0: must be 1 or more"),
    "size": (lambda: api.build_fmu("valve_spring", structure={"coil_masses": 2.5}), "each a whole number"),
    "path": (lambda: api.load("quarter-car").with_({3: 1}), "changes: must be a dictionary of paths"),
}


@pytest.mark.parametrize("misuse", MISUSES)
def test_an_argument_of_another_kind_is_refused_by_name(misuse: str) -> None:
    """Before anything is computed; not by an error from inside."""
    call, said = MISUSES[misuse]
    with pytest.raises(tribocosim.MistakeError, match=said):
        call()


def test_native_takes_machine_code_for_our_fmus_only() -> None:
    scenario = tribocosim.load("two-masses")
    scenario = scenario.with_({"components.second.participant": "in-process"})
    tables = scenario.native().check().components
    assert {name: table.participant for name, table in tables.items()} == {
        "first": "native",
        "second": "in-process",
    }


def test_changes_leave_the_scenario_as_it_is() -> None:
    plain = tribocosim.load("valve-train")
    changed = plain.with_({"components.camshaft.parameters.lift": "9 mm"})
    assert changed.check().components["camshaft"].parameters["lift"] == 9e-3
    assert plain.check().components["camshaft"].parameters.get("lift") != 9e-3
    assert plain.with_(**{"components.camshaft.parameters.lift": "9 mm"}) == changed
    assert tribocosim.load(plain.content).check() == plain.check()


def test_a_run_that_fails_keeps_what_it_computed(tmp_path: Path) -> None:
    master = {"name": "jacobi", "extrapolation": "hermite"}
    steps = {"macro_step": "100 ms", "output_step": "100 ms"}
    unstable = tribocosim.load("quarter-car").with_({**steps, "master": master})
    with pytest.raises(tribocosim.RunError, match="unstable coupling") as error:
        tribocosim.run(unstable, tmp_path / "run")
    assert "; halve them with with_({'macro_step': '0.05 s'}), let " in str(error.value)
    assert " with with_({'master.name': 'auto'}), use " in str(error.value)
    assert "--set 'macro_step=0.05 s'" in in_command_line(error.value.words)
    assert np.all(np.isfinite(tribocosim.open(tmp_path / "run").coupled["chassis.position"]))


def test_a_figure_has_the_variables_and_names_those_that_there_are_not(result: tribocosim.Result) -> None:
    name = next(iter(result.errors))
    figure = result.plot(name)
    labels = [line.get_label() for line in figure.axes[0].lines]
    assert labels == ["coupled", "reference"]
    assert figure._repr_png_().startswith(b"\x89PNG")  # shown by a notebook
    assert figure.axes[-1].get_xlabel() == "time (s)"
    against = result.plot(name, over=name).axes[0]
    assert against.get_xlabel() == against.get_ylabel().replace("\n", " ")
    with pytest.raises(tribocosim.MistakeError, match="over = 'angle': must be one of time"):
        result.plot(name, over="angle")  # nothing turns
    for wrong, message in (
        ("nothing", "nothing: must be one of"),
        ("first.positon", r"mean first\.position\?"),
    ):
        with pytest.raises(tribocosim.MistakeError, match=message):
            result.plot(wrong)


def test_a_run_that_ended_is_not_resumed_but_opened(result: tribocosim.Result, tmp_path: Path) -> None:
    assert result.folder is not None
    assert tribocosim.resume(result.folder).summary == result.summary
    empty = tmp_path / "empty"  # with no neighbour to suggest
    empty.mkdir()
    with pytest.raises(tribocosim.MistakeError, match=r"holds no run .*; make one with tribocosim\.run\(\)$"):
        tribocosim.resume(empty)


def test_a_page_and_a_diagnosis_are_those_of_the_commands(result: tribocosim.Result, tmp_path: Path) -> None:
    assert result.folder is not None
    page = tribocosim.report(result.folder)
    assert page == result.folder / "report.html"
    assert tribocosim.report(result.folder, tmp_path / "page.html").read_bytes() == page.read_bytes()
    lines = called("diagnose", str(result.folder)).stdout.split()
    assert " ".join(result.diagnose()).split() == lines


def test_a_cam_has_the_results_of_the_command(tmp_path: Path) -> None:
    """Of a law, and of a scenario's component; its contour is written where a folder is given."""
    law = tribocosim.cam("cycloidal", {"base_radius": "30 mm"}, out=tmp_path / "cam")
    assert float(law["largest_lift"]) == pytest.approx(8e-3, rel=1e-9)
    made = {path.suffix for path in (tmp_path / "cam").iterdir()}
    assert made == {".nc", ".csv", ".png", ".svg", ".dxf", ".s96"}
    own = tribocosim.cam("valve-train")
    assert float(own["largest_lift"]) == pytest.approx(8e-3, rel=1e-9)


def test_importing_it_loads_little_and_switches_nothing() -> None:
    code = "import sys, tribocosim; print('matplotlib' in sys.modules, 'numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]


@pytest.mark.long
def test_the_page_runs(tmp_path: Path) -> None:
    code = "\n".join(re.findall(r"```python\n(.+?)```", PAGE.read_text("utf-8"), re.DOTALL))
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "within the tolerance" in done.stdout
    assert (tmp_path / "load.png").stat().st_size > 10_000


def test_progress_is_told_by_stages_and_may_end_the_run() -> None:
    told: list[tuple[str, float]] = []
    scenario = tribocosim.load("two-masses")
    tribocosim.run(scenario, progress=lambda stage, share: told.append((stage, share)))
    stages = list(dict.fromkeys(stage for stage, _ in told))
    assert any("coupled run" in stage for stage in stages)
    for stage in stages:
        shares = [share for name, share in told if name == stage]
        assert shares == sorted(shares)
        assert (shares[0], shares[-1]) == (0.0, 1.0)

    def stop(stage: str, share: float) -> None:
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        tribocosim.run(scenario, progress=stop)


def test_an_analysis_has_the_table_of_the_command(tmp_path: Path) -> None:
    assert called("analyse", "cam", "--set", "lift=9 mm", "--out", str(tmp_path)).returncode == 0
    with xarray.open_dataset(tmp_path / "cam.nc", engine="h5netcdf") as written:
        assert written.equals(tribocosim.analyse("cam", {"lift": "9 mm"}))


@pytest.mark.long
def test_a_survey_has_the_table_of_the_command(tmp_path: Path) -> None:
    """Written and printed."""
    done = called("analyse", "two-masses", "--out", str(tmp_path), "--json")
    assert done.returncode == 0, done.stderr
    found = tribocosim.analyse(tribocosim.load("two-masses"))["largest_stable_step"]
    with xarray.open_dataset(tmp_path / "stability.nc", engine="h5netcdf") as written:
        np.testing.assert_array_equal(written["largest_stable_step"], found)
    printed = xarray.Dataset.from_dict(json.loads(done.stdout))
    np.testing.assert_array_equal(printed["largest_stable_step"], found)


@pytest.mark.long
def test_a_script_without_a_guard_makes_a_study(tmp_path: Path) -> None:
    """Its workers do not run the script anew."""
    script = tmp_path / "script.py"
    script.write_text(
        "import tribocosim\n"
        "scenario = tribocosim.load('two-masses').with_({'stop_time': 0.2, 'reference.enabled': False})\n"
        "points = {'kind': 'grid', 'axes': {'macro_step': [1e-3, 2e-3]}}\n"
        "print(tribocosim.study({'points': points}, scenario, workers=2).status.values, __file__)\n"
    )
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == (f"[1 1] {script}\n", "")


@pytest.mark.long
def test_a_sweep_over_speed_has_the_cycles_of_the_command(tmp_path: Path) -> None:
    ends = ("--from", "1000 rpm", "--to", "2000 rpm", "--count", "2")
    assert called("speeds", "my-cam", *ends, "--out", str(tmp_path / "out")).returncode == 0
    table = tribocosim.speeds("my-cam", "1000 rpm", "2000 rpm", 2, workers=1)
    with xarray.open_zarr(tmp_path / "out" / "speeds.zarr") as written:
        np.testing.assert_array_equal(written["contact.least_load"], table["contact.least_load"])
    assert "contact is" in table.attrs["separation"]
