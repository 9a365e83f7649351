"""The stimulus of a component's reference results: inputs as broken lines in time, and the outputs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal

import numpy as np
from numpy.typing import ArrayLike

# Digits of an input at a corner: more than any sensor has, few enough for a small file.
DIGITS = 6


@dataclass(frozen=True)
class Stimulus:
    """A run from time 0 at default parameters and starts, which are all that the rules allow.

    `inputs` are values at `corners` (s), or one for all, and straight lines between them; an instant that
    stands twice is a jump. Inputs that are not named keep their starts. `step_size` (s) is that of
    co-simulation; corners lie on its multiples. `interval` (s) is that of the reference results, `outputs`
    what they are of, at most ten. `says` tells in a few sentences what happens, and for impacts how long it
    can be predicted.
    """

    says: str
    corners: ArrayLike
    inputs: Mapping[str, ArrayLike]
    step_size: float
    interval: float
    outputs: Sequence[str]

    @property
    def stop_time(self) -> float:
        """The last corner (s)."""
        return float(np.asarray(self.corners)[-1])

    def instants(self) -> list[float]:
        """Instants of the results: multiples of the interval, without those at which an input jumps."""
        corners = np.asarray(self.corners)
        jumps = set(corners[1:][np.diff(corners) == 0.0].tolist())
        count = round(self.stop_time / self.interval)
        every = Decimal(repr(self.interval))
        return [t for i in range(count + 1) if (t := float(i * every)) not in jumps]

    def table(self) -> tuple[list[str], list[list[float]]]:
        """Names and rows of the inputs' file: time, inputs, and slopes of those that move, as `<input>_der1`.

        A corner stands twice, with the slope before it and after it, so that a host that holds or
        interpolates what it reads has the right one on either side.
        """
        times = [Decimal(repr(float(t))) for t in np.asarray(self.corners)]
        values = {
            name: [_round(v) for v in np.broadcast_to(line, len(times))] for name, line in self.inputs.items()
        }
        slopes = {name: _slopes(times, line) for name, line in values.items()}
        moving = [name for name, line in slopes.items() if any(line)]
        names = ["time"]
        for name in values:
            names += [name, slope_name(name)] if name in moving else [name]
        rows: list[list[float]] = []
        for i, t in enumerate(times):
            for side in sorted({max(i - 1, 0), min(i, len(times) - 2)}):
                row = [t]
                for name, line in values.items():
                    row += [line[i], slopes[name][side]] if name in moving else [line[i]]
                if times[side] < times[side + 1] and list(map(float, row)) not in rows[-1:]:
                    rows.append(list(map(float, row)))
        return names, rows


def slope_name(name: str) -> str:
    """The input that is the slope of the input `name`: before an index, as FMUs call it."""
    stem, bracket, index = name.partition("[")
    return f"{stem}_der1{bracket}{index}"


def _round(value: float) -> Decimal:
    return Decimal(f"{float(value):.{DIGITS}g}")


def _slopes(times: Sequence[Decimal], values: Sequence[Decimal]) -> list[Decimal]:
    """Slopes between corners, exact where they are finite decimals, else to rounding; 0 at a jump."""
    steps = zip(times[:-1], times[1:], values[:-1], values[1:], strict=True)
    return [(b - a) / (t1 - t0) if t1 > t0 else Decimal(0) for t0, t1, a, b in steps]
