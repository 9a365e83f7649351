"""F's cases and settings (F 4.1, 4.3, 4.4, appendix B)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from models.slider_crank.motions.machine import Machine

# Appendix B: cycles before data is taken, cycles of data, and the rebound below which the roller slides.
TRANSIENT, CYCLES, THRESHOLD = 30, 3000, 0.005
# F 4.1: chaos is what is sustained so long (cycles).
SUSTAINED = 1000
GAPS = (0.01, 0.015, 0.02)
LOW_DAMPINGS, HIGH_DAMPINGS = (0.025, 0.05, 0.075), (0.15, 0.20, 0.25)
MATRIX = (*LOW_DAMPINGS, *HIGH_DAMPINGS)
PUBLISHED, CORRECTED = "as_published", "corrected"
FORMS = (PUBLISHED, CORRECTED)


@dataclass(frozen=True)
class Case:
    """A point of F's parameter space, in one form of the equations; `threshold` 0 is the exact limit."""

    damping: float
    gap: float
    restitution: float = 0.9
    form: str = PUBLISHED
    threshold: float = 0.0

    @cached_property
    def machine(self) -> Machine:
        return Machine(self.damping, self.gap, self.restitution, self.form, sliding_threshold=self.threshold)

    def in_form(self, form: str) -> Case:
        return replace(self, form=form)

    @property
    def by_thesis_rule(self) -> Case:
        """With F's rule for the beginning of sliding (appendix B)."""
        return replace(self, threshold=THRESHOLD)

    def __str__(self) -> str:
        words = f"({self.damping:g}, {self.gap:g})"
        return words if self.restitution == 0.9 else f"{words}, e = {self.restitution:g}"


def list_cases(dampings: tuple[float, ...], form: str = PUBLISHED, restitution: float = 0.9) -> list[Case]:
    """F's cases for these dampings, row by row."""
    return [Case(damping, gap, restitution, form) for damping in dampings for gap in GAPS]
