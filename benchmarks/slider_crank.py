"""Crank revolutions per second of the slider-crank: chaotic, (lambda, rho) = (0.05, 0.01), as published."""

import time

from models.slider_crank.motions.machine import Machine, Motion

from .measure import measure_medians

CYCLES = 40000


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
    run = Motion(Machine(0.05, 0.01, form="as_published")).strobe

    def measure_speed() -> float:
        began = time.perf_counter()
        run(CYCLES)
        return CYCLES / (time.perf_counter() - began)

    speed = measure_medians({"core": measure_speed})["core"]
    return [("slider-crank: revolutions/s", f"{speed:.0f}")]
