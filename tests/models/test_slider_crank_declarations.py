"""Ranges, start values and feedthrough that slider-crank and tilting pistons declare."""

import math

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.component import Component
from models.core.evaluation import check_start
from models.core.quantities import Vector
from models.core.system import Instance, ModelError, System
from models.monolithic import solve
from models.slider_crank import forms

from .slider_cranks import CRANK, DRIVEN, FILMS, FORMS, FREE, INPUTS, STATE, thesis_parameters

MID_STROKE = {"crank_angle": 0.5 * math.pi}


@pytest.mark.parametrize(
    ("component", "values", "name", "rule"),
    [
        (CRANK, {"restitution": 1.1}, "restitution", "<= 1"),
        (CRANK, {"form": 3.0}, "form", "as_published"),
        (CRANK, {"form": 2.0, "clearance": 0.1}, "clearance", "rod_length - crank_radius = 0.0966"),
        (CRANK, {"crank_radius": 0.2}, "crank_radius", "rod_length"),
        (CRANK, {"clearance": 0.02}, "clearance", "0.1 rad"),
        (DRIVEN, {"crank_radius": 0.15}, "crank_radius", "rod_length"),
        (DRIVEN, {"half_length": 1e-3}, "half_length", "0 makes it a roller"),
    ],
)
def test_parameters_out_of_range_are_named(component, values, name, rule):
    (fault,) = component.parameter_faults(component.parameters.vector(values))
    assert name in fault
    assert rule in fault


@pytest.mark.parametrize("component", [CRANK, DRIVEN, FREE])
def test_defaults_are_allowed(component):
    p, x, u = component.parameters.vector(), component.state.vector(), component.inputs.vector()
    assert component.parameter_faults(p) == component.start_faults(p, x, u) == []


@pytest.mark.parametrize(
    ("start", "key"),
    [
        ({"offset": 50e-6}, "upper front corner starts 1e-05 m outside"),
        ({"tilt": -2e-3}, "upper rear corner"),
        ({"closed[1]": 1.0, "closed[3]": 1.0}, "upper front and lower front"),
        ({"closed[1]": 0.5}, "closed"),
    ],
)
def test_piston_cannot_start_outside_its_walls(start, key):
    (fault,) = DRIVEN.start_faults(
        DRIVEN.parameters.vector(), DRIVEN.state.vector(start), DRIVEN.inputs.vector()
    )
    assert key in fault


def slider_faults(form: float, start: dict[str, float], inputs: dict[str, float] | None = None) -> list[str]:
    p = thesis_parameters(0.05, 0.015, form=form)
    return CRANK.start_faults(p, STATE.vector(start), INPUTS.vector(inputs))


@pytest.mark.parametrize("form", FORMS)
def test_slider_starts_between_or_on_its_walls(form):
    """Up to a millionth of the travel outside, which is the rounding of what a user types."""
    for psi in (-0.0149, 0.0, 0.015, 0.015 + 1e-6 * 0.03):
        assert slider_faults(form, {"psi": psi}) == []
    assert slider_faults(form, {"psi": -0.0157}, MID_STROKE) == []
    for psi in (-0.0157, 0.0157):
        (fault,) = slider_faults(form, {"psi": psi})
        assert fault.startswith(f"psi = {psi:g} rad")
        assert "from -0.015" in fault
        assert "to 0.015" in fault
        assert "crank_angle = 0 rad" in fault


