"""What every iteration that converges arrives at, found at once: on linear participants end values that
agree solve linear equations."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from models.core.quantities import Vector

from ..engine.exchange import Exchange
from ..masters import Master
from ..masters.gauss_seidel import order_of, sweep
from ..masters.interface import interface_of
from ..masters.parts import parts_of, step_in_parts
from .linear_participants import Bench


class Converged:
    """Implements `Master` for the bench, about its point, at one step: as `master` once it has converged."""

    implicit: ClassVar[bool] = True

    def __init__(self, master: Master, bench: Bench, step: float) -> None:
        self.degree, self._count = master.degree, bench.count
        # Options that an implicit master may have.
        self._order: Any = getattr(master, "order", ())
        self._iterate: Any = getattr(master, "iterate", ())
        e = bench.exchange
        e.parts = parts_of(e, order_of(e, self._order), self._iterate)
        self.sweeps = {part[0]: self._swept(bench, part, step) for part in e.parts if len(part) > 1}

    def _swept(self, bench: Bench, part: list[int], step: float) -> Vector:
        """What a sweep over a part makes of the end values that its signals assumed, as a matrix."""
        e = bench.exchange
        interface = interface_of(e, part, step)
        size = interface.size // self._count
        matrix = np.empty((size, size))
        for first in range(0, size, self._count):
            columns = np.eye(size)[:, first : first + self._count]
            bench.put(np.zeros((bench.size, 0)), step)
            e.signals[:] = 0.0
            assumed = np.zeros((size, self._count))
            assumed[:, : columns.shape[1]] = columns
            interface.assume(assumed.ravel(), step)
            sweep(e, part, 0.0, step)
            found = interface.vector().reshape(size, self._count)
            matrix[:, first : first + self._count] = found[:, : columns.shape[1]]
        return matrix

    def step(self, exchange: Exchange, time: float, step: float) -> int:
        def iterate(part: list[int]) -> int:
            matrix = self.sweeps[part[0]]
            interface = interface_of(exchange, part, step)
            with exchange.rollback(part) as roll_back:
                zero: Vector = np.zeros(len(matrix) * self._count)
                interface.assume(zero, time + step)
                sweep(exchange, part, time, step)
                rest = interface.vector().reshape(len(matrix), -1)
                roll_back()
                agreed = np.linalg.solve(np.eye(len(matrix)) - matrix, rest)
                interface.assume(agreed.ravel(), time + step)
                sweep(exchange, part, time, step)
            return 2

        return step_in_parts(exchange, self._order, self._iterate, time, step, iterate)
