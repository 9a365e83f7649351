"""What is doubted before a run: values, records, the phase at which a valve opens against its gas."""

import tomllib

import pytest

import tribocosim
from models.core.remedies import in_python
from orchestrator.assessment.gas_phase import list_doubtful_gas
from orchestrator.scenario import ScenarioError, build_scenario
from orchestrator.scenario.checks import check_units
from orchestrator.scenario.files import list_shipped, load, to_full_toml
from orchestrator.scenario.system import build_system
from orchestrator.scenario.warnings import list_inherited, list_warnings


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (["motion=free", "initial_speed=3000 rpm"], ["initial_speed", "motion is prescribed; give"]),
        (["motion=free", "ramp_start=1 ms"], ["ramp_start", "motion is prescribed; leave it out"]),
        (["final_speed=3000 rpm"], []),
        (["motion=free"], []),
    ],
)
def test_a_parameter_without_an_effect_is_said_with_its_remedy(settings, said):
    """That a run's own file of all values is silent is of its defaults. The final speed follows the other."""
    path = "components.flywheel.parameters."
    scenario = load("valve-train", [path + one for one in settings])
    found = [one for one in list_warnings(scenario) if "has an effect only where" in one]
    assert len(found) == bool(said)
    assert all(word in one for one in found for word in said)
    assert list_warnings(build_scenario(tomllib.loads(to_full_toml(scenario)))) == list_warnings(scenario)


def test_inputs_of_an_extended_scenario_are_told(tmp_path):
    """0.1 N m of a clip spring, in every balance of moments about the pivot."""
    file, below = tmp_path / "mine.toml", tmp_path / "below.toml"
    below.write_text('extends = "finger-follower"\n')
    file.write_text('extends = "below.toml"\n[components.finger.parameters]\nbase_radius = "17.5 mm"\n')
    (said,) = list_inherited(load(file))
    assert said.startswith("components.finger.inputs.pivot_torque = 0.1 N m (torque")
    assert said.endswith("is of the scenario that this one extends; give it here to change it, 0 for none")
    for change in (
        "components.finger.inputs.pivot_torque=0.2",
        "components.finger.inputs={pivot_torque = 0}",
    ):
        assert not list(list_inherited(load(file, [change])))
    with file.open("a") as more:
        more.write('[components.finger.inputs]\npivot_torque = "0.2 N.m"\n')
    assert not list(list_inherited(load(file)))
    assert not list(list_inherited(load("finger-follower")))


def test_what_has_no_effect_is_noticed():
    assert list_warnings(load("valve-train")) == []
    assert list_warnings(load("valve-train-controlled")) == []
    (said,) = list_warnings(load("valve-train-controlled", ["output_step=1 ms"]))
    assert said.startswith("output_step = 0.001 s: has no effect: [step_control] records every step")
    assert list_warnings(load("valve-train", ["step_control.relative=1e-4"])) == []
    (said,) = list_warnings(load("valve-train", ["components.flywheel.parameters.initial_speed=0 rpm"]))
    assert "the shaft stands still for the whole run; give a speed" in said
    given = "components.contact.parameters.load_is_given=true"
    (said,) = list_warnings(load("valve-train", [given]))
    assert "nothing drives contact.applied_load" in said
    assert list_warnings(load("valve-train", [given, "components.contact.inputs.applied_load=300"])) == []


WHEEL = 'extends = "quarter-car"\nwithout = ["wheel.position -> chassis.wheel_position"]'
THIRD = """extends = "two-masses"
{line}
[components.third]
component = "sprung_mass"
participant = "in-process"
"""


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (WHEEL, ["chassis.inputs.wheel_position: not connected, stays 0 m, though wheel_velocity is"]),
        (f"{WHEEL}\ncomponents.chassis.inputs = {{ wheel_position = 0.1 }}", []),
        (THIRD.format(line=""), ["third: has no connection"]),
        (
            THIRD.format(line="tolerance = { 'third.position' = 1e-3 }"),
            ["third: nothing drives it: no input"],
        ),
        (
            THIRD.format(line="connections = ['first.force -> third.force']"),
            ["third: drives nothing: no out"],
        ),
    ],
)
def test_what_is_not_coupled_is_doubted(text, said, tmp_path):
    (path := tmp_path / "loose.toml").write_text(text)
    for words, line in zip(said, list_warnings(load(path)), strict=True):
        assert line.startswith(f"warning: components.{words}")


