"""Rectangular piston, gas, friction; the mechanism of Flores et al."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from .shell import summary, tribocosim
from .table import Row

MECHANICS = "models/test_piston_mechanics.py::"
CONTACT = "models/test_piston_contact.py::"
MOTION = "models/test_piston_motion.py::"
FLORES = "models/test_piston_flores.py::"


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as name:
        out = Path(name) / "slap"
        said = tribocosim("run", "piston-slap", "--out", str(out), "--no-figures")
        errors = {key: entry["relative_rms"] for key, entry in summary(out)["errors"].items()}
    parts = ", ".join(
        f"{key.partition('.')[2]} {errors[key]:.1e}" for key in sorted(errors) if "piston_" in key
    )
    yield Row(
        "rectangular piston with its own rotation (two degrees of freedom, four contact corners), gas "
        "pressure, pin offset, friction at wall and joints",
        f"piston-slap, coupled against the reference (relative RMS): {parts}; exit status {said.status}",
        (
            MECHANICS + "test_equation_of_motion_is_lagranges",
            CONTACT + "test_law_of_impact",
            CONTACT + "test_complementarity",
            MOTION + "test_energy_balances_through_impacts_chatter_and_sliding",
            MOTION + "test_walls_are_never_passed_and_only_push",
        ),
        command="tribocosim run piston-slap",
        short="components of their own (`piston_crank`, `free_piston_crank`, `cylinder_gas`) rather than "
        "options of slider_crank; without length and height the piston is its nonlinear form. Friction "
        "between impacts is µ N tanh(v/v_c), without sticking.",
    )
    yield Row(
        "without length and height the piston is the nonlinear slider-crank",
        "the same impacts over 10 rad; between them the damped pendulum",
        (
            MOTION + "test_roller_is_the_nonlinear_slider_crank",
            MOTION + "test_roller_between_impacts_is_a_pendulum",
        ),
    )
    yield Row(
        "the mechanism of Flores et al. (2010) as a second application of the same event machinery",
        "an independent time-stepping method converges to it with the first power of the step "
        "(docs/physics.md has the numbers, and the comparison with Siconos' published reference)",
        (
            FLORES + "test_time_stepping_converges_to_the_event_driven_motion",
            FLORES + "test_start_of_the_source_is_the_aligned_mechanism",
        ),
        short="compared with Siconos' published reference data, whose step of 0.1 ms explains the "
        "difference; the paper itself was not at hand.",
    )
