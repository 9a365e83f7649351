"""A result that is to be overwritten stays until the run that replaces it has begun."""

import shutil
from pathlib import Path

import pytest

from orchestrator.errors import MistakeError
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.run.simulation import Run
from orchestrator.run.summary import Summary
from orchestrator.scenario import Scenario
from orchestrator.store.output_folder import find_run_state

from ..archives import repack
from ..orchestrator.studies import read_files
from .c_fmus import fmu
from .runs import never, scenario


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """A folder with a result, and figures as a run leaves them."""
    folder = tmp_path_factory.mktemp("result")
    again(of(fmu("dahlquist", 2, folder), "shared"), folder / "out")
    (folder / "out" / "figures").mkdir()
    (folder / "out" / "figures" / "one.png").write_bytes(b"a figure")
    (folder / "out" / "notes.txt").write_text("mine")
    return folder / "out"


@pytest.fixture
def out(result, tmp_path):
    """A copy of it."""
    return Path(shutil.copytree(result, tmp_path / "out"))


def of(path: Path, process: str = "own") -> Scenario:
    return scenario({"one": {"participant": path, "process": process}}, master={"name": "jacobi"})


def again(one: Scenario, out: Path) -> Summary:
    return run(one, out, never, Reporter(), overwrite=True, figures=False)


def test_a_run_that_does_not_begin_leaves_it(out, tmp_path):
    """Of a library that crashes before the first values, and of a scenario that is refused."""
    before = read_files(out)
    with pytest.raises(
        MistakeError, match="its process ended by SIGSEGV in the reading of outputs"
    ) as refused:
        again(of(fmu("blind", 2, tmp_path)), out)
    assert str(refused.value).endswith(f"; the run did not begin, and what was in {out} before is kept")
    rigid = {"participant": fmu("rigid", 2, tmp_path)}
    with pytest.raises(MistakeError, match="canGetAndSetFMUstate"):
        again(scenario({"one": rigid}, master={"name": "iterated"}), out)
    assert read_files(out) == before


def test_one_that_is_stopped_before_the_first_values_leaves_it(out, tmp_path, monkeypatch, capsys):
    """No result of it is told of, since there is none; the status is that of a stopped run."""
    before = read_files(out)
    capsys.readouterr()

    def stopped(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(Run, "make", stopped)
    summary = again(of(fmu("dahlquist", 2, tmp_path)), out)
    assert summary.exit_status == 130
    assert summary.message.endswith(f"; the run did not begin, and what was in {out} before is kept")
    assert "result" not in capsys.readouterr().out
    assert read_files(out) == before


def test_a_library_that_cannot_be_loaded_leaves_it(out, tmp_path, monkeypatch):
    """In this process too: fmpy stays in the folder of a library that it could not load."""
    before = read_files(out)
    monkeypatch.chdir(tmp_path)

    def damage(name, content):
        return {name: b"no library" if name.startswith("binaries/") else content}

    other = repack(fmu("dahlquist", 2, tmp_path), tmp_path / "other.fmu", damage)
    with pytest.raises(MistakeError, match="load shared library"):
        again(of(other, "shared"), Path("out"))
    assert Path.cwd() == tmp_path
    assert read_files(out) == before


def test_a_run_that_fails_later_replaces_it(out, tmp_path):
    before = read_files(out)
    summary = again(of(fmu("erring", 2, tmp_path)), out)
    assert summary.exit_status == 3
    after = read_files(out)
    assert set(after) == {*before} - {"figures/one.png"}
    assert after["result.nc"] != before["result.nc"]
    assert after["notes.txt"] == b"mine"


def test_an_unfinished_run_stays_too(out, tmp_path):
    find_run_state(out).mkdir()
    (find_run_state(out) / "coupled.journal").write_bytes(b"rows")
    before = read_files(out)
    with pytest.raises(MistakeError):
        again(of(fmu("blind", 2, tmp_path)), out)
    assert read_files(out).keys() - before.keys() <= {"unfinished/lock"}
    assert read_files(out) | before == read_files(out)


def test_what_a_killed_process_had_put_aside_is_what_stays(out, tmp_path):
    """It was killed before its run began."""
    before = read_files(out)
    for name in ("summary.json", "result.nc", "coupled.csv", "scenario.toml"):
        (out / "replaced").mkdir(exist_ok=True)
        (out / name).rename(out / "replaced" / name)
    (out / "summary.json").write_text("{}")
    with pytest.raises(MistakeError):
        again(of(fmu("blind", 2, tmp_path)), out)
    assert read_files(out) == before
