"""Quasi-static passage through a cam cycle: every instant in the steady film of its load and velocity.

What the squeeze of the film does is left out, so that films vanish where the entraining velocity passes zero;
there, below the size of a molecule, the contact is taken as dry. (The transient line contact says what film
is left there.)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np

from ....core.quantities import Vector
from ....core.system import ModelError
from .contact import FiniteLine, Running
from .dry import dry
from .grid import Mask, Resolution
from .solution import Solution
from .steady import steady, vanishes


@dataclass(frozen=True)
class Passage:
    """Over `angle` (rad), pressures in Pa, films in m.

    Without a load pressures are 0 and films nan; without a velocity films are 0 and pressures those of the
    dry contact. nan where nothing was found; `messages` says why, and what is not to be trusted.
    """

    angle: Vector
    largest_pressure: Vector
    end_pressure: Vector
    middle_pressure: Vector
    smallest_film: Vector
    end_film: Vector
    middle_film: Vector
    central_film: Vector
    messages: tuple[str, ...]

    @property
    def dry(self) -> Mask:
        """Where entrainment all but ends: the surfaces touch, and the largest pressure of a sharp end is the
        grid's."""
        return self.smallest_film == 0.0


_NUMBERS = tuple(f.name for f in fields(Passage) if f.name not in ("angle", "messages"))


def passage(
    contact: FiniteLine,
    angle: Sequence[float],
    load: Sequence[float],
    velocity: Sequence[float],
    radius: Sequence[float],
    misalignment: Sequence[float],
    fine: Resolution | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Passage:
    """Each instant from the solution of the one before, where its surfaces move the same way.

    Equally long sequences in rad, N, m/s, m and rad; ModelError otherwise.
    """
    lengths = {len(each) for each in (angle, load, velocity, radius, misalignment)}
    if len(lengths) != 1:
        raise ModelError(
            f"lengths of the cycle's sequences = {sorted(lengths)}: must be one; cut the longer ones"
        )
    found = {name: np.full(len(angle), math.nan) for name in _NUMBERS}
    messages = []
    before: Solution | None = None
    for i in range(len(angle)):
        try:
            now = _instant(contact, load[i], velocity[i], radius[i], misalignment[i], fine, before)
        except ModelError as error:
            now, text = None, str(error)
            messages.append(f"{math.degrees(angle[i]):g} deg: {text}")
        if now is not None:
            for name in _NUMBERS:
                found[name][i] = getattr(now, name)
            messages += [f"{math.degrees(angle[i]):g} deg: {warning}" for warning in now.warnings]
        elif load[i] <= 0.0:
            for name in _NUMBERS:
                found[name][i] = 0.0 if "pressure" in name else math.nan
        before = now if now is not None and not now.dry else None
        progress(i + 1, len(angle))
    return Passage(np.array(angle, dtype=float), **found, messages=tuple(messages))


def _instant(
    contact: FiniteLine, load: float, velocity: float, radius: float, misalignment: float,
    fine: Resolution | None, before: Solution | None,
) -> Solution | None:  # fmt: skip
    """None where there is no load."""
    if load <= 0.0:
        return None
    running = Running(load, velocity, radius, misalignment)
    if vanishes(contact, running):
        return dry(contact, running, fine)
    alike = before is not None and before.running.velocity * velocity > 0.0
    return steady(contact, running, fine, before if alike else None)
