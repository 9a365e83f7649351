"""Measured forces of springs in scenarios."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
from models.valve_train.measured_spring import MeasuredSpring, fit_gaps
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load
from tests.models.systems import outputs_of

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


def write(folder: Path, rows: str, more: str = "", component: str = "coil_spring") -> Path:
    file = folder / "spring.toml"
    file.write_text(
        'stop_time = "1 ms"\nmacro_step = "10 us"\nconnections = []\n[tolerance]\n"spring.force" = 1e-3\n'
        f'[components.spring]\ncomponent = "{component}"\nforce_table = {rows}\n{more}'
    )
    return file


def test_the_component_has_the_measured_force(tmp_path: Path) -> None:
    rows = '[["0 mm", "330 N"], ["4 mm", "470 N"], ["8 mm", 640]]'
    more = "structure = { segments = 5 }\nparameters = { gap = 1e-3, stop_stiffness = 5e7 }\n"
    table = load(write(tmp_path, rows, more)).components["spring"]
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


@pytest.mark.parametrize(
    ("rows", "more", "component", "message"),
    [
        ('[["0 mm", "330 N"]]', "", "coil_spring", "force_table: must have two rows"),
        ('[["1 mm", "330 N"], ["2 mm", "340 N"]]', "", "coil_spring", "the first at travel 0"),
        ('[["0 mm", "330 N"], ["2 mm", "320 N"]]', "", "coil_spring", r"force_table\[2\]: travel and force"),
        ('[["0 mm", "330 N"], ["2 N", "340 N"]]', "", "coil_spring", r"force_table\[2\]\[1\]: .*'2 N'"),
        (
            '[["0 mm", "330 N"], ["4 mm", "340 N"], ["5 mm", "4 kN"]]',
            "",
            "coil_spring",
            "give a stop_stiffness",
        ),
        ('[["0 mm", 330], [0.002, 340]]', "", "valve_spring", "valve_spring has none"),
    ],
)
def test_tables_that_are_none(tmp_path: Path, rows: str, more: str, component: str, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        load(write(tmp_path, rows, more, component))