def test_no_shipped_scenario_lacks_a_connection():
    said = [line for name in list_shipped() for line in list_warnings(load(name))]
    assert not [line for line in said if "connect" in line]


def test_a_comparison_of_constants_proves_nothing():
    rest = {f"components.{name}.start": {"position": 0.0, "velocity": 0.0} for name in ("first", "second")}
    kept = {f"components.{name}.participant": "in-process" for name in ("first", "second")}
    verdict = tribocosim.run(tribocosim.load("two-masses").with_(rest | kept)).summary["verdict"]
    assert verdict == "within the tolerance; but all compared variables are constant, which proves nothing"


def test_a_stop_time_that_may_be_meant_in_ms_is_doubted():
    (doubt,) = list_warnings(load("valve-train", ["stop_time=120"]))
    assert doubt.startswith("stop_time = 120 s: 24,000,000 macro steps of 5e-06 s; if 120 ms were meant")
    assert list_warnings(load("valve-train", ["stop_time=120 ms"])) == []


def test_a_run_in_a_few_steps_is_doubted():
    changes = ["stop_time=90 ms", "macro_step=30 ms", "output_step=30 ms"]
    (doubt,) = list_warnings(load("two-masses", changes))
    assert doubt.startswith("macro_step = 0.03 s: the run to stop_time = 0.09 s makes 3 steps")


SLIPS = {
    "valve_spring.parameters.spring_rate=45": "45 N/mm",
    "flywheel.parameters.initial_speed=3000": "3000 rpm",
    "valve_spring.parameters.preload=0.33": "0.33 kN",
    "camshaft.parameters.base_radius=17": "17 mm",
    "camshaft.parameters.phase=90": "90 deg",
    "contact.parameters.viscosity=8": "8 mPa.s",
    "contact.parameters.youngs_modulus_1=207": "207 GPa",
    "contact.start.film_thickness=0.1": "0.1 um",
}


def test_a_clearance_is_read_in_micrometres_and_a_missing_number_has_the_unit_in_use():
    """A plunger of 6 mm of clearance and a spring of 8 N/m are a thousand times off."""
    (doubt,) = list_warnings(load("leak-down", ["components.adjuster.parameters.leak_clearance=6"]))
    assert "did you mean 6 um?" in doubt
    for scenario, path, unit in (
        ("valve-train", "valve_spring.parameters.spring_rate", "N/mm"),
        ("leak-down", "adjuster.parameters.leak_clearance", "um"),
    ):
        with pytest.raises(ScenarioError, match=f"write for example '8 {unit}'"):
            load(scenario, [f"components.{path}="])


@pytest.mark.parametrize("setting", SLIPS)
def test_a_run_refuses_a_slip_of_the_unit_and_takes_the_number_with_its_unit(setting, tmp_path):
    """Where nothing is computed yet it is doubted; the reading in the usual unit is neither."""
    path, number = setting.split("=")
    slip = load("valve-train", [f"components.{setting}"])
    assert [f"did you mean {SLIPS[setting]}?" in doubt for doubt in list_warnings(slip)] == [True]
    assert list_warnings(load("valve-train", [f"components.{path}={SLIPS[setting]}"])) == []
    with pytest.raises(ScenarioError) as refused:
        check_units(slip)
    (fault,) = refused.value.faults
    assert fault.place == f"components.{path}"
    assert in_python(fault.remedy).startswith(
        f"did you mean {SLIPS[setting]}? Write the unit, even if {number} "
    )
    written = in_python(fault.remedy).partition("even if ")[2].partition(" is meant")[0]
    meant = load("valve-train", [f"components.{path}={written}"])
    check_units(meant)
    (doubt,) = list_warnings(meant)  # it is said, and believed
    assert doubt.startswith(f"components.{path} = {number} ")
    assert "did you mean" not in doubt
    (kept := tmp_path / "kept.toml").write_text(to_full_toml(meant))
    check_units(load(kept))
    assert to_full_toml(load(kept)) == to_full_toml(meant)


