"""A linear system from its responses to pulses: the smallest that has them (Ho and Kalman 1966, with the
singular values of Kung 1978, "ERA"), and from samples to continuous time."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.linalg import logm, schur

from models.core.quantities import Vector

from .linear import Linear

# Singular values below this share of the largest are rounding.
ROUNDING = 1e-11
MOST_STATES = 24
# A residual as small as that is not improved by more states, nor is one within a factor of the best.
FINE, NEARLY = 1e-6, 10.0
# So many others are tried where the preferred one has no counterpart in continuous time.
OTHERS = 5
# What is not above noise by this factor counts little; and responses that die out count as this share of
# the largest, lasting.
QUIET, BRIEF = 1e4, 0.05
# Eigenvalues of a sample below this are those of a motion that is over within it; so much of it is left.
GONE = 1e-5


# State after a sample from the state before, from held inputs, and the outputs from the state.
Sampled = tuple[Vector, Vector, Vector]


@dataclass(frozen=True)
class Realised:
    """A linear system and by how much its responses miss those given: the largest, over the outputs, RMS of
    the difference over the RMS of the responses, or over BRIEF of the largest if that is more."""

    linear: Linear
    residual: float


def realised(pulses: Vector, direct: Vector, spacing: float, given: Vector, noise: Vector) -> Realised:
    """From the responses `pulses` (samples x outputs x inputs) to inputs of size one that last for the first
    of the samples, `spacing` seconds apart, and the answers `direct` (outputs x inputs) at the same instant.

    `given`: sizes of the inputs to be thought equal. Outputs are weighted by their largest response, those
    not far above `noise` (outputs x inputs) by that.
    """
    p, m = direct.shape
    moved = pulses.copy()
    moved[0] -= direct
    weight = np.maximum(np.max(np.abs(moved * given), axis=(0, 2)), QUIET * np.max(noise * given, axis=1))
    scaled = moved * given / weight[:, None]
    strength = np.max(np.abs(scaled), axis=(0, 1))
    # An input that is not heard has no effect at all.
    scaled[:, :, strength < 1.0 / QUIET] = 0.0
    strength[strength < 1.0 / QUIET] = 1.0
    scaled /= strength
    if not np.any(np.abs(scaled) > 1.0 / QUIET):
        nothing = Linear(np.zeros((0, 0)), np.zeros((0, m)), np.zeros((p, 0)), direct, np.zeros(0))
        return Realised(nothing, 0.0)
    best: Realised | None = None
    for phi, gamma, observed in _choice(scaled):
        try:
            A, B = continuous(phi, gamma, spacing)
        except (ValueError, np.linalg.LinAlgError):
            continue
        own = Linear(A, B, observed, np.zeros((p, m)), np.ones(len(A)))
        again, effect, _ = own.step(spacing)
        missed = _missed((again, effect[:, :m], observed), scaled)
        if best is None or missed < best.residual:
            linear = Linear(A, B * strength / given, observed * weight[:, None], direct, np.ones(len(A)))
            best = Realised(linear, missed)
        if missed <= NEARLY * max(FINE, _missed((phi, gamma, observed), scaled)):
            break
    assert best is not None
    return best


def _choice(scaled: Vector) -> list[Sampled]:
    """Realisations, the preferred one first: the smallest that is fine, or nearly as good as the best."""
    found = []
    for candidate in _candidates(scaled):
        found.append((_missed(candidate, scaled), candidate))
        if found[-1][0] <= FINE:
            break
    enough = max(FINE, NEARLY * min(missed for missed, _ in found))
    smallest = next(i for i, (missed, _) in enumerate(found) if missed <= enough)
    rest = sorted(found[:smallest] + found[smallest + 1 :], key=lambda item: item[0])
    return [found[smallest][1], *(candidate for _, candidate in rest[:OTHERS])]


def _candidates(scaled: Vector) -> Iterator[Sampled]:
    """Realisations of more and more states."""
    n, p, m = scaled.shape
    rows = n // 2

    def hankel(first: int) -> Vector:
        return np.block([[scaled[first + i + j] for j in range(n - rows)] for i in range(rows)])

    left, sizes, right = np.linalg.svd(hankel(0))
    shifted = hankel(1)
    for order in range(1, min(MOST_STATES, int(np.sum(sizes > ROUNDING * sizes[0]))) + 1):
        root = np.sqrt(sizes[:order])
        observed, reached = left[:, :order] * root, right[:order].T * root
        phi = (left[:, :order] / root).T @ shifted @ (right[:order].T / root)
        yield phi, reached[:m].T, observed[:p]


def continuous(phi: Vector, gamma: Vector, spacing: float) -> tuple[Vector, Vector]:
    """(A, B) of x' = A x + B u whose sample with held inputs is x+ = phi x + gamma u."""
    upper, vectors = schur(phi, output="complex")
    own = np.diagonal(upper).copy()
    # No continuous motion has an eigenvalue zero, or a single negative one: what is over at once is left so.
    over = np.abs(own) < GONE
    own[over] = GONE
    np.fill_diagonal(upper, own)
    lasting = (vectors @ upper @ vectors.conj().T).real
    n, m = gamma.shape
    whole = np.zeros((n + m, n + m))
    whole[:n, :n], whole[:n, n:] = lasting, gamma
    whole[n:, n:] = np.eye(m)
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the residual judges what comes out
        found = np.asarray(logm(whole)).real / spacing
    if not np.all(np.isfinite(found)):
        raise np.linalg.LinAlgError("no logarithm")
    return found[:n, :n], found[:n, n:]


def _missed(sampled: Sampled, scaled: Vector) -> float:
    """The residual; infinite where it is no number."""
    phi, state, observed = sampled
    difference = np.empty_like(scaled)
    with np.errstate(over="ignore", invalid="ignore"):
        for k, sample in enumerate(scaled):
            difference[k] = observed @ state - sample
            state = phi @ state
        mean = np.sqrt(np.mean(scaled**2, axis=(0, 2)))
        missed = np.sqrt(np.mean(difference**2, axis=(0, 2)))
    worst = float(np.max(missed / np.maximum(mean, BRIEF)))
    return worst if np.isfinite(worst) else np.inf
