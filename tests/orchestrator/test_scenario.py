"""Scenario files: complete, the same after being written; units are converted exactly, or refused by name."""

import math
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

import tribocosim
from orchestrator.scenario import Scenario, ScenarioError, build_scenario, schema
from orchestrator.scenario.conversion import convert_units
from orchestrator.scenario.files import list_shipped, load, override, read_changed, to_full_toml
from orchestrator.scenario.system import build_system
from orchestrator.scenario.units import FACTORS, ZEROS, UnitError, find_conversion, to_unit
from orchestrator.scenario.warnings import describe_turns, list_warnings

# Of tens of instances: compiling their kernels takes long.
LARGE = ("engine-16v", "pushrod-engine", "valve-train-16v")


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.long) if name in LARGE else name
        for name in sorted(list_shipped())
    ],
)
def test_written_scenario_gives_the_same_system_bit_for_bit(name):
    """Nor is any of its values doubted: written out, the numbers have no units."""
    scenario = load(name)
    assert scenario.name == name
    assert scenario.description
    assert scenario.tolerance
    text = to_full_toml(scenario)
    again = build_scenario(tomllib.loads(text))
    assert to_full_toml(again) == text
    assert not [line for line in list_warnings(again) if "did you mean" in line]
    one, two = build_system(scenario), build_system(again)
    for vector in ("x0", "u0", "p"):
        assert np.array_equal(getattr(one, vector), getattr(two, vector))
    assert [str(c) for c in one.connections] == [str(c) for c in two.connections]
    assert (again.macro_step, again.stop_time, again.master) == (
        scenario.macro_step,
        scenario.stop_time,
        scenario.master,
    )


def test_published_schema_is_current():
    """Otherwise: tribocosim scenarios --schema > docs/scenario.schema.json"""
    published = Path(__file__).parents[2] / "docs" / "scenario.schema.json"
    assert published.read_text("utf-8") == schema.write_schema()


def test_schema_knows_every_key_and_variable():
    made = schema.build_schema()
    assert set(made["properties"]) == {*Scenario.model_fields, "extends", "without"}
    text = schema.write_schema()
    assert '"coil_position(\\\\[' in text.replace("^", "")
    assert "kushwaha" in text


