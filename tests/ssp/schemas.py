"""The schemas of SSP 1.0, as fmpy ships them."""

import functools
import zipfile
from pathlib import Path

import fmpy
from lxml import etree

FOLDER = Path(fmpy.__file__).parent / "ssp" / "schema"
OF_SUFFIX = {".ssd": "Description", ".ssv": "ParameterValues", ".ssm": "ParameterMapping"}


@functools.cache
def schema(suffix: str) -> etree.XMLSchema:
    return etree.XMLSchema(etree.parse(str(FOLDER / f"SystemStructure{OF_SUFFIX[suffix]}.xsd")))


def assert_valid(package: Path) -> None:
    """Every file of the standard in the package follows its schema."""
    with zipfile.ZipFile(package) as archive:
        names = [name for name in archive.namelist() if Path(name).suffix in OF_SUFFIX]
        assert "SystemStructure.ssd" in names
        for name in names:
            schema(Path(name).suffix).assertValid(etree.fromstring(archive.read(name)))
