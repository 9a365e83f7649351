"""One compiled function for a whole system, from those of its components.

Neighbouring instances of one component form a group: a loop over a table of their parts. Compiling takes as
long for a hundred of them as for one. Groups are joined in pairs, and these again, so that the functions nest
as deep as the logarithm of their number. What is compiled knows neither sizes nor places: it is kept for the
next system of the same components.
"""

from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compile.kernel import kernel
from .quantities import Vector


class Tables(NamedTuple):
    """Where the parts of a system lie: copies of outputs to inputs, parts of instances, ends of groups."""

    source: Any
    target: Any
    bounds: Any
    ends: Any


class Composition:
    """Calls `functions[i](t, x part, u part, p part, out part)` for every i in turn.

    `bounds[i]` are start and stop of the four parts. Before each call u[target] = out[source]. All
    functions write their parts of `out`. `run` is the compiled function, for kernels that call it.
    """

    def __init__(
        self,
        functions: Sequence[Any],
        bounds: Sequence[Sequence[int]],
        source: NDArray[np.int64] | None = None,
        target: NDArray[np.int64] | None = None,
    ) -> None:
        none = np.zeros(0, dtype=np.int64)
        self.source = none if source is None else source
        self.target = none if target is None else target
        self.bounds = np.array(bounds, dtype=np.int64).reshape(-1, 8)
        changes = [i for i in range(1, len(functions)) if functions[i] is not functions[i - 1]]
        starts = [0, *changes] if len(functions) else []
        self.ends = np.array([*starts, len(functions)], dtype=np.int64)
        self.run = _join([_repeat(functions[i]) for i in starts])

    def __call__(self, t: float, x: Vector, u: Vector, p: Vector, out: Vector) -> None:
        self.run(t, x, u, p, out, Tables(self.source, self.target, self.bounds, self.ends), 0)


def _join(groups: Sequence[Any]) -> Any:
    if not groups:
        return _nothing
    if len(groups) == 1:
        return groups[0]
    half = len(groups) // 2
    return _chain(_join(groups[:half]), _join(groups[half:]), half)


@kernel
def _nothing(t: float, x: Any, u: Any, p: Any, out: Any, tables: Tables, n: int) -> None:
    return


@cache
def _chain(first: Any, second: Any, groups: int) -> Any:
    """`first`, of so many groups, then `second`."""

    @kernel
    def run(t: float, x: Any, u: Any, p: Any, out: Any, tables: Tables, n: int) -> None:
        first(t, x, u, p, out, tables, n)
        second(t, x, u, p, out, tables, n + groups)

    return run


@cache
def _repeat(function: Any) -> Any:
    """`function` for each of the instances of a group."""

    @kernel
    def run(t: float, x: Any, u: Any, p: Any, out: Any, tables: Tables, n: int) -> None:
        source, target = tables.source, tables.target
        for i in range(tables.ends[n], tables.ends[n + 1]):
            for k in range(source.shape[0]):
                u[target[k]] = out[source[k]]
            b = tables.bounds[i]
            function(t, x[b[0] : b[1]], u[b[2] : b[3]], p[b[4] : b[5]], out[b[6] : b[7]])

    return run
