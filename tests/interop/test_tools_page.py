"""The entry for the FMI project's page of tools says what the code itself says, in that page's form."""

import json
import tomllib
from pathlib import Path
from typing import get_args
from xml.etree import ElementTree

from fmus.build import origin
from fmus.fmi import description, description3, layered
from fmus.fmi.description import EXCHANGE, NATIVE, Experiment
from fmus.native.machine_code import PLATFORMS
from fmus.reference_results import inside
from models.catalogue import CATALOGUE
from orchestrator.participants.description import VERSIONS
from orchestrator.scenario.component_table import ComponentTable

ROOT = Path(__file__).parents[2]
ENTRY = json.loads((ROOT / "interop" / "tools_page.json").read_text("utf-8"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
SHORT = {"co_simulation": "CS", "model_exchange": "ME", "CoSimulation": "CS", "ModelExchange": "ME"}
SYSTEMS = {"darwin": "macOS", "linux": "Linux", "windows": "Windows"}


def test_the_entry_has_the_pages_form() -> None:
    """Without the addresses, which it gets where the project is published."""
    assert [*ENTRY] == [
        "name", "license", "vendor", "description", "features", "platforms", "interfaces", "fmiVersions",
        "fmuExport", "fmuImport", "layeredStandards",
    ]  # fmt: skip
    assert (ENTRY["name"], ENTRY["license"], PROJECT["license"]) == (PROJECT["name"], "osi", "MIT")
    assert f"name: {ENTRY['vendor']}\n" in (ROOT / "CITATION.cff").read_text("utf-8")
    assert not ENTRY["description"].endswith(".")
    assert "://" not in ENTRY["description"]


def test_what_it_claims_is_what_is_declared() -> None:
    written = set()
    made, maker = CATALOGUE["falling_mass"](), origin("a test")
    texts = (
        description.model_description(made, "m", Experiment(1.0, 0.1), maker, NATIVE, EXCHANGE),
        description3.model_description(made, "m", Experiment(1.0, 0.1), maker),
    )
    for text in texts:
        root = ElementTree.fromstring(text)
        assert root.get("fmiVersion") in ENTRY["fmiVersions"]
        written |= {SHORT[each.tag] for each in root if each.tag in SHORT}
    assert written == set(ENTRY["fmuExport"])
    interfaces = get_args(ComponentTable.model_fields["interface"].annotation)
    assert {SHORT[name] for name in interfaces} == set(ENTRY["fmuImport"])
    assert set(ENTRY["fmiVersions"]) == set(VERSIONS)
    assert {SYSTEMS[name.partition("-")[2]] for name in PLATFORMS} == set(ENTRY["platforms"])
    assert ("CLI" in ENTRY["interfaces"]) == ("tribocosim" in PROJECT["scripts"])
    assert ("library" in ENTRY["interfaces"]) == (ROOT / "tribocosim" / "py.typed").exists()
    folders = {layered.STRUCT_MANIFEST.split("/")[1], inside.FOLDER.split("/")[1]}
    assert folders == {f"org.fmi-standard.fmi-ls-{name.lower()}" for name in ENTRY["layeredStandards"]}
