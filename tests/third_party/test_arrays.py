"""Arrays as values of a scenario, and structural parameters that set their sizes."""

from pathlib import Path

import numpy as np
import pytest

from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load
from orchestrator.scenario.ssp import export

from .c_fmus import fmu
from .public import public
from .runs import never, ran, scenario


def test_structural_parameters_set_the_sizes_of_arrays(tmp_path: Path) -> None:
    """dx/dt = u with three states in the place of two: x = x0 + u t. The written scenario is equal."""
    table = {
        "participant": fmu("sized", 3, tmp_path),
        "process": "own",
        "structure": {"n": 3},
        "parameters": {"x0": [1.0, -2.0, 0.5]},
        "inputs": {"u": [0.25, 0.5, -1.0]},
    }
    one = scenario({"one": table})
    summary, found = ran(one, tmp_path / "out")
    assert summary.complete, summary.message
    assert "one.y[4]" not in found
    for i, (start, slope) in enumerate(((1.0, 0.25), (-2.0, 0.5), (0.5, -1.0)), 1):
        np.testing.assert_allclose(
            found[f"one.y[{i}]"], start + slope * found["time"], rtol=1e-13, atol=1e-13
        )
    assert load(tmp_path / "out" / "scenario.toml") == one


def test_connections_reach_elements_that_a_structural_parameter_added(tmp_path: Path) -> None:
    """Of a chain of integrals the second is of order two in time; exact, as the means of a line are."""
    path = fmu("sized", 3, tmp_path)
    size = {"participant": path, "structure": {"n": 3}}
    tables = {
        "one": size | {"parameters": {"x0": [0.0, 0.0, 1.0]}, "inputs": {"u": [0.0, 0.0, 2.0]}},
        "two": size | {"parameters": {"x0": [0.0, 0.0, 0.0]}},
    }
    one = scenario(tables, connections=["one.y[3] -> two.u[3]"], master={"name": "gauss_seidel"})
    _, found = ran(one, tmp_path / "out")
    np.testing.assert_allclose(found["two.y[3]"], found["time"] + found["time"] ** 2, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    "interface", [pytest.param("co_simulation", marks=pytest.mark.long), "model_exchange"]
)
def test_a_public_state_space_takes_matrices(interface: str, tmp_path: Path) -> None:
    """dx/dt = A x + B u from rest with a nilpotent A: x = t b u + t^2/2 A b u, exact for the solver of model
    exchange; the steps h of its co-simulation by Euler give t (t - h)."""
    table = {
        "participant": public("reference-fmus-3/StateSpace.fmu"),
        "interface": interface,
        "parameters": {
            "A": [[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
            "B": [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.0]],
            "D": [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 5.0]],
        },
        "inputs": {"u": [0.0, 1.0, 3.0]},
    }
    _, found = ran(scenario({"one": table}, stop_time=4.0, macro_step=1.0), tmp_path / "out")
    t = found["time"]
    first = t**2 if interface == "model_exchange" else t * (t - 1e-3)
    np.testing.assert_allclose(found["one.y[1]"], first, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(found["one.y[2]"], 2.0 * t, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(found["one.y[3]"], 15.0, rtol=1e-15)


def test_a_package_has_no_structural_parameters(tmp_path: Path) -> None:
    table = {"participant": fmu("sized", 3, tmp_path), "structure": {"n": 1}, "parameters": {"x0": 1.0}}
    with pytest.raises(ScenarioError, match=r"one.structure: packages of SSP 1.0 have no"):
        export(scenario({"one": table}), tmp_path / "one.ssp", never)
    assert not (tmp_path / "one.ssp").exists()
