"""Validates packages against the schemas of SSP 1.0, which fmpy contains."""

from pathlib import Path

import fmpy
from lxml import etree

FOLDER = Path(fmpy.__file__).parent / "ssp" / "schema"
SCHEMAS = {".ssd": "Description", ".ssv": "ParameterValues", ".ssm": "ParameterMapping"}


def find_schema_fault(folder: Path) -> str:
    """The first violation of the standard in the folder's files of SSP 1, with its line; empty if none."""
    for file in sorted(folder.rglob("*")):
        if file.suffix not in SCHEMAS:
            continue
        try:
            root = etree.parse(str(file))
        except etree.XMLSyntaxError as error:
            return f"{file.relative_to(folder).as_posix()}: {error}"
        if not (root.getroot().get("version") or "1.0").startswith("1."):
            continue
        schema = etree.XMLSchema(etree.parse(str(FOLDER / f"SystemStructure{SCHEMAS[file.suffix]}.xsd")))
        if not schema.validate(root):
            first = schema.error_log[0]
            return f"{file.relative_to(folder).as_posix()}, line {first.line}: {first.message}"
    return ""
