"""SSPs of other tools with third-party FMUs run here, and mean what the standard says."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from fmus.native.fmu import build
from fmus.native.machine_code import this_platform
from orchestrator.scenario.files import load
from tests.archives import replace_text
from tests.orchestrator.commands import called
from tests.third_party.c_fmus import fmu
from tests.third_party.runs import completed

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

DECAY = {"x": "output", "k": "parameter"}
VECTOR = {"u[1]": "input", "u[2]": "input", "y[1]": "output", "y[2]": "output"}
THROUGH = {"real in": "input m", "real out": "output m", "offset": "parameter"}
SHAFT = {"height": "input mm", "reached": "output mm", "speed": "output r/min"}


@pytest.fixture
def files(tmp_path):
    """The FMUs of a package, of both versions of FMI."""
    versions = {"dahlquist": 2, "feedthrough": 3, "shaft": 2, "vector": 3}
    return {f"resources/{n}.fmu": fmu(n, version, tmp_path).read_bytes() for n, version in versions.items()}


def ran_here(path: Path, out: Path) -> dict[str, np.ndarray]:
    """The columns of a run with all FMUs in this process, which a package cannot ask for."""
    here = [f"components.{name}.process=shared" for name in load(path).components]
    found = completed(load(path, here), out)
    return found


def lines(path: Path) -> list[str]:
    return load(path).connections


def test_a_package_runs_as_it_is(tmp_path, files):
    """With the values of an external parameter set; steps are those of the FMUs' experiments."""
    bound = '<ssd:ParameterBinding source="resources/set.ssv"/>'
    files["resources/set.ssv"] = parameters({"k": 'Real value="3"', "x": 'Real value="0.5"'}).encode()
    path = package(tmp_path / "a.ssp", component("decay", "dahlquist", DECAY, bound), files=files)
    one = load(path)
    assert (one.stop_time, one.macro_step, one.start, one.reference.enabled) == (1.0, 0.01, "given", False)
    assert one.master.name == "jacobi"
    found = ran_here(path, tmp_path / "out")
    np.testing.assert_allclose(found["decay.x"], 0.5 * np.exp(-3.0 * found["time"]), rtol=1e-13)


def test_a_component_for_model_exchange_is_integrated_here(tmp_path):
    """The reader asks its FMU for that interface; one without it is refused."""
    built = build("quarter_car_wheel", tmp_path, platforms=[this_platform()], fmi=2)
    files = {"resources/wheel.fmu": built.read_bytes()}
    element = component("wheel", "wheel", {"position": "output m"})
    element = element.replace(" source=", ' implementation="ModelExchange" source=')
    one = load(package(tmp_path / "a.ssp", element, files=files))
    assert one.components["wheel"].interface == "model_exchange"
    files = {"resources/wheel.fmu": fmu("dahlquist", 2, tmp_path).read_bytes()}
    with pytest.raises(ValueError, match="has no model exchange; leave `interface` out"):
        load(package(tmp_path / "b.ssp", element.replace("position", "x"), files=files))


def test_connections_pass_through_nested_systems(tmp_path, files):
    """With a transformation at each border: one after the other."""
    inner = system(
        "in-side",
        {"a": "input", "b": "output"},
        component("thru", "feedthrough", {"real in": "input", "real out": "output"}),
        connection(".a", "thru.real in", linear(2.0, 1.0)) + connection("thru.real out", ".b"),
    )
    path = package(
        tmp_path / "a.ssp",
        component("decay", "dahlquist", DECAY) + inner + component("vector", "vector", VECTOR),
        connection("decay.x", "in-side.a", linear(3.0, -1.0))
        + connection("in-side.b", "vector.u[2]", linear(10.0)),
        files=files,
    )
    one = load(path)
    assert list(one.components) == ["decay", "in_side_thru", "vector"]
    assert one.connections == [
        "decay.x * 6.0 - 1.0 -> in_side_thru.real in",
        "in_side_thru.real out * 10.0 -> vector.u[2]",
    ]
    found = ran_here(path, tmp_path / "out")
    x = found["decay.x"]
    np.testing.assert_allclose(found["in_side_thru.real out"][1:], 6.0 * x[:-1] - 1.0, rtol=1e-14)


