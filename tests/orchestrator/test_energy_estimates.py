"""Estimated energies of participants that do not count theirs: against counts, and unseen by all others."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from rich.console import Console

from models.oscillators import exact as solutions
from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from orchestrator.engine.energy import Ledger, Trimmed, add_counting, add_estimates, lines
from orchestrator.engine.energy.estimate import Estimating, without_estimates
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.participants import in_process
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.scenario.files import load

from .coupled import Wrapper, run_coupled
from .recorder import Recorder
from .small_fmus import small_fmu
from .two_masses import START, two_masses

BOND = "first.force * second.velocity"
STOP = 2.0


class Unrated(Wrapper):
    """A participant that gives no rates."""

    def connect(self, bound):
        self._inner.connect(bound._replace(rates=np.zeros(0)))
        return [False] * len(bound.output_names)


def booked(master, step, observers=(), rated=True, **parameters):
    """The ledger of a run in which the second mass does not count."""
    system = add_estimates(add_counting(two_masses(**parameters), ["first"]))
    ledger = Ledger(system)
    second = system.instances["second"]
    unit = in_process("second", without_estimates(second))
    unit = Estimating(unit if rated else Unrated(unit), second.component)
    run_coupled(system, master, step, STOP, ledger, *(Trimmed(o, system) for o in observers), second=unit)
    return ledger


def counts(master, step):
    system = add_counting(two_masses(), ["first", "second"])
    ledger = Ledger(system)
    run_coupled(system, master, step, STOP, ledger)
    return ledger


def misestimated(master, step, rated):
    """By how much the estimate of what the second mass took is off what it counts (J)."""
    channel = f"taken {BOND}"
    return booked(master, step, rated=rated)[channel] - counts(master, step)[channel]


@pytest.mark.parametrize("master", [Jacobi("hold"), Jacobi("quadratic"), GaussSeidel("linear")], ids=repr)
@pytest.mark.parametrize(("rated", "order"), [(True, 4.0), (False, 2.0)], ids=["rates", "no rates"])
def test_an_estimate_comes_to_what_is_counted_with_its_order(master, rated, order):
    coarse, fine = (abs(misestimated(master, step, rated)) for step in (1e-2, 5e-3))
    assert np.log2(coarse / fine) > order - 0.25


def test_an_estimate_over_a_converged_coupling_is_the_energy_of_the_exact_solution():
    """Undamped, what the second mass took is its mechanical energy by the matrix exponential; iterations
    that are taken back leave nothing in the estimate."""
    undamped = {"damping": 0.0, "coupling_damping": 0.0}
    ledger = booked(Iterated("hermite", 1e-12), 1e-3, **undamped)
    first, second = CoupledMassParameters(**undamped), SprungMassParameters(damping=0.0)
    x, v = solutions.two_masses(np.array([0.0, STOP]), first, second, START)[-1, 2:]
    energy = 0.5 * (second.mass * v**2 + second.stiffness * x**2)
    # As for counts: of fourth order at H = 1 ms.
    assert ledger[f"taken {BOND}"] == pytest.approx(energy, abs=1e-7)


def test_estimates_are_named_in_channels_account_and_words():
    ledger = booked(Jacobi("linear"), 1e-2)
    assert ledger.not_counted == []
    for channel in (f"taken {BOND}", f"created {BOND}"):
        assert "estimated" in ledger.quantities[channel].description
    assert "estimated" not in ledger.quantities[f"given {BOND}"].description
    account = ledger.account()
    assert account.bonds[BOND].estimated == ["second"]
    assert list(account.components) == ["first"]
    assert any("second counts no energies" in line and "estimated" in line for line in lines(account))


def test_nobody_sees_the_estimates():
    """Names and bits are those of a run without ledger."""
    plain, beside = run_coupled(two_masses(), GaussSeidel("quadratic"), 1e-2, STOP), Recorder()
    booked(GaussSeidel("quadratic"), 1e-2, [beside])
    assert beside.names == plain.names
    np.testing.assert_array_equal(beside.rows, plain.rows)


@pytest.mark.long
def test_a_third_party_fmu_has_its_bond_booked(tmp_path):
    """It holds its force, so that what it took is the sum of force times way; the estimate knows velocities
    at the ends of steps and is off by the trapezoidal rule's remainder, F v'' H^3 / 12 for each."""
    step = 5e-3
    changes = [
        f"components.second.participant='{small_fmu('sound', tmp_path)}'",
        "components.first.participant='in-process'", "components.second.parameters.stiffness=10",
        "components.second.parameters.damping=0.5", "energy.ledger=true", "master.name='jacobi'",
        "master.extrapolation='hold'", f"macro_step={step}", f"output_step={step}", f"stop_time={STOP}",
        "reference.enabled=false",
    ]  # fmt: skip
    quiet = Reporter(Console(quiet=True))
    summary = run(load("two-masses", changes), tmp_path / "out", lambda *_: Path(), quiet, figures=False)
    assert summary.complete, summary.message
    assert summary.energy.not_counted == []
    bond = summary.energy.bonds[BOND]
    assert bond.estimated == ["second"]
    with h5py.File(tmp_path / "out" / "result.nc") as file:
        force, x, v = (file["coupled"][n][:] for n in ("first.force", "second.position", "second.velocity"))
        assert "estimated" in str(file["energy"][f"taken {BOND}"].attrs["long_name"])
    p = SprungMassParameters(stiffness=10.0, damping=0.5)
    taken = float(force[:-1] @ np.diff(x))
    # v'' = -(k v + d v')/m along a step with its force held, at both ends.
    bends = [
        np.abs(p.stiffness * w + p.damping * (force[:-1] - p.stiffness * y - p.damping * w) / p.mass) / p.mass
        for w, y in ((v[:-1], x[:-1]), (v[1:], x[1:]))
    ]
    remainder = float(np.abs(force[:-1]) @ np.maximum(*bends)) * step**3 / 12.0
    assert 0.0 < remainder < 1e-3 * abs(taken)
    # v'' between the ends of a step may be larger than at both, by a part of step times frequency.
    assert bond.taken == pytest.approx(taken, abs=1.05 * remainder)
