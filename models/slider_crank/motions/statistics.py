"""Where and how hard the slider hits its walls: F 3.2 (profile), F 3.3 (spectra), and a measure of wear."""

import math
from typing import NamedTuple

import numpy as np

from ...compile.kernel import kernel
from ...core.quantities import Vector
from ..equations import Mechanism, inertia
from ..flight.bouncing import LOWER, UPPER
from ..forms import offset_slope, wall_angle
from . import histories as h
from .machine import Events, Machine

TURN = 2.0 * math.pi


class Distribution(NamedTuple):
    """Sums over bins, each wall's apart; edges has one element more."""

    edges: Vector
    upper: Vector
    lower: Vector


def wall_position(theta: Vector, xi: float) -> Vector:
    """F's x: the slider's place along the walls over the rod's length, 1 - xi to 1 + xi."""
    x: Vector = xi * np.cos(theta) + np.sqrt(1.0 - (xi * np.sin(theta)) ** 2)
    return x


def approach_velocities(impacts: Events) -> Vector:
    """Velocities relative to the wall, y' over l, upwards: positive at the upper wall."""
    velocities: Vector = impacts.side * impacts.approach
    return velocities


def impact_profile(impacts: Events, velocities: Vector, xi: float, bins: int, total: float) -> Distribution:
    """F (3.6): sum of the impacts' velocities over equal parts of the wall, over `total`.

    F: velocities psi' (`impacts.rate`), total the number of all impacts. The sum over all bins and both
    walls is then the mean velocity. A motion that slides has infinitely many impacts, of which those above
    the limit of chatter are here: sums of psi', which becomes the wall's, over their number or without it
    have no limit. Those of `approach_velocities` over the number of cycles have one.
    """
    edges = np.linspace(1.0 - xi, 1.0 + xi, bins + 1)
    return _distribute(impacts, wall_position(impacts.theta, xi), edges, velocities / total)


def impact_spectrum(impacts: Events, velocities: Vector, bins: int, total: float) -> Distribution:
    """F (3.7): the same over equal parts of the revolution."""
    edges = np.linspace(0.0, TURN, bins + 1)
    return _distribute(impacts, impacts.theta, edges, velocities / total)


def energy_profile(machine: Machine, impacts: Events, bins: int, total: float) -> Distribution:
    """Energy that the impacts take, over M l^2 Omega^2, over equal parts of the wall, over `total`."""
    edges = np.linspace(1.0 - machine.xi, 1.0 + machine.xi, bins + 1)
    position = wall_position(impacts.theta, machine.xi)
    return _distribute(impacts, position, edges, energies(machine, impacts) / total)


def _distribute(impacts: Events, place: Vector, edges: Vector, weights: Vector) -> Distribution:
    inside = np.clip(place, edges[0], edges[-1])  # the ends but for rounding
    upper, lower = (
        np.histogram(inside[chosen], edges, weights=weights[chosen])[0]
        for chosen in (impacts.side == UPPER, impacts.side == LOWER)
    )
    return Distribution(edges, upper, lower)


def energies(machine: Machine, impacts: Events) -> Vector:
    """Energy that each impact takes: (1 - e^2) a v^2 / (2 (dy/dpsi)^2), v the approach; all of it where
    sliding begins. Over M l^2 Omega^2."""
    taken = np.empty_like(impacts.theta)
    form = machine.form_code
    kept = np.where(impacts.kind == h.ONSET, 0.0, machine.restitution**2)
    fill_energies(form, machine.mechanism, machine.gap, kept, impacts, taken)
    return taken


@kernel
def fill_energies(
    form: float, m: Mechanism, gap: float, kept: Vector, impacts: Events, taken: Vector
) -> None:
    """`kept`: part of the energy that is left after each impact."""
    for i in range(taken.size):
        theta = impacts.theta[i]
        psi = wall_angle(form, theta, impacts.side[i] * gap, m)
        rate = impacts.approach[i] / offset_slope(form, theta, psi, m)
        taken[i] = 0.5 * inertia(m) * (1.0 - kept[i]) * rate**2


def uniformity(weights: Vector) -> float:
    """Shannon's entropy of a distribution over its bins, over that of the even one.

    1: all bins alike; 0: all in one bin; nan: nothing at all. It depends on the number of bins B: n spots
    give at most ln n / ln B, which falls to 0, a density at least 1 - ln(B / worn bins) / ln B, which rises
    to 1. N independent samples make it too small, see `sampling_bias`.
    """
    return math.log(effective_bins(weights)) / math.log(len(weights))


def effective_bins(weights: Vector) -> float:
    """exp of Shannon's entropy: so many bins, alike, would have it. n spots: at most n, for any bins."""
    total = float(np.sum(weights))
    if not total > 0.0:
        return math.nan
    share = weights[weights > 0.0] / total
    return float(np.exp(-np.sum(share * np.log(share))))


def sampling_bias(weights: Vector, samples: Vector) -> float:
    """By how much `uniformity` is too small for a finite number of samples (Miller 1955, first order).

    (occupied bins - 1) / (2 N ln B), with N = (sum w)^2 / sum w^2 of the samples' weights w.
    """
    occupied = int(np.count_nonzero(weights))
    if occupied == 0:
        return math.nan
    effective = float(np.sum(samples)) ** 2 / float(np.sum(samples**2))
    return (occupied - 1) / (2.0 * effective * math.log(len(weights)))