def test_connections_lead_where_the_kinds_of_connectors_say(tmp_path, files):
    """Start and end do not tell; an empty name is none, and is the system's. Through a nested system."""
    nested = system(
        "inner",
        {"in": "input", "out": "output"},
        component("through", "feedthrough", THROUGH),
        '<ssd:Connection startElement="through" startConnector="real in" endElement="" endConnector="in"/>'
        + connection(".out", "through.real out"),
    )
    parts = component("decay", "dahlquist", DECAY) + component("shaft", "shaft", SHAFT) + nested
    joined = connection("inner.in", "decay.x") + connection("shaft.height", "inner.out")
    found = lines(package(tmp_path / "a.ssp", parts, joined, files=files))
    assert sorted(found) == [
        "decay.x -> inner_through.real in", "inner_through.real out -> shaft.height",
    ]  # fmt: skip


def test_harmless_departures_are_told(tmp_path, files, caplog):
    """A unit in brackets, and the value of an input that is connected."""
    values = binding({"real in": 'Real value="3" unit="[mm]"', "offset": 'Real value="2" unit="[mm]"'})
    parts = component("decay", "dahlquist", DECAY) + component("through", "feedthrough", THROUGH, values)
    path = package(tmp_path / "a.ssp", parts, connection("decay.x", "through.real in"), files=files)
    with caplog.at_level("WARNING"):
        table = load(str(path)).components["through"]
    assert table.inputs == {}
    assert [text for text in caplog.messages if "[mm]" in text] == [
        "a.ssp: through: the unit [mm] is taken as mm"
    ]
    assert "through.real in is connected: its value is left out" in caplog.text


@pytest.mark.parametrize("kind", ["definition", "package"])
def test_a_system_may_be_in_a_file_of_its_own(kind, tmp_path, files):
    """Its sources are relative to it; its own values are weaker than those around it."""
    thru = component("thru", "feedthrough", {"real in": "input", "real out": "output"})
    bound = binding({"thru.offset": 'Real value="0.5"', "thru.count": 'Integer value="3"'})
    inner = package(
        tmp_path / "inner.ssp",
        thru,
        connection(".a", "thru.real in", linear(2.0, 1.0)) + connection("thru.real out", ".b"),
        inside=connectors({"a": "input", "b": "output"}) + bindings(bound),
        files={"resources/feedthrough.fmu": files["resources/feedthrough.fmu"]},
    )
    with zipfile.ZipFile(inner) as archive:
        structure = archive.read("SystemStructure.ssd")
    more = {"resources/inner.ssp": inner.read_bytes()}
    if kind == "definition":
        more = {"resources/inner.ssd": structure.replace(b"resources/", b"../resources/")}
    outer = binding({"thru.offset": 'Real value="0.25"'})
    element = component("inside", "inner", {"a": "input", "b": "output"}, outer).replace(
        'x-fmu-sharedlibrary" source="resources/inner.fmu"',
        f'x-ssp-{kind}" source="resources/inner.{"ssd" if kind == "definition" else "ssp"}"',
    )
    path = package(
        tmp_path / "a.ssp",
        component("decay", "dahlquist", DECAY) + element + component("vector", "vector", VECTOR),
        connection("decay.x", "inside.a") + connection("inside.b", "vector.u[2]"),
        files=files | more,
    )
    one = load(path)
    assert list(one.components) == ["decay", "inside_thru", "vector"]
    assert one.connections == [
        "decay.x * 2.0 + 1.0 -> inside_thru.real in",
        "inside_thru.real out -> vector.u[2]",
    ]
    assert one.components["inside_thru"].parameters == {"offset": 0.25, "count": 3.0}


def test_units_are_converted_then_transformed(tmp_path, files):
    """m to mm, then 2 x + 1: `the value is already converted to the target unit` (SSP 1.0, factor)."""
    given = component("thru", "feedthrough", THROUGH, binding({"real in": 'Real value="0.25"'}))
    elements = given + "".join(component(f"shaft{i}", "shaft", SHAFT) for i in range(4))
    path = package(
        tmp_path / "a.ssp",
        elements,
        connection("thru.real out", "shaft0.height")
        + connection("thru.real out", "shaft1.height", linear(2.0, 1.0))
        + connection("thru.real out", "shaft2.height", linear(2.0, 1.0), 'suppressUnitConversion="true"')
        + connection("thru.real out", "shaft3.height", "", 'suppressUnitConversion="true"'),
        after=UNITS,
        files=files,
    )
    found = ran_here(path, tmp_path / "out")
    for i, expected in enumerate((250.0, 501.0, 1.5, 0.25)):
        np.testing.assert_allclose(found[f"shaft{i}.reached"], expected, rtol=1e-14)


