"""Farahanchi's (F) list of motions, `as_published`, and the Lyapunov exponents."""

from __future__ import annotations

import math

import numpy as np
import pytest

from models.core.quantities import Vector
from models.slider_crank.motions.machine import Machine, Motion

from .test_slider_crank import CRANK, INPUTS, OUTPUTS, SCALE, STATE, TURN, thesis_parameters

PSI, RATE = STATE.index("psi"), STATE.index("psi_rate")
UPPER, LOWER = STATE.index("upper_impact_count"), STATE.index("lower_impact_count")
# A motion is called periodic if the last cycles repeat to this (rad): transients of a periodic motion
# have died out to rounding, a chaotic one comes back to 1e-3 at best.
REPEATS = 1e-8


def cycles(p: Vector, count: int, psi_rate: float = 0.0) -> Vector:
    """States at crank angle zero over `count` revolutions."""
    x, states = STATE.vector({"psi_rate": psi_rate}), []
    U = CRANK.input_polynomial()
    U[0, INPUTS.index("crank_speed")] = 1.0
    U[1, INPUTS.index("crank_angle")] = 1.0
    work, u, y = np.zeros(CRANK.work_size), np.zeros(INPUTS.size), np.zeros(OUTPUTS.size)
    for _ in range(count):
        # Every revolution at time zero: the motion is periodic, and time keeps its resolution.
        assert CRANK.step(0.0, TURN, x, U, p, SCALE, work, u, y) == 0
        states.append(x.copy())
    return np.array(states)


def period(states: Vector, longest: int = 12) -> int:
    """Number of revolutions after which the motion repeats; 0 if it does not."""
    for count in range(1, longest + 1):
        late, before = states[-50:, PSI : RATE + 1], states[-50 - count : -count, PSI : RATE + 1]
        if np.abs(late - before).max() < REPEATS:
            return count
    return 0


def chaotic_cycles(states: Vector, repeat: int) -> int:
    """Revolutions before the motion begins to repeat (to 1e-6)."""
    different = np.abs(states[repeat:, :2] - states[:-repeat, :2]).max(axis=1) > 1e-6
    return int(np.nonzero(different)[0][-1]) + 1


@pytest.mark.parametrize(("damping", "gap"), [(0.025, 0.015), (0.05, 0.015)])
def test_periodic_motions(damping: float, gap: float) -> None:
    """After some tens of revolutions; (0.025, 0.015) is F's transient chaos."""
    states = cycles(thesis_parameters(damping, gap), 400)
    assert period(states) > 0
    assert states[:, LOWER][-1] > 0.0


@pytest.mark.parametrize(("damping", "gap"), [(0.025, 0.02), (0.05, 0.01), (0.05, 0.02)])
def test_chaotic_motions(damping: float, gap: float) -> None:
    assert period(cycles(thesis_parameters(damping, gap), 400)) == 0


@pytest.mark.long
@pytest.mark.parametrize(
    ("damping", "gap"), [(0.025, 0.02), (0.05, 0.01), (0.05, 0.02), (0.075, 0.015), (0.075, 0.02)]
)
def test_chaos_lasts(damping: float, gap: float) -> None:
    assert period(cycles(thesis_parameters(damping, gap), 6000)) == 0


@pytest.mark.long
@pytest.mark.parametrize(("damping", "gap"), [(0.025, 0.01), (0.025, 0.015), (0.075, 0.01)])
def test_transient_chaos_ends(damping: float, gap: float) -> None:
    """From some of ten starts within 6000 revolutions: the transient's length is a matter of chance."""
    lengths = []
    for start in range(10):
        states = cycles(thesis_parameters(damping, gap), 6000, psi_rate=0.005 * start)
        if repeat := period(states):
            lengths.append(chaotic_cycles(states, repeat))
    assert lengths
    assert max(lengths) > 20


@pytest.mark.parametrize("gap", [0.010, 0.015, 0.020])
def test_strong_friction_keeps_off_the_lower_wall(gap: float) -> None:
    """lambda = 0.25: periodic with one revolution, sliding on the upper wall, no lower-wall impact."""
    states = cycles(thesis_parameters(0.25, gap), 60)
    assert period(states) == 1
    assert states[-1, LOWER] == 0.0
    assert states[-1, STATE.index("upper_force_integral")] > 0.0


def test_motions_between_chaos_and_sliding() -> None:
    """rho = 0.015: chaos at lambda = 0.20, simple periodic motion at 0.235 (F: from 0.23)."""
    assert period(cycles(thesis_parameters(0.20, 0.015), 300)) == 0
    assert period(cycles(thesis_parameters(0.235, 0.015), 100)) == 1


