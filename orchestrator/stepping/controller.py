"""How long the next step may be, from the errors of the last ones."""

import math
from dataclasses import dataclass

# The error aimed at, over what is allowed: at order five a sixth of the length away from a rejection.
AIM = 0.4
# A length changes by these factors at most.
SHRINK, GROW = 0.2, 2.0
# Gains of the proportional-integral controller, over the order (Gustafsson 1991).
INTEGRAL, PROPORTIONAL = 0.3, 0.4
# Steps as long as the one in which an error was seen that go by before it counts 1/e of its size.
MEMORY = 3.0
# An estimate far below the tolerance is rounding.
SMALLEST = 1e-6


@dataclass
class PI:
    """Proportional-integral control by the largest error of the last few steps.

    Errors are estimates over what is allowed, `exponent` P of error ~ H^P. Where a part rings, the estimate
    passes through zero twice a period, and steps that follow it grow too long there and are rejected
    thereafter. So an error is remembered, in proportion to H^P, and fades with the time that passes: within
    steps of the length in which it was seen, which is fast where steps grow again after an event.
    """

    error: float = 0.0
    length: float = 1.0
    seen: float = 1.0
    previous: float = AIM

    def after(self, error: float, exponent: float, length: float) -> float:
        """Factor for the length of the next step after one of `length` with `error` <= 1."""
        faded = math.exp(-length / (MEMORY * self.seen))
        remembered = self.error * (length / self.length) ** exponent * faded
        if error >= remembered:
            self.seen = length
        self.error, self.length = max(error, remembered, SMALLEST), length
        integral = (AIM / self.error) ** (INTEGRAL / exponent)
        proportional = (self.previous / self.error) ** (PROPORTIONAL / exponent)
        self.previous = self.error
        return min(GROW, max(SHRINK, integral * proportional))

    def allowed(self, error: float, exponent: float) -> float:
        """Factor to the length that the error aimed at allows, by its order alone."""
        return (AIM / max(error, SMALLEST)) ** (1.0 / exponent)

    def instead(self, error: float, exponent: float) -> float:
        """Factor for the length of another attempt after one with `error` > 1."""
        return max(SHRINK, self.allowed(error, exponent))