def test_values_come_by_every_way(tmp_path, files):
    """Inner ones give way to outer ones; mapped with a factor; by a path; by a connector of the system; with
    a prefix; in another unit."""
    mapped = '<ssm:MappingEntry source="rate" target="one.k">' + linear(2.0, 0.5) + "</ssm:MappingEntry>"
    inside = connectors({"start": "parameter"}) + bindings(
        binding({"rate": 'Real value="1.5"', "unused": 'Real value="9"'}, mapped),
        binding({"two.k": 'Real value="4"', "start": 'Real value="0.125"'}),
        binding({"k": 'Real value="7"'}, more='prefix="three."'),
        binding({"thru.real in": 'Real value="250" unit="mm"', "thru.count": 'Integer value="3"'}),
        binding({"thru.negate": 'Boolean value="true"'}),
    )
    own = binding({"k": 'Real value="99"', "x": 'Real value="2"'})
    elements = "".join(component(name, "dahlquist", DECAY, own) for name in ("one", "two", "three"))
    path = package(
        tmp_path / "a.ssp",
        elements + component("thru", "feedthrough", THROUGH),
        connection(".start", "two.x"),
        inside=inside,
        after=UNITS,
        files=files,
    )
    tables = load(path).components
    assert {name: tables[name].parameters for name in ("one", "two", "three")} == {
        "one": {"k": 3.5},
        "two": {"k": 4.0},
        "three": {"k": 7.0},
    }
    assert [tables[name].start["x"] for name in ("one", "two", "three")] == [2.0, 0.125, 2.0]
    assert tables["thru"].inputs == {"real in": 0.25}
    assert tables["thru"].parameters == {"count": 3.0, "negate": True}


def test_a_package_is_written_as_a_scenario(tmp_path, files):
    path = package(tmp_path / "a.ssp", component("decay", "dahlquist", DECAY), files=files)
    done = called("ssp", "import", str(path), "--out", str(tmp_path / "folder"))
    assert done.returncode == 0, done.stderr
    written = tmp_path / "folder" / "other.toml"
    assert 'participant = "resources/dahlquist.fmu"' in written.read_text()
    one, other = load(path), load(written)
    plain = {"components": {}}
    assert one.model_copy(update=plain) == other.model_copy(update=plain)


PARTS = component("decay", "dahlquist", DECAY | {"y": "output"}) + component("vector", "vector", VECTOR)
TRANSFORMED = (
    '<ssc:BooleanMappingTransformation><ssc:MapEntry source="true" target="false"/>'
    "</ssc:BooleanMappingTransformation>"
)
CIRCLE = system("s", {"a": "inout", "b": "inout"}, PARTS, connection(".a", ".b"))


def _source(new: str, old: str = "resources/dahlquist") -> dict[str, str]:
    """The parts, with another source of the decay."""
    return {"elements": PARTS.replace(old, new)}


def _joined(*ends: str, inside: str = "", times: int = 1) -> dict[str, str]:
    """The parts, with that connection so often."""
    return {"connections": times * connection(*ends, inside)}


