"""The documents: CI runs the README's test command; commands are understood, links lead somewhere."""

import contextlib
import csv
import importlib.util
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import typer
import typer.testing

import tribocosim
import tribocosim.errors
from orchestrator.scenario.files import list_shipped, load
from reproduction import SOURCES
from tribocosim.command_line import app

from .orchestrator.commands import called

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
DOCS = ROOT / "docs"
INDEX = (DOCS / "README.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"\.venv/bin/tribocosim (.+?)\n", README) + re.findall(r"`tribocosim (.+?)`", INDEX)
for page in sorted(DOCS.rglob("*.md")):
    for block in re.findall(r"^```sh\n(.+?)^```", page.read_text("utf-8"), re.DOTALL | re.MULTILINE):
        COMMANDS += re.findall(r"^tribocosim (.+?)\s*(?:[>#].*)?$", block, re.MULTILINE)


def test_ci_runs_exactly_the_readmes_test_command():
    commands = re.findall(r"```sh\n(.+?)\n```", README, re.DOTALL)
    (test_command,) = [line for line in commands if "-m tests" in line]
    lines = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    assert lines[-1] == test_command


@pytest.mark.skipif(os.name != "posix", reason="needs a POSIX shell")
def test_ci_begins_with_an_empty_cache_and_leaves_nothing(tmp_path: Path) -> None:
    """With a `python3` that writes down the cache folder and fails, so that nothing is installed."""
    folder = tmp_path / "checkout" / ".ci"
    folder.mkdir(parents=True)
    shutil.copy(ROOT / ".ci" / "run", folder)
    python = tmp_path / "python3"
    python.write_text(
        f'#!/bin/sh\nls -a "$TRIBOCOSIM_CACHE" > {tmp_path}/content; pwd > {tmp_path}/place\nexit 7'
    )
    python.chmod(0o700)
    (tmp_path / "temporary").mkdir()
    variables = {"PATH": f"{tmp_path}:{os.environ['PATH']}", "TMPDIR": str(tmp_path / "temporary")}
    done = subprocess.run([folder / "run"], env=os.environ | {"TRIBOCOSIM_CACHE": str(ROOT)} | variables)
    assert done.returncode == 7
    assert (tmp_path / "content").read_text().split() == [".", ".."]
    assert (tmp_path / "place").read_text().strip() == str(folder.parent)
    assert list((tmp_path / "temporary").iterdir()) == []


PAGES = sorted([*ROOT.glob("*.md"), *DOCS.rglob("*.md"), *ROOT.glob("fmus/*/README.md")])


def list_anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as hosts of repositories make them."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_link_leads_somewhere(page: Path) -> None:
    """Addresses are well formed, without network: https, a host with a dot, no spaces."""
    whole = page.read_text("utf-8")
    addresses = re.findall(r"\]\((\w+://[^)]*)\)", whole) + re.findall(r"<(\w+://[^>]*)>", whole)
    wrong = [a for a in addresses if not re.fullmatch(r"https://[\w-]+(\.[\w-]+)+(/[^\s<>\"]*)?", a)]
    assert wrong == []
    text = re.sub(r"^ *```.+?^ *```", "", whole, flags=re.DOTALL | re.MULTILINE)
    for link, anchor in re.findall(r"\]\(([^)#\s]*)#?([^)]*)\)", text):
        target = page.parent / link if link else page
        if "://" not in link:
            assert target.exists(), link
            assert not anchor or anchor in list_anchors(target), f"{link}#{anchor}"


def test_the_index_lists_every_page() -> None:
    linked = {link.partition("#")[0] for link in re.findall(r"\]\(([^)]+)\)", INDEX)}
    pages = {page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md")} - {"README.md"}
    assert sorted(pages - linked) == []


def test_every_published_source_has_its_command() -> None:
    assert sorted(re.findall(r"python -m reproduction (\w+)`", INDEX)) == sorted(SOURCES)


@pytest.mark.parametrize("line", dict.fromkeys(COMMANDS))
def test_every_command_is_understood(line: str) -> None:
    """Its options are known, and a shipped scenario loads with its changes; NAME stands for any name."""
    command, words = typer.main.get_command(app), shlex.split(line)
    context = command.make_context("tribocosim", words[:], resilient_parsing=True)
    while hasattr(command, "resolve_command"):
        name, command, words = command.resolve_command(context, words)
        assert command is not None
        context = command.make_context(name, words[:], parent=context, resilient_parsing=not words)
    if name == "run" and "NAME" not in line and context.params["scenario"] in list_shipped():
        load(context.params["scenario"], context.params["set_"] or [])


def test_the_guide_to_fits_finds_the_leak_gap(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By its command, word for word: the record was computed for a gap of 6.4 um."""
    (line,) = [line for line in COMMANDS if line.startswith("calibrate leak-down")]
    (tmp_path / "orchestrator").symlink_to(ROOT / "orchestrator")
    monkeypatch.chdir(tmp_path)
    done = typer.testing.CliRunner().invoke(app, shlex.split(line))
    assert done.exit_code == 0, done.output
    (file,) = tmp_path.glob("results/**/calibration.csv")
    (row,) = csv.DictReader(file.read_text("utf-8").splitlines())
    assert float(row["low"]) < 6.4e-6 < float(row["high"])
    assert float(row["high"]) - float(row["low"]) < 1e-8
    guide = (DOCS / "how-to" / "fit-to-measurements.md").read_text("utf-8")
    said = f"{1e6 * float(row['fitted']):.5g} um with an interval from {1e6 * float(row['low']):.4g} to"
    assert said in " ".join(guide.split())


def test_every_name_of_the_interface_is_on_its_page() -> None:
    page = (DOCS / "reference" / "python.md").read_text("utf-8")
    named = set(re.findall(r"auto(?:function|class):: (?:\w+\.)*(\w+)", page))
    assert {name.lower() for name in named} == {
        *(name.lower() for name in tribocosim.__all__ if name not in tribocosim.errors.__all__)
    }


def test_every_module_on_the_page_of_models_is_found() -> None:
    page = (DOCS / "reference" / "models.md").read_text("utf-8")
    modules = re.findall(r"automodule:: (\S+)", page)
    assert len(modules) > 10
    assert [name for name in modules if importlib.util.find_spec(name) is None] == []


@pytest.mark.long
def test_the_site_is_built_without_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("sphinx", reason="needs the extra docs")
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    built = subprocess.run(
        [sys.executable, "-m", "docs", str(tmp_path / "site")],
        cwd=ROOT, env=environment, capture_output=True, text=True, timeout=1500,
    )  # fmt: skip
    assert built.returncode == 0, built.stderr[-4000:]
    site = tmp_path / "site"
    assert (site / "index.html").is_file()
    for page in PAGES:
        assert (site / page.relative_to(ROOT).with_suffix(".html")).is_file(), page
    assert 'id="tribocosim.load"' in (site / "docs" / "reference" / "python.html").read_text("utf-8")
    for page in site.rglob("*.html"):
        loaded = re.findall(
            r"<(?:script|link|img)[^>]* (?:src|href)=\"(\w+:[^\"]+)\"", page.read_text("utf-8")
        )
        assert loaded == [], page  # nothing from the network


FOLDER = ROOT / "docs" / "tutorials"
TUTORIALS = [page for page in sorted(FOLDER.glob("*.md")) if "import tribocosim" in page.read_text("utf-8")]


def read_cells(page: Path) -> str:
    """All cells as one program."""
    return "\n".join(re.findall(r"^```python\n(.+?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL))


def list_expected(code: str) -> list[str]:
    """Comments behind a print, or below a loop of them."""
    return re.findall(r"^(?: *print\(.*\)  |)# (.+)$", code, re.MULTILINE)


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_every_print_has_its_result(page: Path) -> None:
    code = read_cells(page)
    compile(code, page.name, "exec")
    loops = len(re.findall(r"^for .+:\n    print\(.*\)\n# ", code, re.MULTILINE))
    alone = re.findall(r"^(?:    )?print\(.*\)  # .+$", code, re.MULTILINE)
    assert len(re.findall(r"^ *print\(", code, re.MULTILINE)) == loops + len(alone) > 0


@pytest.mark.long
@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_every_tutorial_prints_what_it_says(page: Path, tmp_path: Path) -> None:
    code = read_cells(page)
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True, text=True, timeout=1500,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-4000:]
    assert done.stdout.splitlines() == list_expected(code)


# Their Python is executed, and its results looked at, by the tests of what they show.
ELSEWHERE = ("exchange-ssp", "extending", "multibody", "use-from-python", "write-a-component")
GUIDES = [
    pytest.param(page, id=page.stem, marks=[] if page.stem == "run-a-study" else pytest.mark.long)
    for page in sorted([*(DOCS / "how-to").glob("*.md"), *(DOCS / "theory").glob("*.md")])
    if "```python" in page.read_text("utf-8") and page.stem not in ELSEWHERE
]


@pytest.mark.parametrize("page", GUIDES)
def test_the_python_of_a_guide_runs(page: Path, tmp_path: Path) -> None:
    """After its study, if it has one."""
    if study := re.search(r"```toml\n(analysis = .+?)```", page.read_text("utf-8"), re.DOTALL):
        (tmp_path / "map.toml").write_text(study[1], "utf-8")
        made = called("study", "map.toml", cwd=tmp_path)
        assert made.returncode == 0, made.stderr
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", read_cells(page)]
    done = subprocess.run(command, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 0, done.stderr[-4000:]


FAQ = (DOCS / "faq.md").read_text("utf-8")
ANSWERS = dict(re.findall(r"^\*\*(.+?)\*\*(.+?)(?=^\*\*|^## |\Z)", FAQ, re.DOTALL | re.MULTILINE))
# Words of the questions whose answers take a second; others build FMUs, or run for longer.
FAST = ("couple two", "repeat a step", "late by one step", "write my own", "each time")
CASES = [
    pytest.param(answer, id=question, marks=[] if any(w in question for w in FAST) else pytest.mark.long)
    for question, answer in ANSWERS.items()
]


def test_questions_are_found() -> None:
    assert len(ANSWERS) == FAQ.count("\n**") >= 20
    assert sum(not case.marks for case in CASES) == len(FAST)


@pytest.mark.parametrize("answer", CASES)
def test_an_answer_does_what_it_says(answer: str, tmp_path: Path) -> None:
    blocks = re.findall(r"^```(sh|python)\n(.+?)^```", answer, re.DOTALL | re.MULTILINE)
    assert blocks
    for kind, block in blocks:
        if kind == "python":
            with contextlib.chdir(tmp_path):
                exec(compile(block, "faq.md", "exec"), {"__name__": "faq"})
            continue
        for line in block.splitlines():
            done = called(*shlex.split(line, comments=True)[1:], cwd=tmp_path)
            assert done.returncode == 0, f"{line}\n{done.stdout[-2000:]}{done.stderr}"
