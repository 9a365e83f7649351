"""What the libraries of FMUs print does not bury the lines of a command, and is not lost."""

import os
import sys
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from orchestrator.scenario.files import to_short_toml
from tribocosim.command_line.printed import redirect_descriptors

from ..archives import replace_text
from ..orchestrator.commands import called, tribocosim
from .c_fmus import fmu
from .runs import scenario

pytestmark = pytest.mark.skipif(os.name != "posix", reason="C libraries have descriptors of their own there")


def started(name: str, process: str, folder: Path, *more: str) -> CompletedProcess[str]:
    """The run of that FMU as a command, with the result in `folder`."""
    one = scenario({"decay": {"participant": fmu(name, 2, folder), "process": process}})
    file = folder / "one.toml"
    file.write_text(to_short_toml(one, folder), "utf-8")
    return tribocosim("run", str(file), "--out", str(folder / "out"), "--no-figures", *more)


@pytest.mark.parametrize("process", ["own", pytest.param("shared", marks=pytest.mark.long)])
def test_what_fmus_print_is_in_a_file_that_the_run_names(process: str, tmp_path: Path) -> None:
    done = started("printing", process, tmp_path)
    printed = (tmp_path / "out" / "printed.log").read_text("utf-8").splitlines()
    assert sorted(printed)[:2] == ["at 0", "at 0.01"]
    assert printed.count("of 0.01") > 50
    assert len(printed) == 200
    assert "200 lines that FMUs printed: " in done.stdout
    assert "at 0" not in done.stdout
    assert done.stderr == ""


@pytest.mark.parametrize("process", ["own", pytest.param("shared", marks=pytest.mark.long)])
def test_of_an_fmu_that_crashes_every_line_is_kept(process: str, tmp_path: Path) -> None:
    done = started("printing_crash", process, tmp_path)
    assert done.returncode not in (0, None)
    printed = (tmp_path / "out" / "printed.log").read_text("utf-8").splitlines()
    assert len(printed) == 51


def test_a_run_that_is_refused_shows_what_was_printed(tmp_path: Path) -> None:
    """Nothing is left of its folder; the analysis of it ends with the same status."""
    done = started("printing_first", "own", tmp_path)
    file, folder = str(tmp_path / "one.toml"), str(tmp_path / "survey")
    survey = tribocosim("analyse", file, "--set", "tolerance.decay.x=1e-3", "--out", folder)
    for one in (done, survey):
        assert one.returncode == 2
        assert "no licence" in one.stderr
    assert not (tmp_path / "out").exists()


def analysed(name: str, folder: Path) -> CompletedProcess[str]:
    """The analysis of a pair of that FMU and one of ours as a command, with an older log in its folder."""
    tables = {"mass": {"participant": fmu(name, 2, folder), "process": "own"}}
    tables["driven"] = {"component": "sprung_mass", "participant": "in-process"}
    one = scenario(
        tables, connections=["mass.position * 1 -> driven.force"], tolerance={"driven.position": 0.1},
        stop_time=0.2,
    )  # fmt: skip
    file = folder / "one.toml"
    file.write_text(to_short_toml(one, folder), "utf-8")
    (folder / "out").mkdir()
    (folder / "out" / "stability.log").write_text("old", "utf-8")
    return tribocosim("analyse", str(file), "--out", str(folder / "out"))


@pytest.mark.long
def test_what_fmus_print_in_an_analysis_is_in_a_file(tmp_path: Path) -> None:
    done = analysed("printing_mass", tmp_path)
    assert done.returncode == 0, done.stderr
    printed = (tmp_path / "out" / "stability.log").read_text("utf-8").splitlines()
    assert set(printed) == {"moving"}
    assert f"{len(printed)} lines that FMUs printed: " in done.stdout
    assert "moving" not in done.stdout + done.stderr


@pytest.mark.long
def test_an_analysis_that_fails_shows_what_was_printed(tmp_path: Path) -> None:
    done = analysed("printing_mass_first", tmp_path)
    assert done.returncode not in (0, None)
    assert "no licence" in done.stderr
    assert (tmp_path / "out" / "stability.log").read_text("utf-8") == "no licence\n"


@pytest.mark.long
def test_a_verbose_run_shows_it_where_it_falls(tmp_path: Path) -> None:
    done = started("printing", "shared", tmp_path, "--verbose")
    assert "at 0.01" in done.stdout
    assert not (tmp_path / "out" / "printed.log").exists()


def test_descriptors_and_streams_are_as_before_whatever_happens(tmp_path: Path) -> None:
    told: list[tuple[bytes, bool]] = []

    def tell(path: Path, printed: bytes, failed: bool) -> None:
        told.append((printed, failed))

    def print_and_fail() -> None:
        with redirect_descriptors(tmp_path / "file", tell):
            os.write(1, b"one\n")
            os.write(2, b"two\n")
            raise KeyError

    def find_descriptors() -> list[object]:
        return [*(os.fstat(number)[:2] for number in (1, 2)), sys.stdout, sys.stderr, *os.listdir("/dev/fd")]

    before = find_descriptors()
    with pytest.raises(KeyError):
        print_and_fail()
    with redirect_descriptors(tmp_path / "none", tell):
        pass
    assert told == [(b"one\ntwo\n", True)]
    assert not (tmp_path / "none").exists()
    assert find_descriptors() == before


def test_what_a_file_of_others_says_cannot_command_a_terminal(tmp_path: Path) -> None:
    """XML has control characters too: of C1, of the direction of writing."""
    bad = replace_text(
        fmu("dahlquist", 2, tmp_path),
        tmp_path / "bad.fmu",
        'name="x"',
        'name="x\u202e" description="\x9b31m"',
    )
    table = {"decay": {"participant": bad}}
    one = scenario(table, reference={"enabled": True}, tolerance={"decay.x\u202e": 1.0})
    (file := tmp_path / "one.toml").write_text(to_short_toml(one, tmp_path), "utf-8")
    for command in (
        ("fmu", "info", str(bad)),
        ("fmu", "validate", str(bad)),
        ("run", str(file), "--out", str(tmp_path / "out"), "--no-figures", "--verbose"),
    ):
        done = called(*command)
        assert done.returncode == 0, done.stderr
        shown = (done.stdout + done.stderr).replace("\n", "")
        assert shown.isprintable(), ascii(shown)
