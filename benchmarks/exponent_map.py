"""Time of a map of the largest exponent, 1000 cycles a point after 200, with one worker and with all cores.

A map of 20 x 20 points over F's ranges of (lambda, rho), as published, is computed; the time of 200 x 200 is
100 times as long, since its points lie over the same ranges.
"""

import time

import numpy as np

from models.compile.parallel import cores
from models.slider_crank.motions.machine import Machine
from models.slider_crank.motions.maps import exponent_map

from .measure import measure_medians

SIDE, FULL, CYCLES, TRANSIENT, ROUNDS = 20, 200, 1000, 200, 3


def measure_rate(workers: int) -> float:
    """Points of the map computed in a second of wall time."""
    x, y = ("damping", np.linspace(0.01, 0.25, SIDE)), ("gap", np.linspace(0.005, 0.02, SIDE))
    began = time.perf_counter()
    exponent_map(Machine(form="as_published"), x, y, CYCLES, TRANSIENT, workers)
    return SIDE**2 / (time.perf_counter() - began)


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
    counts = sorted({1, cores()})
    found = measure_medians({str(n): lambda n=n: measure_rate(n) for n in counts}, ROUNDS)
    one = found["1"]
    return [
        (
            f"exponent map, {n} worker{'s' * (n > 1)}: {FULL} x {FULL} points of {CYCLES} cycles",
            f"{FULL**2 / rate / 60.0:.1f} min; {rate:.0f} points/s ({rate / one:.2f} x one worker)",
        )
        for n, rate in ((n, found[str(n)]) for n in counts)
    ]
