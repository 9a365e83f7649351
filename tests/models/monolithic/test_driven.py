"""A component under given inputs: both methods find the closed form, through corners and jumps."""

import math
import re

import numpy as np
import pytest

from models.contact.ehl_line_contact import ehl_line_contact
from models.core.component import Component
from models.core.evaluation import Evaluation
from models.core.system import ModelError
from models.monolithic.driven import Piece, solve_driven
from models.monolithic.equilibrium import _Rest, equilibrium, list_moving_cams
from models.oscillators.bouncing_mass import falling_mass
from models.oscillators.two_masses import sprung_mass

from ..independent_train import cam
from ..slider_cranks import CRANK, advance
from ..systems import valve_train

# Integrators are asked for 1e-12 a step; some hundred steps add up, and times 10.
CLOSE = 1e-9


def pieces(component: Component, name: str, corners: list[tuple[float, float, float]]) -> list[Piece]:
    """(start, value, slope) of the input `name`."""
    found = []
    for start, value, slope in corners:
        u, du = component.inputs.start.copy(), np.zeros(component.inputs.size)
        u[component.inputs.index(name)], du[component.inputs.index(name)] = value, slope
        found.append(Piece(start, u, du))
    return found


def test_free_fall_then_a_force_that_jumps_and_grows() -> None:
    """x'' = F/m - g, with F = 0, then 4 N, then 4 N + 20 N/s: polynomials, joined."""
    component = falling_mass()
    given = pieces(component, "force", [(0.0, 0.0, 0.0), (0.2, 4.0, 0.0), (0.4, 4.0, 20.0)])
    times = np.linspace(0.0, 0.7, 29)
    found = solve_driven(component, given, times)
    m, g, x0 = 1.0, 9.81, 0.1
    after = [np.clip(times - t, 0.0, None) for t in (0.2, 0.4)]
    exact = x0 - 0.5 * g * times**2 + 4.0 * after[0] ** 2 / (2.0 * m) + 20.0 * after[1] ** 3 / (6.0 * m)
    place = component.outputs.index("position")
    np.testing.assert_allclose(found.outputs[:, place], exact, atol=CLOSE, rtol=0.0)
    assert np.max(found.difference[:, place]) <= CLOSE


def test_an_oscillator_under_a_ramp() -> None:
    """m x'' + d x' + k x = r t: the steady lag behind r t / k, and the free motion that starts at rest."""
    component = sprung_mass()
    m, k, d, r = 1.0, 10.0, 0.5, 3.0
    times = np.linspace(0.0, 4.0, 41)
    found = solve_driven(component, pieces(component, "force", [(0.0, 0.0, r)]), times)
    decay, w = 0.5 * d / m, math.sqrt(k / m - 0.25 * (d / m) ** 2)
    a = r * d / k**2
    b = (a * decay - r / k) / w
    exact = (
        r * times / k
        - r * d / k**2
        + np.exp(-decay * times) * (a * np.cos(w * times) + b * np.sin(w * times))
    )
    place = component.outputs.index("position")
    np.testing.assert_allclose(found.outputs[:, place], exact, atol=CLOSE, rtol=0.0)


def test_impacts_are_those_of_the_components_own_steps() -> None:
    """A slider between its walls at a crank that stands; some hundred steps are good to 1e-10 each."""
    x = CRANK.state.vector({"psi_rate": 4.0})
    u, times = CRANK.inputs.vector({"crank_angle": 1.0}), np.linspace(0.0, 0.05, 26)
    found = solve_driven(CRANK, [Piece(0.0, u, np.zeros(u.size))], times, x0=x)
    p = CRANK.parameters.vector()
    for start, end, y in zip(times[:-1], times[1:], found.outputs[1:], strict=True):
        own = advance(CRANK, x, p, start, end - start, crank_angle=1.0)
        np.testing.assert_allclose(y, list(own.values()), rtol=1e-8, atol=1e-8)
    assert len(found.events) == own["impact_count"] >= 2


def test_outputs_at_a_jump_are_those_after_it() -> None:
    u, later = (CRANK.inputs.vector({"crank_angle": angle}) for angle in (1.0, 2.0))
    still = np.zeros(u.size)
    found = solve_driven(CRANK, [Piece(0.0, u, still), Piece(0.001, later, still)], np.array([0.0, 0.001]))
    place = CRANK.outputs.index("piston_position")
    assert found.outputs[0, place] != found.outputs[1, place]


def test_what_cannot_be_solved_is_refused() -> None:
    contact = ehl_line_contact(nodes=101)
    with pytest.raises(ModelError, match="no form as ordinary differential equations"):
        solve_driven(contact, pieces(contact, "approach", [(0.0, 0.0, 0.0)]), np.array([1e-3]))
    mass = falling_mass()
    with pytest.raises(ModelError, match="must ascend"):
        solve_driven(mass, pieces(mass, "force", [(0.1, 0.0, 0.0), (0.1, 1.0, 0.0)]), np.array([1.0]))
    with pytest.raises(ModelError, match="must not be behind"):
        solve_driven(mass, pieces(mass, "force", [(0.5, 0.0, 0.0)]), np.array([0.0, 1.0]))


@pytest.mark.parametrize("phase", [80.0, 120.0, 180.0, 200.0])
def test_a_cam_that_moves_its_follower_is_told_with_its_velocity(phase: float) -> None:
    """s' w; none on the base circle and at the nose, nor where it moves no faster than run-out."""
    system = valve_train(1000.0, camshaft={"phase": math.radians(phase)})
    lift, slope, _ = cam(math.radians(phase))
    lines = list_moving_cams(system, 0.0, equilibrium(system, 0.0))
    slow = valve_train(1.0, camshaft={"phase": math.radians(phase)})
    assert list_moving_cams(slow, 0.0, equilibrium(slow, 0.0)) == []
    if phase in (80.0, 180.0):
        assert lines == []
    else:
        numbers = re.search(r"lifts by (\S+) mm and moves the follower at (\S+) m/s", lines[0])
        assert numbers
        velocity = slope * 1000.0 * math.pi / 30.0
        assert [float(n) for n in numbers.groups()] == pytest.approx([1e3 * lift, velocity], rel=5e-3)


def test_a_train_rests_on_its_lifted_cam() -> None:
    """With bent and twisted shaft: the contact carries the preload and what the lift compresses."""
    system = valve_train(3000.0, camshaft={"phase": math.radians(150.0), "flexible": 1.0})
    evaluation = Evaluation(system)
    y = evaluation.outputs(0.0, equilibrium(system, 0.0))
    load, lift = (y[system.outputs.names.index(n)] for n in ("contact.load", "valve_spring.valve_lift"))
    assert 6e-3 < lift < 6.55e-3
    assert load == pytest.approx(330.0 + 35e3 * lift, rel=1e-9)


def test_where_no_equilibrium_is_found_the_cam_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_Rest, "is_close", lambda self, scaled: False)
    system = valve_train(3000.0, camshaft={"phase": math.radians(150.0)})
    with pytest.raises(
        ModelError, match=r"camshaft: .* its cam lifts by 6\.55 mm .* begin on the base circle"
    ):
        equilibrium(system, 0.0)
