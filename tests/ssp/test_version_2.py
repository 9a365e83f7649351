"""Packages of SSP 2.0: arrays, structural parameters, types of FMI 3.0, texts and clocks."""

import pytest

from orchestrator.scenario import Scenario, ScenarioError
from orchestrator.scenario.files import load
from orchestrator.scenario.ssp import export
from tests.archives import replace_text
from tests.third_party.c_fmus import fmu
from tests.third_party.runs import never, public, ran
from tests.third_party.runs import scenario as foreign_scenario

from .packages import assert_valid, component, connection, package

OURS = 'type="tribocosim"', 'type="of another tool"'


def go_and_come_back(scenario: Scenario, folder, *, as_another: bool = False) -> Scenario:
    """By a package of SSP 2.0; `as_another`: without the annotation that only this program reads."""
    path = folder / "made.ssp"
    export(scenario, path, never, "2.0")
    assert_valid(path)
    if as_another:
        replace_text(path, folder / "plain.ssp", *OURS, "SystemStructure.ssd")
        path = folder / "plain.ssp"
    return load(path)


def content(scenario: Scenario) -> dict:
    """What a package has of each component, and the connections."""
    keys = ("structure", "parameters", "inputs", "start", "interface")
    tables = {name: {key: getattr(table, key) for key in keys} for name, table in scenario.components.items()}
    return {"components": tables, "connections": set(scenario.connections)}


@pytest.mark.parametrize("as_another", [False, True])
def test_arrays_and_their_sizes_come_back(as_another, tmp_path):
    """Values of whole arrays, of matrices row by row; connections of single elements, one with a factor."""
    one = foreign_scenario(
        {
            "grown": {
                "participant": fmu("sized", 3, tmp_path),
                "structure": {"n": 3},
                "parameters": {"x0": [1.0, -2.0, 0.5]},
                "inputs": {"u[1]": 0.25, "u[3]": 0.5},
            },
            "plane": {
                "participant": fmu("vector", 3, tmp_path),
                "parameters": {"A": [[1.0, 2.0], [3.0, 4.0]], "x0": [0.5, 2.5]},
            },
        },
        connections=["grown.y[3] -> plane.u[1]", "plane.y[2] * 2.0 + 1.0 -> grown.u[2]"],
    )
    back = go_and_come_back(one, tmp_path, as_another=as_another)
    assert content(back) == content(one)
    if not as_another:
        first, second = (ran(each, tmp_path / name)[1] for each, name in ((one, "first"), (back, "second")))
        assert {k: v.tolist() for k, v in first.items()} == {k: v.tolist() for k, v in second.items()}


def test_all_types_come_back(tmp_path):
    """Of a public FMU: floats and integers of any size, enumerations, texts and bytes, also connected."""
    path = public("reference-fmus-3/Feedthrough.fmu")
    table = {
        "participant": path,
        "inputs": {"Float32_continuous_input": 0.5, "Int8_input": -3.0, "UInt64_input": 7.0,
                   "Boolean_input": True, "Enumeration_input": 2.0},
    }  # fmt: skip
    kinds = ("String", "Binary", "Int16", "Float64_continuous")
    one = foreign_scenario(
        {"a": table, "b": {"participant": path}},
        connections=[f"a.{kind}_output -> b.{kind}_input" for kind in kinds],
    )
    assert content(go_and_come_back(one, tmp_path, as_another=True)) == content(one)


def test_a_package_for_model_exchange_says_so(tmp_path):
    """By the standard's `implementation`, which other tools read."""
    table = {"participant": public("reference-fmus-3/StateSpace.fmu"), "interface": "model_exchange"}
    back = go_and_come_back(foreign_scenario({"one": table}), tmp_path, as_another=True)
    assert back.components["one"].interface == "model_exchange"


