"""What ships inside an FMU: files told by the manifest of FMI-LS-REF."""

import re
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest

from fmus.build import build
from fmus.reference_results.inside import FOLDER, MANIFEST

from ..names import REFERENCED, mark_long

# The standard's roles, version 1.0.0-alpha.1, of those that are used.
ROLES = {"testcase", "result", "document"}
LAYERED = "{http://fmi-standard.org/fmi-ls-manifest}"


@pytest.mark.parametrize("name", mark_long(REFERENCED))
def test_the_manifest_tells_of_every_file_and_of_no_other(name: str, referenced: dict[str, Path]) -> None:
    with zipfile.ZipFile(referenced[name]) as archive:
        root = ElementTree.fromstring(archive.read(MANIFEST))
        there = {n.removeprefix(FOLDER + "/") for n in archive.namelist() if n.startswith(FOLDER)}
    assert root.tag == "fmiReferences"
    assert root.get(f"{LAYERED}fmi-ls-name") == FOLDER.removeprefix("extra/")
    assert root.get(f"{LAYERED}fmi-ls-description")
    assert re.fullmatch(r"\d+\.\d+\.\d+(-.+)?", root.get(f"{LAYERED}fmi-ls-version", ""))
    told = {related.get("source"): related.get("role") for related in root.iter("Related")}
    assert set(told) == there - {"fmi-ls-manifest.xml"}
    assert set(told) == {"README.md", f"{name}_in.csv", f"{name}_ref.csv", f"{name}_ref.opt"}
    assert set(told.values()) == ROLES
    assert told[f"{name}_ref.csv"] == "result"


def test_other_sizes_have_no_reference(tmp_path: Path) -> None:
    """Eight coil masses move otherwise than two."""

    def ships(name: str, **structure: int) -> bool:
        with zipfile.ZipFile(build(name, tmp_path, structure)) as archive:
            return MANIFEST in archive.namelist()

    assert ships("valve_spring", coil_masses=2)
    assert not ships("valve_spring", coil_masses=8)
