"""Parts of the connection graph: what has to be iterated together, and what can go before and after."""

from __future__ import annotations

from collections.abc import Sequence
from graphlib import TopologicalSorter

import numpy as np
from scipy.sparse.csgraph import connected_components

from ..exchange import Exchange


def parts_of(exchange: Exchange, order: Sequence[int], together: tuple[str, ...]) -> list[list[int]]:
    """The participants in parts that advance one after the other; within a part in `order`.

    Without `together`: the strongly connected parts of the graph, sources before targets, so that a part
    gets signals of earlier ones that are final. `together` names the participants that make the one part to
    be iterated; the others are parts of their own, before or after it as in `order`.
    """
    if together:
        group = {exchange.names.index(name) for name in together}
        first = min(order.index(i) for i in group)
        before = [[i] for i in order[:first]]
        return [*before, [i for i in order if i in group], *([i] for i in order[first:] if i not in group)]
    size = len(exchange.names)
    graph = np.zeros((size, size), dtype=bool)
    for connection in exchange.system.connections:
        source, target = (exchange.names.index(p.instance) for p in (connection.source, connection.target))
        graph[source, target] = True
    _, label = connected_components(graph, directed=True, connection="strong")
    before_part: dict[int, set[int]] = {int(part): set() for part in label}
    for source, target in np.argwhere(graph):
        if label[source] != label[target]:
            before_part[int(label[target])].add(int(label[source]))
    return [[i for i in order if label[i] == part] for part in TopologicalSorter(before_part).static_order()]