@pytest.mark.parametrize(
    ("changes", "every", "why"),
    [
        (["output_step=20 us"], 4, None),
        (
            ["output_step=12.5 us"],
            2,
            "1.25e-05 s: is no multiple of macro_step = 5e-06 s; the interval is 1e-05 s, 2 macro steps",
        ),
        (
            ["output_step=1 us"],
            1,
            "1e-06 s: is shorter than macro_step = 5e-06 s; the interval is 5e-06 s, 1 macro",
        ),
        (["output_step=2 ms"], 240, "0.002 s: is too long for the comparison with the reference"),
        (["stop_time=1 ms"], 2, "2e-05 s: is too long for the comparison with the reference"),
        (["output_step=2 ms", "reference.enabled=false"], 400, None),
    ],
)
def test_records_at_other_times_than_asked_for_are_noticed(changes, every, why):
    scenario = load("valve-train", changes)
    assert scenario.record_every == every
    if scenario.reference.enabled:
        assert scenario.stop_time >= 100 * every * scenario.macro_step * (1 - 1e-9)
    said = list_warnings(scenario)
    assert len(said) == (why is not None)
    assert all(line.startswith(f"output_step = {why}") for line in said)


FIRING, BLOWDOWN = "components.gas.parameters.firing_angle", "components.gas.parameters.exhaust_opening"
# The nose is at 360 deg of the crank; 0.2 mm of lash are taken up on the ramp of 0.3 mm, whose velocity is
# constant over 20 + 5 deg up to the foot of the flank: (0.3 - 0.2) mm from its end, in (25/3 - 2.5/2) deg.
OPENS = 360.0 - 2.0 * (60.0 + 25.0 / 3.0 - 2.5)


@pytest.mark.parametrize(
    ("firing", "blowdown", "doubt"),
    [
        (OPENS - 126.0, 126.0, None),  # exhaust
        (OPENS - 336.0, 126.0, None),  # intake
        (OPENS - 67.0, 126.0, "opens 67 deg after firing, against"),
        (OPENS - 67.0, 126.0, "e.g. '98 deg' for an exhaust valve"),
        (OPENS - 230.0, 126.0, "opens 230 deg after firing"),
        (OPENS - 100.0, 150.0, "set components.gas.parameters.exhaust_opening = '100 deg'"),
    ],
)
def test_a_valve_opens_where_engines_open_it_or_is_doubted(firing, blowdown, doubt):
    system = build_system(load("exhaust-valve", [f"{FIRING}='{firing} deg'", f"{BLOWDOWN}='{blowdown} deg'"]))
    found = list_doubtful_gas(system)
    assert len(found) == (doubt is not None)
    assert doubt is None or (found[0].startswith("components.gas: valve_spring ") and doubt in found[0])


def test_a_valve_without_gas_is_not_judged():
    assert list_doubtful_gas(build_system(load("seat-and-lash"))) == []


def test_a_lash_that_holds_the_valve_open_is_doubted():
    path = "components.valve_spring.parameters.lash"
    (said,) = set(list_warnings(load("seat-and-lash", [f"{path}=-0.1 mm"]))) - set(
        list_warnings(load("seat-and-lash"))
    )
    assert said.startswith(f"{path} = -0.1 mm: the cam holds the valve open by 0.1 mm on")


def test_a_spring_that_lash_compresses_is_doubted(tmp_path):
    """One that takes the position of a valve with lash, and not its lift."""
    file = tmp_path / "wrong.toml"
    own, other = "valve.valve_lift -> spring.position", "valve.position -> spring.position"
    file.write_text(f'extends = "coil-clash"\nwithout = ["{own}"]\nconnections = ["{other}"]\n')
    (said,) = set(list_warnings(load(file))) - set(list_warnings(load("coil-clash")))
    path = "components.valve.parameters.lash"
    assert said.startswith(f"{path} = 0.2 mm: the closed valve compresses spring by it")
    assert own in said
    assert not [one for one in list_warnings(load(file, [f"{path}=0"])) if "spring" in one]
