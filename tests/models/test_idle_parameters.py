"""A parameter without an effect is declared so, and one that is declared so has none."""

from collections.abc import Collection
from contextlib import suppress

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.component import Component
from models.core.quantities import Layout, Vector
from orchestrator.scenario.values import find_idle, to_value

# Each draw of a pressure field takes seconds.
NAMES = [
    pytest.param(name, marks=[pytest.mark.long] * (name == "free_piston_crank"))  # as `piston_crank`
    for name in sorted(set(CATALOGUE) - {"ehl_line_contact"})
]
# What acts in assessments only, at limits that draws do not reach, or with an oil, which a dry contact lacks.
EXCUSED = {
    "elastic_limit", "wire_stress", "wire_amplitude", "wire_strength",
    "limiting_shear_stress", "limiting_shear_coefficient", "chatter_time", "creep_velocity",
    "sliding_threshold", "travel", "retainer_stiffness", "roelands_exponent", "roelands_pressure",
}  # fmt: skip
# So many draws, and more where a parameter is left that should act.
DRAWS, MOST = 10, 80


def evaluate(component: Component, t: float, x: Vector, u: Vector, p: Vector) -> Vector:
    """All that its equations say."""
    found = [np.zeros(component.state.size), np.zeros(component.outputs.size), np.zeros(3)]
    for kernel, values in zip(
        (component.flat_derivative, component.flat_output, component.flat_energy), found, strict=True
    ):
        with suppress(ValueError):  # a root of a negative number, NaN in compiled code
            kernel(t, x, u, p, values)
    for k in range(component.events.count if component.events else 0):
        after = x.copy()
        component.flat_transition(k, t, after, u, p)
        found.append(after)
    return np.concatenate(found)


def draw(layout: Layout, start: Vector, random: np.random.Generator, spread: float) -> Vector:
    """Values about the start, in their ranges."""
    quantities = [one.quantity for one in layout.fields]
    limits = np.array([one.limits() for one in quantities]).reshape(-1, 2)
    limits[:, 0] += [1e-3 * one.nominal * one.positive for one in quantities]
    drawn = start + spread * layout.nominal * random.uniform(-1.0, 1.0, layout.size)
    whole = [one.discrete for one in quantities]
    return np.clip(np.where(whole, start, drawn), limits[:, 0], limits[:, 1])


def find_inert(
    component: Component, about: Vector, declared: set[str], random: np.random.Generator
) -> set[str]:
    """The continuous parameters that change nothing at any of many states, inputs and times."""
    layout = component.parameters
    left = {one.name for one in layout.fields if not one.quantity.discrete}
    vary = np.isin(layout.names, list(left))
    for k in range(MOST):
        if k >= DRAWS and left <= declared | EXCUSED:
            break
        spread = (0.01, 0.3, 1.0, 3.0, 30.0)[k % 5]
        x = draw(component.state, component.state.start, random, spread)
        u = draw(component.inputs, component.inputs.start, random, spread)
        t, p = random.uniform(0.0, 3.0), about * np.where(vary, random.uniform(0.999, 1.001, about.size), 1.0)
        base = evaluate(component, t, x, u, p)
        others = [np.where(p, p * factor, 0.1 * abs(factor - 1.0) * layout.nominal) for factor in (1.02, 0.7)]
        for name in sorted(left):
            moved = (np.where(np.array(layout.names) == name, other, p) for other in others)
            changed = (evaluate(component, t, x, u, q) for q in moved)
            if not all(np.array_equal(values, base, equal_nan=True) for values in changed):
                left.discard(name)
    return left


def list_settings(layout: Layout) -> Collection[Vector]:
    """The defaults, and each option, or number that brings other parameters into play, by itself."""
    deciding = {name for one in layout.fields if one.quantity.only for name in one.quantity.only.parameters}
    found = [layout.start]
    for i, one in enumerate(layout.fields):
        values: Collection[float] = range(len(one.quantity.choices) or 2 * one.quantity.boolean)
        if not one.quantity.discrete and one.name in deciding:
            values = [min(one.quantity.nominal, 0.5 * one.quantity.maximum)]
        found += [np.where(np.arange(layout.size) == i, value, layout.start) for value in values]
    return {tuple(one): one for one in found}.values()


@pytest.mark.plain
@pytest.mark.parametrize("name", NAMES)
def test_parameters_that_act_nowhere_are_those_that_say_so(name):
    component, random = CATALOGUE[name](), np.random.default_rng(2)
    layout = component.parameters
    for p in list_settings(layout):
        chosen = {one.name: to_value(one.quantity, v) for one, v in zip(layout.fields, p, strict=True)}
        idle = find_idle(component, chosen, "parameters")
        declared = {one for one in idle if not layout.field(one).quantity.discrete}
        inert = find_inert(component, p, declared, random)
        said = [f"{one} = {chosen[one]}" for one in np.array(layout.names)[p != layout.start]]
        assert declared <= inert, said
        assert inert - EXCUSED <= declared, said
