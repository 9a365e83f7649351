"""Starts at rest, where contacts just touch: all rates vanish."""

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from models.core.evaluation import Evaluation
from models.monolithic import equilibrium
from models.monolithic.equilibrium import _Rest
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

LASH = "components.valve_spring.parameters.lash"


@pytest.mark.parametrize(
    ("name", "speed", "changes"),
    [
        # The film that the turning cam draws in just fills the gap that the lash leaves.
        ("seat-and-lash", 3000, (f"{LASH}=0.05 mm", "components.contact.parameters.film_model=moes_venner")),
        # The pushrod and its tappet are free within the lash.
        ("pushrod-train", 4000, (f"{LASH}=0.1 mm",)),
    ],
)
def test_parts_that_just_touch_within_a_lash_come_to_rest(
    name: str, speed: int, changes: tuple[str, ...]
) -> None:
    """Velocities change by less than 1 mm/s in a second, all else by less than 1e-8 of itself: a hundred
    roundings of forces of 100 N on parts of 10 g."""
    system = build_system(load(name, [*changes, f"components.flywheel.parameters.initial_speed={speed} rpm"]))
    x = equilibrium(system)
    rates = np.abs(Evaluation(system).derivative(0.0, x)) / (system.state.nominal + np.abs(x))
    turning = np.array([state.startswith("flywheel.") for state in system.state.names])
    moving = np.array(["velocity" in state or state.endswith("_rate") for state in system.state.names])
    assert np.max(rates[moving & ~turning]) < 1e-3
    assert np.max(rates[~moving & ~turning]) < 1e-8


@pytest.mark.parametrize(("temperature", "speed"), [(40, 1600), (60, 1400), (90, 1000), (130, 1800)])
def test_a_lever_rests_on_its_cam_and_not_upside_down(temperature: int, speed: int) -> None:
    """Turned by 150 degrees about its pivot a finger would be at rest, too: the motion never leads there. The
    adjuster, which has leaked out, and the contacts leave it 1e-4 m over 40 mm."""
    given = (f"temperature={temperature} degC", f"components.flywheel.parameters.initial_speed={speed} rpm")
    system = build_system(load("roller-friction", given))
    x = dict(zip(system.state.names, equilibrium(system), strict=True))
    assert abs(x["finger.rotation"]) < 1e-4 / 40e-3


def test_a_film_that_nearly_fills_a_lash_comes_to_rest() -> None:
    """Film and finger together are hardly determined. In a second it changes by less than 1e-5 of itself: by
    1e-12 of what the cam draws in."""
    given = (
        "components.cam_contact.parameters.film_model=moes_venner", "temperature=110 degC",
        "components.finger.parameters.rolls=true", "components.finger.parameters.follower_radius=9 mm",
        "components.flywheel.parameters.initial_speed=2500 rpm",
    )  # fmt: skip
    system = build_system(load("finger-follower", given))
    x = equilibrium(system)
    film = system.state.names.index("cam_contact.film_thickness")
    assert abs(Evaluation(system).derivative(0.0, x)[film]) < 1e-5 * x[film]


def test_a_start_is_found_with_one_thread_of_the_linear_algebra(monkeypatch: pytest.MonkeyPatch) -> None:
    """And the caller's number of threads is his own again."""

    def count() -> set[int]:
        return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}

    seen = list[set[int]]()
    find = _Rest.find
    monkeypatch.setattr(_Rest, "find", lambda rest: seen.append(count()) or find(rest))
    with threadpool_limits(limits=2, user_api="blas"):
        equilibrium(build_system(load("quarter-car")))
        assert (seen, count()) == ([{1}], {2})
