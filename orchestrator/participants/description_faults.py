"""Reads a modelDescription.xml, and says what keeps it from being read, by element and attribute."""

import contextlib
import math
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from fmpy import read_model_description

REALS = ("Real", "Float64", "Float32")
# Abilities, which are true or false.
FLAGS = ("can", "needs", "provides", "has", "might")
INTERFACES = ("CoSimulation", "ModelExchange", "ScheduledExecution")


def read_file(path: Path, root: Element) -> Any:
    """fmpy's description; without validation if that fails for nothing that has to be known."""
    if fault := find_fault(root):
        raise ValueError(f"{fault}, in its modelDescription.xml")
    try:
        return read_model_description(str(path))
    except Exception as error:
        with contextlib.suppress(Exception):
            return read_model_description(str(path), validate=False)
        raise error


def read_root(path: Path) -> Element:
    with zipfile.ZipFile(path) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def find_fault(root: Element) -> str:
    """The first fault, with what is allowed; empty if there is none of these."""
    return next(_list_faults(root), "")


def _list_faults(root: Element) -> Iterator[str]:
    third = (root.get("fmiVersion") or "").startswith("3")
    yield from _list_missing(root, "fmiVersion", "modelName", "instantiationToken" if third else "guid")
    for kind in INTERFACES:
        for interface in root.iterfind(kind):
            yield from _list_missing(interface, "modelIdentifier")
            for name, said in interface.attrib.items():
                if name.startswith(FLAGS) and said not in ("true", "false", "1", "0"):
                    yield f"the element {kind} has {name} = {said!r}, which must be true or false"
    variables = list(root.iterfind("ModelVariables/*"))
    for variable in variables:
        yield from _list_missing(variable, "name", "valueReference")
        yield from _list_wrong_numbers(variable, "valueReference", None)
    types = {one.get("name") for one in root.iterfind("TypeDefinitions/*")}
    known = {str(variable.get("valueReference")) for variable in variables} if third else None
    count = None if third else len(variables)
    for variable in variables:
        for element in (variable, *variable):
            if element.tag in REALS:
                yield from _list_no_numbers(element, variable, "start", "min", "max", "nominal")
            if (declared := element.get("declaredType")) is not None and declared not in types:
                yield f"{_name(variable)} has declaredType = {declared!r}, which TypeDefinitions lacks"
            yield from _list_wrong_numbers(element, "derivative", count, known, variable)
            if element.tag == "Dimension":
                yield from _list_wrong_numbers(element, "valueReference", count, known, variable)
    for experiment in root.iterfind("DefaultExperiment"):
        yield from _list_no_numbers(experiment, experiment, "startTime", "stopTime", "stepSize")
    attribute = "valueReference" if third else "index"
    for unknown in root.iterfind("ModelStructure/*" if third else "ModelStructure/*/Unknown"):
        if unknown.tag != "Annotations":
            yield from _list_missing(unknown, attribute)
        for one in (attribute, "dependencies"):
            yield from _list_wrong_numbers(unknown, one, count, known)


def _list_missing(element: Element, *attributes: str) -> Iterator[str]:
    for attribute in attributes:
        if element.get(attribute) is None:
            yield f"{_name(element)} lacks the attribute {attribute}"


def _list_no_numbers(element: Element, owner: Element, *attributes: str) -> Iterator[str]:
    """Attributes whose words, one for each element of an array, are no finite numbers."""
    for attribute in attributes:
        for word in (element.get(attribute) or "").split():
            try:
                number = float(word)
            except ValueError:
                number = math.nan
            if math.isnan(number) and (attribute, word) != ("start", "NaN"):  # which says that there is none
                yield f"{_name(owner)} has {attribute} = {word[:40]!r}, which must be a number"


def _list_wrong_numbers(
    element: Element, attribute: str, count: int | None, known: set[str] | None = None,
    owner: Element | None = None,
) -> Iterator[str]:  # fmt: skip
    """Numbers of the attribute that are none, or of no variable: from 1 to `count`, or among `known`."""
    for word in (element.get(attribute) or "").split():
        said = f"{_name(element if owner is None else owner)} has {attribute} = {word!r}"
        if not word.isdecimal():
            yield f"{said}, which must be a whole number"
        elif count is not None and not 1 <= int(word) <= count:
            yield f"{said}, which must be from 1 to {count}, as there are variables"
        elif known is not None and word not in known:
            yield f"{said}, which is the valueReference of no variable"


def _name(element: Element) -> str:
    name = element.get("name")
    return f"{element.tag} {name!r}" if name else f"the element {element.tag}"
