"""The degree that the signal through an exchanged value may have, from what participants follow."""

from collections.abc import Mapping, Sequence

import numpy as np

from models.core.system import Connection, Port

from .capabilities import HIGHEST


def find_highest_degrees(connections: Sequence[Connection], followed: Mapping[Port, int]) -> dict[Port, int]:
    """By source, from the degree that is `followed` at each target.

    A signal has the lowest degree of all its targets, and a loop of participants one degree. An input that is
    held (0) gets the mean of its signal, whatever its degree (see `held_inputs`).
    """
    names = list(dict.fromkeys(port.instance for c in connections for port in (c.source, c.target)))
    ends = np.array([[names.index(p.instance) for p in (c.source, c.target)] for c in connections], dtype=int)
    reach = np.eye(len(names))
    reach[tuple(ends.reshape(-1, 2).T)] = 1.0
    for _ in range(len(names).bit_length()):
        reach = np.sign(reach @ reach)
    loop = [int(row.argmax()) for row in reach * reach.T]  # the first of those that reach each other
    own: dict[Port, int] = {}
    of_loop: dict[int, int] = {}
    for c, (source, target) in zip(connections, ends, strict=True):
        degree = followed[c.target] or HIGHEST
        own[c.source] = min(degree, own.get(c.source, HIGHEST))
        if loop[source] == loop[target]:
            of_loop[loop[source]] = min(degree, of_loop.get(loop[source], HIGHEST))
    found = own.copy()
    for c, (source, target) in zip(connections, ends, strict=True):
        if loop[source] == loop[target]:
            found[c.source] = min(found[c.source], of_loop[loop[source]])
    return found
