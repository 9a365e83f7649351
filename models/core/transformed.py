"""A component whose inputs are linear functions of what they are connected to: other units, gains."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..compile.kernel import kernel, scratch
from .component import Component, Flat
from .quantities import Field, Quantity, Vector
from .system import Instance


class Transformation(NamedTuple):
    """input = factor * source + offset, with the unit of the source."""

    factor: float
    offset: float
    unit: str

    def find_source(self, own: Field) -> Field:
        """The input as its source sees it: unit, start, size and range. A factor of zero leaves it free."""
        return replace(own, start=self._invert(own.start, 0.0), quantity=self._find_quantity(own.quantity))

    def _find_quantity(self, own: Quantity) -> Quantity:
        low, high = own.limits()
        positive = own.positive and self.factor > 0.0 and not self.offset
        if own.positive and not positive:
            low = max(low, 0.0)
        ends = self._invert(low, -math.inf), self._invert(high, math.inf)
        kept = self[:2] == (1.0, 0.0) or (own.boolean and self[:2] == (-1.0, 1.0))
        return replace(
            own,
            unit=self.unit,
            nominal=own.nominal / abs(self.factor) if self.factor else 1.0,
            minimum=min(ends),
            maximum=max(ends),
            positive=positive,
            display_unit=own.display_unit if own.unit == self.unit else "",
            boolean=own.boolean and kept,
            count=own.count and kept,
            choices=own.choices if kept else (),
            stepwise=own.jumps,
            plausible=None,
        )

    def _invert(self, value: float, free: float) -> float:
        """The source's value for the input's; `free` where every one gives the same."""
        return (value - self.offset) / self.factor + 0.0 if self.factor else free  # no negative zero


def transform(instance: Instance, inputs: Mapping[str, Transformation]) -> Instance:
    """The instance with these inputs in the units of their sources; what flows there is not its power."""
    own = instance.component
    layout = own.inputs.with_fields(
        inputs[f.name].find_source(f) if f.name in inputs else f for f in own.inputs.fields
    )
    factors, offsets = np.ones(layout.size), np.zeros(layout.size)
    for name, one in inputs.items():
        factors[layout.index(name)], offsets[layout.index(name)] = one.factor, one.offset
    values: dict[str, Any] = {field.name: getattr(own, field.name) for field in fields(Component)}
    values |= {"inputs": layout, "bonds": [b for b in own.bonds if not {b.effort, b.flow} & inputs.keys()]}
    return replace(instance, component=Transformed(**values, own=own, factors=factors, offsets=offsets))


@dataclass(frozen=True, eq=False)
class Transformed(Component):
    """The component of `transform`, by the flat kernels of its `own`."""

    own: Component = None  # type: ignore[assignment]
    factors: Vector = None  # type: ignore[assignment]
    offsets: Vector = None  # type: ignore[assignment]

    @cached_property
    def flat(self) -> Flat:
        give, own = self._give, self.own.flat
        room = np.dtype((np.record, [("u", "f8", (self.inputs.size,))]))

        def wrap(function: Any) -> Any:
            @kernel
            def flat(t: float, x: Any, u: Any, p: Any, out: Any) -> None:
                given = scratch(room)
                give(u, given)
                function(t, x, given, p, out)

            return flat

        kernels = Flat(wrap(own.derivative), wrap(own.output), wrap(own.energy))
        if self.events is None:
            return kernels
        change = own.transition

        @kernel
        def flat_transition(k: int, t: float, x: Any, u: Any, p: Any) -> None:
            given = scratch(room)
            give(u, given)
            change(k, t, x, given, p)

        return replace(kernels, guards=wrap(own.guards), transition=flat_transition)

    @cached_property
    def _give(self) -> Any:
        """A kernel that writes the inputs of `own` for these of the sources."""
        factors, offsets = self.factors, self.offsets

        @kernel
        def give(u: Any, given: Any) -> None:
            for i in range(u.shape[0]):
                given[i] = factors[i] * u[i] + offsets[i]

        return give
