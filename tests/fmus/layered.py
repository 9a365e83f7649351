"""What FMI 3.0 asks of the manifest of a layered standard, by the schema that fmpy ships."""

from pathlib import Path
from xml.etree.ElementTree import Element

import fmpy
import xmlschema

SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3LayeredStandardManifest.xsd"
NAMESPACE = "{http://fmi-standard.org/fmi-ls-manifest}"


def check_manifest(root: Element, folder: str, description: str) -> None:
    """Its attributes are of the schema's types, name the `folder` in an FMU, and say the standard's words."""
    known = xmlschema.XMLSchema(str(SCHEMA)).attributes
    stated = {k.removeprefix(NAMESPACE): v for k, v in root.attrib.items() if k.startswith(NAMESPACE)}
    assert set(stated) == set(known)
    for name, value in stated.items():
        known[name].validate(value)
    assert stated["fmi-ls-name"] == folder.removeprefix("extra/")
    assert stated["fmi-ls-description"] == description
