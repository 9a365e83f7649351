"""A parameter without an effect is declared so, and one that is declared so has none."""

from contextlib import suppress

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.component import Component
from models.core.quantities import Vector
from orchestrator.scenario.values import find_idle, to_value

# Components with conditions; the draws below reach all other parameters of theirs, but for limits.
NAMES = ("camshaft", "ehl_contact", "finger", "flywheel", "journal_bearing", "tappet")
LIMITS = {"elastic_limit", "limiting_shear_stress", "limiting_shear_coefficient"}
# Of an oil, which a dry contact does not have.
OF_OIL = {"roelands_exponent", "roelands_pressure"}
# So many draws, and more where a parameter is left that should act.
DRAWS, MOST = 12, 80


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


def draw(layout, start: Vector, random: np.random.Generator, spread: float) -> Vector:
    """Values about the start, in their ranges."""
    quantities = [layout.field(name).quantity for name in layout.names]
    limits = np.array([one.limits() for one in quantities]).reshape(-1, 2)
    limits[:, 0] += [1e-3 * one.nominal * one.positive for one in quantities]
    drawn = start + spread * layout.nominal * random.uniform(-1.0, 1.0, layout.size)
    whole = [one.discrete for one in quantities]
    return np.clip(np.where(whole, start, drawn), limits[:, 0], limits[:, 1])


def find_inert(
    component: Component, about: Vector, declared: set[str], random: np.random.Generator
) -> set[str]:
    """The continuous parameters that change nothing at any of many states, inputs and times."""
    names = component.parameters.names
    left = {name for name in names if not component.parameters.field(name).quantity.discrete}
    vary = np.isin(names, list(left))
    for k in range(MOST):
        if k >= DRAWS and left <= declared | LIMITS | OF_OIL:
            break
        spread = (0.01, 0.3, 1.0, 3.0)[k % 4]
        x = draw(component.state, component.state.start, random, spread)
        u = draw(component.inputs, component.inputs.start, random, spread)
        t, p = (
            random.uniform(0.0, 3.0),
            about * vary * random.uniform(0.999, 1.001, about.size) + about * ~vary,
        )
        base = evaluate(component, t, x, u, p)
        for name in sorted(left):
            for factor in (1.02, 0.7):
                q, i = p.copy(), names.index(name)
                q[i] = p[i] * factor if p[i] else 0.1 * (factor - 1.0) * component.parameters.nominal[i]
                q[i] = abs(q[i]) if component.parameters.field(name).quantity.limits()[0] >= 0.0 else q[i]
                if not np.array_equal(evaluate(component, t, x, u, q), base, equal_nan=True):
                    left.discard(name)
                    break
    return left


@pytest.mark.plain
@pytest.mark.parametrize("name", NAMES)
def test_parameters_that_act_nowhere_are_those_that_say_so(name):
    """With its defaults, and with each option chosen by itself."""
    component, random = CATALOGUE[name](), np.random.default_rng(2)
    layout, start = component.parameters, component.parameters.start
    options = [(0, start[0])] + [
        (layout.names.index(one.name), value)
        for one in layout.fields
        for value in range(len(one.quantity.choices) or 2 * one.quantity.boolean)
        if one.quantity.choices or one.quantity.boolean
    ]
    for i, value in options:
        p = start.copy()
        p[i] = value
        chosen = {n: to_value(layout.field(n).quantity, v) for n, v in zip(layout.names, p, strict=True)}
        idle = set(find_idle(component, chosen, "parameters"))
        declared = {n for n in idle if not layout.field(n).quantity.discrete}
        inert = find_inert(component, p, declared, random)
        assert declared <= inert, (layout.names[i], value)
        assert inert - LIMITS - OF_OIL <= declared, (layout.names[i], value)
