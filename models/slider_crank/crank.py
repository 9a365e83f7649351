"""What crank and rod must be, whatever they drive."""

from __future__ import annotations

from typing import Any

from ..compile.kernel import kernel
from ..core.quantities import Vector


@kernel
def crank_turns(p: Any, told: Vector) -> bool:
    """With crank_radius and rod_length of the parameters; tells both."""
    told[0], told[1] = p.crank_radius, p.rod_length
    return p.crank_radius < p.rod_length
