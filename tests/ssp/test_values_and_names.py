"""Values of SSP packages pass through connectors and mapping tables; files and elements have any names."""

import logging

import pytest
from hypothesis import given
from hypothesis import strategies as st

from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load
from orchestrator.scenario.ssp.tables import look_up, to_line
from tests.archives import repack, replace_text
from tests.third_party.c_fmus import describe2, fmu, real2

from .packages import (
    UNITS,
    binding,
    bindings,
    component,
    connection,
    connectors,
    linear,
    package,
    parameters,
    system,
)  # fmt: skip

START = 'start="0"'
SUPPRESSED = 'suppressUnitConversion="true"'


@pytest.fixture
def files(tmp_path):
    """An FMU with a parameter p and an input u in m, a difference dT in K, and an output y without a unit."""
    variables = (
        real2("p", 0, "parameter", f'unit="m" {START}', "fixed")
        + real2("dT", 1, "parameter", f'unit="K" relativeQuantity="true" {START}', "fixed")
        + real2("u", 2, "input", f'unit="m" {START}')
        + real2("y", 3, "output")
    )
    return {"resources/gain.fmu": describe2(tmp_path / "gain.fmu", variables).read_bytes()}


# The system's connector and its value, the connection to what it goes to, and what arrives there.
PASSED = {
    "a unit": ("parameter mm", 'Real value="5"', connection(".x", "g.p"), 0.005),
    "a unit of an input": ("input mm", 'Real value="5"', connection(".x", "g.u"), 0.005),
    "a stated unit": ("parameter mm", 'Real value="5" unit="m"', connection(".x", "g.p"), 5.0),
    "no conversion": ("parameter mm", 'Real value="5"', connection(".x", "g.p", more=SUPPRESSED), 5.0),
    "a transformation": ("parameter mm", 'Real value="5"', connection(".x", "g.p", linear(2.0, 1.0)), 1.01),
    "a difference": ("parameter degC", 'Real value="5"', connection(".x", "g.dT"), 5.0),
    "no unit": ("parameter", 'Real value="5"', connection(".x", "g.p"), 5.0),
}


@pytest.mark.parametrize(("kind", "value", "connected", "expected"), PASSED.values(), ids=PASSED)
def test_values_of_a_systems_connector_pass_its_connections(
    kind, value, connected, expected, tmp_path, files
):
    element = component("g", "gain", {"p": "parameter m", "dT": "parameter K", "u": "input m"})
    inside = connectors({"x": kind}) + bindings(binding({"x": value}))
    path = package(tmp_path / "a.ssp", element, connected, inside=inside, after=UNITS, files=files)
    table = load(path).components["g"]
    assert list((table.parameters | table.inputs).values()) == pytest.approx([expected], rel=1e-14)


def test_connectors_have_units_of_their_own(tmp_path):
    """5 at a connector in mm is 0.005 of a parameter in m. Of y (mm) a connector in m gives a thousandth, and
    twice that goes by one in mm to u (m). An unknown unit of a connector leaves that of its variable."""
    variables = real2("p", 0, "parameter", f'unit="m" {START}', "fixed")
    variables += real2("u", 1, "input", f'unit="m" {START}') + real2("y", 2, "output", 'unit="mm"')
    files = {"resources/length.fmu": describe2(tmp_path / "length.fmu", variables).read_bytes()}
    kinds = {"p": "parameter mm", "y": "output m", "u": "input mm"}
    elements = component("a", "length", kinds, binding({"p": 'Real value="5"'}))
    elements += component("b", "length", {"u": "input quux"})
    lines = connection("a.y", "a.u", linear(2.0)) + connection("a.y", "b.u")
    one = load(package(tmp_path / "a.ssp", elements, lines, after=UNITS, files=files))
    assert one.components["a"].parameters["p"] == pytest.approx(0.005, rel=1e-14)
    assert one.connections == ["a.y * 0.002 -> a.u", "a.y -> b.u"]


def test_two_values_of_one_name_in_a_set_are_refused(tmp_path, files):
    set_of_two = parameters({"p": 'Real value="5"', "q": 'Real value="6"'}).replace('"q"', '"p"')
    files["resources/two.ssv"] = set_of_two
    bound = '<ssd:ParameterBinding source="resources/two.ssv"/>'
    path = package(tmp_path / "a.ssp", component("g", "gain", {"p": "parameter m"}, bound), files=files)
    with pytest.raises(ScenarioError, match="g: p has two values in one set; leave one out"):
        load(path)


