"""Layered standards of FMI in FMUs: their manifests, and tables by FMI-LS-STRUCT (1.0.0-rc.1).

FMI-LS-WASM is an unofficial draft (commit c1aac17 of July 2026)."""

from collections.abc import Iterable, Mapping
from itertools import groupby
from typing import Any
from xml.etree.ElementTree import Element, SubElement, register_namespace

from ..variable_layout import Memory
from .arrays import group_arrays
from .description import to_xml
from .validate import TERMINALS

_NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"
register_namespace("fmi-ls", _NAMESPACE)
_STRUCT = "org.fmi-standard.fmi-ls-struct"
STRUCT_MANIFEST = f"extra/{_STRUCT}/fmi-ls-manifest.xml"
COMPONENT_MANIFEST = "extra/org.modelica.fmi-ls-wasm/manifest.xml"
# What the names of structural sizes of tables end in.
POINTS = "_points"


def write_manifest(
    root: str, name: str, version: str, about: str, children: Iterable[tuple[str, Mapping[str, str]]] = ()
) -> bytes:
    """A manifest with this root element, for the layered standard `name`."""
    stated = {"name": name, "version": version, "description": about}
    element = Element(root, {f"{{{_NAMESPACE}}}fmi-ls-{key}": value for key, value in stated.items()})
    for tag, attributes in children:
        SubElement(element, tag, dict(attributes))
    return to_xml(element).encode()


def describe_tables(component: Any) -> dict[str, bytes]:
    """The files, by path, that tell tools of FMI 3.0 which arrays are the columns of one table; none without.

    The arrays of one size are columns. The first one is the domain, and the others are functions of it.
    """
    arrays = [one for one in group_arrays(Memory(component).variables()) if one.first.size.endswith(POINTS)]
    if not arrays:
        return {}
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    listed = SubElement(root, "Terminals")
    for size, columns in groupby(arrays, lambda one: one.first.size):
        label, kind = size.removesuffix(POINTS), f"{_STRUCT}.map"
        stated = {"name": label, "terminalKind": f"{kind}.rectilinearGrid", "matchingRule": kind}
        terminal = SubElement(listed, "Terminal", stated)
        for i, column in enumerate(columns):
            role = f"{kind}.codomain" if i else f"{kind}.domain"
            member = {"variableName": column.name, "memberName": column.name, "variableKind": role}
            SubElement(terminal, "TerminalMemberVariable", member)
    about = "Layered standard for structuring of variables"
    manifest = write_manifest("fmiLayeredStandardManifest", _STRUCT, "1.0.0-rc.1", about)
    return {TERMINALS: to_xml(root).encode(), STRUCT_MANIFEST: manifest}


def describe_component() -> bytes:
    """The manifest of an FMU with a WebAssembly component."""
    about = "FMI Layered Standard for WebAssembly"
    return write_manifest("fmiLayeredStandardManifest", "org.modelica.fmi-ls-wasm", "0.1.0", about)
