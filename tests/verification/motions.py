"""Farahanchi's (F) slider-crank: list of motions, exponents, walls."""

from __future__ import annotations

from collections.abc import Iterator

from models.slider_crank.machine import Machine, Motion
from tests.models.test_slider_crank import STATE, thesis_parameters
from tests.models.test_slider_crank_motions import EXPONENTS, LOWER, chaotic_cycles, cycles, period

from .table import Row

MOTIONS = "models/test_slider_crank_motions.py::"
TURNS = 2000


def rows() -> Iterator[Row]:
    yield from _transient()
    yield from _chaos()
    yield from _periodic()
    yield from _exponents()


def _kind(damping: float, gap: float, turns: int = TURNS, psi_rate: float = 0.0, **values: float) -> int:
    return period(cycles(thesis_parameters(damping, gap, **values), turns, psi_rate))


def _transient() -> Iterator[Row]:
    parts, endless = [], 0
    for damping, gap in ((0.025, 0.01), (0.025, 0.015), (0.075, 0.01)):
        lengths = []
        for start in range(5):
            states = cycles(thesis_parameters(damping, gap), TURNS, psi_rate=0.005 * start)
            if repeat := period(states):
                lengths.append(chaotic_cycles(states, repeat))
        endless += not lengths
        ends = f"ends after {', '.join(map(str, lengths))} turns" if lengths else "does not end"
        parts.append(f"({damping}, {gap}) {ends}")
    yield Row(
        "F's motions: transient chaos at (λ, ρ) = (.025, .01), (.025, .015), (.075, .01)",
        f"five starts, {TURNS} turns each: {'; '.join(parts)}",
        (MOTIONS + "test_transient_chaos_ends", MOTIONS + "test_periodic_motions"),
        short="some transients outlast the turns given here (the long test gives ten starts 6000)."
        if endless
        else "",
    )


def _chaos() -> Iterator[Row]:
    chaotic = ((0.025, 0.02), (0.05, 0.01), (0.05, 0.02), (0.075, 0.015), (0.075, 0.02))
    ended = [pair for pair in chaotic if _kind(*pair)]
    yield Row(
        "F's motions: chaos at (.025, .02), (.05, .01), (.05, .02), (.075, .015), (.075, .02)",
        f"no repetition (to 1e-8, up to 12 turns) after {TURNS} turns in {len(chaotic) - len(ended)} of 5"
        + (f"; {ended} repeat" if ended else ""),
        (MOTIONS + "test_chaotic_motions", MOTIONS + "test_chaos_lasts"),
        short=f"{ended} are periodic." if ended else "",
    )


def _periodic() -> Iterator[Row]:
    strong = {gap: cycles(thesis_parameters(0.25, gap), 60) for gap in (0.010, 0.015, 0.020)}
    yield Row(
        "F's motions: periodic at (.05, .015); λ = .25 periodic, no lower-wall impact",
        f"(.05, .015): period of {_kind(0.05, 0.015, 400)} turn(s); λ = .25, ρ = .01, .015, .02: periods "
        f"{', '.join(str(period(s)) for s in strong.values())}, lower-wall impacts "
        f"{', '.join(f'{s[-1, LOWER]:.0f}' for s in strong.values())}",
        (
            MOTIONS + "test_periodic_motions",
            MOTIONS + "test_strong_friction_keeps_off_the_lower_wall",
            MOTIONS + "test_impacts_per_revolution_of_the_periodic_orbit",
        ),
    )
    fine, coarse = _kind(0.23, 0.015, 1000), _kind(0.23, 0.015, 1000, sliding_threshold=0.005)
    yield Row(
        "F's motions: at ρ = .015 chaos at λ = .20, periodic from .23",
        f"period in turns (0: none up to 12): {_kind(0.20, 0.015, 1000)} at .20, {fine} at .23, "
        f"{_kind(0.234, 0.015, 1000)} at .234; at .23 with F's sliding threshold ε = .005: {coarse}",
        (
            MOTIONS + "test_motions_between_chaos_and_sliding",
            MOTIONS + "test_periodic_motion_from_0_23_is_the_threshold_s",
        ),
        short="F's .23 holds only with F's ε; with chattering taken to its limit the simple periodic motion "
        "begins at .234.",
    )
    spurious = _kind(0.05, 0.02, 600, sliding_threshold=0.005)
    yield Row(
        "F's threshold ε = .005 makes a spurious periodic orbit at (.05, .02)",
        f"period {spurious} with ε = .005; with ε = 1e-3 and 1e-5 "
        f"{_kind(0.05, 0.02, 600, sliding_threshold=1e-3)} and "
        f"{_kind(0.05, 0.02, 600, sliding_threshold=1e-5)} (0: none)",
        (
            MOTIONS + "test_sliding_threshold_of_the_thesis_makes_a_spurious_orbit",
            "models/test_hybrid.py::test_rest_converges_with_the_threshold",
        ),
    )
    held = []
    for form, threshold in ((0.0, 0.2669), (1.0, 0.1196)):
        for factor in (0.98, 1.02):
            states = cycles(thesis_parameters(factor * threshold, 1e-4, form=form), 12)
            upper = STATE.index("upper_impact_count")
            held.append("slides" if states[-1, upper] == states[-3, upper] else "leaves")
    yield Row(
        "permanent upper-wall sliding above λ = .2669 (published), .1196 (corrected)",
        f"2 % below and above: published {held[0]}, {held[1]}; corrected {held[2]}, {held[3]}",
        (
            MOTIONS + "test_permanent_sliding_above_its_threshold",
            "models/test_slider_crank_equations.py::test_threshold_of_permanent_sliding_on_the_upper_wall",
            "models/test_slider_crank_equations.py::test_interval_of_lower_wall_sliding_in_f_2_7",
        ),
    )


def _exponents() -> Iterator[Row]:
    parts, worst, exact = [], 0.0, 0.0
    for damping, gap, reference in EXPONENTS:
        found = Motion(Machine(damping, gap, form="as_published")).skip(200).exponents(200_000)
        parts.append(f"({damping}, {gap}): {found.largest:+.4f} ± {found.uncertainty:.4f} ({reference:+.3f})")
        worst = max(worst, abs(found.largest / reference - 1.0))
        exact = max(exact, abs(found.largest + found.second - found.exact_sum))
    yield Row(
        "F's exponents",
        f"largest, per radian, over 200000 turns with its standard error: {'; '.join(parts)}; largest "
        f"difference {100.0 * worst:.1f} %; sum of both exponents against the exact identity: {exact:.0e}",
        (
            MOTIONS + "test_lyapunov_exponents",
            MOTIONS + "test_lyapunov_exponents_long",
            MOTIONS + "test_periodic_orbit_has_half_the_sum",
        ),
    )
