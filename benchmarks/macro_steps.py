"""Macro steps per second of the `valve-train` FMUs: our masters against a plain fmpy script.

A bare loop over ctypes calls with prepared arguments shows how little a master could cost at best.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from models.core.quantities import Vector
from orchestrator.engine.step import Step
from orchestrator.masters import GaussSeidel, Iterated, Jacobi

from .loops import run_bare, run_master, run_script
from .measure import load_system, measure_medians

SCRIPT = "plain fmpy script, inputs held"


@dataclass
class Sparse:
    """An observer that reads the outputs of every n-th step, as a recorder does."""

    every: int
    steps: int = 0

    def begin(self, names: Sequence[str]) -> None:
        pass

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if self.steps % self.every == 0:
            outputs()
        self.steps += 1

    def end(self, complete: bool, message: str) -> None:
        pass


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
    _, system = load_system("valve-train")
    quadratic = GaussSeidel("quadratic")
    candidates: dict[str, Callable[[], float]] = {
        SCRIPT: partial(run_script, system),
        "bare ctypes loop, inputs held": partial(run_bare, system),
        "gauss_seidel, hold": partial(run_master, system, GaussSeidel("hold")),
        "gauss_seidel, quadratic": partial(run_master, system, quadratic),
        "jacobi, quadratic": partial(run_master, system, Jacobi("quadratic")),
        "iterated, quadratic": partial(run_master, system, Iterated("quadratic")),
    }
    for every, words in ((1, "every step"), (10, "every 10th step")):
        candidates[f"gauss_seidel, quadratic, outputs of {words}"] = lambda every=every: run_master(
            system, quadratic, [Sparse(every)]
        )
    found = measure_medians(candidates)
    return [
        (f"macro steps/s: {name}", f"{1.0 / seconds:.0f} ({found[SCRIPT] / seconds:.2f} x script)")
        for name, seconds in found.items()
    ]
