"""Combinations of parameters that the signals do not show, in words, and what to measure besides.

J are the derivatives of the residuals over the noise by the logarithms of the parameters, their columns over
the lengths d. A combination v/d (v singular vector with the value s) is known to |v/d|/s of itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from models.core.quantities import Vector

if TYPE_CHECKING:
    from .objective import Objective
    from .parameters import Fitted

# A combination whose standard deviation is more than this part of itself is not identified.
LOOSE = 0.25
# Parts of a combination below this are left out; those that are so near to a rule follow it.
SMALL, RULE = 0.1, 0.05
# Singular values of the columns over their lengths below this are within the error of differences.
COLLINEAR = 1e-3
# Below this they may be within it: differences of one side are off by their step times the curvature.
DOUBT = 0.03
# Singular values below this part of the largest are rounding.
ROUNDING = 1e-10
# What another output is taken to be measured with, of its largest value; as many are named.
NOISE, NAMED = 0.01, 3


@dataclass(frozen=True)
class Unseen:
    """A combination with its standard deviation (of itself): the parameters' shares of a change that shows
    in no signal, what is seen, and outputs that would show it, each with the deviation that is left."""

    shares: dict[str, float]
    deviation: float
    seen: str
    remedies: dict[str, float]

    @property
    def text(self) -> str:
        changes = ", ".join(f"{name} {100.0 * share:+.3g} %" for name, share in self.shares.items())
        what = f"only {self.seen} is seen" if self.seen else f"a change of {changes} together is not seen"
        what = what if len(self.shares) > 1 else f"{next(iter(self.shares))} is hardly seen"
        rest = "its rest" if len(self.shares) > 1 else "it"
        known = (
            f"{rest} is known to {100.0 * self.deviation:.3g} %"
            if self.deviation < 10.0
            else f"{rest} is free"
        )
        more = ", ".join(f"{name} (to {100.0 * left:.2g} %)" for name, left in self.remedies.items())
        advice = f"measure {more}" if more else "no other output shows it: leave one parameter as it is"
        return f"{what}; {known}; {advice}"


def invert(jacobian: Vector) -> Vector:
    """The covariance (J^T J)^-1, where singular values are no less than ROUNDING of the largest."""
    _, s, v = np.linalg.svd(jacobian, full_matrices=False)
    return np.asarray((v.T / np.maximum(s, ROUNDING * s.max(initial=1e-300)) ** 2) @ v)


def _compare(jacobian: Vector, sizes: Vector) -> tuple[Vector, Vector, Vector]:
    """Singular values of the columns over their lengths, combinations, and these lengths."""
    scaled = jacobian * sizes
    lengths = np.linalg.norm(scaled, axis=0)
    lengths = np.maximum(lengths, ROUNDING * lengths.max(initial=1e-300))
    _, s, v = np.linalg.svd(scaled / lengths, full_matrices=False)
    return s, v, lengths


def acts_alike(jacobian: Vector) -> bool:
    """Whether some combination shows in nothing but errors of differences."""
    return bool(np.any(_compare(jacobian, np.ones(jacobian.shape[1]))[0] < COLLINEAR))


def is_doubtful(jacobian: Vector) -> bool:
    """Whether the errors of differences decide on what acts alike."""
    s, *_ = _compare(jacobian, np.ones(jacobian.shape[1]))
    return bool(np.any((s > 0.1 * COLLINEAR) & (s < DOUBT)))


def find_unseen(objective: "Objective", x: Vector, jacobian: Vector) -> list[Unseen]:
    """The combinations that are not identified, the least known first."""
    sizes = np.where(x != 0.0, np.abs(x), 1.0)
    s, v, lengths = _compare(jacobian, sizes)
    found = []
    for value, row in zip(s[::-1], v[::-1] / lengths, strict=True):
        largest = row[np.argmax(np.abs(row))]
        deviation = abs(float(largest)) / max(float(value), ROUNDING)
        if deviation <= LOOSE and value >= COLLINEAR:
            continue
        parts = zip(objective.parameters, row / largest, objective.values(x).values(), strict=True)
        held = [(one, float(part), value) for one, part, value in parts if abs(part) >= SMALL]
        shares = {one.name: part for one, part, _ in held}
        found.append(Unseen(shares, deviation, _name_seen(held), {}))
    if not found:
        return found
    remedies = _find_remedies(objective, x, jacobian * sizes, sizes)
    return [replace(one, remedies=remedies) for one in found]


def _name_seen(held: "Sequence[tuple[Fitted, float, float]]") -> str:
    """What two parameters with these relative changes and values leave as it is; "" without a simple name."""
    if len(held) != 2:
        return ""
    (first, a, p), (second, b, q) = held
    one, other = first.name, second.name
    rules = {f"{one} x {other}": (a, b), f"{one} / {other}": (a, -b)}
    for n in (2, 3, 4):
        rules |= {f"{one}^{n} x {other}": (n * a, b), f"{one}^{n} / {other}": (n * a, -b)}
        rules |= {f"{one} x {other}^{n}": (a, n * b), f"{other}^{n} / {one}": (n * b, -a)}
    if first.unit == second.unit:
        sums = {f"{one} + {other}": (a * p, b * q), f"{one} - {other}": (a * p, -b * q)}
        inverse = {f"1/{one} + 1/{other}": (a / p, b / q)}
        # Compliances of springs in series add up, and masses of what moves together.
        rules = inverse | sums | rules if first.unit in ("N/m", "Pa") else sums | inverse | rules
    rest = {text: abs(left + right) for text, (left, right) in rules.items()}
    fits = (text for text, (left, _) in rules.items() if rest[text] <= RULE * abs(left))
    return next(fits, "")


def _find_remedies(objective: "Objective", x: Vector, scaled: Vector, sizes: Vector) -> dict[str, float]:
    """The outputs whose measurement would raise the least singular value most, with what it leaves."""
    measured = {signal.variable for signal in objective.measured.signals}
    normal = scaled.T @ scaled
    found: dict[str, float] = {}
    for i, name in enumerate(objective.outputs):
        if name in measured:
            continue
        largest = max((float(np.max(np.abs(one.others[i]))) for one in objective.predict(x)), default=0.0)
        slopes = [one.others[i] for one in objective.derivatives]
        if largest == 0.0 or not all(np.isfinite(slope).all() for slope in slopes):
            continue
        more = sum(_count_rows(objective, e) * (s.T @ s) / len(s) for e, s in enumerate(slopes))
        more = more * np.outer(sizes, sizes) / (NOISE * largest) ** 2
        least = float(np.linalg.eigvalsh(normal + more)[0])
        found[name] = 1.0 / np.sqrt(max(least, 1e-300))
    before = 1.0 / np.sqrt(max(float(np.linalg.eigvalsh(normal)[0]), 1e-300))
    best = sorted(found, key=found.__getitem__)[:NAMED]
    return {name: found[name] for name in best if found[name] < min(LOOSE, 0.5 * before)}


def _count_rows(objective: "Objective", experiment: int) -> int:
    return int(objective.measured.experiments[experiment].positions.size)


def find_places(objective: "Objective", jacobian: Vector) -> list[str]:
    """The speed without which each parameter would be known least; "" where there is one."""
    experiments = objective.measured.experiments
    counts = np.transpose([np.isfinite(one.values).sum(axis=1) for one in experiments])
    rows = np.concatenate([np.repeat(np.arange(len(experiments)), row) for row in counts])
    if len(experiments) == 1:
        return [""] * jacobian.shape[1]
    left = [np.diag(invert(jacobian[rows != e])) for e in range(len(experiments))]
    return [experiments[e].place for e in np.argmax(left, axis=0)]


def list_correlated(names: Sequence[str], correlation: Vector, least: float = 0.9) -> list[str]:
    """Pairs that are strongly correlated, in words."""
    pairs = [(abs(correlation[i, j]), i, j) for i in range(len(names)) for j in range(i)]
    return [
        f"{names[j]}, {names[i]}: {correlation[i, j]:+.3f}"
        for size, i, j in sorted(pairs)[::-1]
        if size >= least
    ]