def test_extending_merges_tables_and_adds_connections(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text(
        'extends = "valve-train"\nmacro_step = "1 us"\n'
        'connections = ["contact.friction_force -> camshaft.friction_force"]\n'
        "[components.camshaft.parameters]\nlift = '9 mm'\n"
        '[components.contact]\nparticipant = "parts/contact.fmu"\n'
    )
    base, mine = load("valve-train"), load(file)
    assert mine.name == "mine"
    assert mine.macro_step == 1e-6
    assert mine.components["camshaft"].parameters["lift"] == 9e-3
    assert mine.components["flywheel"] == base.components["flywheel"]
    assert mine.connections == [*base.connections, "contact.friction_force -> camshaft.friction_force"]
    assert mine.components["contact"].participant == str(tmp_path / "parts" / "contact.fmu")


def test_a_file_that_is_set_is_beside_who_sets_it(tmp_path, monkeypatch):
    """That of the scenario's own file is beside that; both are found from everywhere."""
    (tmp_path / "there").mkdir()
    (tmp_path / "here").mkdir()
    file = tmp_path / "there" / "mine.toml"
    file.write_text('extends = "valve-train"\n[components.contact]\nparticipant = "contact.fmu"\n')
    monkeypatch.chdir(tmp_path / "here")
    found = load(file, ["components.camshaft.participant=../cam.fmu"]).components
    assert Path(found["contact"].participant) == tmp_path / "there" / "contact.fmu"
    assert Path(found["camshaft"].participant) == tmp_path / "here" / ".." / "cam.fmu"
    assert found["flywheel"].participant == "fmu"


def test_overrides_have_the_meaning_of_the_file():
    scenario = load(
        "valve-train",
        [
            "macro_step=2 us",
            "components.camshaft.parameters.flexible=true",
            "components.flywheel.parameters.initial_speed=600 r/min",
            "components.contact.parameters.film_model=dowson_toyoda",
            "components.valve_spring.structure={coil_masses=3}",
            "components.valve_spring.start.coil_position[3]=1 um",
            "tolerance.contact.load=1e-4",
            "tolerance.camshaft.drive_torque=1e-2",
        ],
    )
    assert scenario.macro_step == 2e-6
    assert scenario.components["camshaft"].parameters["flexible"] is True
    assert scenario.components["flywheel"].parameters["initial_speed"] == pytest.approx(20.0 * np.pi)
    assert scenario.components["valve_spring"].start["coil_position[3]"] == 1e-6
    assert scenario.tolerance["contact.load"] == 1e-4
    assert scenario.tolerance["camshaft.drive_torque"] == 1e-2
    build_system(scenario)


def test_a_number_for_an_array_is_that_of_every_element_without_its_own():
    """Both orders, with a unit, in any table of values."""
    for values in (["gap=0.9 mm", "gap[2]=1 mm"], ["gap[2]=1 mm", "gap=0.9 mm"]):
        spring = load("coil-clash", [f"components.spring.parameters.{value}" for value in values])
        given = spring.components["spring"].parameters
        assert [given[f"gap[{i}]"] for i in range(1, 10)] == [9e-4, 1e-3, *([9e-4] * 7)]
    start = load("coil-clash", ["components.spring.start.coil_position=1 um"]).components["spring"].start
    assert {start[f"coil_position[{i}]"] for i in range(1, 9)} == {1e-6}


def test_the_speed_after_the_ramp_is_that_before_it_unless_given():
    """One parameter states a constant speed."""

    def speeds(*values):
        overrides = [f"components.flywheel.parameters.{value}" for value in values]
        given = build_system(load("valve-train", overrides)).instances["flywheel"].parameters
        return given["initial_speed"], given["final_speed"]

    high = pytest.approx(100.0 * np.pi, rel=1e-15)
    assert speeds("initial_speed=3000 rpm") == (high, high)
    low, after = speeds("initial_speed=600 rpm", "final_speed=3000 rpm")
    assert (low, after) == (pytest.approx(20.0 * np.pi), high)


def test_durations_may_be_given_in_revolutions_of_the_drive():
    turned = load("valve-train", ["stop_time=2 revolutions", "macro_step=0.03 deg", "output_step=0.12 deg"])
    assert (turned.stop_time, turned.macro_step, turned.output_step) == (0.12, 5e-6, 20e-6)
    fast = load("valve-train", ["stop_time=2 rev", "components.flywheel.parameters.initial_speed=3000 rpm"])
    assert fast.stop_time == 0.04


def test_shipped_trains_make_two_revolutions_at_any_speed_and_a_run_says_how_many_it_makes():
    for name in (
        "seat-and-lash",
        "finger-follower",
        "direct-acting-hla",
        "finger-follower-hla",
        "pushrod-train",
    ):
        assert load(name).stop_time == 0.12
        assert load(name, ["components.flywheel.parameters.initial_speed=2000 rpm"]).stop_time == 0.06
    (said,) = describe_turns(load("valve-train", ["components.flywheel.parameters.initial_speed=2000 rpm"]))
    assert said == "the drive makes 4 revolutions at 2000 r/min: stop_time = 0.12 s"
    for changed in (["components.flywheel.parameters.final_speed=2000 rpm"], None):
        assert not describe_turns(load("valve-train", changed) if changed else load("two-masses"))


def test_another_master_keeps_the_options_that_it_has():
    content = read_changed("valve-train", ["master.name=iterated", "master.tolerance=1e-8"])
    assert build_scenario(content).master.build().tolerance == 1e-8
    override(content, ["master.name=jacobi"])
    second = build_scenario(content).master.build()
    assert second.extrapolation == load("valve-train").master.build().extrapolation


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (["master.tolerance=1e-8", "master.name=jacobi"], "master.tolerance: jacobi has no such option"),
        (
            ["components.camshaft.parameters.lift=9 mm", "components.camshaft.lift_table=lift.csv"],
            "parameters.lift: has no meaning beside lift_table",
        ),
        (["oil.density_15=860", "oil=SAE 5W-30"], "oil.density_15: oil is not a table|oil: a part of it is"),
    ],
)
def test_settings_that_exclude_each_other_are_refused_in_any_order(settings, said):
    for ordered in (settings, settings[::-1]):
        with pytest.raises(ScenarioError, match=said):
            load("valve-train", ordered)


def test_a_setting_within_an_oil_keeps_its_other_numbers():
    content = {"oil": {"viscosity_40": "90 mm2/s", "density_15": 870}}
    override(content, ["oil.density_15=860"])
    assert content["oil"] == {"viscosity_40": "90 mm2/s", "density_15": 860}


def test_a_scenario_does_not_take_the_description_of_the_one_that_it_extends(tmp_path):
    own = tmp_path / "mine.toml"
    own.write_text('extends = "valve-train"\nstop_time = "1 ms"\n')
    assert (load(own).name, load(own).description) == ("mine", "")


@pytest.mark.parametrize(("suffix", "use"), [(".fmu", "participant = 'file.fmu'"), (".csv", "lift_table")])
def test_files_of_other_kinds_are_told_their_place(tmp_path, suffix, use):
    other = tmp_path / f"other{suffix}"
    other.write_bytes(b"\x9d;")
    with pytest.raises(ScenarioError, match=re.escape(use)):
        load(other)


