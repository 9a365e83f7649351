"""Names an unstable explicit coupling before it ends in numbers that are not finite."""

import math
from typing import Any

import numpy as np

from models.compile.array_pointers import ArrayPointers, numbers, table
from models.compile.compiled import compiled
from models.core.remedies import Set

from ..engine.coupling import Coupling
from ..engine.signals import STEPWISE, parabola
from ..errors import UnstableCouplingError
from ..masters import Master, find_name

# Steps over which sums fade, and over which swings are the consequence of a landing.
WINDOW = 50
# A value swings where it misses its linear extrapolation by this share of its size.
SWING = 0.3
# Swings in a window without a landing before them, or after landings, that are an instability.
UNPROVOKED, LASTING = 1.9, 0.4 * WINDOW
# Where the mean miss of so many last steps is less than it has been, a swing dies out: it is a motion that
# steps resolve coarsely, as they may with signals of a high order, or a coupling just stable. What has been
# fades by this factor in each step, so that a swing that goes on is seen behind a larger one.
LATELY, FADES = 10, 0.999
# A value that was at rest, up to this share of its nominal size, lands where it leaves its rest by more than
# that share.
REST, LANDING = 1e-12, 1e-2
# Landings in a row, each by so many times the largest value before it, that are an instability.
GROWING, GROWTH = 3, 2.5


class RunawayGuard:
    """It judges the exchanged values, which the master reads in every step.

    An explicit master is right only where exchanged values follow their own linear extrapolation. The
    coupling is suspect where the sum of what a value misses it by, over the last WINDOW steps or so, is
    more than SHARE of the sum of its sizes (at least its nominal size).

    A contact that closes at high speed does that too. A separation begins with a load that falls smoothly to
    zero, and the values swing only after the landing. An unstable coupling swings while the contact is
    still closed, or goes on swinging, or throws the contact open and lands harder each time. So a suspect
    coupling is unstable where values swing from step to step without a landing in the last WINDOW steps, or
    in most of the steps after one, or grow from landing to landing, and where what it misses does not die
    out.

    With any master a value of BOUND nominal sizes is a runaway.
    """

    FIRST = 25  # steps that are not judged: a start in motion rings
    SHARE = 0.5
    BOUND = 1e9

    def __init__(self, coupling: Coupling, master: Master) -> None:
        self._coupling = coupling
        self._master = master
        # Only what is exchanged is judged, and has a course that can be predicted.
        nominal = np.full(len(coupling.wiring.sources), np.inf)
        nominal[coupling.wiring.connected] = coupling.wiring.nominal[coupling.wiring.connected]
        nominal[coupling.wiring.degrees == STEPWISE] = np.inf
        self._patience = math.inf if master.implicit else float(self.FIRST)
        self._sums = {name: np.zeros(len(nominal)) for name in ("missed", "sizes", "swings", "unprovoked")}
        self._sums["landed"] = np.full(1, math.inf)  # steps since the last landing
        self._sums["lately"] = np.zeros(len(nominal))  # as `missed`, over LATELY steps
        self._sums["largest"] = np.zeros(len(nominal))  # mean of that sum
        self._sums["weight"] = np.zeros(1)  # of that sum
        # Largest size, that up to the last landing, and landings in a row that raised it much.
        self._sums |= {"peak": nominal.copy(), "before": nominal.copy(), "growing": np.zeros(len(nominal))}
        past = coupling.state.history
        self._memory = ArrayPointers(
            times=past.times, values=past.values, new=coupling.state.values, nominal=nominal, **self._sums
        )

    def judge(self, time: float, step: float) -> None:
        """UnstableCouplingError if the values after `step` at `time` run away."""
        self._patience -= 1
        share = self.SHARE if self._patience < 0 else math.inf
        worst = _judge(self._memory.record, self._coupling.state.history.count, time, self.BOUND, share)
        if worst >= 0:
            source = self._coupling.wiring.sources[worst]
            raise UnstableCouplingError(
                f"{source}: unstable coupling at t = {time:.6g} s: its values do not follow their "
                f"own prediction any more; {find_name(self._master)} cannot couple this system with steps "
                f"of {step:g} s",
                ("halve them with ", Set("macro_step", f"{step / 2.0:.4g} s")),
                ("let stable ones be chosen with ", Set("master.name", "auto")),
                *self._remedies(),
            )

    def _remedies(self) -> list[str]:
        """Those that the participants can take."""
        remedies = ["use [step_control]"] * self._coupling.restorable
        if not self._master.implicit:
            return remedies + ["use the iterated master"] * self._coupling.restorable
        return remedies + ["use another extrapolation"] * (self._coupling.wiring.degree > 0)

    def state(self) -> dict[str, Any]:
        """The sums, as plain arrays."""
        return {name: sums.copy() for name, sums in self._sums.items()} | {"patience": self._patience}

    def resume(self, state: dict[str, Any]) -> None:
        for name, sums in self._sums.items():
            sums[:] = state[name]
        self._patience = float(state["patience"])