# What a package has instead of the parts alone, and what is said of it.
REFUSED: dict[str, tuple[dict[str, str], str]] = {
    "start": ({"experiment": 'startTime="1" stopTime="2"'}, r"startTime = 1 s: runs begin at 0"),
    "type": (_source("x-table", "x-fmu-sharedlibrary"), "components are FMUs or SSP systems here"),
    "itself": (
        _source('x-ssp-definition" source="SystemStructure.ssd',
                'x-fmu-sharedlibrary" source="resources/dahlquist.fmu'),
        "contains itself",
    ),
    "elsewhere": (_source("https://host/dahlquist"), "not in this package"),
    "outside": (_source("../dahlquist"), "not in this package"),
    "outside on Windows": (_source(r"..\dahlquist"), "not in this package"),
    "lost": (_source("resources/other"), r"other.fmu is not in the package"),
    "text": (
        {"elements": component("decay", "dahlquist", DECAY, binding({"k": 'String value="much"'}))},
        "k is a String in the set, but not in",
    ),
    "unit": (
        {"elements": component("a", "feedthrough", THROUGH, binding({"real in": 'Real value="1" unit="K"'}))},
        "K does not fit",
    ),
    # Between a system inside and that around it; a value would go round without end.
    "circle": (
        {"elements": CIRCLE, "connections": connection("s.b", "s.a"),
         "inside": bindings(binding({"s.a": 'Real value="1"'}))},
        r"s\.a: its connections lead back to it; take one out",
    ),
    "table": (_joined("decay.x", "vector.u[1]", inside=TRANSFORMED), "has 1 entries; give it all that occur"),
    "twice": (_joined("decay.x", "vector.u[1]", times=2), "two sources"),
    "element": (_joined("decoy.x", "vector.u[1]"), "names no element 'decoy'"),
    "parameter": (_joined("vector.y[1]", "decay.k"), "only inputs are connected here"),
    "output": (
        _joined("decay.y", "vector.u[1]"),
        r"from decay\.y to vector\.u\[1\]: decay has no output 'y'; .*\bx\b",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("changes", "said"), REFUSED.values(), ids=REFUSED)
def test_what_is_not_supported_is_refused_by_name(changes, said, tmp_path, files):
    path = package(tmp_path / "a.ssp", **{"elements": PARTS} | changes, files=files, after=UNITS)
    with pytest.raises(ValueError, match=said):
        load(path)


LINE = r"SystemStructure\.ssd, line 1: .*"
DAMAGED = {
    "number": ('factor="2.0"', 'factor="two"', LINE),
    "name": ('startConnector="x"', "", LINE),
    # Parameter sets inside the file have another schema, which its own does not call.
    "value": ('value="3"', 'value="three"', "could not convert string to float: 'three'"),
    "unit": ('factor="0.001"', 'factor="milli"', LINE),
    "end": ('stopTime="1"', 'stopTime="late"', LINE),
}


@pytest.mark.parametrize("case", DAMAGED)
def test_what_is_not_as_the_schema_has_it_is_refused_with_its_line(case, tmp_path, files):
    elements = component("decay", "dahlquist", DECAY, binding({"k": 'Real value="3"'}))
    elements += component("vector", "vector", VECTOR)
    connected = connection("decay.x", "vector.u[1]", linear(2.0))
    path = package(tmp_path / "a.ssp", elements, connected, files=files, after=UNITS)
    replace_text(path, tmp_path / "b.ssp", *DAMAGED[case][:2], "SystemStructure.ssd")
    with pytest.raises(ValueError, match=rf"b\.ssp: not as SSP has it: .*{DAMAGED[case][2]}; correct"):
        load(tmp_path / "b.ssp")


def test_a_damaged_file_is_named_where_another_is_no_number(tmp_path, files):
    path = package(tmp_path / "a.ssp", component("decay", "dahlquist", DECAY), files=files)
    replace_text(path, tmp_path / "b.ssp", 'stopTime="1"', 'stopTime="late"', "SystemStructure.ssd")
    with zipfile.ZipFile(tmp_path / "b.ssp", "a") as archive:
        archive.writestr("A.ssv", "<open")
    with pytest.raises(ValueError, match=r"b\.ssp: not as SSP has it: A\.ssv: .*; correct"):
        load(tmp_path / "b.ssp")


def test_what_is_no_package_is_refused(tmp_path):
    (tmp_path / "a.ssp").write_bytes(b"no archive")
    with pytest.raises(ValueError, match="so not an SSP"):
        load(tmp_path / "a.ssp")
    with zipfile.ZipFile(tmp_path / "b.ssp", "w") as archive:
        archive.writestr("readme.txt", "hello")
    with pytest.raises(ValueError, match=r"SystemStructure\.ssd is missing, so this is not an SSP"):
        load(tmp_path / "b.ssp")


def test_a_package_that_was_cut_off_is_damaged(tmp_path, files):
    """Though an FMU in it, which is an archive too, is whole: packages have them uncompressed."""
    path = tmp_path / "a.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
        archive.writestr("SystemStructure.ssd", "")
    whole = path.read_bytes()
    path.write_bytes(whole[: whole.index(b"SystemStructure.ssd")])
    assert zipfile.is_zipfile(path)
    with pytest.raises(ValueError, match=r"a\.ssp: damaged archive: a part of it is missing"):
        load(path)


def test_a_file_that_is_there_is_not_replaced_unasked(tmp_path):
    path = tmp_path / "made.ssp"
    path.write_text("mine")
    shown = called("ssp", "export", "two-masses", "--out", str(path))
    assert shown.returncode == 2
    assert "made.ssp: is already there; choose another --out, or replace it with --overwrite" in shown.stderr
    assert path.read_text() == "mine"
    assert called("ssp", "export", "two-masses", "--out", str(path), "--overwrite").returncode == 0
    assert zipfile.is_zipfile(path)
