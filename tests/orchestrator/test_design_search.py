"""Rounds of a search for a cam, without a train."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from models.core.quantities import Vector
from models.core.system import ModelError
from orchestrator.study.design.figures import Objective
from orchestrator.study.design.search import BOX, SHORTER, Search
from orchestrator.study.design.slp import Active, Rows
from orchestrator.study.design.wanted import Found


class Parting(Search):
    """A search whose cycles, here their speeds, lose contact above 95 rad/s."""

    measured = columns = contacts = ()  # type: ignore[assignment]
    scale = np.ones(1)  # type: ignore[assignment]

    def kept(self, x: Vector) -> list[float]:
        return [100.0]

    all_speeds = kept

    def is_lost(self, cycle: Any) -> bool:
        return bool(cycle > 95.0)

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

    lobe = SimpleNamespace(angles=np.zeros(1), count=1)
    train: Any = SimpleNamespace(lobe=lobe, simulate=simulate, parameters=())
    wanted: Any = SimpleNamespace(speeds=[], objective=Objective())
    told: list[str] = []
    search = Parting(train, wanted, np.empty((0, 2)), 100.0, 1.0, told.append)
    found = search.improve(np.zeros(1), lambda *best: None).found
    assert told[0].startswith("goes on from designed.toml: area ")
    assert found.unknowns == pytest.approx([SHORTER * BOX])
    assert sum("no cycles (no step succeeds)" in line for line in told) == 1
    assert search.look(found.unknowns)[100.0].parting == pytest.approx(95.0, abs=0.2)


class Returning(Parting):
    """Whose model always has its optimum 0.4 % further, which its cycles refuse."""

    def judge(self, x: Vector, *others: Any) -> Found:
        return Found(x, 1.0 - abs(float(x[0])), {}, 1.0)

    def correct(self, model: Any, *others: Any) -> Any:
        return model

    def solve(self, model: Any, start: Vector, box: float, starts: int) -> Any:
        return SimpleNamespace(unknowns=start + min(box, 4e-3), active=[])


def test_a_search_returns_to_no_refused_optimum() -> None:
    looked: list[float] = []
    lobe = SimpleNamespace(angles=np.zeros(1), count=1)
    train: Any = SimpleNamespace(lobe=lobe, parameters=(), simulate=lambda x, _: looked.append(*x) or 0.0)
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

    lobe = SimpleNamespace(angles=np.zeros(1), count=1)
    train: Any = SimpleNamespace(lobe=lobe, parameters=(), simulate=lambda x, _: 0.0)
    wanted: Any = SimpleNamespace(speeds=[], objective=Objective())
    search = Refuted(train, wanted, np.empty((0, 2)), 100.0, 1.0, print)
    assert search.improve(np.zeros(1), lambda *best: None).active == [(Active("near", 0, gain, 0.01), 0.0)]
