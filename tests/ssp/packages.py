"""SSP packages as other tools write them, and the schemas of SSP and SSP Traceability."""

import functools
import zipfile
from collections.abc import Mapping
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


HEAD = (
    'xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" '
    'xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" '
    'xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping" '
    'xmlns:ssb="http://ssp-standard.org/SSP1/SystemStructureSignalDictionary" '
    'xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"'
)

# What stands after a system whose values have units.
UNITS = "".join(
    f'<ssc:Unit name="{name}"><ssc:BaseUnit {base}/></ssc:Unit>'
    for name, base in (
        ("m", 'm="1"'), ("mm", 'm="1" factor="0.001"'), ("K", 'K="1"'), ("degC", 'K="1" offset="273.15"')
    )
)  # fmt: skip
UNITS = f"<ssd:Units>{UNITS}</ssd:Units>"


def package(
    path: Path, elements: str, connections: str = "", *, inside: str = "", after: str = "",
    files: Mapping[str, bytes | str] | None = None, experiment: str = 'stopTime="1"', dictionaries: str = "",
    version: str = "1.0",
) -> Path:  # fmt: skip
    """A package whose system has these elements and connections; `inside` comes before its elements, `after`
    the system. Checked against the schema of that version."""
    joined = f"<ssd:Connections>{connections}</ssd:Connections>" if connections else ""
    text = (
        f'<ssd:SystemStructureDescription {HEAD} version="{version}" name="other">'
        f'<ssd:System name="root">{inside}<ssd:Elements>{elements}</ssd:Elements>{joined}{dictionaries}'
        f"</ssd:System>{after}"
        f"<ssd:DefaultExperiment {experiment}/></ssd:SystemStructureDescription>"
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", text)
        for name, content in (files or {}).items():
            archive.writestr(name, content)
    assert_valid(path)
    return path


def component(name: str, source: str, connectors: Mapping[str, str], bound: str = "") -> str:
    """A component: kinds of its connectors, each with a unit after it if it has one ("input m"), or a
    type that is no number ("input String")."""
    bindings = f"<ssd:ParameterBindings>{bound}</ssd:ParameterBindings>" if bound else ""
    return (
        f'<ssd:Component name="{name}" type="application/x-fmu-sharedlibrary" '
        f'source="resources/{source}.fmu">'
        f"<ssd:Connectors>{''.join(connector(*one) for one in connectors.items())}</ssd:Connectors>{bindings}"
        "</ssd:Component>"
    )


def connector(name: str, kind: str) -> str:
    kind, _, unit = kind.partition(" ")
    stated = f' unit="{unit}"' if unit else ""
    typed = f"<ssc:{unit}/>" if unit in ("String", "Binary") else f"<ssc:Real{stated}/>"
    return f'<ssd:Connector name="{name}" kind="{kind}">{typed}</ssd:Connector>'


def connection(start: str, end: str, inside: str = "", more: str = "") -> str:
    """From "element.connector" or, of the system itself, ".connector", to another."""
    ends = []
    for side, port in (("start", start), ("end", end)):
        element, _, name = port.partition(".")
        own = f'{side}Element="{element}" ' if element else ""
        ends.append(f'{own}{side}Connector="{name}"')
    return f"<ssd:Connection {' '.join(ends)} {more}>{inside}</ssd:Connection>"


def linear(factor: float, offset: float = 0.0) -> str:
    return f'<ssc:LinearTransformation factor="{factor!r}" offset="{offset!r}"/>'


def parameters(values: Mapping[str, str]) -> str:
    """A parameter set; values as XML: Real value="1"."""
    inside = "".join(f'<ssv:Parameter name="{k}"><ssv:{v}/></ssv:Parameter>' for k, v in values.items())
    return (
        f'<ssv:ParameterSet {HEAD} version="1.0" name="set"><ssv:Parameters>{inside}</ssv:Parameters>'
        "</ssv:ParameterSet>"
    )


def binding(values: Mapping[str, str], mapping: str = "", more: str = "") -> str:
    """An inline parameter binding."""
    mapped = (
        f'<ssd:ParameterMapping><ssm:ParameterMapping version="1.0">{mapping}</ssm:ParameterMapping>'
        "</ssd:ParameterMapping>"
        if mapping
        else ""
    )
    return (
        f"<ssd:ParameterBinding {more}><ssd:ParameterValues>{parameters(values)}</ssd:ParameterValues>"
        f"{mapped}</ssd:ParameterBinding>"
    )


def bindings(*bound: str) -> str:
    return f"<ssd:ParameterBindings>{''.join(bound)}</ssd:ParameterBindings>"


def connectors(kinds: Mapping[str, str]) -> str:
    return f"<ssd:Connectors>{''.join(connector(*one) for one in kinds.items())}</ssd:Connectors>"


def system(name: str, kinds: Mapping[str, str], elements: str, joined: str = "") -> str:
    """A system inside another, with connectors of these kinds."""
    return (
        f'<ssd:System name="{name}">{connectors(kinds)}<ssd:Elements>{elements}</ssd:Elements>'
        f"<ssd:Connections>{joined}</ssd:Connections></ssd:System>"
    )
