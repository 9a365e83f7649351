"""A system: components, their parameters and starts, and the connections between them.

Read by the monolithic solver and by co-simulation masters. Evaluated here as one problem: all outputs
at an instant follow from the state in an order that respects direct feedthrough; what is left of
algebraic loops is solved by Newton's method.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from .component import Component
from .errors import ModelError as ModelError
from .errors import suggestion as suggestion
from .quantities import Layout, Vector


@dataclass(frozen=True)
class Instance:
    """A component in a system, with what differs from its defaults.

    `parameters` by name; `start` gives start values of states by name; `inputs` constant values of
    inputs that nothing drives.
    """

    component: Component
    parameters: Mapping[str, float] = field(default_factory=dict)
    start: Mapping[str, float] = field(default_factory=dict)
    inputs: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Port:
    """A variable of an instance."""

    instance: str
    variable: str

    def __str__(self) -> str:
        return f"{self.instance}.{self.variable}"


@dataclass(frozen=True)
class Connection:
    """An output that drives an input."""

    source: Port
    target: Port

    def __str__(self) -> str:
        return f"{self.source} -> {self.target}"


def parse_port(text: str, instances: Mapping[str, Instance], kind: str) -> Port:
    """`instance.variable` as a Port; ModelError if there is no such input or output (`kind`)."""
    instance, dot, variable = text.partition(".")
    if not dot or instance not in instances:
        raise ModelError(f"{text}: no component {instance!r}; {suggestion(instance, instances)}")
    component = instances[instance].component
    layout = component.outputs if kind == "output" else component.inputs
    if variable not in layout:
        raise ModelError(
            f"{text}: {component.name} has no {kind} {variable!r}; {suggestion(variable, layout.names)}"
        )
    return Port(instance, variable)


class System:
    """Connected instances as one problem.

    `connections` maps inputs to the outputs that drive them, both as "instance.variable"; `drivers` has the
    driving output of each such input. The vectors of
    all instances stand one after the other in the order of `instances`: state `x0`, parameters `p`,
    inputs and outputs. Inputs that `torn` outputs drive take their assumed values (`cuts`: numbers of torn
    outputs, and inputs), others the computed ones (`wires`: outputs, and inputs). Raises ModelError for
    unknown names, unit mismatches, inputs driven twice and values out of range.
    """

    def __init__(self, instances: Mapping[str, Instance], connections: Sequence[tuple[str, str]]) -> None:
        if not instances:
            raise ModelError("the system has no components")
        self.instances = dict(instances)
        self.connections = tuple(self._connection(source, target) for source, target in connections)
        self.state = _Slots({name: i.component.state for name, i in self.instances.items()})
        self.inputs = _Slots({name: i.component.inputs for name, i in self.instances.items()})
        self.outputs = _Slots({name: i.component.outputs for name, i in self.instances.items()})
        self.parameters = _Slots({name: i.component.parameters for name, i in self.instances.items()})
        self._take_values()
        self.source_index = np.array([self.outputs.index(c.source) for c in self.connections], dtype=np.int64)
        self.target_index = np.array([self.inputs.index(c.target) for c in self.connections], dtype=np.int64)
        self.order, self.torn = evaluation_order(self.instances, self.connections)
        self.torn_index = np.array([self.outputs.index(port) for port in self.torn], dtype=np.int64)
        cut, number = np.nonzero(self.source_index[:, None] == self.torn_index)
        self.cuts = number.copy(), self.target_index[cut]
        self.wires = np.delete(self.source_index, cut), np.delete(self.target_index, cut)

    def with_instances(self, instances: Mapping[str, Instance]) -> System:
        """The same connections between other instances of the same names."""
        before, after = (
            [(n, id(i.component)) for n, i in one.items()] for one in (self.instances, instances)
        )
        if before == after:
            same = copy.copy(self)
            same.instances = dict(instances)
            same._take_values()
            return same
        return System(instances, [(str(c.source), str(c.target)) for c in self.connections])

    def _take_values(self) -> None:
        self.drivers = self._find_drivers()
        self.x0 = self.state.fill({n: i.start for n, i in self.instances.items()}, "state")
        self.u0 = self.inputs.fill({n: i.inputs for n, i in self.instances.items()}, "input")
        self.p = self.parameters.fill({n: i.parameters for n, i in self.instances.items()}, "parameter")
        self._check_values()

    def _connection(self, source: str, target: str) -> Connection:
        out = parse_port(source, self.instances, "output")
        into = parse_port(target, self.instances, "input")
        given = self.instances[out.instance].component.outputs.field(out.variable).quantity.unit
        wanted = self.instances[into.instance].component.inputs.field(into.variable).quantity.unit
        if given != wanted:
            raise ModelError(
                f"{source} -> {target}: unit {given} does not fit {wanted}; connect variables of one unit"
            )
        return Connection(out, into)

    def _find_drivers(self) -> dict[Port, Port]:
        drivers: dict[Port, Port] = {}
        for connection in self.connections:
            source, target = connection.source, connection.target
            if target in drivers:
                raise ModelError(f"{target} has two sources, {drivers[target]} and {source}: keep one")
            if target.variable in self.instances[target.instance].inputs:
                raise ModelError(f"{target} has a constant value and the source {source}: keep one")
            drivers[target] = source
        return drivers

    def _check_values(self) -> None:
        faults: list[str] = []
        for name, instance in self.instances.items():
            component = instance.component
            found = {
                "parameters": component.parameter_faults(self.p[self.parameters.of(name)]),
                "start": component.state.faults(self.x0[self.state.of(name)]),
                "inputs": component.inputs.faults(self.u0[self.inputs.of(name)]),
            }
            faults += [f"components.{name}.{table}.{one}" for table, ones in found.items() for one in ones]
        if faults:
            raise ModelError("; ".join(faults))

    def loops(self) -> str:
        """The variables at which algebraic loops are cut, in words; empty without loops."""
        return ", ".join(str(port) for port in self.torn)


class _Slots:
    """Where each instance's part of a vector stands."""

    def __init__(self, layouts: Mapping[str, Layout]) -> None:
        self.layouts = dict(layouts)
        self._start: dict[str, int] = {}
        self.size = 0
        for name, layout in self.layouts.items():
            self._start[name] = self.size
            self.size += layout.size
        self.nominal: Vector = np.concatenate([layout.nominal for layout in self.layouts.values()])
        self.names = tuple(f"{name}.{item}" for name, layout in self.layouts.items() for item in layout.names)

    def of(self, instance: str) -> slice:
        start = self._start[instance]
        return slice(start, start + self.layouts[instance].size)

    def index(self, port: Port) -> int:
        return self._start[port.instance] + self.layouts[port.instance].index(port.variable)

    def fill(self, values: Mapping[str, Mapping[str, float]], kind: str) -> Vector:
        """Start values with `values` in their places; ModelError for names that do not exist."""
        parts = []
        for name, layout in self.layouts.items():
            for key in values[name]:
                if key not in layout:
                    raise ModelError(f"{name}: no {kind} {key!r}; {suggestion(key, layout.variables)}")
            parts.append(layout.vector(values[name]))
        return np.concatenate(parts)


