"""The README's commands: CI runs exactly the test command, others are understood; linked pages exist."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
import typer

from orchestrator.command_line import app
from orchestrator.scenario_files import load
from reproduction import SOURCES

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = list(dict.fromkeys(re.findall(r"\.venv/bin/tribocosim (.+?)[`\n]", README)))


def test_ci_runs_exactly_the_readmes_test_command():
    commands = re.findall(r"```sh\n(.+?)\n```", README, re.DOTALL)
    (test_command,) = [line for line in commands if "-m tests" in line]
    lines = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    assert lines[-1] == test_command


def test_every_link_leads_somewhere():
    links = re.findall(r"\]\(([^)#]+)\)", README)
    assert links
    for link in links:
        assert (ROOT / link).exists(), link


def test_every_published_source_has_its_command() -> None:
    assert sorted(re.findall(r"python -m reproduction (\w+)`", README)) == sorted(SOURCES)


@pytest.mark.parametrize("line", COMMANDS)
def test_every_command_is_understood(line: str) -> None:
    """Its options are known, and a scenario loads with its changes."""
    command, words = typer.main.get_command(app), shlex.split(line)
    context = command.make_context("tribocosim", words[:], resilient_parsing=True)
    while hasattr(command, "resolve_command"):
        name, command, words = command.resolve_command(context, words)
        assert command is not None
        context = command.make_context(name, words[:], parent=context, resilient_parsing=not words)
    if name == "run":
        load(context.params["scenario"], context.params["set_"] or [])
