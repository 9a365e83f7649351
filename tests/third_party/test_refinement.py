"""References by refinement: their errors are the true ones within their stated uncertainty."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tribocosim
from models.monolithic.difference import difference
from models.oscillators.exact import two_masses
from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from orchestrator.run.refinement import extrapolate
from orchestrator.scenario import ScenarioError

from .c_fmus import fmu
from .runs import ran, recorded, scenario
from .test_held_inputs import LINES

TIMES = np.linspace(0.0, 1.0, 41)


@given(
    order=st.floats(0.6, 5.5),
    scale=st.floats(1e-6, 10.0),
    slope=st.floats(-3.0, 3.0),
)
def test_an_error_of_one_order_is_extrapolated_exactly(order: float, scale: float, slope: float) -> None:
    """To rounding of the values, over what the extrapolation divides by."""
    true, error = np.sin(7.0 * TIMES), scale * (1.0 + slope * TIMES**2)
    runs = [true + error * step**order for step in (1.0, 0.5, 0.25)]
    limit, _, found = extrapolate(*runs, np.ones(len(TIMES)))
    assert found == pytest.approx(order, abs=1e-7)
    np.testing.assert_allclose(limit, true, atol=1e-12 + 1e-8 * scale)


def test_runs_that_do_not_converge_have_no_order() -> None:
    """The uncertainty is then the whole difference of the runs."""
    coarse, half, quarter = (np.sin(TIMES + phase) for phase in (0.0, 0.1, 0.3))
    limit, other, order = extrapolate(coarse, half, quarter, np.ones(len(TIMES)))
    assert np.isnan(order)
    assert limit is quarter
    assert other is coarse


@pytest.mark.parametrize(
    ("master", "signal", "expected"),
    [
        ("jacobi", "hold", 1.0),
        ("jacobi", "linear", 2.0),
        ("jacobi", "quadratic", 3.0),
        ("gauss_seidel", "linear", 2.0),
        ("gauss_seidel", "hermite", 4.0),
    ],
)
def test_errors_by_refinement_are_those_against_the_monolithic_reference(
    master: str, signal: str, expected: float, record: Any
) -> None:
    """Of the quarter car, within both uncertainties."""
    plain = tribocosim.load("quarter-car").with_({"master.name": master, "master.extrapolation": signal})
    against = {
        method: tribocosim.run(plain.with_({"reference.method": method})).summary["errors"]
        for method in ("monolithic", "refinement")
    }
    name = "chassis.position"
    true, found = against["monolithic"][name], against["refinement"][name]
    case = f"quarter car, {master} {signal}, 1 ms: {name} by refinement"
    own = found["reference_uncertainty"] + true["reference_uncertainty"]
    measured, allowed = found["relative_rms"], true["relative_rms"]
    record("Coupling", f"{case}, relative RMS error", measured, allowed, "monolithic", tolerance=own)
    record("Coupling", f"{case}, order", found["order"], expected, "order of the signal", tolerance=0.2)


@pytest.mark.parametrize("step", [4e-3, 1e-3])
def test_the_error_of_third_party_fmus_is_that_against_the_exact_solution(
    step: float, tmp_path: Path
) -> None:
    """Two masses, one an FMU of unknown equations that holds its inputs, against their matrix exponential."""
    tables = {
        "first": {"component": "coupled_mass", "participant": "in-process", "start": {"position": 1.0}},
        "second": {"participant": fmu("held_mass", 2, tmp_path)},
    }
    one = scenario(
        tables, connections=LINES, macro_step=step, reference={}, tolerance={"first.position": 1e-3}
    )
    summary, found = ran(one, tmp_path / "out")
    coupled, sprung = CoupledMassParameters(), SprungMassParameters(mass=1.0, stiffness=10.0, damping=0.5)
    exact = two_masses(found["time"], coupled, sprung, np.array([1.0, 0.0, 0.0, 0.0]))[:, 0]
    error = summary.errors["first.position"]
    true = difference(found["first.position"], exact)
    assert summary.reference_method == "refinement"
    assert error.relative_rms == pytest.approx(true.relative_rms, abs=error.uncertainty.relative_rms)
    assert error.order == pytest.approx(2.0, abs=0.1)
    assert summary.exit_status == (0 if true.relative_rms < 1e-3 else 1)


def test_an_fmu_that_is_exact_has_no_error(tmp_path: Path) -> None:
    table = {"participant": fmu("dahlquist", 2, tmp_path)}
    one = scenario({"decay": table}, reference={}, tolerance={"decay.x": 1e-9})
    summary, _ = ran(one, tmp_path / "out")
    assert summary.exit_status == 0
    assert summary.verdict.startswith("within the tolerance; the errors of the FMUs' own solvers")
    assert recorded(tmp_path / "out")["decay.x"][-1] < 1.0


@pytest.mark.parametrize("changes", [{"step_control": {}}, {"event_tolerance": 1e-6}])
def test_steps_of_different_lengths_are_refused(changes: dict[str, Any], tmp_path: Path) -> None:
    table = {"participant": fmu("dahlquist", 2, tmp_path)}
    with pytest.raises(ScenarioError, match="steps of one length"):
        ran(
            scenario({"decay": table}, reference={}, tolerance={"decay.x": 1e-9}, **changes), tmp_path / "out"
        )
