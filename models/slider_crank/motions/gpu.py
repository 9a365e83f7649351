"""Lyapunov exponents of many slider-cranks at once on a CUDA device, one motion a thread.

The device runs the kernels that the processor runs: numba compiles the same functions for it. States agree
to rounding while its growth lasts, in chaos e^(0.4 theta): 1e-9 after 30 rad. Needs the extra `cuda`.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from ...core.errors import MistakeError
from ...core.quantities import Vector
from ..flight.bouncing import POSITION_SIZE, SCRATCH_ROWS
from ..flight.series import TERMS
from .machine import BLOCKS, Exponents, Machine, exponents_of

THREADS = 64
# Motions that are on the device at the same time, with 45 KB each.
BATCH = 16384


class NoDeviceError(MistakeError):
    """There is no CUDA device, or nothing to reach it with."""


class TangentGrowths(NamedTuple):
    """For each machine: logarithmic growths (., blocks, 2) of two tangent vectors over blocks of `length`
    revolutions, impacts (.) in all of them, and y and y' (., 2) at the end."""

    growths: Vector
    impacts: Vector
    state: Vector
    length: int


def compute_exponents(machines: Sequence[Machine], cycles: int, transient: int = 0) -> list[Exponents]:
    """Exponents over `cycles` revolutions (rounded up to whole blocks) after `transient` ones, from rest in
    the middle. Errors as `grow_tangents`."""
    found = grow_tangents(machines, cycles, transient)
    return [
        exponents_of(machine, growths, float(impacts), found.length)
        for machine, growths, impacts in zip(machines, found.growths, found.impacts, strict=True)
    ]


def grow_tangents(
    machines: Sequence[Machine], cycles: int, transient: int = 0, blocks: int = BLOCKS
) -> TangentGrowths:
    """Growth of the tangent vectors of motions from psi = psi' = 0.

    ValueError if linear and nonlinear forms, or machines with different numbers of cells, are mixed;
    NoDeviceError without a device.
    """
    kinds = {machine.form == "nonlinear" for machine in machines}
    cells = {machine.flow.pressing.shape[0] for machine in machines}
    if len(kinds) != 1:
        raise ValueError("follow one kind of form at a time, linear or nonlinear")
    if len(cells) != 1:
        raise ValueError(f"follow machines with equal numbers of cells together, not {sorted(cells)}")
    run = _load_kernels().nonlinear if kinds.pop() else _load_kernels().linear
    length = -(-cycles // blocks)
    parts = [
        _grow_batch(run, machines[i : i + BATCH], length, blocks, transient)
        for i in range(0, len(machines), BATCH)
    ]
    growths, impacts, state = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return TangentGrowths(growths, impacts, state, length)


def _grow_batch(
    run: Any, machines: Sequence[Machine], length: int, blocks: int, transient: int
) -> tuple[Vector, Vector, Vector]:
    cuda, count = _load_kernels().cuda, len(machines)
    tables = [np.array(parts) for parts in zip(*(machine.flow for machine in machines), strict=True)]
    walls = cuda.to_device(np.array([machine.walls for machine in machines]))
    position = cuda.to_device(np.zeros((count, POSITION_SIZE)))
    v = cuda.to_device(np.tile(np.eye(2), (count, 1, 1)))
    scratch = cuda.to_device(np.zeros((count, SCRATCH_ROWS, TERMS)))
    on_device = [*(cuda.to_device(table) for table in tables), walls, position, v, scratch]
    grid = (count + THREADS - 1) // THREADS, THREADS

    def run_block(revolutions: int) -> tuple[Vector, Vector]:
        impacts, growth = np.zeros(count), np.zeros((count, 2 + POSITION_SIZE))
        device_impacts, device_growth = cuda.to_device(impacts), cuda.to_device(growth)
        with warnings.catch_warnings():
            # Few machines leave most of the device idle.
            warnings.filterwarnings("ignore", message=".*low occupancy")
            run[grid](*on_device, device_impacts, revolutions, device_growth)
        return device_growth.copy_to_host()[:, :2], device_impacts.copy_to_host()

    run_block(transient)
    growths, impacts = zip(*(run_block(length) for _ in range(blocks)), strict=True)
    return np.stack(growths, axis=1), np.sum(impacts, axis=0), position.copy_to_host()[:, 2:4]


def _load_kernels() -> Any:
    """The module of the kernels; NoDeviceError if there is no device."""
    try:
        kernels: Any = import_module(".gpu_kernels", __package__)
    except ImportError as error:
        raise NoDeviceError(f"numba cannot use CUDA ({error}): pip install 'tribocosim[cuda]'") from None
    if not kernels.cuda.is_available():
        raise NoDeviceError("no CUDA device is found; with one, and 'tribocosim[cuda]' installed, run again")
    return kernels
