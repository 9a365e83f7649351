"""A spring's wire in a scenario: what follows from it, refusals, stress and fatigue of a motion."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

from models.catalogue import CATALOGUE
from models.core.system import Instance, System
from orchestrator.assessment.figures_of_merit import measure
from orchestrator.assessment.motion import Motion
from orchestrator.assessment.notices import list_notices
from orchestrator.assessment.springs import remark_default_bind, remark_masses, warn_of_solid
from orchestrator.assessment.trains import find_trains
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.scenario.values import to_numbers
from orchestrator.study.speeds.remarks import list_doubts

WIRE = {
    "diameter": "4 mm",
    "mean_diameter": "26 mm",
    "active_coils": 5.5,
    "free_length": "52 mm",
    "installed_length": "40 mm",
}
RATE = 77.2e9 * 4e-3**4 / (8.0 * 26e-3**3 * 5.5)
MASS = 7850.0 * math.pi * 4e-3**2 / 4.0 * math.pi * 26e-3 * 5.5


def read_spring(
    folder: Path, base: str = "coil-clash", name: str = "spring", more: str = "", **wire: Any
) -> Any:
    file = folder / "wire.toml"
    given = {key: value for key, value in (WIRE | wire).items() if value is not None}
    lines = "\n".join(f"{key} = {value!r}" for key, value in given.items())
    file.write_text(f'extends = "{base}"\n{more}\n[components.{name}.wire]\n{lines}\n'.replace("'", '"'))
    table = load(file).components[name]
    return table, to_numbers(table.resolve().parameters, table.parameters)


def test_a_coil_spring_has_what_follows_from_its_wire(tmp_path: Path) -> None:
    """The gaps of coil-clash give way to those of the wire."""
    table, values = read_spring(tmp_path)
    assert values["spring_rate"] == pytest.approx(RATE)
    assert values["preload"] == pytest.approx(12e-3 * RATE)
    # Lumped masses: see test_wire_spring.
    assert values["surge_frequency"] == pytest.approx(0.5 * math.sqrt(RATE / MASS), rel=1e-6)
    left = 52e-3 - (5.5 + 2.0) * 4e-3 - 12e-3
    gaps = [values[f"gap[{i}]"] for i in range(1, 10)]
    assert gaps == pytest.approx([left / 9.0] * 9)
    assert table.notes == [
        "its wire gives 25.56 N/mm, 379.7 Hz, 306.7 N installed (386.2 MPa), 10 mm until all coils touch"
    ]


def test_a_valve_spring_counts_its_installed_length_on_the_seat(tmp_path: Path) -> None:
    """So it does with any lash."""
    more = '[components.valve_spring.parameters]\nlash = "0.2 mm"\nseat_stiffness = 2e7\n'
    _, values = read_spring(tmp_path, "seat-and-lash", "valve_spring", more)
    assert values["preload"] == pytest.approx(12e-3 * RATE)
    assert values["clash_clearance"] == pytest.approx(10e-3)


@pytest.mark.parametrize(
    ("wire", "said"),
    [
        ({"diameter": "0 mm"}, "wire.diameter = 0 mm: must be > 0"),
        ({"diameter": 4}, "wire.diameter = 4 m: wires of springs measure 0.1 to 20 mm; write the unit"),
        ({"free_length": None}, "wire: needs pitch or free_length"),
        ({"pitch": "8 mm"}, "wire.free_length: follows from the pitch; leave one of them out"),
        ({"installed_length": "28 mm"}, "wire.installed_length: compresses its free length 52 mm by 24 mm"),
        ({"mean_diameter": ["26 mm", "7 mm"]}, "wire: mean_diameter = 7 mm: must be 2 to 50 times"),
        ({"endless_mean": "500 MPa"}, "wire: needs endless_amplitude and endless_mean together"),
        ({"tensile_strength": "700 MPa"}, "wire.tensile_strength: the shear strength is 0.67 of the tensile"),
        ({"material": "lead"}, "wire.material.*chrome-silicon"),
        ({"coils": 5}, "wire.coils"),
    ],
)
def test_wires_that_are_none(tmp_path: Path, wire: dict[str, Any], said: str) -> None:
    with pytest.raises(ScenarioError, match=said):
        read_spring(tmp_path, **wire)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("parameters = 5", "parameters = 5: must be a table"),
        ("structure = 5", "structure = 5: must be a table"),
        ('structure = { segments = "x" }', "structure.segments = 'x': must be an integer"),
        ("parameters = { lash = [1, 2] }", "parameters.lash: must be a number"),
        ('parameters = { lash = "0.3 N" }', "parameters.lash.*the unit N does not fit"),
    ],
)
def test_what_stands_beside_a_wire_and_is_no_value_is_named(tmp_path: Path, more: str, said: str) -> None:
    base, name = ("coil-clash", "spring") if "segments" in more else ("seat-and-lash", "valve_spring")
    with pytest.raises(ScenarioError, match=said):
        read_spring(tmp_path, base, name, f"[components.{name}]\n{more}\n")


@pytest.mark.parametrize("name", ["spring_rate = 3e4", "gap[1] = 1e-3", "wire_stress = 1e6"])
def test_what_follows_from_the_wire_is_not_set_beside_it_in_any_order(name: str) -> None:
    settings = [f"components.spring.wire.{k} = {v}" for k, v in WIRE.items()]
    settings.append(f"components.spring.parameters.{name}")
    for ordered in (settings, settings[::-1]):
        with pytest.raises(ScenarioError, match="follows from the wire; leave one"):
            load("coil-clash", ordered)


def test_a_wire_by_set_gives_what_an_extending_file_gives(tmp_path: Path) -> None:
    spring = load("coil-clash", [f"components.spring.wire.{k} = {v}" for k, v in WIRE.items()]).components
    assert spring["spring"].parameters == read_spring(tmp_path)[0].parameters


def test_stress_and_safety_of_a_motion_are_those_of_its_forces() -> None:
    """Goodman: 1/n = amplitude/S_e + mean/S_su, here of 100 to 300 MPa."""
    wire = {"wire_stress": 1e6, "wire_amplitude": 400e6, "wire_strength": 1000e6}
    system = System({"spring": Instance(CATALOGUE["coil_spring"](), wire)}, [])
    columns = {"spring.force": np.array([100.0, 300.0, 200.0]), "spring.least_gap": np.ones(3)}
    motion = Motion(system, np.arange(3.0), lambda name: columns.get(name, np.zeros(3)), None)
    found = {name: value for _, name, _, value in measure(motion)}
    assert found["largest_stress"] == (300e6, 1)
    assert found["fatigue_safety"].value == pytest.approx(1.0 / (100.0 / 400.0 + 200.0 / 1000.0))
    unknown = System({"spring": Instance(CATALOGUE["coil_spring"]())}, [])
    plain = {
        name: value.value for _, name, _, value in measure(Motion(unknown, motion.times, motion.column, None))
    }
    assert math.isnan(plain["largest_stress"])
    assert math.isnan(plain["fatigue_safety"])


def test_stress_is_that_of_the_tightest_coils_until_they_touch() -> None:
    """f_p + k0 (travel to coil bind - travel left): surge closes coils further than the spring's end."""
    wire = {"wire_stress": 1e6, "wire_amplitude": 400e6, "wire_strength": 1000e6}
    system = System({"spring": Instance(CATALOGUE["coil_spring"](), wire)}, [])
    for left, force in ((5e-3, 330.0 + 35e3 * 13e-3), (-2e-3, 330.0 + 35e3 * 18e-3)):
        columns = {
            "spring.force": np.array([330.0, 700.0, 500.0]),
            "spring.least_gap": np.array([18e-3, 10e-3, left]),
        }
        motion = Motion(system, np.arange(3.0), lambda name, of=columns: of.get(name, np.zeros(3)), None)
        found = {name: value for _, name, _, value in measure(motion)}
        assert found["largest_stress"] == (pytest.approx(force * 1e6), 2)
        half = 0.5 * (force - 330.0)
        safety = 1.0 / (half / 400.0 + (330.0 + half) / 1000.0)
        assert found["fatigue_safety"].value == pytest.approx(safety)


