"""Crank revolutions per second of the slider-crank's core, against fixed-step integration; error per impact.

The case is chaotic: (lambda, rho) = (0.05, 0.01), as published. The error is that of one flight, from a
common start just after an impact to the next impact, in crank angle (rad) and in psi' (per radian), against
DOP853 at a tolerance of 1e-13 with its root found by Brent's method.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from models.slider_crank.equations import flight_acceleration, rebound, wall_angle, wall_rate
from models.slider_crank.motions.machine import Machine, Motion

from . import fixed_step
from .measure import measure_medians

MACHINE = Machine(0.05, 0.01, form="as_published")
BASELINE_CYCLES, CORE_CYCLES, FLIGHTS = 2000, 40000, 200


def time_cycles(run: Callable[[int], object], cycles: int) -> Callable[[], float]:
    """A candidate for `measure_medians`."""

    def measured() -> float:
        started = time.perf_counter()
        run(cycles)
        return cycles / (time.perf_counter() - started)

    return measured


def solve_next_impact(theta: float, psi: float, rate: float) -> tuple[float, float]:
    """Crank angle and psi' of the next impact, by an independent method."""
    m, gap = MACHINE.mechanism, MACHINE.gap
    solved = solve_ivp(
        lambda t, x: [x[1], flight_acceleration(t, 1.0, 0.0, x[0], x[1], m)],
        (theta, theta + 7.0), [psi, rate], method="DOP853", rtol=1e-13, atol=1e-17, dense_output=True,
        max_step=0.05,
    )  # fmt: skip

    def distance(t: float) -> float:
        return wall_angle(t, gap, m.xi) - abs(float(solved.sol(t)[0]))

    # From just inside the wall that has been hit.
    times = np.linspace(theta, theta + 7.0, 20001)[1:]
    fallen = next(i for i, t in enumerate(times) if distance(t) < 0.0)
    before = times[fallen - 1] if fallen else theta + 1e-9
    at = float(brentq(distance, before, times[fallen], xtol=1e-15))
    return at, float(solved.sol(at)[1])


def compare_impacts() -> dict[str, tuple[float, float]]:
    """The largest errors of (crank angle, psi') at the next impact, by method."""
    m, gap = MACHINE.mechanism, MACHINE.gap
    events = Motion(MACHINE).events(40).impacts
    errors: dict[str, list[tuple[float, float]]] = {"fixed step": [], "core": []}
    for i in range(20, 20 + FLIGHTS):
        if events.cycle[i + 1] != events.cycle[i]:
            continue
        theta = float(events.theta[i])
        psi = wall_angle(theta, float(events.side[i]) * gap, m.xi)
        rate = rebound(float(events.rate[i]), wall_rate(theta, 1.0, psi, m.xi), MACHINE.restitution)
        true_theta, true_rate = solve_next_impact(theta, psi, rate)
        coarse = fixed_step.find_next_impact(theta, psi, rate, gap, m, 2.0 * math.pi)
        exact = events.theta[i + 1], psi, events.rate[i + 1]
        for name, found in (("fixed step", coarse), ("core", exact)):
            errors[name].append((abs(found[0] - true_theta), abs(found[2] - true_rate)))
    return {name: tuple(np.array(values).max(axis=0)) for name, values in errors.items()}


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
    m, gap, e = MACHINE.mechanism, MACHINE.gap, MACHINE.restitution
    speeds = measure_medians(
        {
            "fixed step": time_cycles(lambda n: fixed_step.count_impacts(m, gap, e, n), BASELINE_CYCLES),
            "core": time_cycles(Motion(MACHINE).strobe, CORE_CYCLES),
        }
    )
    figures = [(f"slider-crank: {name}, revolutions/s", f"{speed:.0f}") for name, speed in speeds.items()]
    figures.append(("slider-crank: core / fixed step", f"{speeds['core'] / speeds['fixed step']:.1f}"))
    for name, (angle, rate) in compare_impacts().items():
        figures.append(
            (f"slider-crank: {name}, largest error per impact", f"{angle:.1e} rad; {rate:.1e} in psi'")
        )
    return figures
