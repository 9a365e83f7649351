"""Tables and drawings in scenarios: pressures, forces of springs, shafts; what is read and refused."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
from models.core.evaluation import Evaluation
from models.valve_train.beam import Disc, Shaft, find_torsion
from models.valve_train.measured_spring import MeasuredSpring, fit_gaps
from orchestrator.scenario import ScenarioError, build_scenario
from orchestrator.scenario.angle_table import AngleTableError, insert_pressure_table
from orchestrator.scenario.component_table import ComponentTable
from orchestrator.scenario.files import list_shipped, load, override, read_contents
from orchestrator.scenario.system import build_system, resolve_start
from tests.models.systems import outputs_of

from .commands import called


def formula(angle: float) -> float:
    """Absolute pressure (Pa) at a crank angle (rad)."""
    return outputs_of(CATALOGUE["cylinder_gas"](), {}, {}, {"crank_angle": angle})["gas_pressure"] + 100e3


def write(
    path: Path, angles: np.ndarray, pressures: np.ndarray, header: str = "angle [deg], p [bar]"
) -> Path:
    separator = next(sign for sign in ";," if sign in header)
    rows = [
        f"{math.degrees(a)!r}{separator} {p / 1e5!r}"
        for a, p in zip(angles.tolist(), pressures.tolist(), strict=True)
    ]
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def read(path: Path, **parameters: float) -> Callable[[float], float]:
    """The gauge pressure (Pa) by the crank angle of a component with that table."""
    table = ComponentTable.model_validate(
        {"component": "cylinder_gas", "pressure_table": str(path), "parameters": parameters}
    )
    gas = CATALOGUE["cylinder_gas"](**table.structure)
    p = gas.parameters.vector({name: float(value) for name, value in table.parameters.items()})
    x, y, place = np.zeros(gas.state.size), np.zeros(gas.outputs.size), gas.outputs.index("gas_pressure")

    def pressure(angle: float) -> float:
        gas.flat_output(0.0, x, gas.inputs.vector({"crank_angle": angle}), p, y)
        return float(y[place])

    return pressure


@pytest.mark.plain
def test_a_table_of_the_formula_tends_to_it(tmp_path: Path, record) -> None:
    """Monotone cubics are of third order but at extremes, where they are of second."""
    at = np.linspace(-6.0, 6.0, 601)
    exact = np.array([formula(a) for a in at]) - 100e3
    errors = []
    for count in (180, 360, 720):
        angles = np.linspace(0.0, 4.0 * math.pi, count, endpoint=False)
        path = write(tmp_path / f"{count}.csv", angles, np.array([formula(a) for a in angles]))
        found = np.array([*map(read(path), at)])
        errors.append(np.sqrt(np.mean((found - exact) ** 2)) / exact.max())
    case = "pressure table of a formula's cycle"
    quantity = f"{case}: RMS error at 1 deg, of the largest"
    record("Slider-crank", quantity, errors[-1], 0.0, "formula", tolerance=2e-4)
    order = math.log2(errors[0] / errors[-1]) / 2.0
    record("Slider-crank", f"{case}: order", order, 2.75, "2 at extremes, 3 elsewhere", tolerance=0.75)


@pytest.mark.plain
@settings(max_examples=20, deadline=None)
@given(
    pressures=st.lists(st.floats(0.5e5, 8e6), min_size=8, max_size=40),
    angle=st.floats(-40.0, 40.0),
    turns=st.sampled_from([1, 2]),
)
def test_the_pressure_stays_between_those_of_its_points(tmp_path_factory, pressures, angle, turns) -> None:
    """And comes again after a cycle."""
    period = 2.0 * math.pi * turns
    angles = np.linspace(0.0, period, len(pressures), endpoint=False)
    path = write(tmp_path_factory.mktemp("table") / "p.csv", angles, np.array(pressures))
    if turns == 2 and angles[-1] <= 2.0 * math.pi:
        return
    pressure = read(path)
    found = pressure(angle) + 100e3
    i = math.floor((angle % period) / period * len(pressures)) % len(pressures)
    near = [pressures[k % len(pressures)] for k in (i - 1, i, i + 1, i + 2)]
    assert min(near) * (1.0 - 1e-9) <= found <= max(near) * (1.0 + 1e-9)
    assert pressure(angle + period) + 100e3 == pytest.approx(found, rel=1e-6)


def test_angles_count_from_the_firing_dead_centre(tmp_path: Path) -> None:
    angles = np.linspace(0.0, 4.0 * math.pi, 40, endpoint=False)
    path = write(tmp_path / "p.csv", angles, 2e5 + 1e5 * np.sin(0.5 * angles))
    turned = read(path, firing_angle=0.7)(1.3 + 0.7)
    assert turned == pytest.approx(read(path)(1.3), rel=1e-12)


@pytest.mark.parametrize(
    ("last", "pressure", "header", "message"),
    [
        (720, [1.0, 1.2], "angle [deg], lift [mm]", "is no pressure"),
        (720, [0.0, 0.2], "angle [deg], p [bar]", "absolute pressures"),
        (600, [1.0, 1.2], "angle [deg], p [bar]", "must go round the cycle"),
        (800, [1.0, 1.2], "angle [deg], p [bar]", "at most 720 deg of the crank"),
        (720, [1.0, 60.0], "angle [deg], p [bar]", "a cycle later"),
        (720, [1.0, 1.2], "cam angle [deg], p [bar]", "spans 1440 deg"),
    ],
)
def test_mistakes_in_a_table_are_named(tmp_path: Path, last, pressure, header, message) -> None:
    angles, pressures = np.radians(np.arange(0.0, last + 1)), np.linspace(*pressure, last + 1) * 1e5
    write(tmp_path / "p.csv", angles, pressures, header)
    file = tmp_path / "gas.toml"
    file.write_text('extends = "exhaust-valve"\n[components.gas]\npressure_table = "p.csv"\n')
    with pytest.raises(ScenarioError, match=message):
        load(str(file))


def test_angles_of_the_cam_are_half_of_the_cranks(tmp_path: Path) -> None:
    """In a file that names the cam: the crank of a four-stroke engine turns twice as far."""
    angles = np.linspace(0.0, 4.0 * math.pi, 90, endpoint=False)
    pressures = np.array([formula(a) for a in angles])
    crank = read(write(tmp_path / "crank.csv", angles, pressures))
    cam = read(write(tmp_path / "cam.csv", angles / 2.0, pressures, "Nockenwinkel [°]; p [bar]"))
    for angle in (0.0, 1.0, 7.0):
        assert cam(angle) == pytest.approx(crank(angle), rel=1e-9)


@pytest.mark.parametrize(("first", "rows", "said"), [(100, 1, "interpolated"), (460, 20, "add them")])
def test_rows_that_are_missing_within_a_pressure_table_are_named(
    tmp_path: Path, first: int, rows: int, said: str
) -> None:
    """One is interpolated; the peak of a cycle could be in more."""
    last = first + 2 + 2 * rows
    angles = np.radians([a for a in np.arange(0.0, 720.0, 2.0) if not first < a < last])
    path = write(tmp_path / "p.csv", angles, np.full(angles.size, 2e5))
    table = {"component": "cylinder_gas", "pressure_table": str(path)}
    try:
        told = " ".join(insert_pressure_table(table).notes)
    except AngleTableError as error:
        told = str(error)
    assert f"rows are missing between {first} and {last} deg" in told
    assert said in told


def test_rows_may_be_closer_about_the_dead_centre(tmp_path: Path) -> None:
    """As tools of indication write them; a row that is missing is one in either part."""
    degrees = np.concatenate(
        [np.arange(-360, -120), np.linspace(-120.0, 120.0, 2400, endpoint=False), np.arange(120, 360)]
    )
    for left_out, count in ((None, 0), (100, 1), (1500, 1)):
        rest = degrees if left_out is None else np.delete(degrees, left_out)
        path = write(tmp_path / "p.csv", np.radians(rest), np.full(rest.size, 2e5))
        table = {"component": "cylinder_gas", "pressure_table": str(path)}
        notes = [note for note in insert_pressure_table(table).notes if "rows are missing" in note]
        assert len(notes) == count, notes


@pytest.mark.long
@pytest.mark.parametrize("participant", ["native", "fmu"])
def test_an_exhaust_valve_opens_against_a_table(tmp_path: Path, participant: str) -> None:
    """By the FMU of the table's component, against the reference."""
    angles = np.linspace(0.0, 4.0 * math.pi, 90, endpoint=False)
    write(tmp_path / "p.csv", angles, np.array([formula(a) for a in angles]))
    file = tmp_path / "gas.toml"
    file.write_text(
        'extends = "exhaust-valve"\nstop_time = "5 ms"\n[components.gas]\npressure_table = "p.csv"\n'
        f'participant = "{participant}"\n'
    )
    done = called("run", str(file), "--no-figures", "--out", str(tmp_path / "out"))
    assert done.returncode == 0, done.stdout + done.stderr


