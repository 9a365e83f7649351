"""F's engine in its own units (F 4.1)."""

from __future__ import annotations

INCH_M = 0.0254
GRAVITY = 9.80665
# lb s^2/in, in, lb s^2 in; as printed.
ROD_MASS, PISTON_MASS, CRANK_IN, ROD_IN, ROD_INERTIA = 0.00399, 0.00210, 1.6535, 5.4570, 0.0295
CRANK_M = CRANK_IN * INCH_M
