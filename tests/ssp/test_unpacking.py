"""Packages are unpacked whole or not at all, and no larger than one package may be."""

import io
import os
import zipfile
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from orchestrator.scenario import Scenario, build_scenario
from orchestrator.scenario.files import list_shipped, load, override, read_contents
from orchestrator.scenario.ssp import export, read_package, unpack
from tests.archives import repack, replace_text
from tests.fmus.names import mark_long
from tests.third_party.c_fmus import fmu
from tests.third_party.runs import ran
from tests.third_party.runs import scenario as foreign_scenario
from tribocosim.cached_fmus import build_fmu

from .packages import assert_valid


def pack(files: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return stream.getvalue()


@pytest.fixture
def cache(tmp_path):
    return tmp_path / "cache"


def occupied(folder: Path) -> int:
    return sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())


@pytest.mark.parametrize("nested", [False, True])
def test_packages_inside_have_one_limit_together(nested, tmp_path, cache, monkeypatch):
    """Each is below the limit alone; nothing stays of what is refused."""
    monkeypatch.setattr(unpack, "MAXIMUM_UNPACKED_BYTES", 1_000_000)
    large = pack({"large": bytes(400_000)})
    if nested:
        inner = {"one.ssp": pack({"large": bytes(400_000), "two.ssp": pack({"x": bytes(700_000)})})}
    else:
        inner = {f"{name}.ssp": large for name in ("one", "two", "three")}
    path = tmp_path / "a.ssp"
    path.write_bytes(pack({"SystemStructure.ssd": b"", **inner}))
    with pytest.raises(ValueError, match=r"(two|three)\.ssp: .* bytes when unpacked: must be .* with"):
        load(path)
    assert occupied(cache) == 0


@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({"large": bytes(400_000)}, r"SystemStructure\.ssd is missing"),
        (
            {"SystemStructure.ssd": b"", "../modelDescription.xml": b""},
            "leaves the archive; not safe to unpack",
        ),
    ],
)
def test_nothing_stays_of_a_package_that_is_refused(files, said, tmp_path, cache):
    (tmp_path / "a.ssp").write_bytes(pack(files))
    with pytest.raises(ValueError, match=said):
        load(tmp_path / "a.ssp")
    assert occupied(cache) < 100


@pytest.mark.parametrize("damage", [b"\0", b""])
def test_a_damaged_file_in_the_cache_is_unpacked_again(damage, tmp_path, cache):
    """As a power cut leaves it: zeroed or empty."""
    path = tmp_path / "a.ssp"
    path.write_bytes(pack({"extra.txt": b"text"}))
    folder = unpack.unpack_into_cache(path)
    before = os.stat(folder).st_ino
    assert os.stat(unpack.unpack_into_cache(path)).st_ino == before
    for file in folder.rglob("*"):
        file.write_bytes(damage * file.stat().st_size)
    assert unpack.unpack_into_cache(path) == folder
    assert (folder / "extra.txt").read_text() == "text"


# With vectors, a table beside the file, conversions and a common oil; the others build many FMUs.
NAMES = mark_long(list_shipped(), ["coil-clash", "my-cam", "quarter-car"])


def round_trip(scenario: Scenario, folder: Path, version: str = "1.0") -> Scenario:
    export(scenario, folder / "made.ssp", build_fmu, version)
    return load(folder / "made.ssp")


@pytest.mark.parametrize("version", [pytest.param("1.0"), pytest.param("2.0", marks=pytest.mark.long)])
@pytest.mark.parametrize("name", NAMES)
def test_every_shipped_scenario_comes_back(name, version, tmp_path):
    scenario = load(name)
    back = round_trip(scenario, tmp_path, version)
    # An oil comes back as the parameters that it has become.
    assert back.model_dump() == scenario.model_dump()
    # Which says nothing of the order, by which some masters go.
    assert list(back.components) == list(scenario.components)
    assert_valid(tmp_path / "made.ssp")


POSITIVE = st.floats(1e-12, 1e12, allow_nan=False)
CHANGES = st.fixed_dictionaries(
    {},
    optional={
        "stop_time": st.floats(1e-2, 1e6),
        "description": st.text(st.characters(codec="utf-8", exclude_categories=["C", "Z"]), max_size=30),
        "master": st.sampled_from(
            [
                {"name": "jacobi", "extrapolation": "hermite"},
                {"name": "gauss_seidel", "order": ["second", "first"]},
                {"name": "iterated", "tolerance": 1e-7, "acceleration": "aitken"},
            ]
        ),
        "event_tolerance": st.floats(1e-12, 1e-6),
        "energy": st.fixed_dictionaries({"ledger": st.booleans()}),
        "reference": st.fixed_dictionaries({"tolerance": st.floats(1e-14, 0.5)}),
        "tolerance": st.dictionaries(
            st.sampled_from(["first.position", "second.velocity", "first.force"]), POSITIVE, min_size=1
        ),
    },
)
TABLES = st.fixed_dictionaries(
    {},
    optional={
        "substeps": st.integers(1, 50),
        "retries": st.integers(0, 9),
        "process": st.sampled_from(["shared", "own"]),
        "participant": st.sampled_from(["fmu", "in-process"]),
        "start": st.dictionaries(st.sampled_from(["position", "velocity"]), st.floats(-1e9, 1e9)),
        "parameters": st.dictionaries(st.sampled_from(["mass", "stiffness", "damping"]), POSITIVE),
    },
).filter(lambda table: table.get("process") != "own" or table.get("participant") == "fmu")