VALUES = (
    '<ssd:ParameterBinding><ssd:ParameterValues><ssv:ParameterSet version="2.0" name="v"><ssv:Parameters>'
    '<ssv:Parameter name="n"><ssv:UInt64 value="3"/></ssv:Parameter>'
    '<ssv:Parameter name="x0"><ssv:Float64 value="1 2 3"/><ssc:Dimension size="{size}"/></ssv:Parameter>'
    "</ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding>"
)
SIZED = {"u": "input", "y": "output", "x0": "parameter"}


def build_chain(folder, connections: str, size: int = 3, more: str = "", sized: str = "") -> Scenario:
    """Two components of three elements in a system `s` that has a connector of them, and one outside."""
    values = VALUES.replace('UInt64 value="3"', sized) if sized else VALUES
    inner = component("one", "sized", SIZED, values.format(size=size))
    other = component("two", "sized", SIZED, VALUES.format(size=3)).replace('source="', f'{more} source="')
    hub = (
        '<ssd:System name="s"><ssd:Connectors><ssd:Connector name="w" kind="output"><ssc:Float64/>'
        '<ssc:Dimension size="3"/></ssd:Connector></ssd:Connectors>'
        f"<ssd:Elements>{inner}</ssd:Elements><ssd:Connections>{connection('one.y', '.w')}</ssd:Connections>"
        "</ssd:System>"
    )
    files = {"resources/sized.fmu": fmu("sized", 3, folder).read_bytes()}
    return load(package(folder / "chain.ssp", hub + other, connections, files=files, version="2.0"))


def test_an_array_goes_whole_through_a_system(tmp_path):
    made = build_chain(tmp_path, connection("s.w", "two.u"))
    assert made.connections == [f"s_one.y[{i}] -> two.u[{i}]" for i in (1, 2, 3)]
    assert made.components["s_one"].structure == {"n": 3}
    assert made.components["s_one"].parameters == {"x0[1]": 1.0, "x0[2]": 2.0, "x0[3]": 3.0}


def test_a_connection_may_be_of_one_element(tmp_path):
    """Element 3 of an array that came whole to the system's connector, to element 1."""
    indices = 'startIndices="3" endIndices="1"'
    made = build_chain(tmp_path, connection("s.w", "two.u", more=indices))
    assert made.connections == ["s_one.y[3] -> two.u[1]"]


def test_what_does_not_fit_is_refused(tmp_path):
    with pytest.raises(ScenarioError, match="x0 has 3 values: must be 2; correct"):
        build_chain(tmp_path, "", size=2)
    with pytest.raises(ScenarioError, match="n = inf: must be a whole number"):
        build_chain(tmp_path, "", sized='Float64 value="INF"')
    with pytest.raises(
        ScenarioError, match=r"s_one: n = 99999999999 \(n\): must be at least 1 and at most 4"
    ):
        build_chain(tmp_path, "", sized='UInt64 value="99999999999"')
    both = connection("s.w", "two.u") + connection("s.w", "two.u", more='startIndices="3" endIndices="1"')
    with pytest.raises(ScenarioError, match=r"two\.u\[1\] has two sources"):
        build_chain(tmp_path, both)
    with pytest.raises(ScenarioError, match="two: implementation 'ScheduledExecution'; give it as CoSim"):
        build_chain(tmp_path, "", more='implementation="ScheduledExecution"')


def test_version_1_lacks_texts_and_sizes(tmp_path):
    sized = {"participant": fmu("sized", 3, tmp_path), "structure": {"n": 1}, "parameters": {"x0": 1.0}}
    with pytest.raises(ScenarioError, match=r"one\.structure: packages of SSP 1\.0 have no .*use version=.2"):
        export(foreign_scenario({"one": sized}), tmp_path / "one.ssp", never)
    assert not (tmp_path / "one.ssp").exists()
    through = {"participant": public("reference-fmus-3/Feedthrough.fmu")}
    texts = foreign_scenario({"a": through, "b": through}, connections=["a.String_output -> b.String_input"])
    with pytest.raises(ScenarioError, match=r"SSP 1\.0 connect numbers only; use version=.2"):
        export(texts, tmp_path / "one.ssp", never)
