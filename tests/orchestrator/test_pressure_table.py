"""Pressure tables: what is read, what is refused, and the gas that follows one."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.component_table import ComponentTable
from orchestrator.scenario.files import load
from tests.models.systems import outputs_of

from .commands import called


def formula(angle: float) -> float:
    """Absolute pressure (Pa) at a crank angle (rad)."""
    return outputs_of(CATALOGUE["cylinder_gas"](), {}, {}, {"crank_angle": angle})["gas_pressure"] + 100e3


def write(
    path: Path, angles: np.ndarray, pressures: np.ndarray, header: str = "angle [deg], p [bar]"
) -> Path:
    rows = [
        f"{math.degrees(a)!r}, {p / 1e5!r}" for a, p in zip(angles.tolist(), pressures.tolist(), strict=True)
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


@pytest.mark.long
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


@pytest.mark.long
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
    ],
)
def test_mistakes_in_a_table_are_named(tmp_path: Path, last, pressure, header, message) -> None:
    angles, pressures = np.radians(np.arange(0.0, last + 1)), np.linspace(*pressure, last + 1) * 1e5
    write(tmp_path / "p.csv", angles, pressures, header)
    file = tmp_path / "gas.toml"
    file.write_text('extends = "exhaust-valve"\n[components.gas]\npressure_table = "p.csv"\n')
    with pytest.raises(ScenarioError, match=message):
        load(str(file))


def test_only_a_gas_has_a_pressure_table(tmp_path: Path) -> None:
    file = tmp_path / "gas.toml"
    file.write_text('extends = "exhaust-valve"\n[components.contact]\npressure_table = "p.csv"\n')
    with pytest.raises(ScenarioError, match="ehl_contact has none"):
        load(str(file))


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