@pytest.mark.long
def test_periodic_motion_from_0_23_is_the_threshold_s() -> None:
    """F's 0.23 needs F's sliding threshold 0.005; converged, simple periodic motion begins at 0.234."""
    coarse = thesis_parameters(0.23, 0.015, sliding_threshold=0.005)
    assert period(cycles(coarse, 1000)) == 1
    for threshold in (1e-4, 1e-6, 1e-8):
        fine = {
            damping: thesis_parameters(damping, 0.015, sliding_threshold=threshold)
            for damping in (0.23, 0.234)
        }
        assert period(cycles(fine[0.23], 1000)) != 1
        assert period(cycles(fine[0.234], 1000)) == 1


def test_sliding_threshold_of_the_thesis_makes_a_spurious_orbit() -> None:
    """(0.05, 0.02): 0.005 gives a periodic motion, anything below 1e-3 chaos."""
    assert period(cycles(thesis_parameters(0.05, 0.02, sliding_threshold=0.005), 600)) > 0
    for threshold in (1e-3, 1e-5):
        assert period(cycles(thesis_parameters(0.05, 0.02, sliding_threshold=threshold), 300)) == 0


def test_sliding_does_not_depend_on_a_small_threshold() -> None:
    """lambda = 0.25: release is from the wall, and what chatter is left out leaves no trace."""
    ends = [cycles(thesis_parameters(0.25, 0.015, sliding_threshold=v), 30)[-1, :2] for v in (1e-5, 1e-8)]
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)


@pytest.mark.parametrize("corrected", [False, True])
def test_permanent_sliding_above_its_threshold(corrected: bool) -> None:
    """As rho -> 0 the upper wall holds the slider for good above 0.2669, or 0.1196 corrected."""
    threshold = 0.1196 if corrected else 0.2669
    for factor, holds in ((0.98, False), (1.02, True)):
        p = thesis_parameters(factor * threshold, 1e-4, form=float(corrected))
        states = cycles(p, 12)
        impacts = states[-1, UPPER] - states[-3, UPPER]
        assert (impacts == 0.0) == holds


EXPONENTS = [(0.05, 0.01, 0.414), (0.025, 0.02, 0.387), (0.05, 0.015, -0.147), (0.075, 0.02, 0.333)]


def published(damping: float, gap: float) -> Motion:
    return Motion(Machine(damping, gap, form="as_published"))


@pytest.mark.parametrize(("damping", "gap", "reference"), EXPONENTS)
def test_lyapunov_exponents(damping: float, gap: float, reference: float, record) -> None:
    """The largest within the references' 2 % and four standard errors; their sum exactly."""
    found = published(damping, gap).skip(200).exponents(5000)
    quantity, total = "sum of both Lyapunov exponents (1/rad)", found.largest + found.second
    record("Slider-crank", quantity, total, found.exact_sum, "-λ/a + 2 N ln e/(2π)", tolerance=1e-11)
    assert found.largest == pytest.approx(reference, abs=0.02 * abs(reference) + 4.0 * found.uncertainty)


@pytest.mark.long
@pytest.mark.parametrize(("damping", "gap", "reference"), EXPONENTS)
def test_lyapunov_exponents_long(damping: float, gap: float, reference: float, record) -> None:
    """Within 2 %, at a standard error of 0.2 %."""
    found = published(damping, gap).skip(200).exponents(200_000)
    quantity = f"largest Lyapunov exponent (1/rad), λ = {damping:g}, ρ = {gap:g}"
    record("Slider-crank", quantity, found.largest, reference, "independent integration", relative=0.02)


def test_periodic_orbit_has_half_the_sum() -> None:
    """(0.05, 0.015): its multipliers are complex, so both exponents are half of the exact sum."""
    found = published(0.05, 0.015).skip(200).exponents(1000)
    assert found.impacts_per_cycle == 8.0
    assert found.largest == pytest.approx(0.5 * found.exact_sum, rel=0.01)


def test_sliding_motion_has_no_exponents() -> None:
    """At a release from rest at a fixed crank angle every deviation has ended."""
    found = published(0.25, 0.015).exponents(20)
    assert (found.largest, found.second) == (-math.inf, -math.inf)


def test_impacts_per_revolution_of_the_periodic_orbit(record) -> None:
    """(0.05, 0.015): three on the upper wall and five on the lower."""
    states = cycles(thesis_parameters(0.05, 0.015), 400)
    assert period(states) == 1
    last = states[-1] - states[-2]
    for wall, count, stated in (("upper", last[UPPER], 3), ("lower", last[LOWER], 5)):
        quantity = f"impacts on the {wall} wall per revolution, λ = 0.05, ρ = 0.015"
        record("Slider-crank", quantity, count, stated, "independent integration", tolerance=0)
