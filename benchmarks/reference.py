"""The monolithic reference: seconds per cam revolution of `valve-train`, and its own uncertainty."""

import numpy as np

from models.monolithic import solve

from .measure import load_system


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
    _, system = load_system("valve-train")
    times = np.linspace(0.0, 0.06, 3001)
    solve(system, times[:3])  # compile
    reference = solve(system, times)
    load_difference = reference.uncertainty["contact.load"]
    return [
        ("reference: one revolution by both methods", f"{reference.wall_time_s:.2f} s"),
        ("reference: relative RMS difference of the contact load", f"{load_difference.relative_rms:.1e}"),
    ]