def alike(instances: Mapping[str, Instance]) -> list[str]:
    """The instances' names, those of one component together, in the order of the first of each."""
    found: dict[int, list[str]] = {}
    for name, instance in instances.items():
        found.setdefault(id(instance.component), []).append(name)
    return [name for names in found.values() for name in names]


def evaluation_order(
    instances: Mapping[str, Instance], connections: Sequence[Connection]
) -> tuple[tuple[str, ...], tuple[Port, ...]]:
    """Instances in the order in which to compute outputs (some more than once), and the torn outputs.

    An instance is computed when that makes new outputs valid; where none is left, the output whose
    assumption makes most others valid is torn (of equals, the one that depends on fewest inputs).
    """
    driver = {connection.target: connection.source for connection in connections}
    names = alike(instances)
    outputs = [Port(name, out) for name, i in instances.items() for out in i.component.outputs.names]

    def ready(port: Port, valid: set[Port]) -> bool:
        inputs = instances[port.instance].component.feedthrough.get(port.variable, ())
        sources = (driver.get(Port(port.instance, name)) for name in inputs)
        return all(source is None or source in valid for source in sources)

    def width(port: Port) -> int:
        return len(instances[port.instance].component.feedthrough.get(port.variable, ()))

    def sweep(assumed: set[Port]) -> tuple[list[str], set[Port]]:
        order: list[str] = []
        computed: set[Port] = set()
        progress = True
        while progress:
            progress = False
            for name in names:
                valid = computed | assumed
                new = {p for p in outputs if p.instance == name and p not in computed and ready(p, valid)}
                if new:
                    computed |= new
                    order.append(name)
                    progress = True
        return order, computed

    torn: list[Port] = []
    order, computed = sweep(set())
    while len(computed) < len(outputs):
        sources = sorted({s for s in driver.values() if s not in computed and s not in torn}, key=str)
        torn.append(max(sources, key=lambda port: (len(sweep({*torn, port})[1]), -width(port))))
        order, computed = sweep(set(torn))
    return tuple(order), tuple(torn)


def bounds(instance: str, *vectors: _Slots) -> tuple[int, ...]:
    """Start and stop of the instance's part of each vector."""
    return tuple(bound for slots in vectors for bound in (slots.of(instance).start, slots.of(instance).stop))
