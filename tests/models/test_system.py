"""Systems and requirements: refusals name the fault and the remedy."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
from models.core.bonds import counting
from models.core.component import Component
from models.core.composite import compose, with_values
from models.core.evaluation import Evaluation, Interpreted
from models.core.quantities import Field, FieldLayout, Quantity
from models.core.requirements import Requirement
from models.core.system import Instance, ModelError, System
from models.core.transformed import Transformation, transform
from models.oscillators.two_masses import sprung_mass

from .systems import VALVE_TRAIN, valve_train


def parts():
    return dict(valve_train().instances)


def refused(connections, instances=None):
    with pytest.raises(ModelError) as caught:
        System(parts() if instances is None else instances, connections)
    return str(caught.value)


ANGLE = ("flywheel.angle", "camshaft.drive_angle")


@pytest.mark.parametrize(
    ("connections", "said"),
    [
        ([("flywhel.angle", ANGLE[1])], "no component 'flywhel'; did you mean flywheel?"),
        ([(ANGLE[0], "camshaft.drive_angel")], "did you mean drive_angle?"),
        ([("flywheel.load_torque[1]", ANGLE[1])], "has no output 'load_torque[1]'"),
        ([(ANGLE[0], "camshaft.drive_speed")], "unit rad does not fit rad/s"),
        ([ANGLE, ("camshaft.cam_angle", ANGLE[1])], "has two sources, flywheel.angle and camshaft.cam_angle"),
    ],
)
def test_connections_that_do_not_fit(connections, said):
    assert said in refused(connections)


def test_constant_and_source_of_one_input():
    instances = parts() | {"camshaft": Instance(CATALOGUE["camshaft"](), inputs={"drive_angle": 1.0})}
    assert "has a constant value and the source" in refused(VALVE_TRAIN, instances)


@pytest.mark.parametrize(
    ("kind", "values", "said"),
    [
        ("parameters", {"valve_mass": -1.0}, (".parameters.valve_mass = -1", "must be > 0")),
        ("parameters", {"spring_rate": math.nan}, ("spring_rate = nan", "must be finite and > 0")),
        ("parameters", {"valve_mas": 1.0}, ("no parameter 'valve_mas'", "did you mean valve_mass?")),
        ("start", {"positon": 1.0}, ("no state 'positon'", "did you mean position?")),
        ("inputs", {"laod": 1.0}, ("no input 'laod'", "did you mean load?")),
    ],
)
def test_values_out_of_range_and_unknown_names(kind, values, said):
    instances = {"valve_spring": Instance(CATALOGUE["valve_spring"](), **{kind: values})}
    message = refused([], instances)
    for words in said:
        assert words in message


def test_all_faults_are_told_at_once():
    assert "no components" in refused([], {})
    instances = {
        "a": Instance(CATALOGUE["valve_spring"](), {"valve_mass": 0.0}),
        "b": Instance(CATALOGUE["ehl_contact"](), {"length": -1.0, "film_model": 99.0}),
    }
    message = refused([], instances)
    assert "components.a.parameters.valve_mass" in message
    assert "components.b.parameters.length" in message
    assert "components.b.parameters.film_model" in message
    assert "kushwaha" in message


def test_other_values_of_the_same_components_are_checked_as_at_first():
    """The system that they come from keeps its own."""
    system = valve_train(1000)
    spring, before = system.instances["valve_spring"], system.p.copy()
    heavy = replace(spring, parameters={**spring.parameters, "valve_mass": 0.3})
    made = system.with_instances({**system.instances, "valve_spring": heavy})
    place = system.parameters.names.index("valve_spring.valve_mass")
    assert np.flatnonzero(made.p != system.p).tolist() == [place]
    assert (made.p[place], made.order) == (0.3, system.order)
    assert np.array_equal(system.p, before)
    for value in (0.0, -1.0, np.nan, np.inf):
        wrong = replace(spring, parameters={"valve_mass": value})
        with pytest.raises(ModelError, match=r"valve_spring\.parameters\.valve_mass"):
            system.with_instances({**system.instances, "valve_spring": wrong})
    driven = replace(system.instances["camshaft"], inputs={"drive_angle": 1.0})
    with pytest.raises(ModelError, match="has a constant value and the source"):
        system.with_instances({**system.instances, "camshaft": driven})


def test_outputs_do_not_depend_on_the_order_of_instances():
    system = valve_train(1000)
    turned = system.with_instances(dict(reversed(system.instances.items())))
    state = {name: i.component.state.start.copy() for name, i in system.instances.items()}
    state["flywheel"][0] = 2.4
    state["valve_spring"][0] = 5.9e-3
    found = []
    for one in (system, turned):
        x = np.concatenate([state[name] for name in one.instances])
        found.append(dict(zip(one.outputs.names, Interpreted(one).outputs(0.0, x).copy(), strict=True)))
    assert found[0] == found[1]


def placed(port, k):
    """A port of the k-th valve train of several on one flywheel."""
    if port.instance == "flywheel":
        return str(port).replace("[1]", f"[{k}]")
    return f"{port.instance}_{k}.{port.variable}"


@pytest.mark.long
def test_a_hundred_instances_are_one_function_with_the_same_bits():
    """Fifty valve trains on one shaft, against instance after instance; functions nested one in another
    reached the interpreter's limit near fifty instances."""
    one, count = valve_train(1000), 50
    own = [name for name in one.instances if name != "flywheel"]
    many = System(
        {
            "flywheel": replace(one.instances["flywheel"], component=CATALOGUE["flywheel"](loads=count)),
            **{f"{name}_{k}": one.instances[name] for k in range(1, count + 1) for name in own},
        },
        [(placed(c.source, k), placed(c.target, k)) for k in range(1, count + 1) for c in one.connections],
    )
    x = many.x0 * (1.0 + 1e-3 * np.random.default_rng(1).uniform(size=many.x0.size))
    composed, interpreted = Evaluation(many), Interpreted(many)
    assert np.array_equal(composed.derivative(0.01, x), interpreted.derivative(0.01, x))
    assert np.array_equal(composed.y, interpreted.y)


