"""Estimated over true errors, and step control by them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from orchestrator.stepping.estimators import ESTIMATORS
from tests.orchestrator.test_estimators import CASES, LENGTHS, at_point, created_ratio, rms, systems

from .table import Row

TESTS = "orchestrator/test_estimators.py::"
LOW, HIGH = 0.5, 2.0
SYSTEMS = {"quarter car": "without feedthrough (quarter car)", "two masses": "with feedthrough (two masses)"}


def rows() -> Iterator[Row]:
    made = systems()
    for estimator in dict.fromkeys(name for name, _ in CASES):
        for system, words in SYSTEMS.items():
            found = {
                f"{type(master).__name__} {master.extrapolation}": _ratio(made[system], system, name, master)
                for name, master in CASES
                if name == estimator
            }
            yield _row(
                f"{estimator}, {words}", found, "test_estimated_over_true_local_error_in_the_asymptotic_range"
            )
    yield _row(
        "energy, with feedthrough (two masses), of the energy that a step creates",
        {f"Jacobi {signal}": created_ratio(signal) for signal in LENGTHS},
        "test_estimated_over_true_energy_that_the_coupling_creates_in_a_step",
        "; it judges power bonds, whose efforts depend directly on the exchanged motion in all components: "
        "there is no case without feedthrough",
    )
    yield Row(
        "an estimator refuses a master that it cannot judge, and names one that can",
        ", ".join(ESTIMATORS),
        (TESTS + "test_an_estimator_refuses_masters_that_it_cannot_judge",),
    )


def _ratio(system, name, estimator, master) -> float:
    """Of the norms over all exchanged values in nominals, for one step from the exact motion."""
    length = LENGTHS[master.extrapolation] * (1.0 if name == "quarter car" else 4.0)
    exchange, time, truth = at_point(system, master, 0.3, length)
    with exchange.point():
        attempt = ESTIMATORS[estimator]().attempt(exchange, master, time, length)
    return float(rms(attempt.error / exchange.nominal) / rms((exchange.values - truth) / exchange.nominal))


def _row(words: str, found: dict[str, float], test: str, fact: str = "") -> Row:
    outside = [name for name, ratio in found.items() if not LOW <= ratio <= HIGH]
    return Row(
        f"estimated error over true error in [0.5, 2] in the asymptotic range: {words}",
        f"from {np.min(list(found.values())):.2f} to {np.max(list(found.values())):.2f}: "
        + ", ".join(f"{name} {ratio:.2f}" for name, ratio in found.items())
        + fact,
        (TESTS + test,),
        short=f"not met by {', '.join(outside)}." if outside else "",
    )
