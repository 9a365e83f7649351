"""The schemas of SSP 1.0 as fmpy ships them, and of 2.0 as pyssp_standard does."""

import functools
import zipfile
from pathlib import Path

import fmpy
import pyssp_standard
from lxml import etree

FOLDERS = {
    "1.0": Path(fmpy.__file__).parent / "ssp" / "schema",
    "2.0": Path(pyssp_standard.__file__).parent / "resources" / "ssp2",
}
OF_SUFFIX = {".ssd": "Description", ".ssv": "ParameterValues", ".ssm": "ParameterMapping"}


@functools.cache
def schema(version: str, suffix: str) -> etree.XMLSchema:
    return etree.XMLSchema(etree.parse(str(FOLDERS[version] / f"SystemStructure{OF_SUFFIX[suffix]}.xsd")))


def assert_valid(package: Path) -> None:
    """Every file of the standard in the package follows the schema of its version, as do the sets in it."""
    with zipfile.ZipFile(package) as archive:
        names = [name for name in archive.namelist() if Path(name).suffix in OF_SUFFIX]
        assert "SystemStructure.ssd" in names
        for name in names:
            root = etree.fromstring(archive.read(name))
            schema(root.get("version"), Path(name).suffix).assertValid(root)
            if root.get("version") == "2.0":  # which its own schema does not call
                for inner in root.iter("{*}ParameterSet"):
                    schema("2.0", ".ssv").assertValid(inner)