@given(changes=CHANGES, first=TABLES, second=TABLES)
@settings(
    max_examples=15,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
def test_whatever_is_changed_comes_back_to_the_last_bit(changes, first, second, tmp_path):
    content: dict[str, Any] = read_contents(list_shipped()["two-masses"]) | changes
    content.pop("step_control", None)
    for name, table in (("first", first), ("second", second)):
        own = content["components"][name]
        content["components"][name] = own | {"participant": "in-process"} | table
    scenario = build_scenario(content)
    assert round_trip(scenario, tmp_path) == scenario


def test_third_party_fmus_go_and_come_back(tmp_path):
    """Each file once, byte for byte; factors, starts, elements, texts, and the results."""
    one = fmu("dahlquist", 2, tmp_path)
    tables = {
        "decay": {"participant": one, "parameters": {"k": 3.0}, "start": {"x": 0.1}, "process": "own"},
        "other": {"participant": one},
        "thru": {
            "participant": fmu("feedthrough", 3, tmp_path),
            "parameters": {"negate": True, "count": 2},
            "inputs": {"whole_in": 4.0},
        },
        "table": {
            "participant": fmu("reading", 3, tmp_path),
            "parameters": {"table file": "µ/a \"b\" 'c' \\ #.csv", "scale": 2.0},
        },
    }
    lines = ["decay.x * 0.1 - 7.0 -> thru.real in"]
    scenario = foreign_scenario(tables, connections=lines)
    back = round_trip(scenario, tmp_path)
    places = {name: Path(table.participant) for name, table in back.components.items()}
    assert places["decay"] == places["other"]
    for name, table in scenario.components.items():
        assert places[name].read_bytes() == Path(table.participant).read_bytes()
    same = {
        name: table.model_copy(
            # Who runs the package decides anew whether its FMUs come into the run's process.
            update={key: getattr(scenario.components[name], key) for key in ("participant", "process")}
        )
        for name, table in back.components.items()
    }
    assert back.model_copy(update={"components": same}) == scenario
    assert_valid(tmp_path / "made.ssp")
    (_, first), (_, second) = ran(scenario, tmp_path / "first"), ran(back, tmp_path / "second")
    assert {name: column.tolist() for name, column in first.items()} == {
        name: column.tolist() for name, column in second.items()
    }


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The package of two masses."""
    path = tmp_path_factory.mktemp("package") / "made.ssp"
    export(load("two-masses"), path, build_fmu)
    return path


def test_the_same_scenario_is_the_same_file(made, tmp_path):
    export(load("two-masses"), tmp_path / "other.ssp", build_fmu)
    assert (tmp_path / "other.ssp").read_bytes() == made.read_bytes()


def test_a_value_changed_in_the_package_is_changed_in_the_scenario(made, tmp_path):
    """What other tools edit: values and connections are those of the standard's files, not a copy of ours."""
    edited = tmp_path / "edited.ssp"
    replace_text(made, edited, 'value="5.0"', 'value="6.5"', "resources/first.ssv")
    assert load(edited).components["first"].parameters["mass"] == 6.5


def test_another_fmu_in_the_package_is_taken_for_what_it_is(made, tmp_path):
    """By its checksum, though it is still the same archive; the component's own is built anew."""
    file = "resources/sprung_mass.fmu"
    edited = repack(made, tmp_path / "edited.ssp", lambda n, c: {n: c + b"\0" if n == file else c})
    tables = load(edited).components
    assert tables["first"].participant == "fmu"
    assert tables["second"].participant.endswith("resources/sprung_mass.fmu")
    assert tables["second"].component == "sprung_mass"


def test_a_package_decides_nothing_that_is_the_users(made, tmp_path):
    """It can name no file outside of it and no code, and keeps its FMUs out of the run's process."""
    file, path = "SystemStructure.ssd", made
    for old, new in (
        ('"component": "sprung_mass"', '"process": "shared", "component": "code:factory"'),
        ('{"name": "two-masses"', '{"extends": "/etc/passwd", "name": "two-masses"'),
        ('"component": "coupled_mass"', '"lift_table": "/etc/passwd", "component": "coupled_mass"'),
    ):
        path = replace_text(path, tmp_path / f"{len(new)}.ssp", old, new, file)
    assert "lift_table" not in read_package(path)["components"]["first"]
    second = load(path).components["second"]
    assert second.third_party
    assert second.process is None
    assert Path(second.participant).is_relative_to(tmp_path)


def test_settings_are_changed_as_those_of_a_scenario(made):
    settings = ["macro_step=1 ms", "components.first.parameters.mass=7 kg"]
    expected = read_contents(list_shipped()["two-masses"])
    override(expected, settings)
    assert load(made, settings) == build_scenario(expected)


def test_the_name_of_a_package_is_an_identifier(tmp_path):
    """Which some tools demand; the scenario has its own name again."""
    export(load("quarter-car"), tmp_path / "made.ssp", build_fmu)
    with zipfile.ZipFile(tmp_path / "made.ssp") as archive:
        assert b'name="quarter_car"' in archive.read("SystemStructure.ssd")
    assert load(tmp_path / "made.ssp").name == "quarter-car"
