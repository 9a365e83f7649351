"""Oils in scenarios: the same run as with their numbers, what is told, and what is refused."""

import io
from pathlib import Path

import pytest
from rich.console import Console

from models.contact.oil_grades import GRADES
from models.contact.oils import evaluate_oil
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.scenario import ScenarioError, build_scenario
from orchestrator.scenario.files import SHIPPED, list_shipped, load, read_contents, to_full_toml
from orchestrator.scenario.system import list_parameters
from orchestrator.scenario.warnings import list_oils, list_warnings
from tribocosim.cached_fmus import build_fmu

from .whole_runs import SHORT, assert_same_run, quiet

OIL = '[components.contact]\noil = "SAE 5W-30"\ntemperature = "90 degC"\n'
SHEET = (
    '[components.contact]\ntemperature = "90 degC"\noil = { viscosity_40 = "63 mm2/s", '
    'viscosity_100 = "11 mm2/s", density_15 = "855 kg/m3" }\n'
)


def write(folder: Path, text: str, base: str = "valve-train") -> Path:
    file = folder / "own.toml"
    file.write_text(f'extends = "{base}"\n{text}')
    return file


@pytest.mark.parametrize(
    ("base", "text"), [("valve-train", OIL), ("valve-train-ehl", SHEET)], ids=["grade", "sheet"]
)
def test_a_scenario_with_an_oil_is_the_one_with_its_numbers(tmp_path, base, text):
    """To the last bit, in what a run writes too, which needs no oil any more."""
    scenario = load(write(tmp_path, text, base))
    state = evaluate_oil(GRADES["SAE 5W-30"], 363.15)
    given = scenario.components["contact"].parameters
    for name in ("viscosity", "pressure_viscosity", "roelands_exponent"):
        assert given[name] == getattr(state, name)
    typed = "".join(f"{name} = {float(value)!r}\n" for name, value in given.items() if name in PARAMETERS)
    numbers = load(write(tmp_path, f"[components.contact.parameters]\n{typed}", base))
    written = to_full_toml(scenario)
    assert written == to_full_toml(numbers)
    assert "oil =" not in written
    assert list_oils(numbers) == []
    assert not any("contact.parameters" in line for line in list_warnings(scenario))


def test_what_a_run_writes_names_the_oil_of_the_scenario(tmp_path):
    """And takes its numbers from it, at another temperature too."""
    file = tmp_path / "written.toml"
    file.write_text(to_full_toml(load("seat-and-lash")))
    for changes in ([], ["temperature=40 degC"]):
        assert to_full_toml(load(file, changes)) == to_full_toml(load("seat-and-lash", changes))
        assert list_parameters(load(file, changes)) == list_parameters(load("seat-and-lash", changes))


PARAMETERS = (
    "viscosity", "pressure_viscosity", "roelands_exponent", "roelands_pressure", "temperature_viscosity",
)  # fmt: skip


def test_a_run_tells_what_it_takes_and_gives_the_bits_of_the_numbers(tmp_path):
    """The second run is made from what the first one wrote, which has the numbers only."""
    said = io.StringIO()
    file = write(tmp_path, OIL)
    first, second = tmp_path / "first", tmp_path / "second"
    run(load(file, SHORT), first, build_fmu, Reporter(Console(file=said, width=400)), figures=False)
    run(load(first / "scenario.toml"), second, build_fmu, quiet(), figures=False)
    assert_same_run(first, second, except_for=["notices"])
    state = evaluate_oil(GRADES["SAE 5W-30"], 363.15)
    line = next(line for line in said.getvalue().splitlines() if line.startswith("contact: SAE 5W-30"))
    assert f"at 90 degC has a viscosity of {1e3 * state.viscosity:.4g} mPa.s" in line
    assert f"coefficient of {1e9 * state.pressure_viscosity:.4g} 1/GPa" in line
    assert "a grade that allows 9.3 to 12.5 mm2/s at 100 degC" in line


def test_an_oil_replaces_that_of_the_scenario_below_as_a_whole(tmp_path):
    """A measured coefficient of another oil is not kept, nor a grade."""
    measured = SHEET.replace("855 kg/m3", '855 kg/m3", pressure_viscosity = "13 1/GPa')
    (tmp_path / "below.toml").write_text(f'extends = "valve-train"\n{measured}')
    for text in (SHEET, OIL):
        table = load(write(tmp_path, text, "below.toml")).components["contact"]
        assert table.parameters["pressure_viscosity"] == evaluate_oil(GRADES["SAE 5W-30"], 363.15)[1]
    below = load(tmp_path / "below.toml").components["contact"]
    assert below.parameters["pressure_viscosity"] == 13e-9