STOP = 5e7  # 32 closed segments are stiffer than any spring drawn here


def find_travel(spring: MeasuredSpring, force: float) -> float:
    """Of segments in series under this force (N)."""
    above, rate = force - spring.preload, spring.spring_rate * spring.gap.size
    closing = rate * spring.gap
    opened, closed = np.minimum(above, closing), np.maximum(above - closing, 0.0)
    return float(np.sum(opened / rate + closed / (rate + STOP)))


def test_a_spring_of_two_rates_is_met_at_every_row() -> None:
    """Two of six coils close at 6 mm: 30, then 45 N/mm (with stops that are rigid)."""
    spring = fit_gaps(np.array([0.0, 3e-3, 6e-3, 12e-3]), np.array([0.0, 90.0, 180.0, 450.0]), 6, 1e15)
    assert spring.spring_rate == pytest.approx(30e3)
    np.testing.assert_allclose(spring.gap[4:], 1e-3, rtol=1e-12)
    assert (spring.gap[:4] > 2e-3).all()


@given(
    st.lists(st.floats(0.2e-3, 3e-3), min_size=2, max_size=8),
    st.lists(st.floats(1.0, 1.5), min_size=8, max_size=8),
)
def test_the_last_row_is_met_and_the_others_nearly(steps: list[float], growth: list[float]) -> None:
    """Any rate that rises. Of N segments, one closes where it should on average: the travel is then off by a
    quarter of 1/N of what the open spring would travel, or less."""
    travel = np.r_[0.0, np.cumsum(steps)]
    rates = 20e3 * np.cumprod([1.0, *growth])[: len(steps)]
    force = 300.0 + np.r_[0.0, np.cumsum(rates * steps)]
    for segments in (8, 32):
        spring = fit_gaps(travel, force, segments, STOP)
        off = np.array([find_travel(spring, f) for f in force]) - travel
        np.testing.assert_allclose(off[[0, -1]], 0.0, atol=1e-9 * travel[-1])
        open_travel = (force[-1] - force[0]) / spring.spring_rate
        assert np.max(np.abs(off)) <= 0.25 / segments * open_travel * (1.0 + 1e-9)


