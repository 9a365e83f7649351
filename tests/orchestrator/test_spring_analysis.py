"""The command `spring`: orders of a lift, surge where they meet the spring, a scenario's wire."""

import cmath
import csv
import math
from pathlib import Path

import numpy as np
import pytest

from orchestrator.analyses._cam_source import find_spring_settings
from orchestrator.analyses._evaluate import compute_table
from orchestrator.analyses.spring import ANALYSIS, find_orders, write_orders
from orchestrator.errors import MistakeError

from .commands import called

RATE = 77.2e9 * 4e-3**4 / (8.0 * 26e-3**3 * 5.5)


def test_orders_of_harmonic_lifts_are_their_amplitudes():
    angle = np.arange(4096) * 2.0 * math.pi / 4096
    found = find_orders(4e-3 * (1.0 - np.cos(angle)) + 0.3e-3 * np.sin(7.0 * angle + 0.4))
    expected = np.zeros(40)
    expected[[0, 6]] = 4e-3, 0.3e-3
    assert found == pytest.approx(expected, abs=1e-15)  # rounding


@pytest.mark.parametrize("ratio", [0.005, 0.02])
def test_an_order_at_resonance_excites_the_force_of_a_damped_rod(ratio):
    """K = k' q cot q of a rod, k' = k (1 + 2i zeta w/w0), q = pi w/w0 sqrt(k/k'): at w0 its size is k/zeta.

    What is beyond the first mode is of the order of zeta.
    """
    table = compute_table(ANALYSIS, ANALYSIS.complete({"damping_ratio": ratio}))
    complex_rate = RATE * (1.0 + 2.0j * ratio)
    q = math.pi * cmath.sqrt(RATE / complex_rate)
    surge = abs(complex_rate * q / cmath.tan(q)) * table["lift_amplitude"].values
    assert table["surge_by_order"].values == pytest.approx(surge, rel=2.0 * ratio)


def test_orders_meet_the_spring_at_its_frequency_over_their_number():
    table = compute_table(ANALYSIS, ANALYSIS.complete({}))
    frequency = table["surge_frequency"].item()
    speeds = table["meeting_speed"].values * np.arange(1, 41) / (2.0 * math.pi)
    assert speeds == pytest.approx([frequency] * 40)
    worst, shown = int(table["critical_order"].item()), table["surge_by_order"].values
    inside = (table["meeting_speed"].values <= ANALYSIS.parameters["high"].default) & (
        table["meeting_speed"].values >= ANALYSIS.parameters["low"].default
    )
    assert shown[worst - 1] == shown[inside].max() == table["surge_force"].item()
    rows = list(csv.reader(write_orders(table, {}).splitlines()))
    assert float(rows[worst][0]) == worst
    assert float(rows[worst][2]) == pytest.approx(table["critical_speed"].item() * 30.0 / math.pi, rel=1e-5)


def test_the_table_ends_at_the_solid_length_with_the_rate_of_a_cylinder():
    table = compute_table(ANALYSIS, ANALYSIS.complete({}))
    assert table["rate"].values == pytest.approx([RATE] * 200)
    assert table["solid_length"].item() == pytest.approx(7.5 * 4e-3)
    assert table["full_force"].item() - table["installed_force"].item() == pytest.approx(8e-3 * RATE)


def test_a_scenario_without_a_wire_has_no_spring_to_wind():
    with pytest.raises(MistakeError, match="valve-train: its springs have no wire"):
        find_spring_settings("valve-train")
    assert "law" in find_spring_settings("valve-train", given=["diameter=4 mm"])


def test_a_scenario_gives_wire_and_cam(tmp_path: Path):
    file = tmp_path / "wound.toml"
    file.write_text(
        'extends = "coil-clash"\n[components.spring.wire]\ndiameter = "3.8 mm"\nactive_coils = 5.5\n'
        'mean_diameter = ["26 mm", "20 mm"]\nfree_length = "52 mm"\ninstalled_length = "40 mm"\n'
        "peened = false\n"
    )
    found = find_spring_settings(str(file))
    assert found["mean_diameter"] == "26 mm, 20 mm"
    assert (found["law"], found["lift"]) == ("modified_trapezoid", 8e-3)
    with pytest.raises(MistakeError, match=r"--component valve|component='valve'"):
        find_spring_settings(str(file), "valve")
    assert "free_length" not in find_spring_settings(str(file), given=["pitch=8 mm"]), (
        "one replaces the other"
    )
    done = called("spring", str(file), cwd=tmp_path)
    assert (done.returncode, "end_coils 2, free_length 52 mm" in done.stdout) == (0, True), (
        "defaults are told"
    )
    made = sorted(path.name for path in (tmp_path / "results" / "wound-spring").iterdir())
    assert made == ["spring.nc", "spring.orders.csv", "spring.png"]
