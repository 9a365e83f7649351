"""Chaotic, transiently chaotic or periodic, with the evidence."""

import math
from dataclasses import dataclass

import numpy as np

from ...core.quantities import Vector
from ...core.words import tally
from .machine import Exponents, Machine, Motion
from .recurrence import SETTLED, TOLERANCE, Recurrence, run_until_recurrent
from .transients import ORDINARY_TRANSIENT

PERIODIC, CHAOTIC, TRANSIENT_CHAOS, UNDECIDED = "periodic", "chaotic", "transient chaos", "undecided"
# A sign is certain if the exponent is so many standard errors away from zero.
CERTAIN = 3.0
# Revolutions of one finite-time exponent within a transient: long enough for the tangent vector to turn to
# the growing direction, short enough to lie between slides, each of which ends a tangent vector.
WINDOW = 5
# An exponent over an orbit is taken over so many blocks of whole periods and at least so many cycles, so that
# the tangent vector's turn to its direction at the start does not count.
BLOCKS, ORBIT_CYCLES = 20, 2000
# Cycles of a long sliding orbit over which the exponent between slides is taken.
LONGEST_LOOK = 2000
# Growth of a deviation, in e-foldings, that takes rounding to the size of the motion.
ROUNDING = -math.log(np.finfo(float).eps)


@dataclass(frozen=True)
class Classification:
    """Kind of a motion, and the evidence.

    period: cycles (0 unless it repeats). transient: cycles before it is within `SETTLED` of the orbit.
    exponent: the largest per radian in the end, -inf if the motion slides, with its standard error
    `uncertainty`; transient_exponent: the same over the transient, nan if there was none.
    """

    kind: str
    period: int
    transient: int
    exponent: float
    uncertainty: float
    transient_exponent: float
    transient_uncertainty: float
    impacts_per_cycle: float
    cycles: int
    evidence: str

    @property
    def slides(self) -> bool:
        """True if the motion slides on a wall in the end."""
        return self.exponent == -math.inf


def classify(
    machine: Machine, cycles: int = 100_000, psi: float = 0.0, psi_rate: float = 0.0
) -> Classification:
    """The kind of the motion from (psi, psi') at crank angle zero, looked at for up to so many cycles.

    periodic: states at crank angle zero repeat (see `recurrence`) and the largest exponent over the orbit is
    negative. transient chaos: the same, after more than ORDINARY_TRANSIENT cycles over which the exponent was
    positive with certainty. chaotic: no repetition, and the exponent over a further fifth of `cycles` is
    positive with certainty. undecided: anything else; the evidence says what would help.
    """
    motion = Motion(machine, psi, psi_rate)
    states, found = run_until_recurrent(motion, cycles)
    if found is None:
        return _classify_aperiodic(motion.exponents(max(20, cycles // 5)), len(states))
    orbit = orbit_exponents(motion, found.period)
    if not orbit.largest < 0.0:
        evidence = (
            f"{_recurrence_text(found)}, but its exponent is not negative ({_exponent_text(orbit)}): an "
            "orbit that is not attracting; another start would help"
        )
        return _build_classification(UNDECIDED, found, orbit, _NO_TRANSIENT, len(states), evidence)
    before = transient_exponent(Motion(machine, psi, psi_rate), found.transient)
    evidence = f"{_recurrence_text(found)}; exponent over the orbit {_exponent_text(orbit)}"
    evidence += _slides_text(motion, found.period, orbit)
    if found.transient > ORDINARY_TRANSIENT and before[0] > CERTAIN * before[1]:
        evidence += f"; before, over {tally(found.transient, 'cycle')}, the exponent was "
        evidence += f"{before[0]:.3g} +- {before[1]:.2g}"
        return _build_classification(TRANSIENT_CHAOS, found, orbit, before, len(states), evidence)
    evidence += f"; within {SETTLED:g} of it after {tally(found.transient, 'cycle')}"
    return _build_classification(PERIODIC, found, orbit, before, len(states), evidence)


_NO_TRANSIENT = (math.nan, math.nan)


def orbit_exponents(motion: Motion, period: int) -> Exponents:
    """Exponents over the orbit on which the motion is."""
    first = motion.exponents(max(BLOCKS, period), BLOCKS)
    if first.largest == -math.inf:
        return first
    return motion.exponents(BLOCKS * period * -(-ORBIT_CYCLES // (BLOCKS * period)), BLOCKS)


def transient_exponent(motion: Motion, cycles: int) -> tuple[float, float]:
    """Mean and standard error of the finite-time exponents of the first cycles; nan if they are too few.

    Windows in which the motion slides are left out: between slides it may be chaotic.
    """
    found = finite_time_exponents(motion, cycles)
    finite = found[np.isfinite(found)]
    if finite.size < 2:
        return _NO_TRANSIENT
    return float(finite.mean()), float(finite.std(ddof=1) / math.sqrt(finite.size))


def finite_time_exponents(motion: Motion, cycles: int, window: int = WINDOW) -> Vector:
    """The largest exponent of every so many cycles, each for itself; -inf where the motion slides."""
    return np.array([motion.exponents(window, blocks=window).largest for _ in range(cycles // window)])


def _classify_aperiodic(end: Exponents, cycles: int) -> Classification:
    none = Recurrence(0, 0, math.nan, cycles, False)
    evidence = f"no state repeats over {tally(cycles, 'cycle')}"
    if end.largest > CERTAIN * end.uncertainty:
        errors = end.largest / end.uncertainty
        evidence += f"; exponent afterwards {_exponent_text(end)}, {errors:.0f} standard errors"
        return _build_classification(CHAOTIC, none, end, _NO_TRANSIENT, cycles, evidence)
    if end.largest == -math.inf:
        evidence += (
            ", although the motion slides and is then released from the same state: a period longer than "
            "that; more cycles would help"
        )
    else:
        evidence += (
            f" and the sign of the exponent is not certain ({_exponent_text(end)}); more cycles would help"
        )
    return _build_classification(UNDECIDED, none, end, _NO_TRANSIENT, cycles, evidence)


def _build_classification(
    kind: str, found: Recurrence, end: Exponents, before: tuple[float, float], cycles: int, evidence: str
) -> Classification:
    return Classification(
        kind, found.period, found.transient, end.largest, end.uncertainty, *before, end.impacts_per_cycle,
        cycles, evidence,
    )  # fmt: skip


def _slides_text(motion: Motion, period: int, orbit: Exponents) -> str:
    """Evidence of chaos between the slides of an orbit; empty without."""
    if orbit.largest > -math.inf or period < 2 * WINDOW:
        return ""
    mean, error = transient_exponent(motion, min(period, LONGEST_LOOK))
    if not mean > CERTAIN * error:
        return ""
    words = f", but between slides {mean:.3g} +- {error:.2g}: chaos that each slide ends"
    if 2.0 * math.pi * mean * period <= ROUNDING:
        return words
    return f"{words}, and whose length hangs on rounding"


def _recurrence_text(found: Recurrence) -> str:
    times = f"{found.repeats} times" if found.repeats > 1 else "once"
    how = "to the last bit" if found.exact and not found.distance else f"within {TOLERANCE:g}"
    return f"repeats every {tally(found.period, 'cycle')}, {times} in succession {how}"


def _exponent_text(found: Exponents) -> str:
    if found.largest == -math.inf:
        return "-inf (it slides)"
    return f"{found.largest:.4g} +- {found.uncertainty:.2g} per radian"
