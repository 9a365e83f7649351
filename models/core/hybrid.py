"""Integration across events: the Runge-Kutta step of `integrator`, cut where a guard falls below zero.

It remembers nothing between calls. A guard that is negative at the start of a call (an input has jumped)
makes its transition at once.
"""

from typing import Any, NamedTuple

from ..compile.kernel import borrow, kernel, shaped
from .dormand_prince import Workspace, make_runge_kutta
from .event_search import FRACTIONS, NONE, Guards, make_find_event
from .integrator import (
    MOST_STEPS,
    NOT_FINITE,
    OK,
    STEP_TOO_SMALL,
    TOO_MANY_EVENTS,
    TOO_MANY_STEPS,
    copy,
    make_derivative_along,
    taylor,
)
from .quadrature import make_quadrature

# Events without progress of time after which the step is given up: chatter that its component does not
# end needs ln(1e16)/ln(1/e) of them to stand still in time (350 for e = 0.9).
STALLED_EVENTS = 1000
# Events in one call: bounces so low that rounding keeps them up pass time, but too slowly to end.
MOST_EVENTS = 100_000


# What the scratch vector has for each guard.
GUARD_WORK_SIZE = len(FRACTIONS) + 2


class HybridMotion(NamedTuple):
    """What is integrated across events: kernels on float vectors, the numbers of states, inputs, guards."""

    derivative: Any
    guards: Any
    transition: Any
    sample: Any
    states: int
    inputs: int
    guard_count: int
    tolerance: float


def make_settle(guards: Any, transition: Any, count: int) -> Any:
    """settle(s, w, g) -> status: make the transitions of all guards that are negative at w.t + s; the guards
    are left in g."""

    @kernel
    def settle(s: float, w: Workspace, g: Any) -> int:
        taylor(w.U, s, w.u)
        for _ in range(4 * count):
            guards(w.t + s, w.x, w.u, w.p, g)
            fallen = NONE
            for j in range(count):
                if g[j] < 0.0:
                    fallen = j
                    break
            if fallen < 0:
                return OK
            transition(fallen, w.t + s, w.x, w.u, w.p)
        return TOO_MANY_EVENTS

    return settle


def make_divide(n: int, m: int, count: int) -> Any:
    """divide(t, x, U, p, scale, work) -> the parts of the scratch vector: workspace, guards, saved state."""
    points = len(FRACTIONS)

    @kernel
    def divide(t: float, x: Any, U: Any, p: Any, scale: Any, work: Any) -> Any:
        room = borrow(work)
        u, rest = room[10 * n : 10 * n + m], room[10 * n + m :]
        k, xt, xn = room[0 : 7 * n], room[7 * n : 8 * n], room[8 * n : 9 * n]
        w = Workspace(t, borrow(x), borrow(U), borrow(p), borrow(scale), room, u, k, xt, xn)
        samples = shaped(rest[2 * count : (2 + points) * count], (points, count))
        return w, Guards(rest[0:count], rest[count : 2 * count], samples), room[9 * n : 10 * n]

    return divide


def make_hybrid_advance(motion: HybridMotion) -> Any:
    """advance(t, h, x, U, p, scale, work) -> status, as `integrator.make_advance`, with the events."""
    n, count, guards, transition = motion.states, motion.guard_count, motion.guards, motion.transition
    derivative_along = make_derivative_along(motion.derivative)
    runge_kutta = make_runge_kutta(derivative_along, n, motion.tolerance)
    find_event = make_find_event(guards, runge_kutta, n, count)
    settle = make_settle(guards, transition, count)
    divide = make_divide(n, motion.inputs, count)
    quadrature = make_quadrature(motion.sample, n)

    @kernel
    def integrate(h: float, w: Workspace, g: Guards) -> int:
        t, x, k = w.t, w.x, w.k
        s, micro, stalled, events, tried = 0.0, h, 0, 0, 0
        status = settle(s, w, g.start)
        derivative_along(t, s, x, w.U, w.u, w.p, k[0:n])
        while s < h and status == OK:
            tried += 1
            if tried > MOST_STEPS:
                return TOO_MANY_STEPS
            last = s + micro >= h
            length = h - s if last else micro
            # Time cannot be told apart more finely than this.
            resolution = 1e-15 * h + 4e-16 * abs(t)
            error = runge_kutta(s, length, w)
            if not error <= 1.0:
                if length <= 10.0 * resolution:
                    return NOT_FINITE if not error < 1e300 else STEP_TOO_SMALL
                micro = length * (max(0.2, 0.9 * error**-0.2) if error < 1e300 else 0.2)
                continue
            event = find_event(s, length, resolution, w, g)
            quadrature(s, event.after, w)
            copy(x, w.xn)
            if event.guard < 0:
                s = h if last else s + length
                micro = length * min(5.0, 0.9 * max(error, 1e-10) ** -0.2)
                copy(g.start, g.samples[len(FRACTIONS) - 1])
                copy(k[0:n], k[6 * n : 7 * n])
                continue
            s += event.after
            taylor(w.U, s, w.u)
            transition(event.guard, t + s, x, w.u, w.p)
            status = settle(s, w, g.start)
            derivative_along(t, s, x, w.U, w.u, w.p, k[0:n])
            stalled, events = stalled + 1 if event.after <= 2.0 * resolution else 0, events + 1
            if stalled > STALLED_EVENTS or events > MOST_EVENTS:
                return TOO_MANY_EVENTS
        return status

    @kernel
    def advance(t: float, h: float, x: Any, U: Any, p: Any, scale: Any, work: Any) -> int:
        w, g, start = divide(t, x, U, p, scale, work)
        copy(start, x)
        status = integrate(h, w, g)
        if status != OK:
            copy(x, start)
        return status

    return advance
