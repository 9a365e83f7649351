"""The energy ledger: it closes, is exact where the coupling is, falls with the order."""

import numpy as np
import pytest

from models.core.system import System
from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from orchestrator.engine.energy import Ledger, add_counting, lines
from orchestrator.engine.observer import Observer
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.run.record import ResultRecorder
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.stepping import ControlledSteps, StepControl
from orchestrator.store.journal import Recorded
from tests.models import exact_oscillators as solutions

from .coupled import run_coupled
from .two_masses import START, two_masses

UNDAMPED = {"damping": 0.0, "coupling_damping": 0.0}
BOND = "first.force * second.velocity"
STOP = 2.0


def booked(master, step, every=1, **parameters):
    system = add_counting(two_masses(**parameters), ["first", "second"])
    ledger = Ledger(system, every)
    run_coupled(system, master, step, STOP, ledger)
    return ledger


ORDERS = [(kind(signal), k) for kind in (Jacobi, GaussSeidel, Iterated) for k, signal in
          enumerate(("hold", "linear", "quadratic"), 1)]  # fmt: skip


@pytest.mark.parametrize("master", [master for master, _ in ORDERS], ids=repr)
def test_the_whole_ledger_closes_to_rounding(master, record):
    """Stored and dissipated - sources = created over bonds + what came outside of them."""
    ledger = booked(master, 1e-2)
    # Three sums of the same two numbers: to the last bit.
    taken, given, created = (ledger[f"{word} {BOND}"] for word in ("taken", "given", "created"))
    assert given + created == pytest.approx(taken, rel=4e-16)
    assert created == taken - given == ledger["created"]
    account = ledger.account()
    parts = account.components.values()
    spent = sum(part.stored + part.dissipated - part.sourced for part in parts)
    # Energies of 25 J at the start, 200 steps, sums of a dozen numbers.
    found, source = account.created + account.outside_bonds, "stored + dissipated - sourced"
    rounding = 200 * 25 * 2.3e-16
    record("Coupling", "energy created by a coupling (J)", found, spent, source, tolerance=rounding)
    for part in parts:
        assert part.outside_bonds == pytest.approx(part.jumped + part.unaccounted, abs=1e-12)
        assert part.outside_bonds == pytest.approx(
            part.stored + part.dissipated - part.sourced - part.received, abs=1e-12
        )


def test_a_component_that_only_takes_a_force_closes_in_itself():
    """Its stored energy does not see the force: nothing comes outside of the bond, in any coupling."""
    second = booked(Jacobi("hold"), 1e-2).account().components["second"]
    assert second.dissipated > 0.1
    # 1e-10 per integration step of energies below 25 J.
    assert abs(second.outside_bonds) < 1e-9


@pytest.mark.parametrize(("master", "order"), ORDERS, ids=repr)
def test_spurious_energy_falls_with_the_order_of_the_method(master, order, record):
    coarse, fine = (abs(booked(master, h).account().bonds[BOND].largest_created) for h in (2e-3, 1e-3))
    quantity = (
        f"order of the energy that the coupling creates, {type(master).__name__}, {master.extrapolation}"
    )
    record("Coupling", quantity, np.log2(coarse / fine), order, "order of the signals", tolerance=0.1)


def test_a_converged_coupling_exchanges_the_energies_of_the_exact_solution(record):
    """Undamped, what the second mass took is its mechanical energy by the matrix exponential."""
    ledger = booked(Iterated("hermite", 1e-12), 1e-3, **UNDAMPED)
    first = CoupledMassParameters(damping=0.0, coupling_damping=0.0)
    second = SprungMassParameters(damping=0.0)
    x, v = solutions.two_masses(np.array([0.0, STOP]), first, second, START)[-1, 2:]
    energy = 0.5 * (second.mass * v**2 + second.stiffness * x**2)
    assert energy > 0.1
    # The Hermite signal's error of order four at H = 1 ms, and 2000 steps of 1e-10.
    for side in ("taken", "given"):
        found, quantity = ledger[f"{side} {BOND}"], f"energy {side} over a bond of two masses (J)"
        record("Coupling", quantity, found, energy, "matrix exponential", tolerance=1e-7)


def test_nobody_sees_that_energies_are_counted(tmp_path):
    """The motion's bits, and the source of every step, are recorded as in a run without ledger; counted
    energies are outputs between the others."""
    system, found = two_masses(), []
    quantities = {f"{name}.{field.name}": field.quantity for name, instance in system.instances.items()
                  for field in instance.component.outputs.fields}  # fmt: skip
    for counted in (system, add_counting(system, ["first", "second"])):
        steps = ControlledSteps(5e-3, StepControl("predictor_corrector"))
        run_coupled(counted, Iterated("quadratic"), steps, STOP, ResultRecorder(tmp_path, quantities, 1))
        found.append([(tmp_path / f"{name}.journal").read_bytes() for name in ("coupled", "steps")])
    assert found[0] == found[1]
    sources = np.concatenate([*Recorded(tmp_path / "steps.journal").blocks(1000)])[:, 5]
    assert len({*sources}) > 1


