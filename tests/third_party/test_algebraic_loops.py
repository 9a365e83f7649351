"""Rings of FMUs whose outputs depend on their inputs at the same instant, against the linear solution.

y = gain u + x and dx/dt = push - decay u in every FMU, u being the y of the one before it in the ring. x
starts with 1, 2, ..., or with zero where it is pushed.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from models.core.quantities import Vector
from orchestrator.analyses.stability.choice import choose
from orchestrator.engine.coupling import Coupling
from orchestrator.masters import Iterated, Newton
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.run.summary import Summary
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.system import resolve

from .c_fmus import fmu
from .runs import never, opened, ran, scenario

# Sizes of rings, and the products of their gains.
RINGS = ((2, 0.3), (2, -0.9), (3, 0.9), (3, -5.0))


def written(
    gains: Sequence[float], decays: Sequence[float], folder: Path, pushed: float
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """Components and connections of a scenario."""
    path = fmu("feedback", 2, folder)
    tables = {
        f"unit{i}": {
            "participant": path,
            "parameters": {"gain": gain, "decay": decay, "push": pushed},
            "start": {"x": 0.0 if pushed else 1.0 + i},
        }
        for i, (gain, decay) in enumerate(zip(gains, decays, strict=True))
    }
    names = list(tables)
    return tables, [f"{names[i - 1]}.y -> {name}.u" for i, name in enumerate(names)]


def ring(
    gains: Sequence[float], decays: Sequence[float], folder: Path, pushed: float = 0.0, **changes: Any
) -> tuple[Summary, Vector, Vector]:
    """A run: its summary, the times, and y of the FMUs at these, n x FMUs."""
    tables, lines = written(gains, decays, folder, pushed)
    settings = {"stop_time": 0.2, "macro_step": 0.01, "connections": lines} | changes
    count = len(list(folder.glob("out*")))
    summary, found = ran(scenario(tables, **settings), folder / f"out{count}")
    return summary, found["time"], np.array([found[f"{name}.y"] for name in tables]).T


def exact(gains: Sequence[float], decays: Sequence[float], pushed: float, times: Vector) -> Vector:
    n = len(gains)
    before = np.roll(np.eye(n), 1, axis=0)
    solved = np.linalg.inv(np.eye(n) - np.diag(gains) @ before)
    rate = np.zeros((n + 1, n + 1))
    rate[:n, :n] = -np.diag(decays) @ before @ solved
    rate[:n, n] = pushed
    start = np.append((1.0 + np.arange(n)) * (pushed == 0.0), 1.0)
    return np.array([solved @ (expm(rate * t) @ start)[:n] for t in times])


@pytest.mark.parametrize(("size", "product"), RINGS)
def test_a_ring_of_any_gain_but_one_starts_with_values_that_agree(size, product, tmp_path):
    gains = [
        math.copysign(abs(product) ** (1.0 / size), product),
        *[abs(product) ** (1.0 / size)] * (size - 1),
    ]
    decays = [0.0] * size
    _, times, y = ring(gains, decays, tmp_path, stop_time=0.01, master={"name": "newton"})
    # Ten roundings for the condition of a ring with a gain of 0.9.
    np.testing.assert_allclose(y, exact(gains, decays, 0.0, times), rtol=1e-11)


def test_a_ring_with_a_gain_of_one_is_named(tmp_path):
    tables, lines = written([2.0, 0.5], [0.0, 0.0], tmp_path, 0.0)
    one = scenario(tables, connections=lines)
    summary = run(one, tmp_path / "out", never, Reporter(), figures=False)
    assert not summary.complete
    assert "unit" in summary.message
    assert "gain of 1" in summary.message
    asked = scenario(tables, connections=lines, master={"name": "auto"}, tolerance={"unit0.y": 1e-3})
    with pytest.raises(ScenarioError, match=r"'auto': .*gain of 1"):
        choose(resolve(asked), Reporter())


def test_a_ring_starts_with_rates_that_agree(tmp_path):
    """Of fourth order from the first step on, though values agree from the start and only rates do not."""
    gains, decays = (0.9, 0.8, 0.9), (1.0, 2.0, 1.5)
    errors = []
    for step in (0.02, 0.01):
        master = {"name": "newton", "extrapolation": "hermite", "tolerance": 1e-13}
        _, times, y = ring(gains, decays, tmp_path, 1.0, macro_step=step, master=master)
        errors.append(np.abs(y - exact(gains, decays, 1.0, times)).max())
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.1)
    assert errors[1] < 1e-5


@pytest.mark.parametrize(
    ("product", "master"),
    [
        (0.45, Iterated(acceleration="none")),
        (0.45, Iterated(extrapolation="hermite")),
        (0.9, Iterated()),
        (0.9, Newton()),
        (-5.0, Iterated(acceleration="quasi_newton")),
    ],
    ids=lambda value: (
        f"{type(value).__name__}-{value.extrapolation}" if hasattr(value, "step") else str(value)
    ),
)
def test_end_values_are_right_to_the_iterations_tolerance(product, master, tmp_path):
    """Whatever the lengths of the steps: a loop's gain does not depend on them."""
    tables, lines = written([product, 1.0], [1.0, 2.0], tmp_path, 0.0)
    one = scenario(tables, connections=lines)
    time, errors = 0.0, []
    exact = replace(master, tolerance=1e-13, maximum_iterations=100)
    with opened(one) as (plan, units):
        coupling = Coupling(plan.system, units, master.degree)
        coupling.initialise(0.0, 1.0)
        coupling.prove(0.0)  # without, each way back would be a fresh instance
        for length in np.tile([1e-2, 1e-2, 1e-3, 3e-4, 1e-3], 6):
            with coupling.points.keep() as saved:
                exact.step(coupling, time, length)
                best = coupling.state.values.copy()
                coupling.points.restore(saved)
                master.step(coupling, time, length)
            errors.append(np.max(np.abs(coupling.state.values - best) / np.maximum(1.0, np.abs(best))))
            time += length
            coupling.accept(time)
    assert max(errors) <= master.tolerance