@pytest.mark.parametrize("name", ["..", ".", "", "a/b"])
def test_a_name_is_that_of_a_folder_below_the_results(name):
    with pytest.raises(ScenarioError, match=r"name = .*: must have a letter or digit, and only"):
        load("two-masses", [f"name={name!r}"])


PER_MINUTE = (
    "r/min",
    "rev/min",
    "RPM",
    "U/min",
    "u/min",
    "Upm",
    "tr/min",
    "tours/min",
    "giri/min",
    "giri / min",
)


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("8 mm", "m", 8e-3),
        ("5 us", "s", 5e-6),
        ("2 µm", "m", 2e-6),
        ("1000 rpm", "rad/s", 1000.0 * math.pi / 30.0),
        *((f"30 {unit}", "rad/s", math.pi) for unit in PER_MINUTE),
        ("20 degree", "rad", math.radians(20.0)),
        ("-20°", "rad", -math.radians(20.0)),
        ("35 kN/m", "N/m", 35e3),
        ("920 N.s/m", "N.s/m", 920.0),
        ("300 kg.mm2", "kg.m2", 3e-4),
        ("18 1/GPa", "1/Pa", 1.8e-8),
        ("36 mPa.s", "Pa.s", 0.036),
        ("5 %", "1", 0.05),
        ("1.5e-3", "m", 1.5e-3),
        ("90 degC", "K", 363.15),
        ("-10 °C", "K", 263.15),
        ("20 K", "K", 20.0),
        ("2 J/degC", "J/K", 2.0),
        ("3.2 foo", "foo", 3.2),  # of an FMU
    ],
)
def test_conversion(text, unit, value):
    assert to_unit(text, unit) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "unit", "named"),
    [
        ("3 kg", "m", ("kg", "m")),
        ("10 Hz", "rad/s", ("Hz", "rad/s")),  # a frequency is no angular speed
        ("1000 rpm", "Hz", ("rpm", "Hz")),
        ("1 rad", "1", ("rad", "plain number")),
        ("3 foos", "m", ("foos", "known unit")),
        ("3 bars", "foo", ("foo", "plain number")),
        ("400 lb/in", "N/m", ("lb is a mass", "lbf/in")),
        ("30 kg/cm2", "Pa", ("kgf/cm2",)),
        ("eight mm", "m", ("eight mm", "'8 mm'")),
        ("", "m", ("''", "'8 mm'")),
        ("0,2 mm", "m", ("'0,2 mm': a decimal comma; write '0.2 mm', with a point",)),
        (",5", "1", ("write '.5', with a point",)),
        ("1.234,5 mm", "m", ("write '1234.5 mm', with a point",)),
        ("2,000 rpm", "rad/s", ("write '2.000 rpm', with a point, or '2000 rpm'",)),
        ("1,234.5 mm", "m", ("write '1234.5 mm', without commas",)),
        ("2000 1/min", "rad/s", ("1/min does not fit a speed; write '2000 rpm'",)),
        ("2000 min⁻¹", "rad/s", ("write '2000 rpm'",)),
        ("1 __import__('os')", "s", ("__import__", "known unit")),
    ],
)
def test_what_does_not_fit_is_named(text, unit, named):
    with pytest.raises(UnitError) as error:
        to_unit(text, unit)
    assert all(word in str(error.value) for word in named)


@pytest.mark.parametrize("pair", FACTORS, ids=" to ".join)
def test_factors_without_pint_are_pints(pair):
    assert (FACTORS[pair], ZEROS.get(pair, 0.0)) == find_conversion("1", *pair)


CELSIUS = ("Celsius", "deg_C", "deg C", "degrees C", "degree_Celsius", "Degrees Celsius", "°Celsius", "° C")


@pytest.mark.parametrize(
    ("given", "wanted", "value", "converted"),
    [
        ("degC", "K", 20.0, 293.15),
        ("K", "°C", 293.15, 20.0),
        ("℃", "K", 20.0, 293.15),
        ("degF", "degC", 100.0, (100.0 - 32.0) / 1.8),
        ("celsius", "degF", 100.0, 212.0),
        *((name, "K", 20.0, 293.15) for name in CELSIUS),
        ("deg_F", "degrees C", 68.0, 20.0),
        ("W/(m2.deg C)", "W/(m2.K)", 3.0, 3.0),
        ("delta_degC", "Kelvin", 20.0, 20.0),
        ("degR", "K", 9.0, 5.0),
        ("W/(m2.degC)", "W/(m2.K)", 3.0, 3.0),  # per degree of difference
        ("m²", "mm2", 1.0, 1e6),
    ],
)
def test_units_that_no_fmu_defines_keep_their_offset(given, wanted, value, converted):
    linear = convert_units(given, {}, wanted, {})
    assert linear is not None
    assert linear.factor * value + linear.offset == pytest.approx(converted, rel=1e-13)


