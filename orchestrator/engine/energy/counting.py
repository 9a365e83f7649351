"""Instances that count their energies, and observers that do not see it."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from models.core.bonds import CountingComponent, counting
from models.core.quantities import Vector
from models.core.system import System

from ...store.json_codec import Plain
from ..observer import Observer
from ..step import Step


def add_counting(system: System, names: Collection[str]) -> System:
    """The system with the instances `names` counting their energies."""
    return system.with_instances(
        {
            name: replace(i, component=counting(i.component)) if name in names else i
            for name, i in system.instances.items()
        }
    )


def counting_structure(structure: Mapping[str, int]) -> dict[str, int]:
    """The structure of the FMU that counts."""
    return {**structure, "energies": 1}


def list_added_outputs(system: System) -> tuple[str, ...]:
    """The outputs that counting adds, as "instance.variable"."""
    return tuple(
        f"{name}.{variable}"
        for name, instance in system.instances.items()
        if isinstance(instance.component, CountingComponent)
        for variable in instance.component.outputs.names[instance.component.plain.outputs.size :]
    )


class Trimmed(Observer):
    """`observer` sees the outputs without the energies, bit for bit those of a run that does not count."""

    def __init__(self, observer: Observer, system: System) -> None:
        self._observer = observer
        energies = set(list_added_outputs(system))
        self._kept = np.array([i for i, n in enumerate(system.outputs.names) if n not in energies], dtype=int)
        self._number = {int(kept): i for i, kept in enumerate(self._kept)}

    def _names(self, names: Sequence[str]) -> list[str]:
        return [names[i] for i in self._kept]

    def begin(self, names: Sequence[str]) -> None:
        self._observer.begin(self._names(names))

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        counted = step._replace(source=self._number.get(step.source, -1))
        self._observer.observe(time, lambda: outputs()[self._kept], counted)

    def end(self, complete: bool, message: str) -> None:
        self._observer.end(complete, message)

    def state(self) -> Plain:
        return self._observer.state()

    def resume(self, names: Sequence[str], state: Plain) -> None:
        self._observer.resume(self._names(names), state)
