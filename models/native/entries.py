"""A component's flat kernels as C calls them: with pointers in the place of vectors.

Each entry names the sizes of what its pointers point to; `runtime/kernels.h` has the same signatures in C.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numba

from ..compile.kernel import record_of
from ..core.quantities import Layout
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
    n, m = component.state.size, component.inputs.size
    parameters, outputs = component.parameters.size, component.outputs.size
    coefficients = component.input_polynomial().shape
    work_size, rates_work_size = component.work_size, component.rates_work_size
    step, find_output, derivative = component.step, component.flat_output, component.flat_derivative
    find_energy, find_rates, find_slopes = component.flat_energy, component.flat_rates, component.input_rates

    def entry_step(t: float, h: float, x: Any, U: Any, p: Any, scale: Any, work: Any, u: Any, y: Any) -> int:
        return step(
            t,
            h,
            carray(x, (n,)),
            carray(U, coefficients),
            carray(p, (parameters,)),
            carray(scale, (n,)),
            carray(work, (work_size,)),
            carray(u, (m,)),
            carray(y, (outputs,)),
        )

    def entry_output(t: float, x: Any, u: Any, p: Any, y: Any) -> None:
        find_output(t, carray(x, (n,)), carray(u, (m,)), carray(p, (parameters,)), carray(y, (outputs,)))

    def entry_derivative(t: float, x: Any, u: Any, p: Any, dx: Any) -> None:
        derivative(t, carray(x, (n,)), carray(u, (m,)), carray(p, (parameters,)), carray(dx, (n,)))

    def entry_energy(t: float, x: Any, u: Any, p: Any, e: Any) -> None:
        find_energy(t, carray(x, (n,)), carray(u, (m,)), carray(p, (parameters,)), carray(e, (3,)))

    def entry_slopes(U: Any, s: float, du: Any) -> None:
        find_slopes(carray(U, coefficients), s, carray(du, (m,)))

    def entry_rates(t: float, x: Any, u: Any, du: Any, p: Any, work: Any, yd: Any) -> None:
        find_rates(
            t,
            carray(x, (n,)),
            carray(u, (m,)),
            carray(du, (m,)),
            carray(p, (parameters,)),
            carray(work, (rates_work_size,)),
            carray(yd, (outputs,)),
        )

    at_a_point = numba.void(real, vector, vector, vector, vector)
    yield Entry("step", entry_step, index(real, real, *[vector] * 7))
    yield Entry("output", entry_output, at_a_point, smooth=True)
    yield Entry("derivative", entry_derivative, at_a_point, smooth=True)
    yield Entry("energy", entry_energy, at_a_point, smooth=True)
    yield Entry("slopes", entry_slopes, numba.void(vector, real, vector))
    yield Entry("rates", entry_rates, numba.void(real, *[vector] * 6), smooth=True)
    yield from _entries_of_requirements(component, component.kernel_state, m, parameters)
    if component.events is not None:
        yield from _entries_of_events(component, n, m, parameters)


def _entries_of_requirements(component: Any, state: Layout, m: int, parameters: int) -> Iterator[Entry]:
    n, X, U, P = state.size, state.dtype, component.inputs.dtype, component.parameters.dtype

    def of_parameters(met: Any) -> Callable[..., Any]:
        def entry_requirement(x: Any, u: Any, p: Any, numbers: Any) -> int:
            return 1 if met(record_of(carray(p, (parameters,)), P), carray(numbers, (PLACES,))) else 0

        return entry_requirement

    def requirement_of_start(met: Any) -> Callable[..., Any]:
        def entry_start_requirement(x: Any, u: Any, p: Any, numbers: Any) -> int:
            fits = met(
                record_of(carray(x, (n,)), X),
                record_of(carray(u, (m,)), U),
                record_of(carray(p, (parameters,)), P),
                carray(numbers, (PLACES,)),
            )
            return 1 if fits else 0

        return entry_start_requirement

    signature = index(*[vector] * 4)
    for i, rule in enumerate(component.requirements):
        yield Entry(f"{REQUIREMENT}_{i}", of_parameters(rule.met), signature)
    for i, rule in enumerate(component.start_requirements):
        yield Entry(f"{START_REQUIREMENT}_{i}", requirement_of_start(rule.met), signature)


def _entries_of_events(component: Any, n: int, m: int, parameters: int) -> Iterator[Entry]:
    find_guards, transition, count = component.flat_guards, component.flat_transition, component.events.count

    def entry_guards(t: float, x: Any, u: Any, p: Any, g: Any) -> None:
        find_guards(t, carray(x, (n,)), carray(u, (m,)), carray(p, (parameters,)), carray(g, (count,)))

    def entry_transition(k: int, t: float, x: Any, u: Any, p: Any) -> None:
        transition(k, t, carray(x, (n,)), carray(u, (m,)), carray(p, (parameters,)))

    yield Entry("guards", entry_guards, numba.void(real, *[vector] * 4), smooth=True)
    yield Entry("transition", entry_transition, numba.void(index, real, *[vector] * 3))
