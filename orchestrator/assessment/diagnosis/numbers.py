"""What set the steps of a run, as numbers."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from models.core.quantities import Vector

from ...engine.step import REASONS
from .steps import Steps

# The run's time is divided into so many spans, each dominated by the variable that limits most steps there.
SPANS = 100
# Quantiles of step length and of iterations.
QUANTILES = {"least": 0.0, "p05": 0.05, "median": 0.5, "p95": 0.95, "most": 1.0}
# A dense interval holds this share of the work; so many are looked for.
DENSE_WORK, DENSE = 0.1, 3
LISTED = 20  # times of discontinuities


@dataclass(frozen=True)
class Share:
    """A share of all steps, and of the simulated time."""

    steps: float
    time: float


@dataclass(frozen=True)
class Limit(Share):
    """Steps limited by the error of one variable, and the spans (s, s) where it limits most of them."""

    spans: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Interval:
    """From `start` to `end` (s), with shares of the work and of the simulated time."""

    start: float
    end: float
    work: float
    time: float

    @property
    def density(self) -> float:
        """Work over time, relative to the whole run."""
        return self.work / self.time


@dataclass(frozen=True)
class Diagnosis:
    """`start`, `end` in s; `reasons` and `limits` by falling share of steps, without those that never were.

    `rejections` counts rejected attempts by what the step was finally set by; `length` (s) and `iterations`
    are quantiles; `densest` the shortest intervals that hold a tenth of the work each, merged where they
    touch; `events` counts located ones by the variable that told; `discontinuities` are the first times (s)
    and variables of steps over the tolerance at the shortest length; `over` are the others over it, which
    were not made again: how many, the largest error over what is allowed, and its time (s).
    """

    start: float
    end: float
    steps: int
    rejected: int
    total_iterations: int
    do_steps: int | None
    reasons: dict[str, Share]
    limits: dict[str, Limit]
    rejections: dict[str, int]
    length: dict[str, float]
    iterations: dict[str, float]
    densest: tuple[Interval, ...]
    events: dict[str, int]
    discontinuities: tuple[tuple[float, str], ...]
    over: tuple[int, float, float]

    @property
    def rejected_share(self) -> float:
        """Of all attempts."""
        return self.rejected / max(1, self.steps + self.rejected)

    @property
    def mean_iterations(self) -> float:
        return self.total_iterations / max(1, self.steps)

    def share(self, reason: str) -> float:
        """Of the steps that were set by `reason`."""
        return self.reasons[reason].steps if reason in self.reasons else 0.0


def diagnose_steps(steps: Steps, do_steps: int | None = None) -> Diagnosis | None:
    """The numbers of these steps; None if there are none."""
    if not len(steps):
        return None
    events = _named(steps, steps.reason == REASONS.index("event"))
    jumps = steps.reason == REASONS.index("discontinuity")
    return Diagnosis(
        start=float(steps.start[0]),
        end=float(steps.end[-1]),
        steps=len(steps),
        rejected=int(steps.rejected.sum()),
        total_iterations=int(steps.iterations.sum()),
        do_steps=do_steps,
        reasons=_reasons(steps),
        limits=_limits(steps),
        rejections={
            name: count
            for i, name in enumerate(REASONS)
            if (count := int(steps.rejected[steps.reason == i].sum()))
        },
        length=_quantiles(steps.length),
        iterations=_quantiles(steps.iterations),
        densest=_densest(steps),
        events={name: int(chosen.sum()) for name, chosen in events.items()},
        discontinuities=tuple(
            (float(steps.end[i]), steps.name(int(steps.source[i]))) for i in np.flatnonzero(jumps)[:LISTED]
        ),
        over=_over(steps, ~jumps & (steps.error > 1.0)),
    )


def _over(steps: Steps, chosen: Any) -> tuple[int, float, float]:
    """Of the steps over the tolerance, see `Diagnosis`."""
    if not chosen.any():
        return 0, 0.0, 0.0
    worst = int(np.argmax(np.where(chosen, steps.error, 0.0)))
    return int(chosen.sum()), float(steps.error[worst]), float(steps.end[worst])


def _share(steps: Steps, chosen: Any) -> Share:
    return Share(float(np.mean(chosen)), float(steps.length[chosen].sum() / steps.length.sum()))


def _reasons(steps: Steps) -> dict[str, Share]:
    found = {
        name: _share(steps, steps.reason == i) for i, name in enumerate(REASONS) if np.any(steps.reason == i)
    }
    return dict(sorted(found.items(), key=lambda item: -item[1].steps))


def _named(steps: Steps, among: Any) -> dict[str, Any]:
    """Which of the steps in `among` each source set."""
    sources = np.unique(steps.source[among])
    return {steps.name(int(i)): among & (steps.source == i) for i in sources if i >= 0}


def _limits(steps: Steps) -> dict[str, Limit]:
    limited = steps.reason == REASONS.index("error")
    spans = _spans(steps, limited)
    found = {}
    for name, chosen in _named(steps, limited).items():
        share = _share(steps, chosen)
        found[name] = Limit(share.steps, share.time, tuple(spans.get(name, ())))
    return dict(sorted(found.items(), key=lambda item: -item[1].steps))


def _spans(steps: Steps, limited: Any) -> dict[str, list[tuple[float, float]]]:
    """Where each variable limits more steps than any other; neighbouring spans are joined."""
    edges = np.linspace(steps.start[0], steps.end[-1], SPANS + 1)
    spans = np.clip(np.searchsorted(edges, steps.end) - 1, 0, SPANS - 1)
    sources, places = np.unique(steps.source, return_inverse=True)
    counts = np.zeros((SPANS, len(sources)), dtype=int)
    np.add.at(counts, (spans[limited], places[limited]), 1)
    first = np.where(counts.any(axis=1), sources[counts.argmax(axis=1)], -1)
    # A span in which no step ends is within the step that ends next.
    ended = np.flatnonzero(np.bincount(spans, minlength=SPANS))
    first = first[ended[np.searchsorted(ended, np.arange(SPANS))]]
    found: dict[str, list[tuple[float, float]]] = {}
    changes = [0, *(np.flatnonzero(np.diff(first)) + 1), SPANS]
    for a, b in pairwise(changes):
        if first[a] >= 0:
            found.setdefault(steps.name(int(first[a])), []).append((float(edges[a]), float(edges[b])))
    return found


def _quantiles(values: Any) -> dict[str, float]:
    # Values that were, not means between two of them.
    found = np.quantile(values, list(QUANTILES.values()), method="inverted_cdf")
    return {name: float(value) for name, value in zip(QUANTILES, found, strict=True)}


def _densest(steps: Steps) -> tuple[Interval, ...]:
    """The shortest intervals with DENSE_WORK of the work, one after the other, without overlap."""
    start, end = steps.start, steps.end
    done: Vector = np.concatenate([[0.0], np.cumsum(steps.work)])
    first = np.arange(len(steps))
    last = np.searchsorted(done, done[:-1] + DENSE_WORK * done[-1] * (1.0 - 1e-9)) - 1
    fits = last < len(steps)
    last = np.minimum(last, len(steps) - 1)
    lasting = np.where(fits, end[last] - start[first], np.inf)
    chosen: list[tuple[int, int]] = []
    for _ in range(DENSE):
        i = int(np.argmin(lasting))
        if not np.isfinite(lasting[i]):
            break
        chosen.append((i, int(last[i])))
        lasting[(first <= last[i]) & (last >= i)] = np.inf
    merged: list[tuple[int, int]] = []
    for a, b in sorted(chosen):
        if merged and a == merged[-1][1] + 1:
            merged[-1] = (merged[-1][0], b)
        else:
            merged.append((a, b))
    whole = end[-1] - start[0]
    return tuple(
        Interval(
            float(start[a]),
            float(end[b]),
            float((done[b + 1] - done[a]) / done[-1]),
            float((end[b] - start[a]) / whole),
        )
        for a, b in merged
    )
