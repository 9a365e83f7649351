"""How a cam wears until it has lost a depth: few simulated cycles, each with what has worn off until then."""

import hashlib
import io
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from models.core.embedded_pair import Step, march
from models.core.quantities import Vector
from models.core.system import ModelError
from models.valve_train.worn_cam import PLACES

from ...reporter import Reporter, tell_interruption
from ...scenario.files import to_full_toml
from ...store import atomic_write
from .train import FOLLOWER, LOSS, Rubbed, WearingTrain

FOLDER = "cycles"  # with a file for each simulated cycle
MOST = 50
# Parts of the limit that the first step takes at the unworn rate, and any step at most. The last one may pass
# the limit by EXCESS of what is left, so that no short one need follow. The shortest steps are longer by
# SPARE than would reach the limit with the cycles that are left, EACH for a step: the wear may slow down.
FIRST, LONGEST, EXCESS, SPARE, EACH = 0.2, 0.5, 1.05, 1.5, 3


@dataclass(frozen=True)
class Age:
    """After the dose k N (m2/N), wear coefficient times cycles: the state, the depth along the follower (m),
    the volume worn off each body (m3), and the simulated cycle."""

    dose: float
    state: Vector
    follower: Vector
    volume: float
    rubbed: Rubbed

    @property
    def deepest(self) -> float:
        return deepest(self.state)


@dataclass(frozen=True)
class History:
    """Ages from the unworn cam on; the last one is at the limit if there is no `fault`.

    `error` (m) is the sum of the errors estimated in the steps, `simulated` the number of cycles.
    """

    train: WearingTrain
    ages: list[Age]
    error: float
    simulated: int
    fault: str = ""


def deepest(state: Vector) -> float:
    """The largest depth of a body (m)."""
    return float(np.delete(state, LOSS, axis=0).max())


class _Spent(Exception):
    """All cycles that may be simulated are."""


@dataclass
class _Simulations:
    """Rates of wear from simulated cycles, which a folder keeps; a cycle begins where the last ended."""

    train: WearingTrain
    folder: Path
    show: Callable[[float], None]
    count: int = 0
    last: Rubbed | None = None
    by_rate: dict[int, Rubbed] = field(default_factory=dict)

    def __post_init__(self) -> None:
        t = self.train
        told = to_full_toml(t.scenario), t.contact, t.period, t.limit, t.rows, metadata.version("tribocosim")
        self._digest = hashlib.sha256(repr(told).encode())

    def rate(self, state: Vector) -> Vector:
        """The rows of a state per dose (N/m)."""
        if self.count >= MOST:
            raise _Spent
        self.count += 1
        self.show(deepest(state) / self.train.limit)
        digest = self._digest.copy()
        digest.update(state.tobytes())
        path = self.folder / f"{digest.hexdigest()[:32]}.npz"
        self.last = _read(path) or self._simulate(state, path)
        self.by_rate[id(self.last.rate)] = self.last
        return self.last.rate

    def _simulate(self, state: Vector, path: Path) -> Rubbed:
        start = self.last.end if self.last else None
        train = self.train
        found = train.rub(train.unworn if start is None else train.simulate(train.lose(state), start))
        content = io.BytesIO()
        scalars = json.dumps({"work": found.work, "distance": found.distance, "numbers": dict(found.numbers)})
        np.savez(content, scalars=scalars, rate=found.rate, follower=found.follower, end=found.end)
        atomic_write.write_whole(path, content.getvalue())
        return found


def _read(path: Path) -> Rubbed | None:
    if not path.exists():
        return None
    with np.load(path, allow_pickle=False) as kept:
        arrays = {name: kept[name] for name in ("rate", "follower", "end")}
        return Rubbed(**arrays, **json.loads(str(kept["scalars"])))


def follow(train: WearingTrain, tolerance: float, folder: Path, reporter: Reporter) -> History:
    """Wear until the limit, with an error of about `tolerance` of it; at most MOST cycles are simulated.

    Cycles of the history that are in the folder are kept; that of the unworn cam is simulated once more.
    ModelError if it has none.
    """
    (folder / FOLDER).mkdir(exist_ok=True)
    with (
        tell_interruption(lambda: f"the simulated cycles are kept in {folder}: the same command continues"),
        reporter.stage(train.worn) as bar,
    ):
        simulations = _Simulations(train, folder / FOLDER, bar.show)
        state = np.zeros((len(train.rows), PLACES.size))
        first = simulations.rate(state)
        assert simulations.last
        ages = [Age(0.0, state, 0.0 * simulations.last.follower, 0.0, simulations.last)]
        if not first.any():
            slides = simulations.last.distance > 0.0
            cause = "the film carries all of the load" if slides else "it rolls and does not slide"
            return History(train, ages, 0.0, 1, f"{cause}: nothing wears")
        error = 0.0
        length = FIRST * train.limit / deepest(first)

        def bounds(now: Vector, rate: Vector) -> tuple[float, float]:
            """The shortest steps would reach the limit with the cycles that are left."""
            left, grows = EXCESS * (train.limit - deepest(now)), deepest(rate)
            steps = max(1, (MOST - simulations.count) // EACH)
            return min(SPARE * left / steps, left) / grows, min(LONGEST * train.limit, left) / grows

        try:
            for step in march(simulations.rate, state, first, length, tolerance, bounds):
                ages.append(_grow(ages[-1], step, simulations.by_rate[id(step.rates[1])], train.limit))
                error += step.error
                if deepest(step.states[1]) >= train.limit:
                    return History(train, ages, error, simulations.count)
                if not step.rates[1].any():
                    fault = "the worn cam's film carries all of the load"
                    break
        except _Spent:
            fault = f"{MOST} simulated cycles do not suffice; allow a larger tolerance"
        except ModelError as refused:
            fault = f"the cam cannot lose more: {refused}"
    return History(train, ages, error, simulations.count, fault)


def _grow(before: Age, step: Step, rubbed: Rubbed, limit: float) -> Age:
    """The age at the end of a step, or in it where the limit is reached."""
    share = 1.0
    if deepest(step.states[1]) > limit:
        share = float(brentq(lambda x: deepest(step.at(x)) - limit, 0.0, 1.0))
    length, state, old = share * step.length, step.at(share), before.rubbed
    follower = before.follower + 0.5 * length * (old.follower + rubbed.follower)
    if len(state) > FOLLOWER:
        follower = state[FOLLOWER]
    volume = before.volume + 0.5 * length * (old.work + rubbed.work)
    return Age(before.dose + length, state, follower, volume, rubbed)
