"""The analysis `finite_line`: the cam's contact, its table and its figure."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import xarray

from models.contact.hertz import ELASTIC_LIMIT
from orchestrator.analyses import load
from orchestrator.analyses._evaluate import analyse
from orchestrator.errors import MistakeError

ROUGH = {"nodes_per_half_width": 12.0, "end_cell": 0.3}
ANALYSIS = load("finite_line")


@pytest.mark.long
def test_the_nose_bears_spring_and_lift():
    """610 N on 28.88 mm: Hertz pressure 252.4 MPa; the slope of the set's own shaft is W l^2/(2 E J)."""
    values = ANALYSIS.complete({**ROUGH, "profile": "logarithmic", "alignment": 1.0, "shaft_length": 0.02})
    found = ANALYSIS.evaluate(values)
    # Half a unit of the last digit stated.
    assert found["load"] == pytest.approx(610.0, abs=0.5)
    assert found["hertz_pressure"] == pytest.approx(252.4e6, abs=0.05e6)
    bending = 207e9 * math.pi * 0.02**4 / 64.0
    assert found["slope"] == pytest.approx(610.0 * 0.02**2 / (2.0 * bending), rel=1e-3)
    assert found["moment"] < 0.0


@pytest.mark.long
def test_table_and_figure(tmp_path: Path):
    """All profiles, aligned and not; the results are those of the chosen one."""
    settings = [*(f"{key}={value}" for key, value in ROUGH.items()), "alignment=1", "shaft_length=20 mm"]
    found = analyse("finite_line", settings, tmp_path)
    assert (tmp_path / "finite_line.png").read_bytes().startswith(b"\x89PNG")
    with xarray.open_dataset(tmp_path / "finite_line.nc", engine="h5netcdf") as table:
        assert set(table["kind"].values) == {"straight", "chamfered", "crowned", "logarithmic"}
        straight = table["peak_along"].sel(kind="straight", aligned="misaligned").values
        # Interpolated from the lines of the grid to those of the table.
        assert np.max(straight) == pytest.approx(found["largest_pressure"], rel=0.05)
        aligned = table["peak_along"].sel(kind="straight", aligned="aligned").values
        np.testing.assert_allclose(aligned, aligned[::-1], rtol=1e-4)
        assert table["pressure"].sizes["x"] > 100


@pytest.mark.long
def test_through_the_cycle_the_middle_is_the_line_contact(tmp_path: Path):
    """Straight, aligned, at the flank, before the first reversal, between both and at the nose."""
    settings = ["instants=4", "start=2.0", "end_cell=0.4", "speed=100"]
    found = analyse("finite_line_cycle", settings, tmp_path)
    assert (tmp_path / "finite_line_cycle.png").read_bytes().startswith(b"\x89PNG")
    assert found["not_found"] == 0
    assert found["messages"] == ""
    with xarray.open_dataset(tmp_path / "finite_line_cycle.nc", engine="h5netcdf") as table:
        middle = table["middle_film"].sel(kind="straight", aligned="aligned").values
        # Its ends bear more than their share of the load, some 2 % of it, which moves the film by up to half
        # as much at the flank (M = 0.7, nearly rigid); the grid errs by 0.5 %.
        np.testing.assert_allclose(middle, table["line_film"].values, rtol=1.5e-2)


@pytest.mark.long
def test_through_the_cycle_an_end_bears_what_misalignment_puts_there():
    values = {"instants": 2, "start": 2.4, "end_cell": 0.4, "shaft_length": 0.03}
    cycle = load("finite_line_cycle")
    ratios = [cycle.evaluate(cycle.complete({**values, "alignment": a}))["largest_ratio"] for a in (0.0, 1.0)]
    assert ratios[1] > ratios[0] > 1.0


@pytest.mark.parametrize("name", ["finite_line", "finite_line_cycle"])
def test_a_mistake_in_a_profile_is_the_users(name):
    analysis = load(name)
    with pytest.raises(MistakeError, match=r"crown radius = 0.001 m: must be >= length/2"):
        analysis.evaluate(analysis.complete({"profile": "crowned", "crown_radius": 1e-3}))


@pytest.mark.long
def test_at_a_reversal_the_contact_is_dry_and_says_so(tmp_path: Path):
    """At 144 degrees only rounding is left of the entraining velocity."""
    settings = ["angle=144 deg", *(f"{key}={value}" for key, value in ROUGH.items())]
    found = analyse("finite_line", settings, tmp_path)
    assert (tmp_path / "finite_line.png").read_bytes().startswith(b"\x89PNG")
    assert (found["smallest_film"], found["middle_film"]) == (0.0, 0.0)
    assert "taken as dry" in found["warnings"]
    # The middle of the length is Hertz's, but for the share of the load that the ends bear (some 5 %).
    assert found["middle_pressure"] == pytest.approx(found["hertz_pressure"], rel=0.06)


@pytest.mark.long
def test_yield_is_said_and_dry_instants_are_left_out(tmp_path: Path):
    """144, 156, 168, 180 degrees, misaligned: two reversals, between them more than bodies bear."""
    settings = ["instants=4", "start=144 deg", "end_cell=0.15", "alignment=1", "shaft_length=40 mm"]
    found = analyse("finite_line_cycle", settings, tmp_path)
    assert (found["dry"], found["at_angle"]) == (2, pytest.approx(156.0))
    assert found["curve"].startswith("straight, misaligned by up to 0.")
    assert found["messages"].startswith("144, 168 deg: entrainment all but ends: no film")
    assert "156 deg: the pressure reaches" in found["messages"]
    with xarray.open_dataset(tmp_path / "finite_line_cycle.nc", engine="h5netcdf") as table:
        one = table.sel(kind="straight", aligned="misaligned")
        assert found["largest_pressure_of_cycle"] == one["largest_pressure"].values[1] > ELASTIC_LIMIT
        ratio = (one["largest_pressure"] / table["line_pressure"]).values
        assert found["largest_ratio"] == max(ratio[1], ratio[3]) < max(ratio)
