"""A component's flat kernels as C calls them: with pointers in the place of vectors.

Each entry names the sizes of what its pointers point to; `runtime/kernels.h` has the same signatures in C.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numba

from ..compile.kernel import record_of
from ..core.requirements import PLACES

# The names of entries for requirements, each followed by its number.
REQUIREMENT, START_REQUIREMENT = "requirement", "start_requirement"

carray: Any = numba.carray  # type: ignore[attr-defined]
types: Any = numba.types
real, index, vector = types.float64, types.int64, types.CPointer(types.float64)


@dataclass(frozen=True)
class Entry:
    """A function that C may call by `name`; `smooth` ones have a directional derivative (`differentiate`)."""

    name: str
    function: Callable[..., Any]
    signature: Any
    smooth: bool = False


def smooth(component: Any) -> list[str]:
    """Names of the entries that have a directional derivative."""
    return [entry.name for entry in entries(component) if entry.smooth]


def entries(component: Any) -> Iterator[Entry]:
    """Those of a component; guards and transition only where it has events."""
    layouts = component.state, component.inputs, component.parameters, component.outputs
    X, M, P, Y = ((layout.size,) for layout in layouts)
    polynomial, room = component.input_polynomial().shape, (component.work_size,)
    rates_room, events = (component.rates_work_size,), component.events
    step, find_rates, find_slopes = component.step, component.flat_rates, component.input_rates

    def entry_step(t: float, h: float, x: Any, U: Any, p: Any, scale: Any, work: Any, u: Any, y: Any) -> int:
        coefficients, result = carray(U, polynomial), carray(y, Y)
        memory = carray(work, room)
        return step(
            t, h, carray(x, X), coefficients, carray(p, P), carray(scale, X), memory, carray(u, M), result
        )

    def at_a_point(name: str, function: Any, shape: tuple[int, ...]) -> Entry:
        def entry(t: float, x: Any, u: Any, p: Any, out: Any) -> None:
            function(t, carray(x, X), carray(u, M), carray(p, P), carray(out, shape))

        return Entry(name, entry, numba.void(real, *[vector] * 4), smooth=True)

    def entry_slopes(U: Any, s: float, du: Any) -> None:
        find_slopes(carray(U, polynomial), s, carray(du, M))

    def entry_rates(t: float, x: Any, u: Any, du: Any, p: Any, work: Any, yd: Any) -> None:
        memory, slopes = carray(work, rates_room), carray(du, M)
        find_rates(t, carray(x, X), carray(u, M), slopes, carray(p, P), memory, carray(yd, Y))

    yield Entry("step", entry_step, index(real, real, *[vector] * 7))
    yield at_a_point("output", component.flat_output, Y)
    yield at_a_point("derivative", component.flat_derivative, X)
    yield at_a_point("energy", component.flat_energy, (3,))
    yield Entry("slopes", entry_slopes, numba.void(vector, real, vector))
    yield Entry("rates", entry_rates, numba.void(real, *[vector] * 6), smooth=True)
    yield from _entries_of_requirements(component)
    if events is not None:
        transition = component.flat_transition

        def entry_transition(k: int, t: float, x: Any, u: Any, p: Any) -> None:
            transition(k, t, carray(x, X), carray(u, M), carray(p, P))

        yield at_a_point("guards", component.flat_guards, (events.count,))
        yield Entry("transition", entry_transition, numba.void(index, real, *[vector] * 3))


def _entries_of_requirements(component: Any) -> Iterator[Entry]:
    layouts = component.kernel_state, component.inputs, component.parameters
    (n, X), (m, U), (parameters, P) = ((layout.size, layout.dtype) for layout in layouts)

    def of_parameters(met: Any) -> Callable[..., Any]:
        def entry_requirement(x: Any, u: Any, p: Any, numbers: Any) -> int:
            return 1 if met(record_of(carray(p, (parameters,)), P), carray(numbers, (PLACES,))) else 0

        return entry_requirement

    def requirement_of_start(met: Any) -> Callable[..., Any]:
        def entry_start_requirement(x: Any, u: Any, p: Any, numbers: Any) -> int:
            state, inputs = record_of(carray(x, (n,)), X), record_of(carray(u, (m,)), U)
            given = record_of(carray(p, (parameters,)), P)
            return 1 if met(state, inputs, given, carray(numbers, (PLACES,))) else 0

        return entry_start_requirement

    signature = index(*[vector] * 4)
    for i, rule in enumerate(component.requirements):
        yield Entry(f"{REQUIREMENT}_{i}", of_parameters(rule.met), signature)
    for i, rule in enumerate(component.start_requirements):
        yield Entry(f"{START_REQUIREMENT}_{i}", requirement_of_start(rule.met), signature)
