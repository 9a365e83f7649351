"""Descriptions of FMUs, with an empty library: enough for what is decided before anything runs."""

import zipfile
from pathlib import Path

import fmpy

ABLE = 'canGetAndSetFMUstate="true" canHandleVariableCommunicationStepSize="true"'
UNITS = (
    '<UnitDefinitions><Unit name="K"><BaseUnit K="1"/></Unit>'
    '<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>'
    '<Unit name="degF"><BaseUnit K="1" factor="0.5555555555555556"/></Unit>'  # no offset
    '<Unit name="celsius"><BaseUnit K="1" offset="273.1500001"/></Unit></UnitDefinitions>'
)


def describe2(
    path: Path,
    variables: str,
    *,
    head: str = "",
    types: str = "",
    structure: str = "",
) -> Path:
    """An FMU of FMI 2.0 with these elements."""
    return _write(
        path,
        f'<fmiModelDescription fmiVersion="2.0" modelName="{path.stem}" guid="g">'
        f'<CoSimulation modelIdentifier="m" {ABLE}/>{UNITS}<TypeDefinitions>{types}</TypeDefinitions>{head}'
        f"<ModelVariables>{variables}</ModelVariables><ModelStructure>{structure}</ModelStructure>",
    )


def describe3(path: Path, variables: str, *, types: str = "") -> Path:
    """The same of FMI 3.0."""
    time = '<Float64 name="time" valueReference="999" causality="independent" variability="continuous"/>'
    return _write(
        path,
        f'<fmiModelDescription fmiVersion="3.0" modelName="{path.stem}" instantiationToken="t">'
        f'<CoSimulation modelIdentifier="m" {ABLE.replace("FMUstate", "FMUState")}/>{UNITS}'
        f"<TypeDefinitions>{types}</TypeDefinitions><ModelVariables>{variables}{time}</ModelVariables>"
        "<ModelStructure/>",
    )


def real2(
    name: str, reference: int, causality: str, attributes: str = "", varying: str = "continuous"
) -> str:
    """A Real of FMI 2.0."""
    return (
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
        f'variability="{varying}"><Real {attributes}/></ScalarVariable>'
    )


def _write(path: Path, text: str) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", text + "</fmiModelDescription>")
        for folder in (fmpy.platform, fmpy.platform_tuple):
            archive.writestr(f"binaries/{folder}/m{fmpy.sharedLibraryExtension}", b"")
    return path