def test_coils_of_a_wire_that_touch_are_stiff_and_said() -> None:
    """As those of a coil spring, unless a stiffness is given; a sweep says where they touch."""
    own = "components.valve_spring."
    wires = [f"{own}wire.{key} = {value}" for key, value in WIRE.items()]
    for more, stiffness in (([], 5e6), ([f"{own}parameters.clash_stiffness = 1e7"], 1e7)):
        table = load("seat-and-lash", [*wires, *more]).components["valve_spring"]
        values = to_numbers(table.resolve().parameters, table.parameters)
        assert values["clash_stiffness"] == stiffness
    found = {"valve_spring.least_gap": [1e-3, -0.2e-3, -1.5e-3], "change": np.zeros(3)}
    speeds = np.array([1000.0, 2000.0, 3000.0]) * math.pi / 30.0
    cycles = xarray.Dataset({name: ("speed", column) for name, column in found.items()}, {"speed": speeds})
    (said,) = list_doubts(None, build_system(load("seat-and-lash")), cycles)
    assert "valve_spring clash at 2 speeds from 2000 to 3000 r/min, the tightest 1.5 mm" in said


@pytest.mark.parametrize(("installed", "solid"), [("36 mm", True), ("39 mm", False)])
def test_a_spring_that_is_solid_before_full_lift_is_said_before_the_run(installed: str, solid: bool) -> None:
    """Its 7.5 coils of 4 mm touch at 30 mm; the valve lifts by 8.3 mm less 0.2 mm of lash."""
    wire = WIRE | {"installed_length": installed}
    wires = [f"components.valve_spring.wire.{key} = {value}" for key, value in wire.items()]
    said = " ".join(line for line in list_notices(load("seat-and-lash", wires)) if "solid" in line)
    assert said.partition("; ")[0] == solid * (
        "warning: components.valve_spring: solid before full lift, at any speed: "
        "its valve lifts by 8.1 mm, 2.1 mm more than the 6 mm where all coils touch"
    )