@pytest.mark.parametrize(
    ("form", "start", "inputs", "key"),
    [
        # At mid-stroke the upper wall is at 0.01574 rad (linear) and 0.01570 rad (exact).
        (forms.CORRECTED, {"psi": 0.01572}, MID_STROKE, None),
        (forms.NONLINEAR, {"psi": 0.01572}, MID_STROKE, "to 0.0157013789 rad"),
        (forms.CORRECTED, {"psi": 0.012, "upper_wall_film": 0.005}, None, "to 0.01 rad"),
        (forms.CORRECTED, {"upper_wall_film": 0.01, "lower_wall_film": 0.03}, None, "clearance of 0.015"),
        (forms.CORRECTED, {"mode": -1.0, "psi": -0.0149}, None, None),
        (forms.CORRECTED, {"mode": 1.0, "psi": 0.0149}, None, None),
        (forms.CORRECTED, {"mode": -1.0, "psi": 0.015}, None, "psi = -0.015 rad"),
        (forms.CORRECTED, {"mode": 1.0, "psi": -0.015}, None, "psi = 0.015 rad"),
    ],
)
def test_walls_of_the_start_are_those_of_form_films_and_mode(form, start, inputs, key):
    faults = slider_faults(form, start, inputs)
    assert len(faults) == (key is not None)
    assert key is None or key in faults[0]


def engine(psi: float) -> System:
    """The default engine on a flywheel that starts at mid-stroke."""
    wheel = Instance(CATALOGUE["flywheel"](), start={"angle": 0.5 * math.pi, "speed": 100.0})
    return System(
        {"wheel": wheel, "engine": Instance(CRANK, start={"psi": psi})},
        [("wheel.angle", "engine.crank_angle"), ("wheel.speed", "engine.crank_speed")],
    )


def test_system_checks_the_start_with_connected_inputs():
    check_start(engine(0.0157), 0.0, engine(0.0157).x0)
    for psi in (0.0158, -0.0158):
        with pytest.raises(ModelError, match=rf"^engine\.psi = {psi:g} rad .*crank_angle = 1\.5708"):
            check_start(engine(psi), 0.0, engine(psi).x0)
    with pytest.raises(ModelError, match=r"^engine\.psi"):
        solve(engine(0.02), np.linspace(0.0, 1e-3, 3))


def random_slider_state(random: np.random.Generator) -> Vector:
    mode, psi, rate = random.integers(-1, 2), random.uniform(-0.01, 0.01), random.uniform(-5.0, 5.0)
    x = STATE.vector({"psi": psi, "psi_rate": rate, "mode": float(mode)})
    x[FILMS] = random.uniform(0.0, 1e-6, 4)
    return x


def random_piston_state(component: Component, random: np.random.Generator) -> Vector:
    modes = ((), (0,), (3,), (0, 1), (2, 3), (0, 3), (1, 2))
    x = component.state.vector({f"closed[{i + 1}]": 1.0 for i in modes[random.integers(len(modes))]})
    x[:4] = random.uniform(-1.0, 1.0, 4) * np.array([1e-5, 0.3, 2e-4, 5.0])
    return x


@pytest.mark.parametrize(
    ("component", "values"),
    [
        *((CRANK, {"form": form}) for form in FORMS),
        *(
            pytest.param(piston, {"pin_offset": 1e-3, "mass_offset": -0.5e-3}, marks=pytest.mark.long)
            for piston in (DRIVEN, FREE)
        ),
    ],
)
def test_outputs_depend_on_no_other_inputs_than_declared(component, values):
    """Changing an input changes only the outputs that list it, and all that list it in some mode."""
    random = np.random.default_rng(5)
    p, seen = component.parameters.vector(values), set()
    outputs, inputs = component.outputs, component.inputs
    for _ in range(60):
        x = random_slider_state(random) if component is CRANK else random_piston_state(component, random)
        u = random.uniform(0.5, 2.0, inputs.size) * inputs.nominal
        y, changed = np.zeros(outputs.size), np.zeros(outputs.size)
        component.flat_output(0.0, x, u, p, y)
        for j, name in enumerate(inputs.names):
            other = u.copy()
            other[j] *= 1.01
            component.flat_output(0.0, x, other, p, changed)
            seen |= {(outputs.names[i], name) for i in np.nonzero(y != changed)[0]}
    assert seen == {(out, name) for out, names in component.feedthrough.items() for name in names}
