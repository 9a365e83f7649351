"""Mapping tables of SSP packages."""

import logging
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load
from orchestrator.scenario.ssp.tables import look_up, to_line
from tests.archives import repack
from tests.third_party.c_fmus import fmu

from .packages import component, package, parameters

TRUTHS = st.sampled_from(["true", "false"])


@given(TRUTHS, TRUTHS)
def test_a_table_of_truth_values_is_a_line(no: str, yes: str) -> None:
    """What a connection computes is what the table says."""
    entries = {"false": no, "true": yes}
    factor, offset = to_line("Boolean", entries, "here")
    for value in (False, True):
        assert factor * value + offset == look_up("Boolean", entries, value, "here")


@given(st.dictionaries(st.integers(-50, 50), st.integers(-50, 50), min_size=2, max_size=6))
def test_a_table_of_numbers_is_a_line_or_refused(numbers: dict[int, int]) -> None:
    entries = {str(x): str(y) for x, y in numbers.items()}
    (x0, y0), (x1, y1), *others = numbers.items()
    if any((y - y0) * (x1 - x0) != (y1 - y0) * (x - x0) for x, y in others):
        with pytest.raises(ScenarioError, match="lie on no straight line"):
            to_line("Integer", entries, "here")
        return
    factor, offset = to_line("Integer", entries, "here")
    for x, y in numbers.items():
        assert factor * x + offset == pytest.approx(y, abs=1e-9)
        assert look_up("Integer", entries, float(x), "here") == y


@pytest.mark.parametrize(
    ("kind", "entries", "value", "said"),
    [
        ("Integer", {"1": "2"}, 3.0, "no entry for 3"),
        ("Integer", {"one": "2"}, 1.0, "must be a whole number"),
        ("Boolean", {"yes": "true"}, True, "must be true or false"),
        ("Enumeration", {"a": "b"}, "c", "no entry for 'c'"),
    ],
)
def test_what_a_table_lacks_is_named(kind: str, entries: dict[str, str], value: float, said: str) -> None:
    with pytest.raises(ScenarioError, match=said):
        look_up(kind, entries, value, "here")


MAPPING = """<ssm:ParameterMapping xmlns:ssm="http://ssp-standard.org/SSP1/{name}"
 xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" version="1.0">
<ssm:MappingEntry source="stage" target="decay.k"><ssc:IntegerMappingTransformation>
<ssc:MapEntry source="1" target="3"/><ssc:MapEntry source="2" target="7"/>
<ssc:MapEntry source="3" target="4"/>
</ssc:IntegerMappingTransformation></ssm:MappingEntry>
<ssm:MappingEntry source="stage" target="elsewhere.k"/><ssm:MappingEntry source="absent" target="decay.x"/>
</ssm:ParameterMapping>"""


@pytest.mark.parametrize("name", ["SystemStructureParameterMapping", "ParameterMapping"])
def test_a_mapped_parameter_takes_the_tables_value(
    name: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Also under a name that tools write for the standard's; what is of no part is left out with a notice."""
    files = {
        "resources/dahlquist.fmu": fmu("dahlquist", 2, tmp_path).read_bytes(),
        "resources/set.ssv": parameters({"stage": 'Integer value="2"'}).encode(),
    }
    plain = package(tmp_path / "plain.ssp", component("decay", "dahlquist", {"x": "output"}), files=files)
    bound = (
        '<ssd:ParameterBindings><ssd:ParameterBinding source="resources/set.ssv">'
        '<ssd:ParameterMapping source="resources/map.ssm"/></ssd:ParameterBinding></ssd:ParameterBindings>'
    )

    def bind(entry: str, content: bytes) -> dict[str, bytes]:
        if entry != "SystemStructure.ssd":
            return {entry: content}
        structure = content.decode().replace("<ssd:Elements>", f"{bound}<ssd:Elements>", 1).encode()
        return {entry: structure, "resources/map.ssm": MAPPING.format(name=name).encode()}

    path = repack(plain, tmp_path / "a.ssp", bind)
    with caplog.at_level(logging.WARNING):
        one = load(path)
    assert float(one.components["decay"].parameters["k"]) == 7.0
    assert "'elsewhere.k' is of no element of this package" in caplog.text
    assert "'absent' is no parameter of the set" in caplog.text