def test_a_table_steeper_than_closed_coils_says_how_stiff_their_stops_must_be() -> None:
    """To the number named the spring is met, below it refused."""
    travel, force = np.array([0.0, 4e-3, 6e-3]), np.array([300.0, 380.0, 780.0])
    with pytest.raises(ValueError, match=r"gets 2e\+05 N/m.* at least 1.44e\+06 N/m"):
        fit_gaps(travel, force, 8, 1.4e6)
    spring = fit_gaps(travel, force, 8, 1.441e6)
    assert np.isfinite(spring.gap).all()


def test_noise_that_softens_the_spring_is_averaged() -> None:
    travel, force = np.linspace(0.0, 8e-3, 9), 300.0 + 35e3 * np.linspace(0.0, 8e-3, 9)
    force[4] += 4.0
    spring = fit_gaps(travel, force, 9, STOP)
    assert find_travel(spring, force[-1]) == pytest.approx(8e-3)


def write_spring(folder: Path, rows: str, more: str = "") -> Path:
    file = folder / "spring.toml"
    file.write_text(
        'stop_time = "1 ms"\nmacro_step = "10 us"\nconnections = []\n[tolerance]\n"spring.force" = 1e-3\n'
        f'[components.spring]\ncomponent = "coil_spring"\nforce_table = {rows}\n{more}'
    )
    return file


def test_the_component_has_the_measured_force(tmp_path: Path) -> None:
    rows = '[["0 mm", "330 N"], ["4 mm", "470 N"], ["8 mm", 640]]'
    more = "structure = { segments = 5 }\nparameters = { gap = 1e-3, stop_stiffness = 5e7 }\n"
    table = load(write_spring(tmp_path, rows, more)).components["spring"]
    assert table.force_table is None
    values: dict[str, Any] = dict(table.parameters)
    gap = np.array([values[f"gap[{i}]"] for i in range(1, 6)])
    spring = MeasuredSpring(values["spring_rate"], values["preload"], gap)
    assert find_travel(spring, 640.0) == pytest.approx(8e-3)
    rate, force = 5.0 * spring.spring_rate, 640.0 - 330.0
    shorter = np.where(force > rate * gap, (force + STOP * gap) / (rate + STOP), force / rate)
    coils = {f"coil_position[{i}]": 8e-3 - float(np.sum(shorter[:i])) for i in range(1, 5)}
    y = outputs_of(CATALOGUE["coil_spring"](segments=5), values, coils, {"position": 8e-3})
    assert y["force"] == pytest.approx(640.0)


TABLES = {
    '[["0 mm", "330 N"]]': "force_table: must have two rows",
    '[["1 mm", "330 N"], ["2 mm", "340 N"]]': "the first at travel 0",
    '[["0 mm", "330 N"], ["2 mm", "320 N"]]': r"force_table\[2\]: travel and force",
    '[["0 mm", "330 N"], ["2 N", "340 N"]]': r"force_table\[2\]\[1\]: .*'2 N'",
    '[["0 mm", "330 N"], ["4 mm", "340 N"], ["5 mm", "4 kN"]]': "give a stop_stiffness",
}


