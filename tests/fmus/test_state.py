"""A saved state restores an FMU to the last bit: at once, later, elsewhere, and after a reset."""

import pytest
from fmpy.fmi1 import FMICallException
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fmus.build import NAMES

from .instance import Instance
from .kinds import FAST, FILES, HOSTS, every_fmu
from .names import ALWAYS, LAYER
from .reference import Reference, held, wave

STEP = 1e-5


def drive(slave: Instance, name: str, t: float, steps: int, curved: bool = True, h: float = STEP) -> list:
    """Step with moving inputs; the outputs after every step."""
    component = COMPONENTS[name]
    results = []
    for _ in range(steps):
        values = wave(component, t)
        slave.set(values if curved else held(values))
        slave.step(t, h)
        t += h
        results.append(slave.outputs())
    return results


COMPONENTS = {name: Reference(name).component for name in (*NAMES, LAYER)}


PAIRS = [
    pytest.param(one.values, marks=one.marks)
    for one in every_fmu([*NAMES, LAYER], python=[*ALWAYS, LAYER], native=FAST, native3=FAST)
]


@pytest.fixture(scope="module", params=PAIRS)
def pair(request):
    """Two instances of every FMU, in Python first."""
    kind, name = request.param
    both = [HOSTS[kind](FILES[kind][name], number) for number in ("one", "two")]
    yield name, *both
    for slave in both:
        slave.free()


@pytest.fixture
def fresh(pair):
    """The two instances, initialised."""
    name, one, two = pair
    for slave in (one, two):
        slave.fmu.reset()
        slave.initialize()
    return name, one, two


def test_restore_in_another_instance(fresh):
    name, one, two = fresh
    drive(one, name, 0.0, 40)
    drive(two, name, 0.0, 7, curved=False)
    data = one.saved_bytes()
    two.restore_bytes(data)
    assert two.saved_bytes() == data
    assert drive(two, name, 40 * STEP, 30) == drive(one, name, 40 * STEP, 30)


def test_reset_is_exact(fresh):
    name, one, two = fresh
    begin = one.saved_bytes()
    drive(one, name, 0.0, 25)
    one.fmu.reset()
    one.initialize()
    assert one.saved_bytes() == begin
    assert drive(one, name, 0.0, 25) == drive(two, name, 0.0, 25)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    before=st.integers(0, 30),
    between=st.integers(1, 30),
    curved=st.booleans(),
    size=st.floats(1e-7, 3e-5),
    through_bytes=st.booleans(),
    pending_input=st.booleans(),
)
def test_rollback_at_any_moment(fresh, before, between, curved, size, through_bytes, pending_input):
    """Also when inputs were set but not yet used, and with other steps after the rollback than before."""
    name, slave, _ = fresh
    slave.fmu.reset()
    slave.initialize()
    drive(slave, name, 0.0, before, curved, size)
    t = sum([size] * before)
    if pending_input:
        slave.set(held(wave(COMPONENTS[name], t + 1e-4)))
    data, state = slave.saved_bytes(), slave.save()
    expected = slave.outputs()
    first = drive(slave, name, t, between, curved, size)
    if through_bytes:
        slave.restore_bytes(data)
    else:
        slave.restore(state)
    assert slave.outputs() == expected
    assert drive(slave, name, t, between, curved, size) == first
    slave.release(state)


@pytest.mark.parametrize("pair", PAIRS[: len(NAMES) + 1], indirect=True)
@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda data: b"rubbish", "was not written by this FMU"),
        (lambda data: data[:-8], "its length is wrong"),
        (lambda data: data.replace(data[19:35], b"0123456789abcdef"), "belongs to another FMU or version"),
    ],
)
def test_a_foreign_state_is_refused_by_an_fmu_in_python_and_changes_nothing(fresh, damage, message):
    name, slave, other = fresh
    drive(slave, name, 0.0, 5)
    drive(other, name, 0.0, 5)
    data = slave.saved_bytes()
    slave.messages.clear()
    with pytest.raises(FMICallException, match="fatal"):
        slave.restore_bytes(damage(data))
    assert any(message in text for _, _, text in slave.messages)
    assert slave.saved_bytes() == data
    assert drive(slave, name, 5 * STEP, 5) == drive(other, name, 5 * STEP, 5)
