"""Kernels of the CUDA device, one motion a thread; compiled at the first call, see `gpu`."""

from __future__ import annotations

from typing import Any

from numba import cuda

from ..equations import Mechanism
from ..flight.bouncing import Walls
from ..flight.flow import Flow
from ..flight.pendulum import PendulumFlow
from .histories import LINEAR, NONLINEAR

_follow_linear, _follow_nonlinear = LINEAR.follow_tangents, NONLINEAR.follow_tangents


@cuda.jit  # type: ignore[untyped-decorator]
def linear(
    xi: Any, cells: Any, ends: Any, bounds: Any, pressing: Any, walls: Any, position: Any, v: Any,
    scratch: Any, impacts: Any, cycles: int, growth: Any,
) -> None:  # fmt: skip
    """`follow_tangents` of motion i; every array has one element, row or table for each."""
    i = cuda.grid(1)  # type: ignore[attr-defined]
    if i < position.shape[0]:
        flow = Flow(xi[i], cells[i], ends[i], bounds[i], pressing[i])
        limits = Walls(walls[i, 0], walls[i, 1], walls[i, 2], walls[i, 3])
        impacts[i] = _follow_linear(flow, limits, position[i], v[i], cycles, growth[i], scratch[i])


@cuda.jit  # type: ignore[untyped-decorator]
def nonlinear(
    xi: Any, mechanism: Any, pressing: Any, walls: Any, position: Any, v: Any, scratch: Any, impacts: Any,
    cycles: int, growth: Any,
) -> None:  # fmt: skip
    """The same for the nonlinear form."""
    i = cuda.grid(1)  # type: ignore[attr-defined]
    if i < position.shape[0]:
        m = mechanism[i]
        flow = PendulumFlow(xi[i], Mechanism(m[0], m[1], m[2], m[3], m[4]), pressing[i])
        limits = Walls(walls[i, 0], walls[i, 1], walls[i, 2], walls[i, 3])
        impacts[i] = _follow_nonlinear(flow, limits, position[i], v[i], cycles, growth[i], scratch[i])
