"""Inputs that are linear functions of their sources: what is said of them holds at the source."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.core.component import Component
from models.core.composite import compose, with_values
from models.core.quantities import Field, FieldLayout, Quantity
from models.core.system import Instance
from models.core.transformed import Transformation, transform
from models.oscillators.two_masses import sprung_mass

LENGTH = Quantity("m", "length", nominal=1e-2, minimum=-0.02, maximum=0.05, display_unit="mm")


def at_source(quantity: Quantity, start: float, one: Transformation) -> Field:
    """The only input of a component, behind this transformation."""
    component = Component(
        name="one",
        description="",
        parameters=FieldLayout([]),
        state=FieldLayout([]),
        inputs=FieldLayout([Field("u", quantity, start)]),
        outputs=FieldLayout([]),
        derivative=None,
        output=None,
        energy=None,
        feedthrough={},
    )
    inputs = transform(Instance(component), {"u": one}).component.inputs
    field = inputs.field("u")
    assert (inputs.start[0], inputs.nominal[0]) == (field.start, field.quantity.nominal)
    return field


@pytest.mark.parametrize(
    ("factor", "offset", "start", "low", "high"),
    [
        (1e-3, 0.0, 20.0, -20.0, 50.0),
        (-2.0, 0.0, -0.01, -0.025, 0.01),
        (0.5, 0.01, 0.02, -0.06, 0.08),
        (0.0, 0.01, 0.0, -math.inf, math.inf),
    ],
)
def test_start_and_range_are_those_of_the_source(factor, offset, start, low, high):
    """(value - offset) / factor of each; a factor of zero leaves the source free. To rounding."""
    field = at_source(LENGTH, 0.02, Transformation(factor, offset, "m"))
    found = field.quantity
    assert [field.start, found.minimum, found.maximum] == pytest.approx([start, low, high], rel=1e-14)
    assert found.nominal == pytest.approx(1e-2 / abs(factor) if factor else 1.0)


def test_a_display_unit_is_of_the_unit():
    assert at_source(LENGTH, 0.0, Transformation(2.0, 0.0, "m")).quantity.display_unit == "mm"
    assert at_source(LENGTH, 0.0, Transformation(2.0, 0.0, "rad/s")).quantity.display_unit == ""


@pytest.mark.parametrize(
    ("factor", "offset", "limits", "positive"),
    [
        (2.0, 0.0, (-math.inf, math.inf), True),
        (-2.0, 0.0, (-math.inf, 0.0), False),
        (-2.0, 4.0, (-math.inf, 2.0), False),
        (2.0, 4.0, (-2.0, math.inf), False),
    ],
)
def test_positive_is_a_side_of_the_source(factor, offset, limits, positive):
    found = at_source(Quantity("m", "film", positive=True), 1.0, Transformation(factor, offset, "m")).quantity
    assert (found.limits(), found.positive) == (limits, positive)


def test_a_discrete_input_takes_what_its_source_has():
    """Not is a truth value; what else is made of whole numbers need not be whole."""
    switch, count = Quantity("1", "switch", boolean=True), Quantity("1", "count", count=True, maximum=3.0)
    negated = at_source(switch, 1.0, Transformation(-1.0, 1.0, "1"))
    assert (negated.quantity.boolean, negated.start) == (True, 0.0)
    halved = at_source(count, 1.0, Transformation(2.0, 0.0, "1"))
    assert (halved.start, halved.quantity.limits(), halved.quantity.discrete) == (
        0.5,
        (-math.inf, 1.5),
        False,
    )
    assert halved.quantity.jumps


@given(
    size=st.floats(1e-6, 1e6),
    sign=st.sampled_from([1.0, -1.0]),
    offset=st.floats(-1e3, 1e3),
    start=st.floats(-0.02, 0.05),
)
def test_the_start_at_the_source_is_the_start_at_the_part(size, sign, offset, start):
    """Factor and offset give it back, and it stays in range.

    The difference, the quotient, the product and the sum round by half a unit in the last place each, of
    numbers up to |start| + |offset|, or loses what is below the least normal number.
    """
    one = Transformation(sign * size, offset, "m")
    field = at_source(LENGTH, start, one)
    given = one.factor * field.start + one.offset
    double = np.finfo(float)
    rounding = 2 * double.eps * (abs(start) + abs(offset)) + double.tiny
    assert given == pytest.approx(start, rel=0.0, abs=float(rounding))
    assert field.quantity.fault("u", field.start) is None


@pytest.mark.plain
def test_an_open_input_begins_with_what_its_part_begins_with():
    """A force of 8 N behind -4 * source + 2 is a source of -1.5: the mass of 2 kg at rest moves off by 4."""
    force = Instance(sprung_mass(), {"mass": 2.0})
    force = replace(force, component=with_values(replace(force, inputs={"force": 8.0})))
    part = transform(force, {"force": Transformation(-4.0, 2.0, "m")})
    train = compose("train", "", {"mass": part}, [("outside.position", "mass.force")])
    rates = np.zeros(train.state.size)
    train.flat_derivative(0.0, train.state.start, train.inputs.start, train.parameters.start, rates)
    assert train.inputs.named(train.inputs.start) == {"outside.position": -1.5}
    assert train.state.named(rates) == {"mass.position": 0.0, "mass.velocity": 4.0}