def test_values_pass_nested_systems_and_mappings(tmp_path, files):
    """4 mm by a mapping (2 x + 1 in mm), on from mm to m (3 x), and to a parameter in m."""
    element = component("g", "gain", {"p": "parameter m"})
    nested = system("s", {"z": "parameter m"}, element, connection(".z", "g.p"))
    mapped = f'<ssm:MappingEntry source="a" target="x">{linear(2.0, 1.0)}</ssm:MappingEntry>'
    inside = connectors({"x": "parameter mm"}) + bindings(
        binding({"a": 'Real value="0.004" unit="m"'}, mapped)
    )
    connected = connection(".x", "s.z", linear(3.0))
    path = package(tmp_path / "a.ssp", nested, connected, inside=inside, after=UNITS, files=files)
    assert load(path).components["s_g"].parameters == pytest.approx({"p": 3.0 * 0.009}, rel=1e-14)


def test_signals_have_the_units_of_dictionaries(tmp_path, files):
    """A number without a unit is in mm at the dictionary's entry, and goes on into m."""
    parts = component("a", "gain", {"y": "output"}) + component("b", "gain", {"u": "input m"})
    parts += (
        '<ssd:SignalDictionaryReference name="R" dictionary="D">'
        f"{connectors({'q': 'inout'})}</ssd:SignalDictionaryReference>"
    )
    dictionary = (
        '<ssd:SignalDictionaries><ssd:SignalDictionary name="D"><ssb:SignalDictionary version="1.0">'
        '<ssb:DictionaryEntry name="q"><ssc:Real unit="mm"/></ssb:DictionaryEntry></ssb:SignalDictionary>'
        "</ssd:SignalDictionary></ssd:SignalDictionaries>"
    )
    connected = connection("a.y", "R.q") + connection("R.q", "b.u")
    path = package(tmp_path / "a.ssp", parts, connected, after=UNITS, dictionaries=dictionary, files=files)
    assert load(path).connections == ["a.y * 0.001 -> b.u"]


def test_names_of_files_and_elements_are_any(tmp_path, files):
    """Sources are URIs, names may have dots, and sets are larger than a component."""
    files["resources/my gain.fmu"] = files.pop("resources/gain.fmu")
    files["resources/my set.ssv"] = parameters({"p": 'Real value="5"', "other": 'Real value="1"'})
    bound = '<ssd:ParameterBinding source="resources/my%20set.ssv"/>'
    element = component("B.C", "my%20gain", {"dT": "parameter K"}, bound)
    inside = bindings(binding({"B.C.dT": 'Real value="3"'}))
    path = package(tmp_path / "a.ssp", element, inside=inside, after=UNITS, files=files)
    assert load(path).components["B_C"].parameters == {"p": 5.0, "dT": 3.0}


def test_what_a_component_lacks_of_a_set_is_told(tmp_path, files, caplog):
    bound = binding({"p": 'Real value="5"', "P": 'Real value="1"', "label": 'String value="red"'})
    path = package(tmp_path / "a.ssp", component("g", "gain", {"p": "parameter m"}, bound), files=files)
    with caplog.at_level("WARNING"):
        assert load(str(path)).components["g"].parameters == {"p": 5.0}
    for name in ("P", "label"):
        assert f"g: no parameter, input or start value '{name}': left out (" in caplog.text


LATER = {
    "the structure": ('version="1.0" name="other"', 'version="3.0" name="other"'),
    "a set": ('version="1.0" name="set"', 'version="3.0" name="set"'),
    "a value": ('<ssv:Real value="5"', '<ssv:Float128 value="5"'),
}


@pytest.mark.parametrize(("old", "new"), LATER.values(), ids=LATER)
def test_a_later_version_of_ssp_is_refused(old, new, tmp_path, files):
    bound = binding({"p": 'Real value="5"'})
    path = package(tmp_path / "a.ssp", component("g", "gain", {"p": "parameter m"}, bound), files=files)
    replace_text(path, tmp_path / "b.ssp", old, new, "SystemStructure.ssd")
    with pytest.raises(
        ScenarioError, match=r"is of SSP 3\.0; export|p: a value of type Float128; give one of SSP 2\.0"
    ):
        load(tmp_path / "b.ssp")


TRUTHS = st.sampled_from(["true", "false"])


@given(TRUTHS, TRUTHS)
def test_a_table_of_truth_values_is_a_line(no, yes):
    """What a connection computes is what the table says."""
    entries = {"false": no, "true": yes}
    factor, offset = to_line("Boolean", entries, "here")
    for value in (False, True):
        assert factor * value + offset == look_up("Boolean", entries, value, "here")


@given(st.dictionaries(st.integers(-50, 50), st.integers(-50, 50), min_size=2, max_size=6))
def test_a_table_of_numbers_is_a_line_or_refused(numbers):
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
def test_what_a_table_lacks_is_named(kind, entries, value, said):
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
def test_a_mapped_parameter_takes_the_tables_value(name, tmp_path, caplog):
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

    def bind(entry, content):
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
