"""The model description says what the component's metadata says, and other tools find no fault with it."""

import math
import re
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest
from fmpy import read_model_description

from fmus.build import NAMES
from fmus.documentation import MARKER, render_page
from fmus.fmi.layered import describe_tables
from fmus.fmi.units import base, display_factor, factors, per_second
from fmus.fmi.validate import terminal_faults
from fmus.native import fmu as native_fmu
from fmus.variable_layout import Memory
from models.catalogue import CATALOGUE

from .kinds import FILES, every_fmu
from .layered import check_manifest
from .names import mark_long


@pytest.mark.parametrize(("kind", "name"), every_fmu(kinds=("python", "native3"), python=["flywheel"]))
def test_fmutool_finds_no_fault(kind: str, name: str) -> None:
    pytest.importorskip("fmu_manipulation_toolbox", reason="fmu-manipulation-toolbox is not installed")
    tool = Path(sys.executable).with_name("fmutool")
    command = [str(tool), "-input", str(FILES[kind][name]), "-check"]
    finished = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    text = finished.stdout + finished.stderr
    assert f"seems to be compliant with FMI-{'3.0' if kind == 'native3' else '2.0'}" in text
    assert "No semantic error" in text
    assert "WARNING" not in text
    assert "ERROR" not in text


def number(text: str) -> float:
    """The value of a start attribute of any type."""
    return {"true": 1.0, "false": 0.0}[text] if text in ("true", "false") else float(text)


@pytest.mark.parametrize("name", mark_long(NAMES))
def test_every_quantity_is_described(name: str, fmu_files: dict[str, Path]) -> None:
    """Names, units, ranges, nominals, start values and dependencies are those of the component."""
    component = CATALOGUE[name]()
    described = read_model_description(str(fmu_files[name]))
    found = {v.name: v for v in described.modelVariables}
    for layout, causality in (
        (component.parameters, "parameter"),
        (component.inputs, "input"),
        (component.outputs, "output"),
    ):
        for field in layout.fields:
            variable, quantity = found[field.name], field.quantity
            assert variable.causality == causality
            assert variable.description == quantity.description
            if causality != "output":
                assert number(variable.start) == field.start
            if variable.type == "Real":
                assert variable.unit == quantity.unit
                assert (variable.displayUnit or "") == quantity.display_unit
                assert float(variable.nominal or 1.0) == quantity.nominal
                low = 0.0 if quantity.positive else quantity.minimum
                assert float(variable.min if variable.min is not None else -math.inf) == low
                assert float(variable.max if variable.max is not None else math.inf) == quantity.maximum
            else:
                assert variable.variability in ("discrete", "fixed")
    for unknown in described.outputs:
        inputs = {v.name for v in unknown.dependencies}
        rated = unknown.variable.derivative
        direct = component.feedthrough.get((rated or unknown.variable).name, ())
        if rated is None:
            assert inputs == set(direct)
        else:
            slopes = {component.inputs.field(name).add_suffix("_der1") for name in direct}
            assert inputs == {*component.inputs.names, *slopes}
    states = {u.variable.derivative.name for u in described.derivatives}
    for unknown in described.derivatives:  # hosts ask what they depend on: here everything
        assert {v.name for v in unknown.dependencies} == {*states, *component.inputs.names}
    continuous = [field for field in component.outputs.fields if not field.quantity.discrete]
    rates = [v for v in found.values() if v.derivative is not None]
    assert [(v.name, v.derivative.name) for v in rates] == [(f"der({f.name})", f.name) for f in continuous]
    assert [v.unit for v in rates] == [per_second(f.quantity.unit, 1) for f in continuous]
    assert found["stored_energy"].unit == "J"


@pytest.mark.parametrize("name", mark_long(NAMES))
def test_every_file_that_the_standard_offers(name: str, fmu_files: dict[str, Path]) -> None:
    with zipfile.ZipFile(fmu_files[name]) as archive:
        names = archive.namelist()
        html = archive.read("documentation/index.html").decode()
        code = [n for n in names if n.endswith(".py")]
        text = b"".join(archive.read(n) for n in code)
    assert names[0] == "modelDescription.xml"
    assert {"model.png", "documentation/licenses/LICENSE"} <= set(names)
    assert not [n for n in code if "system.py" in n or "monolithic" in n]
    assert b"import scipy" not in text
    assert b"from scipy" not in text
    for variable in Memory(CATALOGUE[name]()).variables():
        assert variable.derivative_order or f"<td>{variable.name}</td>" in html


