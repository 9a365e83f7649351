"""A motion dense enough to draw, with both sides of every impact."""

from copy import deepcopy
from typing import NamedTuple

import numpy as np

from ...core.quantities import Vector
from ..equations import rebound
from ..forms import wall_angle, wall_rate
from . import histories as h
from .machine import Events, Machine, Motion


class Portrait(NamedTuple):
    """Points in their order: equally spaced ones, and two of equal theta for each impact.

    theta: since the start, rad; psi: rad; psi_rate: per radian of crank; side: the wall on which it
    slides, 0 in flight. upper, lower: the walls in psi.
    """

    theta: Vector
    psi: Vector
    psi_rate: Vector
    side: Vector
    upper: Vector
    lower: Vector


def trace_portrait(motion: Motion, cycles: int, points: int = 1000) -> Portrait:
    """The next `cycles` revolutions; advances the motion."""
    parts = [_trace_revolution(motion, points) for _ in range(cycles)]
    theta, psi, rate, side = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    lower, upper = (wall_angles(motion.machine, sign, theta) for sign in (-1.0, 1.0))
    return Portrait(theta, psi, rate, side, upper, lower)


def wall_angles(machine: Machine, side: float | Vector, theta: Vector) -> Vector:
    """psi of the wall on that side, or on each angle's side, F (2.14), (2.15)."""
    form, m, offsets = machine.form_code, machine.mechanism, np.broadcast_to(side, theta.shape) * machine.gap
    return np.array([wall_angle(form, angle, y, m) for angle, y in zip(theta, offsets, strict=True)])


def rates_after(machine: Machine, impacts: Events) -> Vector:
    """psi' after each impact, F (2.16), (2.17); the wall's where sliding begins."""
    form, m = machine.form_code, machine.mechanism
    rates, angles = np.empty_like(impacts.rate), wall_angles(machine, impacts.side, impacts.theta)
    for i, (theta, psi) in enumerate(zip(impacts.theta, angles, strict=True)):
        restitution = 0.0 if impacts.kind[i] == h.ONSET else machine.restitution
        rates[i] = rebound(impacts.rate[i], wall_rate(form, theta, 1.0, psi, m), restitution)
    return rates


def _trace_revolution(motion: Motion, points: int) -> tuple[Vector, Vector, Vector, Vector]:
    """theta, psi, psi', side of one revolution.

    Events and samples are taken from twins of equal start: stops at the samples change the rounding of a
    motion, which over many revolutions of chaos would tell them apart.
    """
    machine, first = motion.machine, motion.cycle
    twin = deepcopy(motion, {id(machine): machine})
    impacts = twin.events(1).impacts
    theta, states = motion.trace(1, points)
    psi = wall_angles(machine, impacts.side, impacts.theta)
    sliding = np.where(impacts.kind == h.ONSET, impacts.side, 0.0)
    at = impacts.theta + 2.0 * np.pi * first
    angles = np.concatenate([np.repeat(at, 2), theta])
    order = np.argsort(angles, kind="stable")
    columns = (
        (np.repeat(psi, 2), states[:, 0]),
        (_interleave(impacts.rate, rates_after(machine, impacts)), states[:, 1]),
        (_interleave(np.zeros_like(sliding), sliding), states[:, 2]),
    )
    psi, rate, side = (np.concatenate(parts)[order] for parts in columns)
    return angles[order], psi, rate, side


def _interleave(before: Vector, after: Vector) -> Vector:
    return np.stack([before, after], axis=1).ravel()
