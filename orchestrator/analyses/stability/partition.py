"""Loops of connections, and candidate orders of a Gauss-Seidel sweep.

A connection counts if its input acts on an output, by a nonzero slope at some point of the trajectory. The
load torque on a flywheel with prescribed motion closes no loop.
"""

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np
from scipy.sparse.csgraph import connected_components

from models.core.quantities import Vector
from models.core.system import Connection, Port, System

from .linear import Linear
from .linearisation import Point

# All orders of a loop are compared if there are no more than this; else three.
MOST_ORDERS = 120


class Partition:
    """The loops of a system about its points, and the order in which its parts drive one another.

    `counting` are the connections that act, directly or through others, on a loop or on a `watched` output.
    """

    def __init__(self, system: System, points: Sequence[Point], watched: Sequence[Port]) -> None:
        self.system = system
        self.names = list(system.instances)
        self._effects = {
            name: np.logical_or.reduce([_find_effects(point.linears[name]) for point in points])
            for name in self.names
        }
        n = len(system.connections)
        follows = np.zeros((n, n), dtype=bool)
        for i, one in enumerate(system.connections):
            for j, next_ in enumerate(system.connections):
                follows[i, j] = one.target.instance == next_.source.instance and self._passes(one, next_)
        _, labels = connected_components(follows, directed=True, connection="strong")
        self.loops: list[list[Connection]] = []
        counts = np.array([self._shows(c, watched) for c in system.connections], dtype=bool)
        for label in range(labels.max(initial=-1) + 1):
            members = np.flatnonzero(labels == label)
            if len(members) > 1:
                self.loops.append([system.connections[k] for k in members])
                counts[members] = True
        for _ in range(n):
            counts |= follows @ counts
        self.counting = [c for c, count in zip(system.connections, counts, strict=True) if count]

    def _passes(self, one: Connection, following: Connection) -> bool:
        c = self.system.instances[one.target.instance].component
        effect = self._effects[one.target.instance]
        return bool(effect[c.outputs.index(following.source.variable), c.inputs.index(one.target.variable)])

    def _shows(self, connection: Connection, watched: Sequence[Port]) -> bool:
        """Whether its input acts on a watched output."""
        name = connection.target.instance
        c = self.system.instances[name].component
        column = self._effects[name][:, c.inputs.index(connection.target.variable)]
        return any(bool(column[c.outputs.index(p.variable)]) for p in watched if p.instance == name)

    @property
    def participants(self) -> list[list[str]]:
        """Groups of participants in a common loop, in the order of driving; others are groups of one."""
        n = len(self.names)
        drives = np.zeros((n, n), dtype=bool)
        for c in self.counting:
            drives[self.names.index(c.source.instance), self.names.index(c.target.instance)] = True
        count, labels = connected_components(drives, directed=True, connection="strong")
        groups = [[self.names[k] for k in np.flatnonzero(labels == label)] for label in range(count)]
        above = [
            {int(labels[k]) for k in np.flatnonzero(np.any(drives[:, labels == label], axis=1))} - {label}
            for label in range(count)
        ]
        placed: list[int] = []
        while len(placed) < count:
            placed += [i for i in range(count) if i not in placed and above[i] <= set(placed)][:1]
        return [groups[i] for i in placed]

    @property
    def stiff(self) -> tuple[str, ...]:
        """The participants worth iterating: those of the only loop, if it is not the whole system."""
        circling = [group for group in self.participants if len(group) > 1]
        return tuple(circling[0]) if len(circling) == 1 and len(circling[0]) < len(self.names) else ()

    def list_orders(self) -> Iterator[tuple[str, ...]]:
        """Orders to compare: driving parts first, with the sequences within a loop.

        Loops of the same components are ordered alike (an engine has one for each valve).
        """
        kinds = [tuple(self.system.instances[n].component.name for n in group) for group in self.participants]
        choices = [self._list_sequences(group) for group in self.participants]
        numbers: dict[tuple[str, ...], range] = {}
        for kind, choice in zip(kinds, choices, strict=True):
            numbers[kind] = range(min(len(choice), len(numbers.get(kind, choice))))
        if math.prod(len(each) for each in numbers.values()) > MOST_ORDERS:
            numbers = {kind: each[:2] for kind, each in numbers.items()}
        for chosen in itertools.product(*numbers.values()):
            number = dict(zip(numbers, chosen, strict=True))
            parts = (choice[number[kind]] for kind, choice in zip(kinds, choices, strict=True))
            yield tuple(itertools.chain.from_iterable(parts))

    def _list_sequences(self, group: list[str]) -> list[tuple[str, ...]]:
        """Along direct feedthrough, against it, as listed, and all others if these are not too many.

        Only of participants that exchange values does it matter which one advances first.
        """
        along = tuple(dict.fromkeys(name for name in self.system.order if name in group))
        few = [along, along[::-1], tuple(group)]
        ends = ({c.source.instance, c.target.instance} & set(group) for c in self.counting)
        pairs = sorted({tuple(sorted(pair)) for pair in ends if len(pair) == 2})
        if 2 ** len(pairs) <= MOST_ORDERS:
            directions = itertools.product(*((pair, pair[::-1]) for pair in pairs))
            return list(dict.fromkeys(filter(None, (_sort(group, first) for first in directions))))
        if math.factorial(len(group)) <= MOST_ORDERS:
            return list(itertools.permutations(group))
        return list(dict.fromkeys(few))


def _sort(names: Sequence[str], first: Sequence[Sequence[str]]) -> tuple[str, ...]:
    """The names with the first of each pair before the second, else as listed; () if that cannot be."""
    placed: list[str] = []
    while len(placed) < len(names):
        waiting = {after for before, after in first if before not in placed}
        ready = [name for name in names if name not in placed and name not in waiting]
        if not ready:
            return ()
        placed.append(ready[0])
    return tuple(placed)


def _find_effects(linear: Linear) -> Vector:
    """Which inputs (columns) act on which outputs, directly or through the states."""
    A, B, C, D = (np.asarray(part != 0.0) for part in (linear.A, linear.B, linear.C, linear.D))
    reached = B
    for _ in range(len(A)):
        reached = reached | (A.astype(int) @ reached > 0)
    return np.asarray(D | (C.astype(int) @ reached > 0))
