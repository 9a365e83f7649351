"""What a solver of whole systems needs of a component that is no ODE: one implicit step of its inside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from .quantities import Vector


@dataclass(frozen=True)
class ImplicitSteps:
    """dq/dt = F(x, u) with q = q(x), in kernels on float vectors.

    Every implicit one-step or multistep method solves (q(x) - base)/interval = F(x, u), where it makes `base`
    and `interval` (s) of what came before.

    `needed(p)`: whether the parameters ask for it; the derivative serves otherwise.
    begin(x, u, p, work): makes x ready for the first step, if nothing has.
    carry(x, u, p, work, q): writes q, `carried` elements.
    stage(x, u, p, base, interval, work) -> status: x, a guess, becomes the solution; of no use unless OK.
    `work_size` elements of `work`, zero at first, belong to one instance.
    """

    carried: int
    work_size: int
    needed: Callable[[Vector], bool]
    begin: Any
    carry: Any
    stage: Any