def test_contacts_with_the_same_oil_share_a_line():
    names = ["contact", "contact_2", "contact_3", "contact_4"]
    content = read_contents(SHIPPED / "valve-train.toml")
    table = {**content["components"]["contact"], "oil": "ISO VG 68", "temperature": "40 degC"}
    content["components"] |= dict.fromkeys(names, table)
    (line,) = list_oils(build_scenario(content))
    assert line.startswith("contact, contact_2, contact_3 and 1 more: ISO VG 68 at 40 degC has")
    assert line.endswith("allows +-10 % of 68 mm2/s at 40 degC")


def by_grade(line: str) -> str:
    """The oil by its grade, with this line in place of the one with the same key."""
    key = line.partition(" ")[0]
    rest = "".join(f"{other}\n" for other in OIL.splitlines() if not other.startswith(key))
    return f"{rest}{line}\n"


def by_sheet(data: str) -> str:
    return f'[components.contact]\ntemperature = "90 degC"\noil = {{ {data} }}\n'


VISCOSITIES = 'viscosity_40 = "63 mm2/s", viscosity_100 = "11 cSt"'
REFUSED = {
    by_grade('oil = "SAE 5W-3"'): r"oil = 'SAE 5W-3': no such grade; did you mean SAE 5W-30",
    by_grade("oil = 46"): r"oil = 46: must be the name of a grade, or a table",
    by_grade("temperature = 90"): r"= 90: without a unit this is 90 K; write '90 degC'",
    by_grade("temperature = -5"): r"temperature = -5: without a unit this is -5 K; write '-5 degC'",
    by_grade("temperature = 900"): r"temperature = 626.85 degC: must be -20 to 200 degC$",
    by_grade('temperature = "90 mm"'): r"temperature: '90 mm': the unit mm does not fit",
    by_grade('temperature = "-15 degC"'): r"= -15 degC: the oil has 1637 mm2/s, .* holds to 800",
    by_grade("parameters = { viscosity = 0.02 }"): r"viscosity = 0.02: the oil gives it too",
    by_grade('parameters = { pressure_viscosity = "15 1/GPa" }'): r"pressure_viscosity = '15 1/GPa'",
    by_sheet('viscosity_40 = "63 mm2/s", density_15 = 855'): r"oil.viscosity_100: missing",
    by_sheet("viscosity_40 = 63, viscosity_100 = 11, density_15 = 855"): r"oil.viscosity_40 = 6.3e\+07 mm2/s",
    by_sheet('viscosity_40 = "11 mm2/s", viscosity_100 = "63 mm2/s", density_15 = 855'): (
        r"oil.viscosity_100: gives the slope -2.99 of ASTM D341"
    ),
    by_sheet(
        'viscosity_40 = "63 mm2/s", viscosity_100 = "3 mm2/s", density_15 = 855'
    ): r"slope 6.59 .* 2 to 4.5",
    by_sheet(f"{VISCOSITIES}, density_15 = 0.855"): r"oil.density_15 = 0.855 kg/m3: must be 600 to 1300",
    by_sheet(f"{VISCOSITIES}, density_15 = 855, colour = 3"): r"oil.colour: unknown key",
    '[components.contact]\noil = "SAE 30"\n': r"temperature: missing beside oil",
    '[components.contact]\ntemperature = "90 degC"\n': r"oil: missing beside temperature",
    'oil = "SAE 5W-30"\n': r"temperature: missing beside oil",
    'oil = "SAE 5W-3"\ntemperature = "90 degC"\n': r"oil = 'SAE 5W-3': no such grade",
    'oil = "SAE 30"\ntemperature = 90\n': r"= 90: without a unit this is 90 K; write '90 degC'",
    'oil = "SAE 30"\ntemperature = "90"\n': r"; write '90 degC'",
    'oil = "SAE 30"\ntemperature = "90 degC"\n[components.contact]\ntemperature = "110 degC"\n': (
        r"components.contact.oil: missing beside temperature; set temperature = '110 degC' of the scenario, "
        r"which every part has, or give this part its own oil, e.g. oil = 'SAE 5W-30'"
    ),
    'oil = "SAE 30"\ntemperature = "90 degC"\n[components.contact]\noil = "SAE 5W-30"\n': (
        r"components.contact.temperature: missing beside oil; set oil = 'SAE 5W-30' of the scenario, "
        r"which every part has, or give this part its own temperature, e.g. temperature = '90 degC'"
    ),
}


