"""The site of the documentation: built whole, with all of the interface; tutorials print what they say."""

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

import tribocosim
import tribocosim.errors

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = sorted([*ROOT.glob("*.md"), *DOCS.rglob("*.md"), *ROOT.glob("fmus/*/README.md")])


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


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_addresses_are_well_formed(page: Path) -> None:
    """Without network: https, a host with a dot, no spaces."""
    text = page.read_text("utf-8")
    addresses = re.findall(r"\]\((\w+://[^)]*)\)", text) + re.findall(r"<(\w+://[^>]*)>", text)
    wrong = [a for a in addresses if not re.fullmatch(r"https://[\w-]+(\.[\w-]+)+(/[^\s<>\"]*)?", a)]
    assert wrong == []


def test_the_hosted_checks_build_the_site_by_the_documented_commands() -> None:
    (job,) = yaml.safe_load((ROOT / ".github/workflows/docs.yml").read_text("utf-8"))["jobs"].values()
    install, build = [step["run"] for step in job["steps"] if "run" in step]
    index = (DOCS / "README.md").read_text("utf-8")
    assert install.replace(" --quiet", "") in index
    assert f"`{build}`" in index


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
