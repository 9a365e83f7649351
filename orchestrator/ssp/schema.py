"""What the schemas of SSP 1.0, which fmpy brings along, find in a package's files."""

from __future__ import annotations

from pathlib import Path

import fmpy
from lxml import etree

FOLDER = Path(fmpy.__file__).parent / "ssp" / "schema"
SCHEMAS = {".ssd": "Description", ".ssv": "ParameterValues", ".ssm": "ParameterMapping"}


def find_schema_fault(folder: Path) -> str:
    """The first thing in the folder's files that the standard does not allow, with its place; empty: none."""
    for file in sorted(folder.rglob("*")):
        if file.suffix not in SCHEMAS:
            continue
        schema = etree.XMLSchema(etree.parse(str(FOLDER / f"SystemStructure{SCHEMAS[file.suffix]}.xsd")))
        if not schema.validate(etree.parse(str(file))):
            first = schema.error_log[0]
            return f"{file.relative_to(folder).as_posix()}, line {first.line}: {first.message}"
    return ""
