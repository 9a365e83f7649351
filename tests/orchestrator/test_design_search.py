"""Rounds of a search for a cam, without a train."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from models.core.quantities import Vector
from models.core.system import ModelError
from orchestrator.study.design.figures import Objective
from orchestrator.study.design.search import BOX, MOST_ROUNDS, SHORTER, SMALLEST, Search
from orchestrator.study.design.slp import Active, Rows
from orchestrator.study.design.wanted import Found

ONE = SimpleNamespace(angles=np.zeros(1), count=1)


class Parting(Search):
    """A search whose cycles, here their speeds, lose contact above 95 rad/s."""

    columns = contacts = ()  # type: ignore[assignment]
    scale = np.ones(1)  # type: ignore[assignment]

    def measured(self, speed: float) -> list[str]:
        return []

    def kept(self, x: Vector) -> list[float]:
        return [100.0]

    all_speeds = kept

    def is_lost(self, cycle: Any) -> bool:
        return bool(cycle > 95.0)

    def correct(self, model: Any, *others: Any) -> Any:
        return model

    def judge(self, x: Vector, *others: Any) -> Found:
        return Found(x, 1.0 + 1e-3 * float(x[0]), {}, 1.0)

    def model(self, *others: Any) -> Any:
        objective, none = SimpleNamespace(gradient=np.zeros(1)), SimpleNamespace(limits=[])
        return SimpleNamespace(lines=[], objective=objective, evaluate=lambda x: none)

    def solve(self, model: Any, start: Vector, box: float, starts: int) -> Any:
        return SimpleNamespace(unknowns=start + box, active=[])


def test_a_cycle_that_fails_between_speeds_makes_the_step_smaller_and_ends_no_search() -> None:
    """Where contact is lost is looked for by halves: there the first step has no cycle."""

    def simulate(x: Vector, speed: float) -> float:
        if x[0] >= BOX and 94.1 < speed < 97.0:
            raise ModelError("no step succeeds")
        return speed

    train: Any = SimpleNamespace(lobe=ONE, simulate=simulate, parameters=())
    wanted: Any = SimpleNamespace(speeds=[], objective=Objective())
    told: list[str] = []
    search = Parting(train, wanted, np.empty((0, 2)), 100.0, 1.0, told.append)
    found = search.improve(np.zeros(1), lambda *best: None).found
    assert told[0].startswith("goes on from designed.toml: area ")
    assert SHORTER * BOX <= found.unknowns[0] < BOX
    assert "round 1 refused: no cycles (no step succeeds); a smaller step is tried" in told
    assert told[2].startswith("round 2: area")
    assert search.look(found.unknowns)[100.0].parting == pytest.approx(95.0, abs=0.2)


def test_a_search_ends_where_steps_become_too_small_for_want_of_cycles() -> None:
    def simulate(x: Vector, speed: float) -> float:
        if x[0] > 0.0:
            raise ModelError("no step succeeds")
        return speed

    train: Any = SimpleNamespace(lobe=ONE, parameters=(), simulate=simulate)
    wanted: Any = SimpleNamespace(speeds=[], objective=Objective())
    told: list[str] = []
    search = Parting(train, wanted, np.empty((0, 2)), 100.0, 1.0, told.append)
    improved = search.improve(np.zeros(1), lambda *best: None)
    refused = math.ceil(math.log(SMALLEST / BOX) / math.log(SHORTER))
    assert len(told) == 1 + refused
    assert improved.ended.endswith(f"(refused rounds at last: {refused})")


@pytest.mark.parametrize(("slope", "rounds"), [(1e-2, MOST_ROUNDS - 1), (1e-3, 4)])
def test_little_gain_in_a_small_box_ends_no_search(slope: float, rounds: int) -> None:
    """The first round is refused. The next gain 1.7e-4 and 3.5e-4 in small boxes, and more in larger ones; or
    a tenth of it, also in a box as large as the first."""
    looked: list[float] = []

    class Refused(Parting):
        def judge(self, x: Vector, *others: Any) -> Found:
            looked.append(x[0])
            return Found(x, 1.0 + slope * x[0] - (len(looked) == 2), {}, 1.0)

    train: Any = SimpleNamespace(lobe=ONE, parameters=(), simulate=lambda x, speed: speed)
    wanted: Any = SimpleNamespace(speeds=[], objective=Objective())
    search = Refused(train, wanted, np.empty((0, 2)), 100.0, 1.0, print)
    assert search.improve(np.zeros(1), lambda *best: None).found.unknowns == looked[-1]
    assert len(looked) == 1 + rounds


class Returning(Parting):
    """Whose model always has its optimum 0.4 % further, which its cycles refuse."""

    def judge(self, x: Vector, *others: Any) -> Found:
        return Found(x, 1.0 - abs(float(x[0])), {}, 1.0)

    def solve(self, model: Any, start: Vector, box: float, starts: int) -> Any:
        return SimpleNamespace(unknowns=start + min(box, 4e-3), active=[])


def test_a_search_returns_to_no_refused_optimum() -> None:
    looked: list[float] = []
    train: Any = SimpleNamespace(lobe=ONE, parameters=(), simulate=lambda x, _: looked.append(*x) or 0.0)
    wanted: Any = SimpleNamespace(speeds=[], objective=Objective())
    search = Returning(train, wanted, np.empty((0, 2)), 100.0, 1.0, print)
    improved = search.improve(np.zeros(1), lambda *best: None)
    assert improved.found.unknowns == [0.0]
    assert looked == [0.0, 4e-3]
    assert improved.ended == "the search ended because its steps became too small (refused rounds at last: 1)"


@pytest.mark.parametrize(("feasible", "gain"), [(True, -0.03), (False, 0.0)])
def test_only_limits_that_the_accepted_cycles_are_near_to_hold_a_cam(feasible: bool, gain: float) -> None:
    """Not those of a model that refused rounds have lowered; where no step keeps all limits of the model, the
    multipliers are of violations, and no price."""

    class Refuted(Returning):
        def model(self, *others: Any) -> Any:
            rows = [
                Rows(name, np.array([excess]), np.zeros((1, 1)), np.zeros(1))
                for name, excess in (("far", -0.3), ("near", -0.01))
            ]
            local = SimpleNamespace(limits=rows)
            objective = SimpleNamespace(gradient=np.zeros(1))
            return SimpleNamespace(lines=[], objective=objective, evaluate=lambda x: local)

        def correct(self, model: Any, *others: Any) -> Any:
            return None

        def solve(self, model: Any, start: Vector, box: float, starts: int) -> Any:
            assert model is not None
            active = [Active("far", 0, 2.9), Active("near", 0, -0.03)]
            return SimpleNamespace(unknowns=start + min(box, 4e-3), active=active, feasible=feasible)

    train: Any = SimpleNamespace(lobe=ONE, parameters=(), simulate=lambda x, _: 0.0)
    wanted: Any = SimpleNamespace(speeds=[], objective=Objective())
    search = Refuted(train, wanted, np.empty((0, 2)), 100.0, 1.0, print)
    assert search.improve(np.zeros(1), lambda *best: None).active == [(Active("near", 0, gain, 0.01), 0.0)]
