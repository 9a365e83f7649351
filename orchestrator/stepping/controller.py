"""How long the next step may be, from the errors of the last ones."""

from __future__ import annotations

from dataclasses import dataclass

# Of the length that would just do.
SAFETY = 0.9
# A length changes by these factors at most.
SHRINK, GROW = 0.2, 3.0
# Gains of the proportional-integral controller (Gustafsson 1991: 0.3 and 0.4, over the order).
INTEGRAL, PROPORTIONAL = 0.3, 0.4
# An estimate far below the tolerance is rounding.
SMALLEST = 1e-6


@dataclass
class PI:
    """Proportional-integral control: smoother than control by the last error alone.

    `error` is the estimate over what is allowed, `exponent` P of error ~ H^P.
    """

    previous: float = 1.0

    def after(self, error: float, exponent: float) -> float:
        """Factor for the length of the next step after one with `error` <= 1."""
        error = max(error, SMALLEST)
        factor = error ** -(INTEGRAL / exponent) * (self.previous / error) ** (PROPORTIONAL / exponent)
        self.previous = error
        return min(GROW, max(SHRINK, SAFETY * factor))

    def instead(self, error: float, exponent: float) -> float:
        """Factor for the length of another attempt after one with `error` > 1."""
        return max(SHRINK, min(SAFETY, SAFETY * error ** -(1.0 / exponent)))
