"""A slider cannot begin outside its walls, nor slide where it is not."""

from __future__ import annotations

import math

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.evaluation import check_start
from models.core.system import Instance, ModelError, System
from models.monolithic import solve
from models.slider_crank import forms

from .test_slider_crank import CRANK, INPUTS, STATE, thesis_parameters

MID_STROKE = {"crank_angle": 0.5 * math.pi}


def faults(form: float, start: dict[str, float], inputs: dict[str, float] | None = None) -> list[str]:
    p = thesis_parameters(0.05, 0.015, form=form)
    return CRANK.start_faults(p, STATE.vector(start), INPUTS.vector(inputs))


@pytest.mark.parametrize("form", [forms.AS_PUBLISHED, forms.CORRECTED, forms.NONLINEAR])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_start_outside_the_walls_is_one_message(form: float, side: float) -> None:
    (message,) = faults(form, {"psi": side * 0.0157})
    assert message.startswith(f"psi = {side * 0.0157:g} rad")
    assert "must be from -0.015" in message
    assert " to 0.015" in message
    assert "at crank_angle = 0 rad; start between them" in message


@pytest.mark.parametrize("form", [forms.AS_PUBLISHED, forms.CORRECTED, forms.NONLINEAR])
def test_start_between_or_on_the_walls_is_allowed(form: float) -> None:
    """Up to a millionth of the travel outside, which is the rounding of what a user types."""
    for psi in (-0.0149, 0.0, 0.015):
        assert faults(form, {"psi": psi}) == []
    assert faults(form, {"psi": -0.0157}, MID_STROKE) == []
    assert faults(form, {"psi": 0.015 + 1e-6 * 0.03}) == []


def test_each_form_has_its_own_walls() -> None:
    """At mid-stroke the upper one is at 0.01574 (linear) and 0.01570 (exact)."""
    assert faults(forms.CORRECTED, {"psi": 0.01572}, MID_STROKE) == []
    assert "to 0.0157013789 rad" in faults(forms.NONLINEAR, {"psi": 0.01572}, MID_STROKE)[0]


def test_films_narrow_the_room_at_the_start() -> None:
    film = {"upper_wall_film": 0.005}
    assert "to 0.01 rad" in faults(forms.CORRECTED, {"psi": 0.012, **film})[0]
    films = {"upper_wall_film": 0.01, "lower_wall_film": 0.03}
    assert "there is no room between the walls" in faults(forms.CORRECTED, films)[0]


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_sliding_start_is_on_its_wall(side: float) -> None:
    assert faults(forms.CORRECTED, {"mode": side, "psi": side * 0.0149}) == []
    (message,) = faults(forms.CORRECTED, {"mode": side, "psi": -side * 0.015})
    assert message.startswith(f"mode = {side:g}")
    assert f"needs psi = {side * 0.015:g} rad" in message


def turned(psi: float) -> System:
    """The default engine on a flywheel that starts at mid-stroke."""
    wheel = Instance(CATALOGUE["flywheel"](), start={"angle": 0.5 * math.pi, "speed": 100.0})
    return System(
        {"wheel": wheel, "engine": Instance(CRANK, start={"psi": psi})},
        [("wheel.angle", "engine.crank_angle"), ("wheel.speed", "engine.crank_speed")],
    )


def test_a_system_judges_the_start_with_its_connected_inputs() -> None:
    check_start(turned(0.0157), 0.0, turned(0.0157).x0)
    for psi in (0.0158, -0.0158):
        with pytest.raises(ModelError, match=rf"^engine\.psi = {psi:g} rad .* at crank_angle = 1\.5708 rad"):
            check_start(turned(psi), 0.0, turned(psi).x0)


def test_the_reference_refuses_it_too() -> None:
    with pytest.raises(ModelError, match=r"^engine\.psi = 0\.02 rad"):
        solve(turned(0.02), np.linspace(0.0, 1e-3, 3))
