"""The README and the documents: CI runs exactly the README's test command on an empty cache, all commands are
understood, and all linked pages exist."""

import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest
import typer

from orchestrator.scenario.files import list_shipped, load
from reproduction import SOURCES
from tribocosim.command_line import app

ROOT = Path(__file__).parent.parent
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


PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *ROOT.glob("fmus/*/README.md"), *DOCS.rglob("*.md")]


def list_anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as hosts of repositories make them."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", sorted(PAGES), ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_link_leads_somewhere(page: Path) -> None:
    for link, anchor in re.findall(r"\]\(([^)#\s]*)#?([^)]*)\)", page.read_text(encoding="utf-8")):
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
