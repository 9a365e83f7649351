"""Parts of the connection graph: what has to be iterated together, and what can go before and after."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from graphlib import TopologicalSorter

import numpy as np
from scipy.sparse.csgraph import connected_components

from ..engine.exchange import Exchange
from ..engine.signals import extrapolate
from .gauss_seidel import order_of, sweep


def step_in_parts(
    exchange: Exchange,
    order: tuple[str, ...],
    together: tuple[str, ...],
    time: float,
    step: float,
    iterate: Callable[[list[int]], int],
) -> int:
    """Make a step part by part: one participant by a sweep, several by `iterate`; the most sweeps taken.

    Signals are extrapolated where a part has not arrived yet.
    """
    if exchange.parts is None:
        exchange.parts = parts_of(exchange, order_of(exchange, order), together)
    extrapolate(exchange.history, exchange.degree, exchange.signals)
    most = 1
    for part in exchange.parts:
        if len(part) == 1:
            sweep(exchange, part, time, step)
        else:
            most = max(most, iterate(part))
    return most


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
