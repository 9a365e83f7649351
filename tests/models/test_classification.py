"""Chaotic, transient or periodic: known motions, and the evidence for each."""

from __future__ import annotations

import math

import pytest

from models.slider_crank.motions.classification import (
    CHAOTIC,
    PERIODIC,
    TRANSIENT_CHAOS,
    UNDECIDED,
    classify,
)
from models.slider_crank.motions.machine import Machine, Motion

THESIS = "as_published"


@pytest.mark.parametrize("form", ["as_published", "corrected", "nonlinear"])
def test_without_rebound_the_motion_slides_and_repeats_every_cycle(form: str) -> None:
    # Low friction: both walls are reached in every cycle, and each impact ends the motion's memory.
    found = classify(Machine(damping=0.05, gap=0.01, restitution=0.0, form=form), 2000)
    assert (found.kind, found.period, found.slides) == (PERIODIC, 1, True)
    assert "to the last bit" in found.evidence


@pytest.mark.parametrize("form", ["corrected", "nonlinear"])
def test_permanent_sliding_is_periodic(form: str) -> None:
    # F 2.6: above the threshold of permanent sliding, 0.1196 with the corrected sign as the gap goes to 0.
    found = classify(Machine(damping=0.2, gap=0.01, form=form), 2000)
    assert (found.kind, found.period, found.slides) == (PERIODIC, 1, True)
    assert found.impacts_per_cycle == 0.0


def test_a_motion_without_memory_has_no_finite_exponent() -> None:
    motion = Motion(Machine(damping=0.2, gap=0.01, form="corrected")).skip(100)
    assert motion.exponents(20).largest == -math.inf


def test_stable_orbit_has_the_exponent_of_its_multipliers() -> None:
    # Both exponents of a spiralling orbit are half of the exact sum of logarithms.
    found = classify(Machine(damping=0.05, gap=0.015, form=THESIS), 2000)
    exact_sum = Motion(Machine(damping=0.05, gap=0.015, form=THESIS)).skip(500).exponents(400).exact_sum
    assert found.period == 1
    assert found.exponent == pytest.approx(exact_sum / 2.0, abs=5.0 * found.uncertainty + 1e-3)


@pytest.mark.parametrize(("damping", "gap"), [(0.025, 0.02), (0.05, 0.01), (0.05, 0.02)])
def test_sustained_chaos_of_the_thesis(damping: float, gap: float) -> None:
    found = classify(Machine(damping=damping, gap=gap, form=THESIS), 5000)
    assert (found.kind, found.period) == (CHAOTIC, 0)
    assert found.exponent > 3.0 * found.uncertainty > 0.0


def test_transient_chaos_of_the_thesis() -> None:
    found = classify(Machine(damping=0.025, gap=0.01, form=THESIS), 10_000)
    assert (found.kind, found.period) == (TRANSIENT_CHAOS, 1)
    assert found.transient_exponent > 3.0 * found.transient_uncertainty > 0.0
    assert found.exponent + 3.0 * found.uncertainty < 0.0


def test_the_threshold_of_the_thesis_makes_a_chaotic_motion_periodic() -> None:
    machine = Machine(damping=0.05, gap=0.02, form=THESIS)
    spurious = classify(Machine(damping=0.05, gap=0.02, form=THESIS, sliding_threshold=0.005), 5000)
    assert classify(machine, 5000).kind == CHAOTIC
    assert (spurious.kind, spurious.period, spurious.slides) == (TRANSIENT_CHAOS, 2, True)


def test_what_neither_grows_nor_dies_out_is_undecided_and_says_what_helps() -> None:
    # No friction, no loss, no forcing: the middle is an orbit that neither attracts nor repels.
    rest = classify(Machine(damping=0.0, gap=0.01, restitution=1.0, xi=0.0, alpha=0.0, beta=0.0), 200)
    assert rest.kind == UNDECIDED
    assert "would help" in rest.evidence
