"""Parts of the connection graph: what has to be iterated together, and what can go before and after."""

from collections.abc import Callable
from graphlib import TopologicalSorter

import numpy as np
import scipy

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.signals import extrapolate
from ..engine.sweeps import GAUSS_SEIDEL
from .gauss_seidel import resolve_order
from .protocol import MasterStep


def step_in_parts(
    coupling: Coupling,
    order: tuple[str, ...],
    together: tuple[str, ...],
    time: float,
    step: float,
    iterate: Callable[[tuple[int, ...], Vector], int],
) -> MasterStep:
    """Make a step part by part: one participant by a sweep, several by `iterate`.

    `iterate(part, predicted)` returns its number of sweeps, and stores the part's values after the first one.
    Signals are extrapolated where a part has not advanced yet.
    """
    parts = coupling.bind(find_parts, order, together)
    predicted = coupling.bind(_make_predicted)
    extrapolate(coupling.state.history, coupling.wiring.degree, coupling.signals)
    most = 1
    for part in parts:
        if len(part) == 1:
            coupling.sweep(GAUSS_SEIDEL, part, time, step)
            own = coupling.wiring.slices[part[0]]
            predicted[own] = coupling.state.values[own]
        else:
            most = max(most, iterate(part, predicted))
    return MasterStep(most, predicted)


def _make_predicted(coupling: Coupling) -> Vector:
    return np.zeros_like(coupling.state.values)


def find_parts(
    coupling: Coupling, names: tuple[str, ...], together: tuple[str, ...]
) -> list[tuple[int, ...]]:
    """The participants in parts that advance one after the other; within a part in the order `names`.

    Without `together`: the strongly connected parts of the graph, sources before targets, so that a part
    gets signals of earlier ones that are final. `together` names the participants that make the one part to
    be iterated; the others are parts of their own, before or after it as in the order.
    """
    wiring, order = coupling.wiring, resolve_order(coupling, names)
    if together:
        group = {wiring.names.index(name) for name in together}
        first = min(order.index(i) for i in group)
        before, after = order[:first], [i for i in order[first:] if i not in group]
        return [*((i,) for i in before), tuple(i for i in order if i in group), *((i,) for i in after)]
    graph = np.zeros((len(order), len(order)), dtype=bool)
    for connection in wiring.system.connections:
        source, target = (wiring.names.index(p.instance) for p in (connection.source, connection.target))
        graph[source, target] = True
    _, label = scipy.sparse.csgraph.connected_components(graph, directed=True, connection="strong")
    before_part: dict[int, set[int]] = {int(part): set() for part in label}
    for source, target in np.argwhere(graph):
        if label[source] != label[target]:
            before_part[int(label[target])].add(int(label[source]))
    return [
        tuple(i for i in order if label[i] == part) for part in TopologicalSorter(before_part).static_order()
    ]
