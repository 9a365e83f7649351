"""Time and memory of the solved film against its nodes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchmarks.line_contact import Turn, over_event, over_turn
from models.contact.line.workspace import workspace_size

from .table import Row

COMMAND = "python -m benchmarks line_contact"
KERNELS = "models/contact/line/test_kernels.py::"
# Promised milliseconds of a step, and those of a plain dense Newton.
PROMISED = {301: (1.0, 2.4), 701: (5.0, 37.0)}
NODES = (101, 301, 701, 1501, 3001)
# The event is dear: shorter stretches of it where there are many nodes.
MANY, LAST, SHORT_LAST = 1000, 225.0, 115.0
TURN, REPEATS = 1.0, 3
# That of the FMU unless told otherwise (m).
ROUGHNESS = 0.2e-6


def rows() -> Iterator[Row]:
    found = {nodes: over_event(nodes, LAST if nodes < MANY else SHORT_LAST) for nodes in NODES}
    for nodes, (promised, dense) in PROMISED.items():
        event = min(found[nodes][0], over_event(nodes, LAST)[0])
        smooth, rough = (min(over_turn(nodes, sigma) for _ in range(REPEATS)) for sigma in (0.0, ROUGHNESS))
        slow = [f"the cam's event alone takes {event:.2f}"] if event > promised else []
        slow += [f"rough surfaces take {rough:.2f}"] if rough > promised else []
        yield Row(
            f"transient step at {nodes} nodes: {promised:g} ms or less on average over the cam cycle (a "
            f"plain dense Newton took {dense:g} ms)",
            f"{nodes} nodes, 0.1°: {smooth:.2f} ms of processor time over the cycle, {event:.2f} over the "
            f"event; {rough:.2f} over the cycle with a roughness of {1e6 * ROUGHNESS:g} µm",
            command=COMMAND,
            short=("; ".join(slow) + " ms.") if slow else "",
        )
    yield _growth(found)
    yield _revolution()
    yield _memory(found)


def _growth(found: dict[int, tuple[float, float]]) -> Row:
    same = {nodes: over_event(nodes, SHORT_LAST)[0] for nodes in NODES}
    order = np.log(same[3001] / same[301]) / np.log(3001 / 301)
    return Row(
        "cost must grow much more slowly than the cube of the nodes (choose by measurement and say why)",
        f"exponent {order:.1f} from 301 to 3001 nodes; factors and solution by LAPACK take "
        + ", ".join(f"{ratio:.1f} times ours at {nodes}" for nodes, (_, ratio) in found.items())
        + "; the choice is told in docs/contact.md; bands as preconditioner need more (`python -m benchmarks "
        "line_preconditioner`)",
        (
            KERNELS + "test_hierarchical_factors_solve_as_dense_ones",
            KERNELS + "test_factors_serve_after_nodes_changed_sides",
        ),
        command=COMMAND,
    )


def _revolution() -> Row:
    turn = Turn(301, 1.0)
    turn.run(0.0, 10.0)
    spent = min(turn.run(0.0, 360.0) for _ in range(REPEATS))
    return Row(
        "a full cam revolution of 360 steps under a second (an open code needed 130.8 s for 329)",
        f"301 nodes, load given: {spent:.2f} s of processor time, least of {REPEATS}",
        command=COMMAND,
        short="" if spent < TURN else "not met.",
    )


def _memory(found: dict[int, tuple[float, float]]) -> Row:
    return Row(
        "memory and time against nodes from 100 to 3000 shown",
        ", ".join(
            f"{nodes}: {spent:.2f} ms, {workspace_size(nodes) * 8 / 1e6:.1f} MB"
            for nodes, (spent, _) in found.items()
        )
        + f" (from {MANY} nodes on only the flank, 95° to {SHORT_LAST:g}°)",
        command=COMMAND,
    )