def broken(a: float, numbers: Any) -> bool:
    numbers[0], numbers[1] = a, 1.0 / 3.0
    return a < 0.0


def test_what_is_compiled_serves_the_next_system_of_the_same_components():
    """Each has its own values: what one computes does not depend on the other."""
    slow = valve_train(1000)
    faster = {n: i.parameters for n, i in valve_train(3000).instances.items()}
    fast = slow.with_instances({n: replace(i, parameters=faster[n]) for n, i in slow.instances.items()})
    first, second = Evaluation(slow), Evaluation(fast)
    assert second.flat_outputs is first.flat_outputs
    assert second.flat_derivative is first.flat_derivative
    for system, evaluation in ((slow, first), (fast, second), (slow, first)):
        expected = Interpreted(system).derivative(0.01, system.x0)
        np.testing.assert_array_equal(evaluation.derivative(0.01, system.x0), expected)


def test_numbers_stand_in_their_places() -> None:
    rule = Requirement(broken, "a = {0:g} m: must be {1:.3f} or {1:.9g}, not {0:g}")
    assert rule.fault(-1.0) is None
    assert rule.fault(2.5e-7) == "a = 2.5e-07 m: must be 0.333 or 0.333333333, not 2.5e-07"


def test_the_first_number_counts_the_word() -> None:
    rule = Requirement(broken, "a: not on the {word} wall", words=("lower", "upper"))
    assert rule.fault(0.0) == "a: not on the lower wall"
    assert rule.fault(1.0) == "a: not on the upper wall"


@pytest.mark.parametrize("text", ["{0}", "{8:g}", "{0:d}", "{name}", "50 %}"])
def test_braces_that_machine_code_cannot_fill_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="is no place"):
        Requirement(broken, f"a = {text}")


def test_messages_on_starts_begin_with_a_state() -> None:
    """So that FMUs can name the variable of its start."""
    for component in (make() for make in CATALOGUE.values()):
        states = {state.partition("[")[0] for state in component.state.names}
        assert all(rule.says.partition(" ")[0].rstrip(":") in states for rule in component.start_requirements)


def test_counting_energies_does_not_change_the_records_that_rules_see() -> None:
    """For a longer record numba would compile each rule again, and warn that it is taken for the shorter."""
    seen = []
    rule = Requirement(lambda x, u, p, numbers: seen.append(x.dtype) or True, "height = {0:g}")
    plain = replace(CATALOGUE["falling_mass"](), start_requirements=[rule])
    for component in (plain, counting(plain)):
        start = component.state.vector()
        assert component.start_faults(component.parameters.vector(), start, component.inputs.vector()) == []
    assert seen == [plain.state.dtype] * 2


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
