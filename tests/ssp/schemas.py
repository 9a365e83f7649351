"""The schemas of SSP 1.0 as fmpy ships them, and of 2.0 and SSP Traceability as pyssp_standard does."""

import functools
import zipfile
from pathlib import Path

import fmpy
import pyssp_standard
import xmlschema
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


@functools.cache
def task_schema() -> xmlschema.XMLSchema11:
    """Of a simulation task: its phases in the standard's order, of steps of the type that is shipped."""
    steps = {
        "ExecutionPhase": ["ExecuteSimulation"],
        "EvaluationPhase": [
            "EvaluateSimulationResults",
            "AssureSimulationQuality",
            "DeriveSimulationQualityVerdict",
        ],
    }
    common, of = "http://ssp-standard.org/SSPTraceability1/SSPTraceabilityCommon", "SimulationTaskMetaData"
    phases = "".join(
        f'<xs:element name="{phase}" minOccurs="0"><xs:complexType><xs:sequence>'
        + "".join(f'<xs:element name="{one}" type="stc:StepType" minOccurs="0"/>' for one in names)
        + "</xs:sequence></xs:complexType></xs:element>"
        for phase, names in steps.items()
    )
    asked = "".join(f'<xs:attribute name="{one}" use="required"/>' for one in ("version", "name", "GUID"))
    return xmlschema.XMLSchema11(
        f'''<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" xmlns:stc="{common}"
        targetNamespace="{common.replace("SSPTraceabilityCommon", of)}" elementFormDefault="qualified">
        <xs:import namespace="{common}" schemaLocation="STC11.xsd"/><xs:element name="{of}"><xs:complexType>
        <xs:sequence>{phases}</xs:sequence>{asked}<xs:attribute name="description"/>
        <xs:attribute name="generationTool"/></xs:complexType></xs:element></xs:schema>''',
        base_url=str(FOLDERS["2.0"].parent),
    )
