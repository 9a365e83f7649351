"""The energy ledger on the two masses."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from orchestrator.masters import Iterated, Jacobi
from tests.orchestrator.test_energy import BOND, MASTERS, ORDERS, booked, impulses
from tests.orchestrator.test_energy_estimates import misestimated

from .table import Row, largest

TESTS = "orchestrator/test_energy.py::"
ESTIMATES = "orchestrator/test_energy_estimates.py::"


def rows() -> Iterator[Row]:
    yield _orders()
    yield _hermite()
    yield _closing()
    yield _correction()
    yield Row(
        "per power bond the energy given, taken and created, as result channels, totals in the summary",
        "group `/energy` of `result.nc`, `energy` in `summary.json`, figures/energy.png, a line at the end",
        (
            TESTS + "test_a_converged_coupling_exchanges_the_energies_of_the_exact_solution",
            TESTS + "test_every_record_books_all_energies_since_the_last_one",
            TESTS + "test_nobody_sees_that_energies_are_counted",
        ),
        command="tribocosim run valve-train --set energy.ledger=true",
    )
    yield _estimates()
    yield _impulses()


def _estimates() -> Row:
    """An FMU that does not count: estimates beside the counts of one that does."""
    parts, orders = [], []
    for kind, rated, wanted in (("with rates", True, 4.0), ("without", False, 2.0)):
        coarse, fine = (abs(misestimated(Jacobi("quadratic"), step, rated)) for step in (1e-2, 5e-3))
        orders.append(np.log2(coarse / fine) > wanted - 0.25)
        parts.append(f"{kind} {fine:.1e} J, order {np.log2(coarse / fine):.2f}")
    return Row(
        "the same for an FMU that does not count its energies: an estimate from what it was given and gave, "
        "named as one in channels, summary and text",
        f"two masses, 5 ms, off the counted energy by: {'; '.join(parts)}",
        (
            ESTIMATES + "test_an_estimate_comes_to_what_is_counted_with_its_order",
            ESTIMATES + "test_a_foreign_fmu_has_its_bond_booked",
            ESTIMATES + "test_estimates_are_named_in_channels_account_and_words",
            ESTIMATES + "test_nobody_sees_the_estimates",
        ),
        command="tribocosim run two-masses --set components.second.participant=FILE.fmu "
        "--set energy.ledger=true",
        short="" if all(orders) else "not met.",
    )


def _impulses() -> Row:
    besides, given, bound = impulses()
    return Row(
        "what impacts take from a shaft as impulses is in the ledger",
        f"slider-crank on a free flywheel, 30 ms: `besides` of the flywheel {besides:.5f} J, by its speed "
        f"and the impulses {given:.5f} J (to {bound:.0e} J)",
        (TESTS + "test_what_impacts_take_as_impulses_comes_besides_the_bonds",),
        short="" if abs(besides - given) <= bound else "not met.",
    )


def created(master, step: float) -> float:
    return abs(booked(master, step).account().bonds[BOND].largest_created)


def _slope(master, step: float = 2e-3) -> tuple[float, float]:
    coarse, fine = created(master, step), created(master, 0.5 * step)
    return float(np.log2(coarse / fine)), fine


def _name(master) -> str:
    return f"{type(master).__name__} {master.extrapolation}"


def _orders() -> Row:
    found = {_name(master): (_slope(master), order) for master, order in ORDERS}
    off = [name for name, ((slope, _), order) in found.items() if abs(slope - order) > 0.1]
    return Row(
        "the spurious energy falls with the method's order",
        "largest created energy at 1 ms and its slope, two masses: "
        + "; ".join(f"{name} {energy:.1e} J, {slope:.2f}" for name, ((slope, energy), _) in found.items()),
        (TESTS + "test_spurious_energy_falls_with_the_order_of_the_method",),
        short=f"not met by {', '.join(off)}." if off else "",
    )


def _hermite() -> Row:
    slope, energy = _slope(Iterated("hermite", 1e-13), 2e-2)
    return Row(
        "the same for Hermite signals (order 4)",
        f"iterated, 10 ms: {energy:.1e} J, slope {slope:.2f}",
        short="" if slope > 3.9 else f"not met: {slope:.2f}.",
    )


def _closing() -> Row:
    gaps, sums = [], []
    for master in MASTERS:
        ledger = booked(master, 1e-2)
        sums.append(ledger[f"given {BOND}"] + ledger[f"created {BOND}"] - ledger[f"taken {BOND}"])
        account = ledger.account()
        spent = sum(p.stored + p.dissipated - p.sourced for p in account.components.values())
        gaps.append(spent - account.created - account.besides)
    # 200 steps, energies of 25 J at the start.
    rounding = 200 * 25 * np.finfo(float).eps
    return Row(
        "the ledger closes to rounding",
        f"{len(MASTERS)} masters, 25 J, 200 steps: given + created - taken at most {largest(sums)} J; "
        "stored + "
        f"dissipated - sourced - created - besides at most {largest(gaps)} J (rounding {rounding:.1e})",
        (
            TESTS + "test_the_whole_ledger_closes_to_rounding",
            TESTS + "test_what_is_given_and_created_is_taken",
        ),
        short="" if np.abs([*gaps, *sums]).max() <= rounding else "not met.",
    )


def _correction() -> Row:
    parts = []
    for signal in ("hold", "linear", "quadratic"):
        plain, corrected = (
            booked(Jacobi(signal), 1e-3, correct=correct).account().bonds[BOND].largest_created
            for correct in (False, True)
        )
        parts.append(f"{signal} {corrected / plain:.2f}")
    return Row(
        "optionally as a correction",
        f"jacobi, 1 ms, created energy with it over without: {', '.join(parts)}",
        (TESTS + "test_the_correction_lowers_what_the_coupling_creates",),
        command="tribocosim run two-masses --master jacobi --set energy.ledger=true --set "
        "energy.correction=true",
        short="Jacobi masters only; the order stays, and positions are not corrected.",
    )