def test_logarithmic_units_are_not_converted():
    assert convert_units("dB", {}, "1", {}) is None
    with pytest.raises(UnitError, match="dB"):
        to_unit("3 dB", "1")


def test_step_control_does_not_inherit_the_records_of_equal_steps(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text('extends = "valve-train"\n[step_control]\n')
    assert load("valve-train").output_step is not None
    assert load(file).output_step is None
    file.write_text('extends = "valve-train"\noutput_step = "1 ms"\n[step_control]\n')
    assert load(file).output_step == 1e-3


def test_a_changed_value_is_named_in_the_description():
    """Which may state another: at 1000 r/min."""
    speed = "components.flywheel.parameters.initial_speed"
    changed = load("valve-train", [f"{speed}=2000 rpm", f"{speed}=3000 rpm", "stop_time=20 ms"])
    assert changed.description == (
        "Valve train with rigid camshaft at 1000 r/min, two revolutions; changed: initial_speed = 3000 "
        "rpm, stop_time = 20 ms"
    )
    assert load("valve-train", ["master.name=jacobi"]).description == load("valve-train").description


def write(folder: Path, text: str, base: str = "valve-train") -> Path:
    file = folder / "mine.toml"
    file.write_text(f'extends = "{base}"\n{text}')
    return file


def test_a_component_leaves_with_its_connections_and_tolerances(tmp_path: Path) -> None:
    file = write(tmp_path, 'without = ["components.contact"]\ntolerance = { "camshaft.bending" = 1e-3 }\n')
    scenario, parent = load(file), load("valve-train")
    assert set(scenario.components) == set(parent.components) - {"contact"}
    assert scenario.connections == [line for line in parent.connections if "contact." not in line]
    assert set(scenario.tolerance) == {"camshaft.bending"}


def test_connections_and_keys_leave(tmp_path: Path) -> None:
    line = "contact.load  ->  valve_spring.load"  # whatever its blanks
    file = write(tmp_path, f'without = ["{line}", "tolerance.contact.load", "output_step"]\n')
    scenario, parent = load(file), load("valve-train")
    assert set(parent.connections) - set(scenario.connections) == {"contact.load -> valve_spring.load"}
    assert set(parent.tolerance) - set(scenario.tolerance) == {"contact.load"}
    assert (scenario.output_step, parent.output_step) == (None, 2e-5)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('without = ["components.contcat"]', "no 'components.contcat'; did you mean contact?"),
        (
            'without = ["contact.laod -> valve_spring.load"]',
            "did you mean contact.load -> valve_spring.load?",
        ),
        ('without = "components.contact"', "must be a list"),
        ('without = ["components.contact.parameters.mass.more"]', "no 'components.contact.parameters"),
        ("components.camshft.parameters.lift = 1", "toml:2: components.camshft.component: missing"),
        (
            "\n[components.camshft.parameters]\nlift = 1",
            "toml:3: components.camshft.component: missing; did you mean components.camshaft?",
        ),
        ("tolerance.contact.load = 1e-3", 'must be a number, without a unit; write "contact.load" = 0.001'),
    ],
)
def test_what_is_not_there_is_named(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(tribocosim.MistakeError, match=said.replace("?", r"\?")):
        load(write(tmp_path, text))


def test_without_needs_a_scenario_to_take_from(tmp_path: Path) -> None:
    (tmp_path / "alone.toml").write_text('without = ["stop_time"]\n')
    with pytest.raises(tribocosim.MistakeError, match="only beside extends"):
        load(tmp_path / "alone.toml")


@pytest.mark.parametrize("as_setting", [False, True])
def test_a_law_replaces_the_lift_table_of_the_other(as_setting: bool, tmp_path: Path) -> None:
    angle = np.arange(360)
    lift = 4.0 * (1.0 + np.cos(np.radians(np.clip(angle - 180, -60, 60) * 3.0)))
    rows = (f"{a},{s:.6f}" for a, s in zip(angle, lift, strict=True))
    (tmp_path / "cam.csv").write_text("\n".join(["cam_deg,lift_mm", *rows]))
    table = '[components.camshaft]\nlift_table = "cam.csv"\n'
    base = write(tmp_path, table).rename(tmp_path / "base.toml")
    assert load(base).components["camshaft"].structure["table_points"] > 0
    law = '[components.camshaft.parameters]\nlaw = "cycloidal"\n'
    changed = (
        load(base, ["components.camshaft.parameters.law=cycloidal"])
        if as_setting
        else load(write(tmp_path, law, "base.toml"))
    )
    assert changed.components["camshaft"].structure.get("table_points", 0) == 0
    assert changed.components["camshaft"].parameters["law"] == "cycloidal"