@pytest.mark.parametrize("given", ["parameters.clash_clearance = 19 mm", "wire"])
def test_coil_bind_by_a_default_is_said_with_how_to_give_it(given: str) -> None:
    """Of many springs once; a resumed run, whose scenario has all numbers, says the same."""
    lines = [f"wire.{key} = {value}" for key, value in WIRE.items()] if given == "wire" else [given]
    own = load("seat-and-lash", [f"components.valve_spring.{line}" for line in lines])
    assert not [line for line in list_notices(own) if "coil bind" in line]
    (said,) = [line for line in list_notices(load("seat-and-lash")) if "coil bind" in line]
    assert said == (
        "valve_spring: coil bind is judged by the component's default, 20 mm of lift until all coils touch; "
        "give your spring's components.valve_spring.parameters.clash_clearance, "
        "or components.valve_spring.wire"
    )
    (said,) = remark_default_bind(build_system(load("engine-16v")))
    assert said.startswith("valve_spring_intake_1a and 15 more: coil bind")
    (said,) = remark_default_bind(build_system(load("valve-stem")))
    assert said.endswith("components.NAME.parameters.gap, or components.NAME.wire")
    assert not list(remark_default_bind(build_system(load("coil-clash"))))


def test_a_rate_that_varies_alone_says_that_the_spring_changes_its_mass() -> None:
    """At 480 Hz k/(4 f^2) is 32.55 g of 30 N/mm, and 54.25 g of 50; 40 N/mm of 554.3 Hz have 32.55 g too."""
    springs = [("30 N/mm", "480 Hz"), ("50 N/mm", "480 Hz"), ("40 N/mm", "554.256258 Hz")]
    path = "components.valve_spring.parameters"
    given = [[f"{path}.spring_rate = {k}", f"{path}.surge_frequency = {f}"] for k, f in springs]
    light, heavy, stiff = (build_system(load("valve-train", one)) for one in given)
    (said,) = remark_masses([light, heavy])
    assert said.startswith("valve_spring: surge_frequency stays 480 Hz as spring_rate changes, so that")
    assert "is 32.55, 54.25 g; set surge_frequency too" in said
    assert not list(remark_masses([light, stiff]))  # both differ
    assert not list(remark_masses([light, light]))
    alone, both = (
        [line for line in list_notices(load("valve-train", one)) if "mass" in line]
        for one in (given[2][1:], given[2])
    )
    assert alone[0].startswith("valve_spring: spring_rate stays 35000 N/m as surge_frequency changes")
    assert not both


@pytest.mark.parametrize("solid", [True, False])
def test_full_lift_of_a_valve_is_that_of_its_rocker(solid: bool) -> None:
    """The rod's end of the rocker has the cam's 7.35 mm as the valve has its lash and its lift."""
    (train,) = find_trains(build_system(load("pushrod-train")))
    lash = train.system.instances["valve_spring"].parameters["lash"]
    assert train.find_cam_lash(lash + train.valve_lift) == pytest.approx(train.largest_lift, rel=1e-9)
    assert train.valve_lift > 1.2 * train.largest_lift
    travel = train.valve_lift + (-1e-5 if solid else 1e-5)
    given = [f"components.valve_spring.parameters.clash_clearance = {travel}"]
    assert bool(list(warn_of_solid(build_system(load("pushrod-train", given))))) == solid