def test_every_record_books_all_energies_since_the_last_one():
    """Counts are cumulative: fewer records lose nothing."""
    often, seldom = booked(Jacobi("linear"), 1e-2), booked(Jacobi("linear"), 1e-2, every=50)
    for channel in often.channels:
        assert seldom[channel] == often[channel], channel


def test_a_bond_that_only_one_side_counts_is_named_and_not_booked():
    system = add_counting(two_masses(), ["second"])
    ledger = Ledger(system)
    assert ledger.not_counted == [BOND]
    assert any(BOND in line and "not counted" in line for line in lines(ledger.account()))


def test_a_ledger_goes_on_from_its_state(tmp_path):
    """Two halves with the state handed on, as after a checkpoint, come to what the whole run comes to."""
    system = add_counting(two_masses(), ["first", "second"])
    whole, first = Ledger(system, folder=tmp_path), Ledger(system)

    class Halves(Observer):
        """Hands the state from one ledger to the next in the middle."""

        now = first

        def begin(self, names):
            self.now.begin(names)

        def observe(self, time, outputs, step):
            self.now.observe(time, outputs, step)
            if abs(time - 1.0) < 1e-9:
                following = Ledger(system)
                following.resume(system.outputs.names, self.now.state())
                self.now = following

        def end(self, complete, message):
            self.now.end(complete, message)

    halves = Halves()
    run_coupled(system, GaussSeidel("linear"), 1e-2, STOP, whole, halves)
    assert halves.now is not first
    assert halves.now.account() == whole.account()


class Impulses:
    """Angular impulses between a bouncing slider-crank and its free flywheel, booked by a ledger.

    An impulse dJ gives the mechanism dJ w and takes dJ w - dJ^2 / 2 I from a shaft with the speed w just
    before it. Here w is that at the macro step's start: `bound` (J) is what its change can make of it.
    """

    def __init__(self, inertia, stop, start):
        step = 1e-5
        given = [
            "flywheel.parameters.motion='free'",
            f"flywheel.parameters.inertia={inertia}",
            "slider_crank.parameters.joint_friction=0",
            *start,
        ]
        base = build_system(load("slider-crank", [f"components.{setting}" for setting in given]))
        connections = [(str(c.source), str(c.target)) for c in base.connections]
        taken = ("slider_crank.crank_impact_impulse", "flywheel.load_impulse[1]")
        system = add_counting(System(base.instances, [*connections, taken]), list(base.instances))
        self.ledger = Ledger(system)
        self.records = run_coupled(system, GaussSeidel("quadratic"), step, stop, self.ledger)
        speed, impulse = self.records["flywheel.speed"][:-1], np.diff(self.records[taken[0]])
        self.given = float((impulse * speed).sum())
        self.destroyed = float((0.5 * impulse**2 / inertia).sum())
        self.bound = float(np.abs(impulse).sum() * step * np.abs(self.records["flywheel.acceleration"]).max())


# How long, and from where: shortly before an impact, and with three of them.
ONE = (4e-4, ("flywheel.start.angle=0.7077", "slider_crank.start={psi = 0.01405, psi_rate = 5.89}"))
THREE = (0.03, ())
COURSES = pytest.mark.parametrize(
    ("stop", "start"),
    [pytest.param(*ONE, marks=pytest.mark.plain), pytest.param(*THREE, marks=pytest.mark.long)],
    ids=["one", "three"],
)


@COURSES
def test_impulses_take_their_work_from_the_shaft(stop, start, record):
    found = Impulses(0.1, stop, start)
    assert found.destroyed > found.bound > 0.0
    quantity, exact = "work of impact impulses on a free flywheel (J)", found.destroyed - found.given
    outside = found.ledger["outside_bonds flywheel"]
    record("Coupling", quantity, outside, exact, "speeds and impulses", tolerance=found.bound)


@COURSES
def test_what_impulses_take_from_the_shaft_the_mechanism_stores_or_loses(stop, start, record):
    """The shaft is so heavy that its speed, and with it the mechanism's own, jumps by less than 1e-6.

    Without friction at the joint an impact with impulse P and velocity v dissipates (1 - e) P v / 2.
    """
    found = Impulses(1e4, stop, start)
    assert abs(found.given) > 0.1
    assert found.ledger["outside_bonds slider_crank"] == pytest.approx(found.given, rel=1e-6)
    assert found.ledger["outside_bonds flywheel"] == pytest.approx(-found.given, rel=1e-6)
    counts = np.diff(found.records["slider_crank.impact_count"])
    assert counts.sum() == (1.0 if start else 3.0)
    assert counts.max() == 1.0
    assert not np.any(found.records["slider_crank.sliding"])
    sides = (np.diff(found.records[f"slider_crank.{side}_impact_impulse"]) for side in ("upper", "lower"))
    velocity = found.records["slider_crank.last_impact_velocity"][1:]
    losses = 0.5 * (1.0 - 0.9) * float((sum(sides) * velocity).sum())
    # Rounding of some hundred sums.
    dissipated = found.ledger["dissipated slider_crank"]
    record("Coupling", "energy lost in impacts (J)", dissipated, losses, "(1 - e) P v / 2", relative=1e-12)