def test_page_needs_its_marker() -> None:
    with pytest.raises(ValueError, match=re.escape(MARKER)):
        render_page("# no place for the variables", CATALOGUE["flywheel"]())


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("1", {}),
        ("N.s/m", {"kg": 1, "s": -1}),
        ("1/Pa", {"kg": -1, "m": 1, "s": 2}),
        ("rad/s2", {"rad": 1, "s": -2}),
    ],
)
def test_units_in_base_units(unit: str, expected: dict[str, int]) -> None:
    assert base(unit) == (1.0, expected)


@pytest.mark.parametrize(
    ("unit", "order", "expected"),
    [("m/s", 2, "m/s3"), ("N.s/m", 1, "N/m"), ("1", 1, "1/s"), ("rad", 0, "rad")],
)
def test_unit_of_a_derivative(unit: str, order: int, expected: str) -> None:
    assert per_second(unit, order) == expected
    assert base(expected)[1].get("s", 0) == base(unit)[1].get("s", 0) - order


def test_display_units() -> None:
    assert display_factor("m", "mm") == 1e3
    assert display_factor("rad/s", "rpm") == pytest.approx(60.0 / (2.0 * math.pi), rel=1e-15)
    assert display_factor("Pa", "MPa") == 1e-6
    with pytest.raises(ValueError, match="does not measure"):
        display_factor("m", "deg")
    with pytest.raises(ValueError, match="not a known symbol"):
        factors("furlong")


TERMINALS = """<?xml version="1.0" encoding="UTF-8"?>
<fmiTerminalsAndIcons fmiVersion="3.0"><Terminals>
  <Terminal name="load" matchingRule="plug" terminalKind="translation">
    <TerminalMemberVariable memberName="force" variableName="load" variableKind="signal"/>
    <TerminalMemberVariable memberName="velocity" variableName="velocity" variableKind="signal"/>
  </Terminal>
</Terminals></fmiTerminalsAndIcons>
"""


TABLES = [
    ("camshaft", "table_points", ["table_angle", "table_lift", "table_slope", "table_curvature"]),
    ("cylinder_gas", "pressure_points", ["pressure_angle", "point_pressure", "pressure_slope"]),
]
STRUCT = "extra/org.fmi-standard.fmi-ls-struct"
MAP = "org.fmi-standard.fmi-ls-struct.map"


@pytest.mark.parametrize(("name", "size", "columns"), TABLES, ids=[name for name, _, _ in TABLES])
def test_tables_are_maps_of_their_layered_standard(
    name: str, size: str, columns: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """FMI-LS-STRUCT: arrays of one length, the domain first; fmpy finds no fault with the file."""
    monkeypatch.setattr(native_fmu, "_kernels", lambda *of: ("", ""))
    files = native_fmu.collect_files(name, CATALOGUE[name](**{size: 5}), {size: 5}, (), 3)
    (tmp_path / "modelDescription.xml").write_bytes(files["modelDescription.xml"])
    described = read_model_description(str(tmp_path), validate=False)
    arrays = {v.name: [int(d.start) for d in v.dimensions] for v in described.modelVariables}
    xml = files["terminalsAndIcons/terminalsAndIcons.xml"]
    assert terminal_faults(xml, arrays) == []
    (terminal,) = ElementTree.fromstring(xml).iter("Terminal")
    assert (terminal.get("terminalKind"), terminal.get("matchingRule")) == (f"{MAP}.rectilinearGrid", MAP)
    assert [member.get("variableName") for member in terminal] == columns
    kinds = [member.get("variableKind") for member in terminal]
    assert kinds == [f"{MAP}.domain", *[f"{MAP}.codomain"] * (len(columns) - 1)]
    assert all(arrays[column] == [5] for column in columns)
    manifest = ElementTree.fromstring(files[f"{STRUCT}/fmi-ls-manifest.xml"])
    assert manifest.tag == "fmiLayeredStandardManifest"
    check_manifest(manifest, STRUCT, "Layered standard for structuring of variables")
    assert not describe_tables(CATALOGUE[name]())


def test_faults_of_terminals_are_said() -> None:
    xml = TERMINALS
    assert terminal_faults(xml.encode(), {"load", "velocity"}) == []
    assert terminal_faults(xml.encode(), {"load"}) == [
        "terminalsAndIcons/terminalsAndIcons.xml: terminal load: there is no variable velocity"
    ]
    twice = xml.replace('memberName="velocity"', 'memberName="force"')
    assert "members need names of their own" in terminal_faults(twice.encode(), {"load", "velocity"})[0]
    assert "not XML" in terminal_faults(b"<fmi", set())[0]
    assert "line" in terminal_faults(xml.replace("matchingRule", "rule").encode(), set())[0]
