"""Step control without a way back: what it sees, what it costs, and what it says of itself."""

from typing import Any

import numpy as np
import pytest

from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from orchestrator.masters import MASTERS
from orchestrator.participants.protocol import Abilities
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.stepping import FixedSteps, ForwardSteps, StepControl, Stepper
from tests.models import exact_oscillators as exact

from .coupled import build_participants, run_coupled

STOP = 2.0
MASSES = build_system(load("two-masses"))
COUPLED = CoupledMassParameters(**MASSES.instances["first"].parameters)
SPRUNG = SprungMassParameters(**MASSES.instances["second"].parameters)
# An output of each problem, and its exact values.
TRUE: dict[str, Any] = {
    "quarter-car": ("chassis.position", lambda at: exact.quarter_car(at)[:, 0]),
    "two-masses": ("first.position", lambda at: exact.two_masses(at, COUPLED, SPRUNG, MASSES.x0)[:, 0]),
}


class OneWay:
    """A participant that fails where it is asked to go back."""

    def __init__(self, unit: Any) -> None:
        self._unit, self.abilities = unit, Abilities(restorable=False)

    def __getattr__(self, name: str) -> Any:
        assert name not in ("save", "restore")
        return getattr(self._unit, name)


def ride(
    steps: Stepper, master: str = "gauss_seidel", name: str = "quarter-car", signal: str = "quadratic",
    wrap: Any = OneWay,
) -> tuple[float, Any]:  # fmt: skip
    """The error of a scenario's first output (RMS over the RMS of its motion), and the records."""
    output, solve = TRUE[name]
    system = build_system(load(name))
    units = {part: wrap(unit) for part, unit in build_participants(system).items()}
    found = run_coupled(system, MASTERS[master](extrapolation=signal), steps, STOP, **units)
    true = solve(found.times[1:])
    error = np.sqrt(np.mean((found[output][1:] - true) ** 2) / np.mean(true**2))
    return float(error), found


def control(tolerance: float) -> ForwardSteps:
    return ForwardSteps(2.5e-3, StepControl("defect", tolerance, tolerance))


@pytest.mark.parametrize(
    ("name", "master", "most"),
    [
        pytest.param("quarter-car", "jacobi", 1.0, marks=pytest.mark.long),
        ("quarter-car", "gauss_seidel", 1.0),
        # A motion of even liveliness, where equal steps are best.
        pytest.param("two-masses", "gauss_seidel", 1.1, marks=pytest.mark.long),
        ("two-masses", "jacobi", 1.05),
    ],
)
def test_the_error_falls_with_the_tolerance_and_is_compared_with_fixed_steps(name, master, most, record):
    """Participants that cannot go back, at the same number of steps."""
    loose, _ = ride(control(1e-3), master, name)
    tight, found = ride(control(1e-5), master, name)
    assert tight < 0.1 * loose
    assert found.statistics.rejected_steps == 0
    fixed, same = ride(FixedSteps(STOP / found.statistics.macro_steps), master, name)
    assert same.statistics.macro_steps == found.statistics.macro_steps
    case = f"{name}, defect, {master}: error over that of fixed steps at equal work"
    record("Coupling", case, tight / fixed, 0.0, "bound", tolerance=most)


@pytest.mark.long
@pytest.mark.parametrize("master", ["gauss_seidel", "jacobi"])
def test_where_equal_steps_are_best_controlled_ones_come_near(master, record):
    """A motion of even liveliness, over seven tolerances: the steps at the start are all that is lost."""
    ratios = []
    for tolerance in np.geomspace(1e-3, 1e-6, 7):
        error, found = ride(control(float(tolerance)), master, "two-masses")
        fixed, _ = ride(FixedSteps(STOP / found.statistics.macro_steps), master, "two-masses")
        ratios.append(error / fixed)
    case = f"two-masses, defect, {master}, 1e-3 to 1e-6: error over that of fixed steps at equal work"
    record("Coupling", f"{case}, median", float(np.median(ratios)), 0.0, "bound", tolerance=1.1)
    record("Coupling", f"{case}, worst", max(ratios), 0.0, "bound", tolerance=1.2)


@pytest.mark.parametrize("signal", ["linear", "quadratic"])
@pytest.mark.parametrize("master", ["jacobi", "gauss_seidel"])
def test_participants_that_cannot_go_back_begin_as_well_as_others(master, signal):
    """Two masses on a spring that is stretched at the start, with equal steps: the same error."""
    error = []
    for wrap in (OneWay, lambda unit: unit):
        missed, found = ride(FixedSteps(5e-3), master, "two-masses", signal=signal, wrap=wrap)
        error.append(missed)
        assert found.statistics.do_steps <= 2 * (STOP / 5e-3 + 16)
    assert error[0] == pytest.approx(error[1], rel=0.1)


@pytest.mark.long
def test_a_step_over_the_tolerance_is_kept_and_told():
    """The two masses start with a force that is in no signal yet."""
    steps = ride(control(1e-8), name="two-masses")[1].steps[1:]
    assert steps[0].length == pytest.approx(2.5e-5)
    assert max(step.error for step in steps[:10]) > 1.0
    assert np.mean([step.error > 1.0 for step in steps[10:]]) < 0.05
