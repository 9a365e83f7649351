"""Implicit steps of a component that is no ODE, for solvers of whole systems."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class ImplicitSteps:
    """dq/dt = F(x, u) with q = q(x), in kernels on float vectors.

    Every implicit one-step or multistep method solves (q(x) - base)/interval = F(x, u); `base` and `interval`
    (s) follow from earlier steps.

    begin(x, u, p, work): prepares x for the first step, once.
    carry(x, u, p, work, q): writes q, `carried` elements.
    stage(x, u, p, base, interval, work) -> status: replaces the guess x by the solution, valid if OK.
    Each instance has `work_size` elements of `work` of its own, zero at first.
    """

    carried: int
    work_size: int
    begin: Any
    carry: Any
    stage: Any