@pytest.mark.parametrize("text", REFUSED)
def test_what_is_no_oil_is_refused_with_its_remedy(tmp_path, text):
    with pytest.raises(ScenarioError, match=REFUSED[text]):
        load(write(tmp_path, text))


@pytest.mark.parametrize(
    ("base", "part"), [("shaft-in-bearings", "bearing_1"), ("direct-acting-hla", "adjuster")]
)
def test_parts_with_a_viscosity_alone_take_that_of_the_oil(tmp_path, base, part):
    text = OIL.replace("contact", part)
    given = load(write(tmp_path, text, base)).components[part].parameters
    assert given["viscosity"] == evaluate_oil(GRADES["SAE 5W-30"], 363.15).viscosity
    assert "pressure_viscosity" not in given


ONE_OIL = 'oil = "SAE 5W-30"\ntemperature = "100 degC"\n'
HOT = evaluate_oil(GRADES["SAE 5W-30"], 373.15)
OILED = {
    "finger-follower-hla": ("cam_contact", "valve_contact", "adjuster"),
    "shaft-in-bearings": ("contact", "bearing_1", "bearing_2"),
    "rocker-friction": ("cam_contact", "valve_contact"),
    "engine": ("contact", "upper_wall", "lower_wall"),
}


@pytest.mark.parametrize("base", OILED)
def test_every_part_has_the_viscosity_of_the_scenarios_oil(tmp_path, base):
    """11 mm2/s at 100 degC (the sheet) times 855 kg/m3 expanded by ASTM D1250: 8.81 mPa.s."""
    scenario = load(write(tmp_path, ONE_OIL, base))
    assert HOT.viscosity == pytest.approx(8.81e-3, rel=1e-3)
    for part in OILED[base]:
        given = scenario.components[part].parameters
        assert given["viscosity"] == HOT.viscosity
        if "contact" in part:
            assert given["pressure_viscosity"] == HOT.pressure_viscosity
    assert not any("viscosity" in line for line in list_warnings(scenario))
    assert f"viscosity of {1e3 * HOT.viscosity:.4g} mPa.s" in list_oils(scenario)[0]


def test_a_viscosity_beside_the_scenarios_oil_is_said_once(tmp_path):
    by_hand = "".join(f"[components.{part}.parameters]\nviscosity = 0.01\n" for part in OILED["engine"][1:])
    scenario = load(write(tmp_path, ONE_OIL + by_hand, "engine"))
    assert scenario.components["upper_wall"].parameters["viscosity"] == 0.01
    (line,) = (line for line in list_warnings(scenario) if "viscosity" in line)
    assert line == (
        "viscosity of components.upper_wall, lower_wall is set by hand: 0.01 Pa.s; "
        f"the oil has {HOT.viscosity:.4g} Pa.s at 100 degC"
    )


def test_a_part_keeps_its_own_oil(tmp_path):
    scenario = load(write(tmp_path, ONE_OIL + OIL))
    assert (
        scenario.components["contact"].parameters["viscosity"]
        == evaluate_oil(GRADES["SAE 5W-30"], 363.15).viscosity
    )
    assert [line.partition(":")[0] for line in list_oils(scenario)] == ["contact"]


TWO_OILS = "[components.upper_wall.parameters]\nviscosity = 0.02\n"


@pytest.mark.parametrize(
    ("text", "doubted"),
    [
        (TWO_OILS, True),
        ("", False),
        (OIL, True),
        (OIL + OIL.replace("contact", "upper_wall") + OIL.replace("contact", "lower_wall"), False),
        ("".join(OIL.replace("contact", p).replace("90", t) for p, t in (
            ("contact", "120"), ("upper_wall", "150"), ("lower_wall", "150"))), False),
        (TWO_OILS + 'film_model = "dry"\n', False),
    ],
)  # fmt: skip
def test_parts_that_no_temperature_of_one_oil_explains_are_doubted(tmp_path, text, doubted):
    """Of one oil at several stated temperatures each part is explained; a dry contact has no oil."""
    found = [line for line in list_warnings(load(write(tmp_path, text, "engine"))) if "no oil has" in line]
    assert len(found) == doubted
    assert not found or ("0.036 Pa.s in" in found[0] and 'temperature = "100 degC"' in found[0])


@pytest.mark.parametrize("name", list_shipped())
def test_shipped_scenarios_have_one_oil(name):
    assert not [line for line in list_warnings(load(name)) if "viscosity" in line]
