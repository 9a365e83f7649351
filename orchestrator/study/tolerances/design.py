"""The trains of a tolerance study: the mean one, those beside it, and a sample of all factors.

A factor is what varies independently of the others: a parameter, several that are correlated, the grinding
errors of a cam. The sample is that of Saltelli, Comput. Phys. Commun. 145 (2002) 280-297: A and B of equal
size, and for each factor A with that factor's values of B. Points of a Sobol' sequence fill A and B more
evenly than chance.
"""

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from models.core.quantities import Vector
from models.valve_train.worn_cam import PLACES, FreshCam

from .distributions import Distribution

# A share of 0 or 1 would be an infinite value.
LEAST_SHARE = 1e-12
# Kinds of trains.
NOMINAL, BESIDE, SAMPLE, MIXED = "nominal", "beside", "sample", "mixed"


@dataclass(frozen=True)
class Parameters:
    """Parameters with correlated normal scores, by the Cholesky factor `root` of their correlations."""

    names: tuple[str, ...]
    distributions: tuple[Distribution, ...]
    root: Vector

    @property
    def size(self) -> int:
        return len(self.names)

    @property
    def nominal(self) -> Vector:
        return np.array([float(one.mean()) for one in self.distributions])

    @property
    def covariance(self) -> Vector:
        deviations = np.array([float(one.std()) for one in self.distributions])
        return np.asarray(self.root @ self.root.T * np.outer(deviations, deviations))

    def draw(self, shares: Vector) -> Vector:
        """Values of trains, the rows, whose numbers lie above these shares of their distributions."""
        scores = ndtri(np.clip(shares, LEAST_SHARE, 1.0 - LEAST_SHARE)) @ self.root.T
        drawn = zip(self.distributions, ndtr(scores).T, strict=True)
        return np.column_stack([one.ppf(below) for one, below in drawn])

    def apply(self, values: Vector) -> dict[str, float]:
        return dict(zip(self.names, map(float, values), strict=True))


@dataclass(frozen=True)
class GrindingError:
    """Waves on a cam's lift. Values are cosine and sine parts (m), in turn, of the orders."""

    cam: str
    orders: tuple[int, ...]
    amplitudes: tuple[float, ...]
    fresh: FreshCam

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(f"{self.cam}.{part}[{order}]" for order in self.orders for part in ("cosine", "sine"))

    @property
    def size(self) -> int:
        return len(self.orders)

    @property
    def nominal(self) -> Vector:
        return np.zeros(2 * self.size)

    @property
    def covariance(self) -> Vector:
        """A wave of random phase: half of its amplitude's square in each part."""
        return np.diag(np.repeat(np.square(self.amplitudes) / 2.0, 2))

    def draw(self, shares: Vector) -> Vector:
        phases, amplitudes = 2.0 * math.pi * shares, np.array(self.amplitudes)
        parts = np.stack([amplitudes * np.cos(phases), amplitudes * np.sin(phases)], axis=-1)
        return parts.reshape(len(shares), -1)

    @functools.cached_property
    def waves(self) -> Vector:
        """Of each part of 1 m, what it adds to lift, slope and curvature at the cam's points."""
        parts = [part(order * PLACES) for order in self.orders for part in (np.cos, np.sin)]
        return np.array([self.fresh.interpolate(part) for part in parts])

    def apply(self, values: Vector) -> dict[str, float]:
        points = self.fresh.lower(-np.tensordot(values, self.waves, 1))
        return {f"{self.cam}.{k}": v for k, v in points.parameters().items()}


Factor = Parameters | GrindingError


@dataclass(frozen=True)
class Design:
    """The trains of all factors: `half` are those of A, as many of B, and with `mixed` for each factor."""

    factors: Mapping[str, Factor]
    half: int
    mixed: bool
    seed: int

    @functools.cached_property
    def names(self) -> tuple[str, ...]:
        """Of all values."""
        return tuple(name for factor in self.factors.values() for name in factor.names)

    @functools.cached_property
    def nominal(self) -> Vector:
        return np.concatenate([factor.nominal for factor in self.factors.values()])

    @functools.cached_property
    def deviations(self) -> Vector:
        return np.sqrt(np.concatenate([np.diag(f.covariance) for f in self.factors.values()]))

    @functools.cached_property
    def kinds(self) -> tuple[str, ...]:
        """Of every train."""
        mixed = len(self.factors) * self.half if self.mixed else 0
        beside, sample = 2 * len(self.names), 2 * self.half
        return (NOMINAL, *[BESIDE] * beside, *[SAMPLE] * sample, *[MIXED] * mixed)

    @functools.cached_property
    def shares(self) -> tuple[Vector, Vector]:
        """Of A and B, (half, numbers that are drawn)."""
        size = sum(factor.size for factor in self.factors.values())
        points = qmc.Sobol(2 * size, scramble=True, rng=self.seed).random(self.half)
        return points[:, :size], points[:, size:]

    @property
    def sample(self) -> Vector:
        """The shares of all sampled trains, (2 half, numbers that are drawn)."""
        return np.concatenate(self.shares)

    def __len__(self) -> int:
        return len(self.kinds)

    @functools.cached_property
    def values(self) -> Vector:
        """Of all trains, (trains, names)."""
        beside = self.nominal + np.kron(np.diag(self.deviations), [[-1.0], [1.0]])
        shares, (first, second) = [self.sample], self.shares
        for k in range(len(self.factors) if self.mixed else 0):
            shares.append(first.copy())
            shares[-1][:, self.columns(k)] = second[:, self.columns(k)]
        every = np.concatenate(shares)
        drawn = [factor.draw(every[:, self.columns(k)]) for k, factor in enumerate(self.factors.values())]
        return np.vstack([self.nominal, beside, np.column_stack(drawn)])

    def columns(self, factor: int) -> slice:
        """Where the drawn numbers of a factor stand."""
        sizes = [one.size for one in self.factors.values()]
        return slice(sum(sizes[:factor]), sum(sizes[: factor + 1]))

    def settings(self, values: Vector) -> dict[str, float]:
        """The parameters "component.parameter" of a train with these values."""
        found, begin = dict[str, float](), 0
        for factor in self.factors.values():
            end = begin + len(factor.names)
            found |= factor.apply(values[begin:end])
            begin = end
        return found