@compiled
def _judge(memory: Any, known: int, time: float, bound: float, share: float) -> int:
    """The source that most misses its own linear extrapolation, if the coupling is unstable; else -1.

    Updates the fading sums. A value above `bound` nominal sizes counts as well.
    """
    m = memory[0]
    times, values, new, nominal = numbers(m.times), table(m.values), numbers(m.new), numbers(m.nominal)
    missed, sizes, landed = numbers(m.missed), numbers(m.sizes), numbers(m.landed)
    swings, unprovoked = numbers(m.swings), numbers(m.unprovoked)
    lately, largest, weight = numbers(m.lately), numbers(m.largest), numbers(m.weight)
    peak, before, growing = numbers(m.peak), numbers(m.before), numbers(m.growing)
    keep, keep_lately = 1.0 - 1.0 / WINDOW, 1.0 - 1.0 / LATELY
    weight[0] = keep_lately * weight[0] + 1.0
    landed[0] += 1.0
    for i in range(new.shape[0]):
        resting = known > 1 and abs(values[0, i] - values[1, i]) <= REST * nominal[i]
        if resting and abs(new[i] - values[0, i]) > LANDING * nominal[i]:
            landed[0] = 0.0
            growing[i] = growing[i] + 1.0 if peak[i] > GROWTH * before[i] else 0.0
            before[i] = peak[i]
        peak[i] = max(peak[i], abs(new[i]))
    worst, most, unstable = -1, share, False
    for i in range(new.shape[0]):
        v, d, _ = parabola(times[0], values[0, i], times[1], values[1, i], 0.0, 0.0, min(known, 2), times[0])
        miss = abs(new[i] - (v + (time - times[0]) * d))
        missed[i], lately[i] = keep * missed[i] + miss, keep_lately * lately[i] + miss
        sizes[i] = keep * sizes[i] + max(abs(new[i]), nominal[i])
        size = max(max(abs(new[i]), nominal[i]), max(abs(values[0, i]), abs(values[1, i])))
        swing = 1.0 if miss > SWING * size else 0.0
        swings[i] = keep * swings[i] + swing
        unprovoked[i] = keep * unprovoked[i] + (swing if landed[0] > WINDOW else 0.0)
        unstable |= swings[i] > LASTING or unprovoked[i] > UNPROVOKED
        unstable |= peak[i] > GROWTH * before[i] and growing[i] + 1.0 >= GROWING
        dying = lately[i] / weight[0] < FADES * largest[i]
        largest[i] = max(lately[i] / weight[0], FADES * largest[i])
        if missed[i] > most * sizes[i] and not dying:
            worst, most = i, missed[i] / sizes[i]
    if worst >= 0 and unstable:
        return worst
    for i in range(new.shape[0]):
        if abs(new[i]) > bound * nominal[i]:
            return i
    return -1
