"""Requirement on crank and rod, shared by slider-crank and cylinder gas."""

from __future__ import annotations

from typing import Any

from ..compile.kernel import kernel
from ..core.quantities import Vector


@kernel
def crank_turns(p: Any, told: Vector) -> bool:
    """The crank is shorter than the rod; reports both."""
    told[0], told[1] = p.crank_radius, p.rod_length
    return p.crank_radius < p.rod_length
