"""A component made of others: a connected system as one subsystem, with its equations solved together.

Its variables are those of its parts, as `part.variable`. What drives its inputs from inside is closed here;
the inputs that are left open are its own. Outputs follow in the order of direct feedthrough, as in
`evaluation`; an algebraic loop is cut at one output, in which it is linear (an inertia that its load
accelerates), and closed by the secant.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..compile.kernel import kernel, scratch
from .component import Component, Events, Flat, PowerBond
from .composition import Composition, Tables
from .errors import ModelError
from .quantities import Field, FieldLayout, Layout
from .requirements import Requirement
from .system import Instance, Port, System, alike, bounds

# A linear loop is closed by one step of the secant; the second removes what rounding leaves.
CORRECTIONS = 2

# In the description of an open input, before the start of a part's own that it replaces.
REPLACES = "replaces the start"


def with_values(instance: Instance) -> Component:
    """The component of an instance, whose parameters, start values and inputs are its defaults."""
    component = instance.component
    return replace(
        component,
        parameters=component.parameters.with_start(instance.parameters),
        state=component.state.with_start(instance.start),
        inputs=component.inputs.with_start(instance.inputs),
    )


def compose(
    name: str,
    description: str,
    instances: Mapping[str, Instance],
    connections: Sequence[tuple[str, str]],
) -> Component:
    """The system of `instances` and `connections` (see `System`) as one component.

    Inputs that nothing drives are its inputs, with the instances' values as defaults. Connections may begin
    or end at other components, which are left to the host: their outputs that drive others become inputs.
    ModelError for parts that are no ordinary differential equations, and for loops through more than one
    output.
    """
    for part, instance in instances.items():
        if not instance.component.ode:
            raise ModelError(
                f"{part}: {instance.component.name} is no system of ordinary differential equations, which "
                "one FMU of a whole train needs; take a film formula, or leave it out"
            )
    inner = [line for line in connections if all(end.partition(".")[0] in instances for end in line)]
    inside = System(instances, inner)
    if len(inside.torn) > 1:
        raise ModelError(f"algebraic loops through {inside.loops()}: one FMU can close one; leave a part out")
    opening = _Opening(inside, {target: source for source, target in connections})
    parts = {part: with_values(instance) for part, instance in instances.items()}
    guards = sum(component.events.count for component in parts.values() if component.events)
    return Composite(
        name=name,
        description=description,
        parameters=_join({part: component.parameters for part, component in parts.items()}),
        state=_join({part: component.state for part, component in parts.items()}),
        inputs=FieldLayout(opening.fields),
        outputs=_join({part: component.outputs for part, component in parts.items()}),
        derivative=None,
        output=None,
        energy=None,
        feedthrough=_find_feedthrough(inside, opening),
        bonds=_find_bonds(inside, opening),
        events=Events(guards, None, None) if guards else None,
        requirements=_list_requirements(inside),
        tolerance=min(component.tolerance for component in parts.values()),
        event_indicators=[f"{part}.{n}" for part, c in parts.items() for n in c.event_indicators],
        kernels=_make_kernels(inside, opening),
    )


def _join(layouts: Mapping[str, Layout]) -> Layout:
    """The layouts of the parts, one after the other; elements of vectors are scalars like others."""
    scalars = [
        replace(field, name=f"{part}.{field.name}", quantity=replace(field.quantity, size=""))
        for part, layout in layouts.items()
        for field in layout.fields
    ]
    records = [(part, layout.dtype) for part, layout in layouts.items() if layout.size]
    return FieldLayout(scalars, np.dtype((np.record, records)))


@dataclass(frozen=True, eq=False)
class Composite(Component):
    """The component of `compose`."""

    kernels: Flat = None  # type: ignore[assignment]

    @cached_property
    def flat(self) -> Flat:
        return self.kernels


class _Opening:
    """The inputs that are left open: their fields, and where each drives an input of a part.

    One that drives several starts as the first of them; its description names the starts that it replaces.
    """

    def __init__(self, inside: System, sources: Mapping[str, str]) -> None:
        self.names: dict[Port, str] = {}
        self.fields: list[Field] = []
        places: list[tuple[int, int]] = []
        driven = {c.target for c in inside.connections}
        numbers: dict[str, int] = {}
        for part, instance in inside.instances.items():
            for field in instance.component.inputs.fields:
                port = Port(part, field.name)
                if port in driven:
                    continue
                name = self.names[port] = sources.get(str(port), str(port))
                start = float(instance.inputs.get(field.name, field.start))
                if name not in numbers:
                    numbers[name] = len(self.fields)
                    quantity = replace(field.quantity, size="")
                    self.fields.append(Field(name, quantity, start))
                elif start != (shared := self.fields[numbers[name]]).start:
                    words = f"{shared.quantity.description}; {REPLACES} {port} = {start:g}"
                    quantity = replace(shared.quantity, description=words)
                    self.fields[numbers[name]] = replace(shared, quantity=quantity)
                places.append((numbers[name], inside.inputs.index(port)))
        self.source, self.target = np.array(places, dtype=np.int64).reshape(-1, 2).T.copy()


def _find_feedthrough(system: System, opening: _Opening) -> dict[str, list[str]]:
    """The open inputs on which each output depends at the same instant."""
    driver = {c.target: c.source for c in system.connections}

    def follow(output: Port, seen: set[Port]) -> Iterator[str]:
        if output in seen:
            return
        seen.add(output)
        component = system.instances[output.instance].component
        for name in component.feedthrough.get(output.variable, ()):
            port = Port(output.instance, name)
            if port in driver:
                yield from follow(driver[port], seen)
            else:
                yield opening.names[port]

    outputs = (Port(n, out) for n, i in system.instances.items() for out in i.component.outputs.names)
    return {str(port): list(dict.fromkeys(follow(port, set()))) for port in outputs}


def _find_bonds(system: System, opening: _Opening) -> list[PowerBond]:
    """The bonds through which power comes from outside."""
    driver = {c.target: c.source for c in system.connections}
    found = []
    for part, instance in system.instances.items():
        for bond in instance.component.bonds:
            ports = [Port(part, bond.effort), Port(part, bond.flow)]
            if any(port in opening.names for port in ports):
                effort, flow = (opening.names.get(port) or str(driver.get(port, port)) for port in ports)
                found.append(PowerBond(effort, flow, bond.sign))
    return found


def _list_requirements(system: System) -> list[Requirement]:
    """What the parts require of their parameters."""
    return [
        replace(rule, met=_make_rule(rule.met, part), says=f"{part}.{rule.says}")
        for part, instance in system.instances.items()
        for rule in instance.component.requirements
    ]


def _make_rule(met: Any, part: str) -> Any:
    @kernel
    def rule(p: Any, numbers: Any) -> bool:
        return met(p[part], numbers)

    return rule


def _make_kernels(s: System, opening: _Opening) -> Flat:
    """The kernels of a system on flat vectors, with the open inputs in the place of all inputs."""
    names = alike(s.instances)
    components = [s.instances[name].component for name in names]
    slots = s.state, s.inputs, s.parameters
    outputs = Composition(
        [s.instances[name].component.flat_output for name in s.order],
        [bounds(name, *slots, s.outputs) for name in s.order],
        *s.wires,
    )
    evaluate = _make_evaluate(outputs, opening, s)
    derivatives = Composition(
        [component.flat_derivative for component in components],
        [bounds(name, *slots, s.state) for name in names],
    )
    energies = Composition(
        [component.flat_energy for component in components],
        [(*bounds(name, *slots), 3 * i, 3 * i + 3) for i, name in enumerate(names)],
    )
    room = np.dtype((np.record, [("u", "f8", (s.inputs.size,)), ("y", "f8", (s.outputs.size,))]))
    inputs = s.inputs.size
    guards, places, change, end = [], [], _no_transition, 0
    for name, component in zip(names, components, strict=True):
        if component.events is not None:
            own, start, end = bounds(name, *slots), end, end + component.events.count
            guards.append(component.flat_guards)
            places.append((*own, start, end))
            change = _make_change(component.flat_transition, own, start, change)
    return Flat(
        _make_each(evaluate, room, inputs, derivatives),
        _make_output(evaluate, room, inputs),
        _make_energy(_make_each(evaluate, room, inputs, energies), len(names)),
        _make_each(evaluate, room, inputs, Composition(guards, places)),
        _make_transition(evaluate, room, inputs, change),
    )


def _make_evaluate(outputs: Composition, opening: _Opening, s: System) -> Any:
    """evaluate(t, x, c, p, u, y): all inputs u and outputs y from the open inputs c."""
    run, source, target = outputs.run, outputs.source, outputs.target
    bound, ends = outputs.bounds, outputs.ends
    free_source, free_target = opening.source, opening.target
    torn = int(s.torn_index[0]) if s.torn else 0
    cut = s.cuts[1]
    probe = float(s.outputs.nominal[torn])
    looped = bool(s.torn)

    @kernel
    def assume(value: float, u: Any) -> None:
        for k in range(cut.shape[0]):
            u[cut[k]] = value

    @kernel
    def evaluate(t: float, x: Any, c: Any, p: Any, u: Any, y: Any) -> None:
        tables = Tables(source, target, bound, ends)
        for k in range(free_source.shape[0]):
            u[free_target[k]] = c[free_source[k]]
        for i in range(y.shape[0]):
            y[i] = 0.0
        assume(0.0, u)
        run(t, x, u, p, y, tables, 0)
        if looped:
            still = y[torn]
            assume(probe, u)
            run(t, x, u, p, y, tables, 0)
            slope = (y[torn] - still) / probe - 1.0
            guess = -still / slope
            for _ in range(CORRECTIONS):
                assume(guess, u)
                run(t, x, u, p, y, tables, 0)
                guess -= (y[torn] - guess) / slope
            assume(y[torn], u)
        for k in range(source.shape[0]):
            u[target[k]] = y[source[k]]

    return evaluate


def _make_output(evaluate: Any, room: Any, inputs: int) -> Any:
    @kernel
    def flat_output(t: float, x: Any, c: Any, p: Any, y: Any) -> None:
        memory = scratch(room)
        evaluate(t, x, c, p, memory[:inputs], y)

    return flat_output


def _make_each(evaluate: Any, room: Any, inputs: int, parts: Composition) -> Any:
    """each(t, x, c, p, out): what the parts write at these open inputs, such as derivatives or guards."""
    run, none, bound, ends = parts.run, parts.source, parts.bounds, parts.ends

    @kernel
    def each(t: float, x: Any, c: Any, p: Any, out: Any) -> None:
        memory = scratch(room)
        u = memory[:inputs]
        evaluate(t, x, c, p, u, memory[inputs:])
        run(t, x, u, p, out, Tables(none, none, bound, ends), 0)

    return each


def _make_energy(each: Any, parts: int) -> Any:
    """The sums over the parts of what `each` writes, three numbers of each."""
    table = np.dtype((np.record, [("energies", "f8", (3 * parts,))]))

    @kernel
    def flat_energy(t: float, x: Any, c: Any, p: Any, e: Any) -> None:
        energies = scratch(table)
        each(t, x, c, p, energies)
        e[:] = 0.0
        for i in range(energies.shape[0]):
            e[i % 3] += energies[i]

    return flat_energy


@kernel
def _no_transition(k: int, t: float, x: Any, u: Any, p: Any) -> None:
    return


def _make_change(change: Any, part: tuple[int, ...], start: int, before: Any) -> Any:
    """The transitions of a part, whose guards begin with `start`; those `before` are of other parts."""
    x0, x1, u0, u1, p0, p1 = part

    @kernel
    def transition(k: int, t: float, x: Any, u: Any, p: Any) -> None:
        if k >= start:
            change(k - start, t, x[x0:x1], u[u0:u1], p[p0:p1])
        else:
            before(k, t, x, u, p)

    return transition


def _make_transition(evaluate: Any, room: Any, inputs: int, change: Any) -> Any:
    @kernel
    def flat_transition(k: int, t: float, x: Any, c: Any, p: Any) -> None:
        memory = scratch(room)
        u = memory[:inputs]
        evaluate(t, x, c, p, u, memory[inputs:])
        change(k, t, x, u, p)

    return flat_transition
