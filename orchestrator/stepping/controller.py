"""How long the next step may be, from the errors of the last ones."""

from __future__ import annotations

from dataclasses import dataclass

# The error aimed at, over what is allowed: at order five a sixth of the length away from a rejection.
AIM = 0.4
# A length changes by these factors at most.
SHRINK, GROW = 0.2, 2.0
# Gains of the proportional-integral controller, over the order. Half of what Gustafsson (1991) gives for
# single solvers: on a ringing valve train that halves the rejections.
INTEGRAL, PROPORTIONAL = 0.15, 0.3
# An estimate far below the tolerance is rounding.
SMALLEST = 1e-6


@dataclass
class PI:
    """Proportional-integral control: smoother than control by the last error alone.

    `error` is the estimate over what is allowed, `exponent` P of error ~ H^P.
    """

    previous: float = AIM

    def after(self, error: float, exponent: float) -> float:
        """Factor for the length of the next step after one with `error` <= 1."""
        error = max(error, SMALLEST)
        factor = (AIM / error) ** (INTEGRAL / exponent) * (self.previous / error) ** (PROPORTIONAL / exponent)
        self.previous = error
        return min(GROW, max(SHRINK, factor))

    def allowed(self, error: float, exponent: float) -> float:
        """Factor to the length that the error aimed at allows, by its order alone."""
        return (AIM / max(error, SMALLEST)) ** (1.0 / exponent)

    def instead(self, error: float, exponent: float) -> float:
        """Factor for the length of another attempt after one with `error` > 1."""
        return max(SHRINK, self.allowed(error, exponent))
