"""Flights of whichever form the flow is of, chosen flight by flight, so that what flies is compiled once."""

from __future__ import annotations

from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ..equations import Mechanism
from ..forms import NONLINEAR
from . import linear, pendulum
from .bouncing import Walls, make_next_event


class EitherFlow(NamedTuple):
    """What flights of all forms ask for: the fields of `flow.Flow` and of `pendulum.PendulumFlow`."""

    form: float
    mechanism: Mechanism
    xi: float
    cells: Any
    ends: Any
    bounds: Any
    pressing: Any


@kernel
def flight(flow: Any, position: Any, scratch: Any) -> float:
    """As that of the form; flow: an EitherFlow."""
    if flow.form == NONLINEAR:
        return pendulum.flight(flow, position, scratch)
    return linear.flight(flow, position, scratch)


@kernel
def skip(flow: Any, walls: Walls, position: Any) -> bool:
    """As that of the form; flow: an EitherFlow."""
    return flow.form != NONLINEAR and linear.skip(flow, walls, position)


next_event = make_next_event(flight, skip)
