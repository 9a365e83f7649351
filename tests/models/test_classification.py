"""Chaotic, transient or periodic: known motions, and the evidence for each."""

from models.slider_crank.motions.classification import (
    CHAOTIC,
    PERIODIC,
    TRANSIENT_CHAOS,
    UNDECIDED,
    WINDOW,
    classify,
)
from models.slider_crank.motions.machine import Machine

THESIS = "as_published"


def test_without_rebound_the_motion_slides_and_repeats_every_cycle() -> None:
    # Low friction: both walls are reached in every cycle, and each impact ends the motion's memory.
    found = classify(Machine(damping=0.05, gap=0.01, restitution=0.0), 2000)
    assert (found.kind, found.period, found.slides) == (PERIODIC, 1, True)
    assert "to the last bit" in found.evidence


def test_sustained_chaos_of_the_thesis() -> None:
    found = classify(Machine(damping=0.05, gap=0.01, form=THESIS), 5000)
    assert (found.kind, found.period) == (CHAOTIC, 0)
    assert found.exponent > 3.0 * found.uncertainty > 0.0


def test_transient_chaos_of_the_thesis() -> None:
    found = classify(Machine(damping=0.025, gap=0.01, form=THESIS), 10_000)
    assert (found.kind, found.period) == (TRANSIENT_CHAOS, 1)
    assert found.transient_exponent > 3.0 * found.transient_uncertainty > 0.0
    assert found.exponent + 3.0 * found.uncertainty < 0.0


def test_a_long_orbit_that_slides_tells_of_chaos_between_its_slides() -> None:
    found = classify(Machine(damping=0.228, gap=0.015, form=THESIS), 2000)
    assert (found.kind, found.slides) == (PERIODIC, True)
    assert "chaos that each slide ends" in found.evidence
    assert found.period >= 2 * WINDOW


def test_what_neither_grows_nor_dies_out_is_undecided_and_says_what_helps() -> None:
    # No friction, no loss, no forcing: the middle is an orbit that neither attracts nor repels.
    rest = classify(Machine(damping=0.0, gap=0.01, restitution=1.0, xi=0.0, alpha=0.0, beta=0.0), 200)
    assert rest.kind == UNDECIDED
    assert "would help" in rest.evidence
