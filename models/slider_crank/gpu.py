"""Lyapunov exponents of many slider-cranks at once on a CUDA device, one motion a thread.

The device runs the kernels that the processor runs: numba compiles the same functions for it. States agree
to rounding while its growth lasts, in chaos e^(0.4 theta): 1e-9 after 30 rad. Needs the extra `cuda`.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from ..quantities import Vector
from .bouncing import POSITION_SIZE, SCRATCH_ROWS
from .machine import Machine
from .series import TERMS

THREADS = 64
# Motions that are on the device at the same time, with 45 KB each.
BATCH = 16384


class NoDeviceError(RuntimeError):
    """There is no CUDA device, or nothing to reach it with."""


class Followed(NamedTuple):
    """For each machine: both exponents per radian (-inf: it slides), impacts, and y and y' at the end."""

    largest: Vector
    second: Vector
    impacts: Vector
    state: Vector


def follow(machines: Sequence[Machine], cycles: int, transient: int = 0) -> Followed:
    """Exponents over `cycles` revolutions after `transient` ones, from psi = psi' = 0.

    ValueError if linear and nonlinear forms are mixed, NoDeviceError without a device.
    """
    kinds = {machine.form == "nonlinear" for machine in machines}
    if len(kinds) != 1:
        raise ValueError("follow one kind of form at a time, linear or nonlinear")
    run = _kernels().nonlinear if kinds.pop() else _kernels().linear
    batches = [machines[i : i + BATCH] for i in range(0, len(machines), BATCH)]
    parts = [_follow_batch(run, batch, cycles, transient) for batch in batches]
    return Followed(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def _follow_batch(run: Any, machines: Sequence[Machine], cycles: int, transient: int) -> Followed:
    count = len(machines)
    cells = {machine.flow.pressing.shape[0] for machine in machines}
    if len(cells) > 1:
        raise ValueError(f"follow machines with equal numbers of cells together, not {sorted(cells)}")
    tables = [np.array(parts) for parts in zip(*(_flat(machine) for machine in machines), strict=True)]
    walls = np.array([machine.walls for machine in machines])
    position = np.zeros((count, POSITION_SIZE))
    v = np.tile(np.eye(2), (count, 1, 1))
    scratch = np.zeros((count, SCRATCH_ROWS, TERMS))
    impacts = np.zeros(count)
    cuda = _kernels().cuda
    on_device = [cuda.to_device(table) for table in (*tables, walls, position, v, scratch, impacts)]
    blocks = (count + THREADS - 1) // THREADS
    growth = cuda.to_device(np.zeros((count, 2 + POSITION_SIZE)))
    run[blocks, THREADS](*on_device, transient, growth)
    growth = cuda.to_device(np.zeros((count, 2 + POSITION_SIZE)))
    run[blocks, THREADS](*on_device, cycles, growth)
    exponents = growth.copy_to_host()[:, :2] / (2.0 * np.pi * cycles)
    state = on_device[-4].copy_to_host()[:, 2:4]
    return Followed(exponents[:, 0], exponents[:, 1], on_device[-1].copy_to_host(), state)


def _flat(machine: Machine) -> tuple[Any, ...]:
    flow = machine.flow
    return tuple(np.array(part) for part in flow)


def _kernels() -> Any:
    """The module of the kernels; NoDeviceError if there is no device."""
    try:
        kernels: Any = import_module(".gpu_kernels", __package__)
    except ImportError as error:
        raise NoDeviceError(f"numba cannot use CUDA ({error}): pip install 'tribocosim[cuda]'") from None
    if not kernels.cuda.is_available():
        raise NoDeviceError("no CUDA device is found; with one, and 'tribocosim[cuda]' installed, run again")
    return kernels
