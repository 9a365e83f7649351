"""The files around the code: hosted checks, hooks, citation, and the benchmarks' help."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


def read(name: str) -> dict:
    return yaml.safe_load((ROOT / name).read_text("utf-8"))


def list_commands(job: str, workflow: str = "ci") -> list[str]:
    """What the steps of a job of the hosted checks run, with each of its options in turn."""
    found = read(f".github/workflows/{workflow}.yml")["jobs"][job]
    options = found.get("strategy", {}).get("matrix", {}).get("option", [""])
    steps = [step["run"] for step in found["steps"] if "run" in step]
    return list(dict.fromkeys(s.replace("${{ matrix.option }}", o) for o in options for s in steps))


def test_the_hosted_checks_are_those_of_ci():
    assert list_commands("checks") == [".ci/run"]
    job = read(".github/workflows/ci.yml")["jobs"]["checks"]
    (python,) = (step["with"]["python-version"] for step in job["steps"] if "with" in step)
    assert PROJECT["requires-python"] == f">={python}"  # the oldest that is promised


def test_every_test_file_of_the_hosted_checks_exists():
    files = re.findall(r"tests/\S+\.py", " ".join(list_commands("versions")))
    assert files
    assert [file for file in files if not (ROOT / file).is_file()] == []


@pytest.mark.parametrize(
    ("workflow", "job", "extra"), [("nightly", "tests", "dev"), ("docs", "site", "docs")]
)
def test_other_hosted_jobs_install_from_the_lock_and_run_documented_commands(workflow, job, extra):
    install, *commands = list_commands(job, workflow)
    assert install.endswith(f"--constraint requirements.lock --editable '.[{extra}]'")
    assert commands
    table = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    assert [command for command in commands if f"| `.venv/bin/{command}` |" not in table] == []


def test_the_lock_holds_every_requirement_within_its_bounds():
    lines = (ROOT / "requirements.lock").read_text("utf-8").splitlines()
    held = [Requirement(line) for line in lines]
    extras = PROJECT["optional-dependencies"]
    for text in [
        *PROJECT["dependencies"],
        *extras["studies"],
        *extras["fit"],
        *extras["dev"],
        *extras["native"],
        *extras["docs"],
    ]:
        wanted = Requirement(text)
        found = [one for one in held if canonicalize_name(one.name) == canonicalize_name(wanted.name)]
        versions = [str(one.specifier).removeprefix("==") for one in found]
        assert wanted.name == PROJECT["name"] or versions, f"renew requirements.lock: {text} is not in it"
        assert all(wanted.specifier.contains(version) for version in versions), (
            f"renew requirements.lock: {text}"
        )


def test_the_hosted_check_of_javascript_is_the_documented_command():
    (command,) = list_commands("javascript")
    assert f"| `{command}` |" in (ROOT / "CONTRIBUTING.md").read_text("utf-8")


def test_the_citation_has_the_projects_name_version_and_licence():
    citation = read("CITATION.cff")
    assert [citation[key] for key in ("title", "version", "license")] == [
        PROJECT[key] for key in ("name", "version", "license")
    ]


def test_the_changelog_has_a_dated_section_of_the_version():
    sections = re.findall(r"^## (.+)$", (ROOT / "CHANGELOG.md").read_text("utf-8"), re.MULTILINE)
    assert sections[0] == "Unreleased"
    assert re.fullmatch(re.escape(PROJECT["version"]) + r" \(\d{4}-\d{2}-\d{2}\)", sections[1])


@pytest.mark.skipif(sys.platform == "win32", reason="needs a POSIX shell")
@pytest.mark.parametrize(("length", "status"), [(72, 0), (73, 1)])
def test_the_hook_measures_the_subject_of_a_commit(length, status, tmp_path):
    (repository,) = read(".pre-commit-config.yaml")["repos"]
    (entry,) = (hook["entry"] for hook in repository["hooks"] if hook["id"] == "subject")
    message = tmp_path / "message"
    message.write_text("s" * length + "\n\n" + "a longer line of the body " * 5)
    assert subprocess.run(["sh", "-c", f'{entry} "{message}"']).returncode == status


def test_the_other_hooks_are_checks_of_the_tests():
    from .__main__ import checks

    (repository,) = read(".pre-commit-config.yaml")["repos"]
    commands = {" ".join(command[1:]) for command in checks(False).values()} | {"--no-cache"}
    for hook in repository["hooks"]:
        if hook["id"] != "subject":
            words = hook["entry"].split()[1:]
            assert any(command.startswith(" ".join(words)) for command in commands), hook["id"]


def test_benchmarks_have_help_and_know_their_names():
    def run(*arguments):
        command = [sys.executable, "-m", "benchmarks", *arguments]
        return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)

    assert "heated_film" in run("--help").stdout
    wrong = run("no_such")
    assert wrong.returncode == 2
    assert "'no_such'" in wrong.stderr


def test_every_deliberate_error_can_be_made_and_has_its_test():
    from .mutants import mutants

    assert [fault for mutant in mutants() if (fault := mutant.fault(ROOT))] == []