@pytest.mark.parametrize("rows", TABLES)
def test_tables_that_are_none(tmp_path: Path, rows: str) -> None:
    with pytest.raises(ScenarioError, match=TABLES[rows]):
        load(write_spring(tmp_path, rows))


GOOD = (
    'length = "100 mm"\ndiameter = "20 mm"\ncams = [{ place = "40 mm" }, { place = 0.08, inertia = 2e-4 }]\n'
)


def write_drawing(folder: Path, drawing: str) -> Path:
    file = folder / "shaft.toml"
    file.write_text(
        'stop_time = "1 ms"\nmacro_step = "10 us"\nconnections = []\n'
        '[tolerance]\n"turning.twist[1]" = 1e-3\n'
        f'[components.turning]\ncomponent = "shaft"\n[components.turning.drawing]\n{drawing}'
    )
    return file


def test_a_drawing_becomes_modes(tmp_path: Path) -> None:
    table = load(write_drawing(tmp_path, GOOD)).components["turning"]
    assert table.drawing is None
    modes = find_torsion(
        Shaft(0.1, 0.02, [Disc(0.04, 0.1, 1.2e-4, 0.7e-4), Disc(0.08, 0.1, 2e-4, 0.7e-4)]), 3
    )
    assert table.structure == {"cams": 2, "torsion_modes": modes.frequency.size, "bending_modes": 1}
    frequency = float(table.parameters["torsion_frequency[1]"])
    assert frequency == pytest.approx(modes.frequency[0] / (2.0 * math.pi), rel=1e-12)
    assert float(table.parameters["torsion_damping[1]"]) == 0.02
    assert float(table.parameters["bending_shape[1]"]) == 0.0


def test_bearings_let_it_bend(tmp_path: Path) -> None:
    table = load(write_drawing(tmp_path, GOOD + 'bearings = [0.0, "100 mm"]\n')).components["turning"]
    assert table.structure["bending_modes"] > 1
    assert max(abs(float(v)) for n, v in table.parameters.items() if n.startswith("bending_shape")) == 1.0


def test_journals_have_the_numbers_after_the_cams(tmp_path: Path) -> None:
    table = load(write_drawing(tmp_path, GOOD + 'journals = [0.0, "100 mm"]\n')).components["turning"]
    assert table.structure["cams"] == 4
    assert [float(table.parameters[f"bending_frequency[{j}]"]) for j in (1, 2)] == [0.0, 0.0]
    assert float(table.parameters["bending_frequency[3]"]) > 0.0


@pytest.mark.parametrize(
    ("drawing", "message"),
    [
        ("", r"drawing.length: missing"),
        (GOOD.replace('"20 mm"', '"20 N"'), r"drawing.diameter: .*'20 N'"),
        (GOOD.replace('"20 mm"', "-0.02"), r"drawing.diameter = -0.02: must be > 0"),
        (GOOD.replace('"40 mm"', '"140 mm"'), r"drawing.cams\[1\].place = 0.14 m: must be <= length"),
        (GOOD + "bearings = [0.05]\n", r"drawing.bearings: 1 bearings and journals: .* at least two"),
        (GOOD + "journals = [0.05]\n", r"drawing.bearings: 1 bearings and journals: .* at least two"),
        (GOOD + "journals = [0.0, 0.2]\n", r"drawing.journals\[2\] = 0.2 m: must be <= length"),
        (GOOD + 'bore = "30 mm"\n', r"drawing.bore = 0.03 m: must be < diameter"),
        (GOOD + "colour = 3\n", r"drawing.colour"),
    ],
)
def test_mistakes_in_a_drawing_are_named(tmp_path: Path, drawing: str, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        load(write_drawing(tmp_path, drawing))


@pytest.mark.long
@pytest.mark.parametrize(("speed", "preload"), [(1000, 330), (10, 330), (20, 3000)])
def test_a_slow_shaft_finds_its_rest_in_its_bearings(speed: int, preload: int) -> None:
    """The journals sink until film or asperities carry the cam's load, which Newton's method overshoots."""
    content = read_contents(list_shipped()["shaft-in-bearings"])
    values = f"flywheel.parameters.initial_speed={speed} rpm", f"spring.parameters.preload={preload}"
    override(content, [f"components.{value}" for value in values])
    scenario = build_scenario(content)
    system = resolve_start(scenario, build_system(scenario))
    evaluation = Evaluation(system)
    outputs = dict(zip(system.outputs.names, evaluation.outputs(0.0, system.x0).tolist(), strict=True))
    rates = dict(zip(system.state.names, evaluation.derivative(0.0, system.x0).tolist(), strict=True))
    carried = sum(outputs[f"bearing_{i}.force_y"] for i in (1, 2))
    assert carried == pytest.approx(outputs["contact.load"], rel=1e-9)
    assert max(abs(rates[f"bearing_{i}.eccentricity_{end}"]) for i in (1, 2) for end in "xy") < 1e-12
