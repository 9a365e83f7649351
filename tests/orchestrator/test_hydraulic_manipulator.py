"""The hydraulic manipulator of cosim-benchmarks, which a benchmark couples: its equations."""

import numpy as np
import pytest

from benchmarks.hydraulic_manipulator import OPENING, PRESSURE_1, PRESSURE_2, WEIGHT, links
from benchmarks.public import PUBLISHED, compare_manipulator, describe_manipulator, find_data
from models.core.system import Instance, System
from models.monolithic import solve
from orchestrator.scenario.system import build_system


@pytest.mark.long
def test_the_start_is_the_published_equilibrium() -> None:
    """To the digits that are printed there; nothing moves while the valve does not (its motion begins with
    t^2)."""
    assert [f"{PRESSURE_1 / 1e6:.4f}", f"{PRESSURE_2 / 1e6:.4f}"] == ["3.1708", "4.5292"]
    assert (f"{OPENING:.4f}", f"{WEIGHT / 1e3:.3f}") == ("0.4543", "8.829")
    solution = solve(build_system(describe_manipulator(1.0)), np.array([0.0, 1e-4]))
    np.testing.assert_allclose(solution["links.length"], 0.5, atol=1e-12)
    np.testing.assert_allclose(solution["cylinder.force"], 8829.0, rtol=1e-6)


@pytest.mark.long
def test_links_that_nothing_lifts_keep_their_energy(record) -> None:
    """Over 0.5 s of a free fall of both, of 1.5 kJ."""
    system = System({"links": Instance(links(), inputs={"force": 0.0})}, [])
    solution = solve(system, np.linspace(0.0, 0.5, 51), tolerance=1e-10)
    component, energy = links(), np.zeros((51, 3))
    p, u = component.parameters.start, np.zeros(1)
    for k, x in enumerate(solution.state):
        component.flat_energy(0.0, x, u, p, energy[k])
    record(
        "FMUs", "manipulator in free fall: energy (J)", energy[:, 0], energy[0, 0], "start", tolerance=1e-5
    )
    assert np.ptp(solution["links.length"]) > 0.1


def test_the_solution_is_the_published_one(record) -> None:
    """Of the manoeuvre M2 over 10 s, which was integrated there in steps of 0.05 ms with a method of first
    order: some 1e-4 of each output's range."""
    folder = find_data([PUBLISHED])
    if folder is None:
        pytest.skip(f"{PUBLISHED} is in no folder of data of others (TRIBOCOSIM_THIRD_PARTY)")
    for output, difference in compare_manipulator(folder / PUBLISHED).items():
        record("FMUs", f"hydraulic manipulator, M2: {output}", difference, 0.0, "published", tolerance=5e-4)
