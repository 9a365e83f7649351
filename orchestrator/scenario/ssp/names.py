"""Names of the standard: namespaces, files, kinds; and of annotations, ours and other tools'."""

from typing import Any
from xml.etree import ElementTree

STRUCTURE, RESOURCES = "SystemStructure.ssd", "resources"
# Where a package inside of one is unpacked, after its own name.
UNPACKED = ".unpacked"
FMU_TYPE = "application/x-fmu-sharedlibrary"
DEFINITION_TYPE, PACKAGE_TYPE = "application/x-ssp-definition", "application/x-ssp-package"
VALUES_TYPE = "application/x-ssp-parameter-set"

_SSP, _TRACEABILITY = "http://ssp-standard.org/SSP1/", "http://ssp-standard.org/SSPTraceability1/"
NAMESPACES = {
    "ssd": _SSP + "SystemStructureDescription",
    "ssc": _SSP + "SystemStructureCommon",
    "ssv": _SSP + "SystemStructureParameterValues",
    "ssm": _SSP + "SystemStructureParameterMapping",
    "ssb": _SSP + "SystemStructureSignalDictionary",
    "stc": _TRACEABILITY + "SSPTraceabilityCommon",
    "srmd": _TRACEABILITY + "SimulationResourceMetaData",
    "stmd": _TRACEABILITY + "SimulationTaskMetaData",
    "xlink": "http://www.w3.org/1999/xlink",
    # Steps of other tools' masters: OMSimulator's, and that of libcosim and ecos.
    "oms": "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd",
    "osp": "http://opensimulationplatform.com/SSP/OSPAnnotations",
    "tribocosim": "urn:tribocosim:scenario:1",
}
# Types of the annotations.
OURS, OMSIMULATOR, OSP = "tribocosim", "org.openmodelica", "com.opensimulationplatform"

for _prefix, _uri in NAMESPACES.items():
    ElementTree.register_namespace(_prefix, _uri)


# Names that some tools write for the standard's.
_ALIASES = {
    _SSP + "ParameterValues": NAMESPACES["ssv"],
    _SSP + "ParameterMapping": NAMESPACES["ssm"],
    _SSP + "SignalDictionary": NAMESPACES["ssb"],
}


def correct_tag(tag: str) -> str:
    """An element's tag with the namespace that the standard has for it."""
    namespace, closed, local = tag[1:].partition("}")
    return f"{{{_ALIASES[namespace]}}}{local}" if closed and namespace in _ALIASES else tag


def expand_tag(name: str) -> str:
    """ssd:System as ElementTree writes it."""
    prefix, _, local = name.partition(":")
    return f"{{{NAMESPACES[prefix]}}}{local}"


def add_element(parent: Any, name: str, /, **attributes: Any) -> Any:
    """A child of `parent`, if there is one, with attributes: numbers to the last bit; None leaves one out."""
    written = {key: format_value(value) for key, value in attributes.items() if value is not None}
    if parent is None:
        return ElementTree.Element(expand_tag(name), written)
    return ElementTree.SubElement(parent, expand_tag(name), written)


def format_value(value: Any) -> str:
    """As attributes have it."""
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value) if isinstance(value, float) else str(value)


def to_bytes(root: Any) -> bytes:
    """The file of an element."""
    ElementTree.indent(root)
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"
