"""Energies over power bonds of participants that do not count them: estimated from what is exchanged.

Over a step an input is the polynomial that the participant was given, or the mean of it that was held. Its
own effort or flow is known at both ends: the cubic through values and rates where it gives rates, else the
straight line. The product is integrated exactly (Gauss), so that the estimate is of fourth order in the macro
step with rates, of second without. A motion inside the step that the ends do not show, an impact say, is
missed.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, NoReturn

import numpy as np

from models.core.bonds import CountingComponent, counting, energy_through
from models.core.component import Component, PowerBond
from models.core.quantities import Quantity, Vector
from models.core.system import Instance, System

from ...participants.compiled_calls import NotCompiledError
from ...participants.held_inputs import mean
from ...participants.protocol import BoundVariables, Participant
from ...participants.wrapping import ParticipantWrapper
from ..observer import Observer
from ..step import Step
from .bonds import find_exchanged_bonds


def _rule() -> tuple[Vector, Vector, Vector]:
    """Gauss's rule on a step from 0 to 1, exact for the product of two cubics, and at its nodes Hermite's
    cubics: of value and rate at the start, of value and rate at the end."""
    nodes, weights = np.polynomial.legendre.leggauss(4)
    s = 0.5 * (nodes + 1.0)
    cubics = np.array([(1 + 2 * s) * (1 - s) ** 2, s * (1 - s) ** 2, s**2 * (3 - 2 * s), s**2 * (s - 1)])
    return s, 0.5 * weights, cubics.T


AT, WEIGHTS, CUBICS = _rule()


@dataclass(frozen=True, eq=False)
class EstimatedComponent(Component):
    """`plain` with an output more for each of `estimates`, its bonds whose energies are estimated."""

    plain: Component = None  # type: ignore[assignment]  # given always, after fields with defaults
    estimates: tuple[PowerBond, ...] = ()


def add_estimates(system: System) -> System:
    """The system with estimates for all exchanged bonds of instances that do not count their energies."""
    wanted: dict[str, list[PowerBond]] = {}
    for bond in find_exchanged_bonds(system):
        for name, own in bond.declared.items():
            if not isinstance(system.instances[name].component, CountingComponent):
                wanted.setdefault(name, []).append(own)
    return system.with_instances(
        {
            name: replace(i, component=_with_estimates(i.component, wanted[name])) if name in wanted else i
            for name, i in system.instances.items()
        }
    )


def _with_estimates(plain: Component, bonds: Sequence[PowerBond]) -> EstimatedComponent:
    more = {energy_through(bond): Quantity("J", "energy in since the start, estimated") for bond in bonds}
    attributes: dict[str, Any] = {f.name: getattr(plain, f.name) for f in fields(Component)}
    attributes["outputs"] = plain.outputs.extend(more)
    return EstimatedComponent(**attributes, plain=plain, estimates=tuple(bonds))


def without_estimates(instance: Instance) -> Instance:
    """The instance as its participant knows it."""
    component = instance.component
    return (
        replace(instance, component=component.plain)
        if isinstance(component, EstimatedComponent)
        else instance
    )


class Estimating(ParticipantWrapper):
    """Implements `Participant` by `participant`; after its outputs come those of `component.estimates`."""

    def __init__(self, participant: Participant, component: EstimatedComponent) -> None:
        super().__init__(participant)
        self._bonds = component.estimates
        self._own = np.zeros(len(self._bonds))  # the energies
        self._fresh = False

    def compiled_calls(self) -> NoReturn:
        raise NotCompiledError("its energies are estimated")

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        input_names, self._given, output_names, self._outputs, self._rates = bound
        self._values, self._slopes = np.zeros(len(output_names)), np.zeros(len(output_names))
        rated = self._participant.connect(bound._replace(outputs=self._values, rates=self._slopes))
        self._rated = np.array(rated, dtype=bool)
        orders = np.arange(len(bound.inputs))[:, None]
        degrees = np.array(self.signal_degrees(input_names), dtype=int)
        self._followed, self._held = orders <= degrees, np.flatnonzero(degrees == 0).tolist()
        # Variables are numbered through inputs, then outputs.
        names = [*input_names, *output_names]
        self._efforts = [names.index(bond.effort) for bond in self._bonds]
        self._flows = [names.index(bond.flow) for bond in self._bonds]
        self._signs = np.array([bond.sign for bond in self._bonds], dtype=float)
        return rated if bound.rates.size else [False] * len(output_names)

    def write(self) -> None:
        self._fresh = False
        self._participant.write()

    def read(self) -> None:
        if not self._fresh:
            self._participant.read()
        self._outputs[:] = self._values
        if self._rates.size:
            self._rates[self._rated] = self._slopes[self._rated]

    def read_all(self, values: Vector) -> None:
        plain = len(values) - len(self._own)
        self._participant.read_all(values[:plain])
        values[plain:] = self._own

    def advance(self, time: float, step: float) -> None:
        # At its start outputs already see the step's inputs.
        self._participant.read()
        value, slope = self._values.copy(), self._slopes.copy()
        signals = np.where(self._followed, self._given, 0.0)
        for column in self._held:
            signals[0, column] = mean(self._given, column, step)
        self._participant.advance(time, step)
        self._participant.read()
        self._fresh = True
        powers = np.cumprod([np.ones(len(AT)), *(step * AT / k for k in range(1, len(signals)))], axis=0)
        straight = np.outer(1.0 - AT, value) + np.outer(AT, self._values)
        cubic = CUBICS @ np.array([value, step * slope, self._values, step * self._slopes])
        course = np.hstack([powers.T @ signals, np.where(self._rated, cubic, straight)])
        power = course[:, self._efforts] * course[:, self._flows] * self._signs
        self._own += step * (WEIGHTS @ power)

    def save(self) -> tuple[Any, Vector]:
        return self._participant.save(), self._own.copy()

    def restore(self, saved: tuple[Any, Vector]) -> None:
        self._fresh = False
        self._participant.restore(saved[0])
        self._own[:] = saved[1]

    def release(self, saved: tuple[Any, Vector]) -> None:
        self._participant.release(saved[0])

    def to_bytes(self, saved: tuple[Any, Vector]) -> bytes:
        return saved[1].tobytes() + self._participant.to_bytes(saved[0])

    def from_bytes(self, data: bytes) -> tuple[Any, Vector]:
        size = self._own.nbytes
        return self._participant.from_bytes(data[size:]), np.frombuffer(data[:size]).copy()


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
    """The outputs that counting and estimates add, as "instance.variable"."""
    return tuple(
        f"{name}.{variable}"
        for name, instance in system.instances.items()
        if isinstance(instance.component, CountingComponent | EstimatedComponent)
        for variable in instance.component.outputs.names[instance.component.plain.outputs.size :]
    )


class Trimmed:
    """`observer` sees the outputs without the energies, bit for bit those of a run that does not count.

    It continues a run as `observer` does (see `checkpoint`).
    """

    def __init__(self, observer: Observer, system: System) -> None:
        self._observer: Any = observer
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

    def state(self) -> dict[str, Any]:
        return self._observer.state()

    def resume(self, names: Sequence[str], state: Mapping[str, Any]) -> None:
        self._observer.resume(self._names(names), state)
