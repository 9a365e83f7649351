"""The solved film where it is hard: inputs that make no sense, opening and closing, rest, jumps, any step."""

import math
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.core.integrator import NOT_CONVERGED, OK

from .stepped import Contact

RADIUS = 0.02
RUNNING = {"approach": 0.3e-6, "entraining_velocity": 1.0, "radius_of_curvature": RADIUS}
LOADED = {"applied_load": 500.0, "entraining_velocity": 1.0, "radius_of_curvature": RADIUS}
# What the field gives; the others are its formula's.
SEEN = ("load", "film_thickness", "minimum_film_thickness", "maximum_pressure", "friction_force")


def whole(contact: Contact) -> None:
    """Finite outputs; pressure and load are not negative, films are positive."""
    assert all(math.isfinite(contact[name]) for name in SEEN), {name: contact[name] for name in SEEN}
    assert np.all(contact.field("pressure") >= 0.0)
    assert np.all(contact.field("film") > 0.0)
    assert contact["load"] >= 0.0
    assert 0.0 < contact["minimum_film_thickness"] <= contact["film_thickness"] * (1.0 + 1e-12)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("radius_of_curvature", 0.0),
        ("radius_of_curvature", math.inf),
        ("entraining_velocity", math.nan),
        ("approach", math.nan),
        ("applied_load", math.inf),
    ],
)
@pytest.mark.parametrize("steps_before", [0, 3])
def test_inputs_that_make_no_sense_end_the_step_and_leave_no_trace(name, value, steps_before):
    """The state stays, to the last bit, and what follows is what would have followed without."""
    given_load = name == "applied_load"
    sound = LOADED if given_load else RUNNING
    tried, spared = (Contact(load_is_given=float(given_load)) for _ in range(2))
    for contact in (tried, spared):
        for _ in range(steps_before):
            assert contact.step(1e-5, **sound) == OK
    before = tried.x.copy()
    assert tried.step(1e-5, **{**sound, name: value}) == NOT_CONVERGED
    assert np.array_equal(tried.x, before)
    for contact in (tried, spared):
        assert contact.step(1e-5, **sound) == OK
    assert np.array_equal(tried.x, spared.x)


def test_an_input_outside_its_range_is_named():
    """At the start of a step or at its end; not what is as it should be."""
    component = Contact().component
    U = component.input_polynomial()
    U[:2, component.inputs.index("radius_of_curvature")] = 0.01, -2e3
    assert component.input_faults(U, 1e-6) == []
    (fault,) = component.input_faults(U, 1e-5)
    assert fault == "radius_of_curvature = -0.01 m (reduced radius R of the contact): must be > 0"


@pytest.mark.parametrize("step", [1e-6, pytest.param(1e-3, marks=pytest.mark.long)])
def test_a_contact_opens_and_closes_ten_times(step):
    """By 50 um, in forty steps each time: without load the film is the gap between the bodies."""
    contact, period = Contact(), 40.0 * step
    inputs = {**RUNNING, "approach": lambda t: -24e-6 + 26e-6 * math.cos(2.0 * math.pi * t / period)}
    most = 0.0
    for _ in range(400 if step < 1e-3 else 80):
        assert contact.step(step, **inputs) == OK
        whole(contact)
        gap = -inputs["approach"](contact.t)
        if gap > 30e-6:
            # What load there is deflects the bodies by W times about 4e-9 m/N at most.
            assert contact["film_thickness"] == pytest.approx(gap, abs=5e-9 * contact["load"] + 1e-12)
            if -inputs["approach"](contact.t - step) < gap:
                # Opening takes away from Martin's load of rigid bodies.
                assert contact["load"] < 4.9 * 0.036 * RADIUS * 12e-3 / gap
        most = max(most, contact["load"])
    assert most > 500.0


@pytest.mark.parametrize("drive", [RUNNING, LOADED], ids=["approach", "load"])
def test_entrainment_stops_for_long_and_starts_again(drive):
    """At rest nothing is drawn in: the film only thins, and never vanishes; afterwards it recovers."""
    contact = Contact(load_is_given=float("applied_load" in drive))
    for _ in range(50):
        assert contact.step(2e-5, **drive) == OK
    running = contact["minimum_film_thickness"]
    least = [running]
    for _ in range(50):
        assert contact.step(1e-3, **{**drive, "entraining_velocity": 0.0}) == OK
        whole(contact)
        least.append(contact["minimum_film_thickness"])
    # The first steps move the film's own dimple about.
    assert np.all(np.diff(least[3:]) < 0.0)
    assert least[-1] < 0.2 * running
    for _ in range(50):
        assert contact.step(2e-5, **drive) == OK
    assert contact["minimum_film_thickness"] == pytest.approx(running, rel=0.05)


@pytest.mark.parametrize("drive", [RUNNING, LOADED], ids=["approach", "load"])
def test_macro_steps_of_any_length_give_one_motion(drive):
    """Lines over 1 ms are the same inputs in 1000, 100, 10 steps and one; entrainment reverses in the middle.

    A macro step is also the longest micro-step, so that errors are those of `field_tolerance` 1e-5, some
    hundred times.
    """
    found = {}
    inputs = {**drive, "entraining_velocity": lambda t: 1.0 - t / 0.5e-3}
    if "approach" in drive:
        inputs["approach"] = lambda t: 0.3e-6 + 1e-3 * t
    for steps in (1000, 100, 10, 1):
        contact = Contact(load_is_given=float("applied_load" in drive), field_tolerance=1e-5)
        for n in range(steps):
            contact.t = n * 1e-3 / steps
            assert contact.step(1e-3 / steps, **inputs) == OK
        found[steps] = [contact[name] for name in ("load", "film_thickness", "minimum_film_thickness")]
    for steps in (100, 10, 1):
        assert found[steps] == pytest.approx(found[1000], rel=1e-3)


@pytest.mark.parametrize("step", [1e-2, 1.0])
def test_a_start_far_from_balance_is_made_in_one_long_step(step):
    """A uniform film that is squeezed at rest: as in a hundred steps that grow as the film settles."""
    at_rest = {**RUNNING, "approach": 0.0, "entraining_velocity": 0.0}
    once, often = Contact(), Contact()
    assert once.step(step, **at_rest) == OK
    growth = (step / 1e-7) ** (1.0 / 99.0)
    lengths = growth ** np.arange(100.0)
    for length in lengths * step / lengths.sum():
        assert often.step(length, **at_rest) == OK
    for name in ("load", "film_thickness", "minimum_film_thickness"):
        # Errors of field_tolerance = 1e-4 in some tens of micro-steps; measured 1.1e-3.
        assert once[name] == pytest.approx(often[name], rel=5e-3)


def test_an_open_contact_at_rest_stays_open_whatever_its_gap():
    """Nothing flows but rounding."""
    random = np.random.default_rng(0)
    for _ in range(20):
        gap, radius = random.uniform(1.1e-6, 20e-6), random.uniform(5e-3, 50e-3)
        contact = Contact()
        inputs = {"approach": -gap, "entraining_velocity": 0.0, "radius_of_curvature": radius}
        for step in (1e-6, 1e-4):
            assert contact.step(step, **inputs) == OK
        assert contact["film_thickness"] == pytest.approx(gap, rel=1e-9)
        assert contact["load"] < 1e-6


JUMPS_OF_LOAD = [(500.0, 0.0), (3000.0, 1.0), (1.0, 3000.0)]


def jumped(form: float, before: float, after: float, length: float, **parameters: float) -> Contact:
    """A contact that ran under one load, or approach, for 2 ms and for the `length` (s) under another."""
    contact, name = Contact(load_is_given=form, **parameters), "applied_load" if form else "approach"
    running = {"entraining_velocity": 1.0, "radius_of_curvature": RADIUS}
    for _ in range(100):
        assert contact.step(2e-5, **{name: before}, **running) == OK
    assert contact.step(length, **{name: after}, **running) == OK
    whole(contact)
    return contact


@pytest.mark.parametrize(("before", "after"), JUMPS_OF_LOAD)
@pytest.mark.parametrize("length", [1e-6, 1e-4])
def test_jumps_of_a_given_load_are_made(before, after, length):
    """Whatever steps the error control takes: a hundredth of the tolerance gives the same film."""
    found = jumped(1.0, before, after, length)
    fine = jumped(1.0, before, after, length, field_tolerance=1e-6)
    # Some tens of micro-steps of field_tolerance = 1e-4 each; measured 0.3 % at most.
    assert found["film_thickness"] == pytest.approx(fine["film_thickness"], rel=1e-2)


def test_the_oil_under_a_falling_load_stays_where_it_is():
    """In no time no oil flows: under a load that falls at once the bodies part, but not in the middle,
    where pressure is left and the film is the old one."""
    loaded = jumped(1.0, 500.0, 500.0, 1e-9)
    relieved = jumped(1.0, 500.0, 250.0, 1e-9)
    pressed = relieved.field("pressure") > 0.1 * np.max(relieved.field("pressure"))
    assert 5 < np.count_nonzero(pressed) < np.count_nonzero(loaded.field("pressure") > 0.0)
    # Oil that expands by 1/K = 0.6/GPa times the 0.1 GPa or so of pressure that it loses.
    np.testing.assert_allclose(relieved.field("film")[pressed], loaded.field("film")[pressed], rtol=0.06)


def test_a_load_below_the_floor_is_shown_as_what_it_is():
    """The film is that of the floor; of load, pressure and friction there is the share that the load is."""
    shown = {}
    drive = {"entraining_velocity": 1.0, "sliding_velocity": 0.5, "radius_of_curvature": RADIUS}
    for load in (0.0, 10.0, 20.0):
        contact = Contact(load_is_given=1.0, film_load_floor=20.0)
        for _ in range(20):
            assert contact.step(2e-5, applied_load=load, **drive) == OK
        assert contact["load"] == pytest.approx(load, rel=1e-6)
        assert contact["separated"] == float(load == 0.0)
        shown[load] = [contact[name] for name in ("maximum_pressure", "friction_force", "film_thickness")]
    assert shown[0.0] == [0.0, 0.0, shown[20.0][2]]
    assert shown[10.0] == pytest.approx([0.5 * shown[20.0][0], 0.5 * shown[20.0][1], shown[20.0][2]])


@pytest.mark.parametrize(("opening", "length"), [(20e-6, 1e-6), (1e-6, 1e-7)])
def test_a_contact_torn_open_carries_no_load(opening, length):
    """Cavities have no oil that could be squeezed: what load there is comes from entrainment, less than
    Martin's load of rigid bodies."""
    contact = jumped(0.0, 0.3e-6, -opening, length)
    assert contact["load"] < 4.9 * 0.036 * RADIUS * 12e-3 / opening
    assert contact["film_thickness"] == pytest.approx(opening, abs=5e-9 * contact["load"] + 1e-12)


@pytest.mark.parametrize("form", [0.0, pytest.param(1.0, marks=pytest.mark.long)], ids=["approach", "load"])
def test_jumps_are_survived_or_refused_without_a_trace(form):
    """Of all inputs at once, as no mechanism makes them."""
    random, refused = np.random.default_rng(5), 0
    contact = Contact(load_is_given=form)
    for _ in range(40):
        before = contact.x.copy()
        status = contact.step(
            10.0 ** random.uniform(-6.0, -3.5),
            approach=random.uniform(-20e-6, 4e-6),
            applied_load=random.choice([0.0, random.uniform(1.0, 3000.0)]),
            entraining_velocity=random.choice([0.0, random.uniform(-5.0, 5.0)]),
            radius_of_curvature=RADIUS * random.uniform(0.7, 1.4),
        )
        if status != OK:
            assert status == NOT_CONVERGED
            assert np.array_equal(contact.x, before)
            refused += 1
        else:
            whole(contact)
    # Seen with other seeds: none of 450 with the load given, one in a hundred with the approach given, where
    # a radius that jumps up leaves the oil less room than it needs.
    assert refused <= (0 if form else 3)


INPUTS = "approach", "applied_load", "entraining_velocity", "radius_of_curvature", "sliding_velocity"


def walked(steps: list[tuple[float, ...]], form: float, nodes: int, **parameters: float) -> None:
    """A walk whose inputs go linearly from one value to the next: every step is whole, and made at once or,
    after it has been refused without a trace, in a hundred steps."""
    contact = Contact(nodes=nodes, load_is_given=form, **parameters)
    last: dict[str, float] = {}
    for exponent, *values in steps:
        length, here = 10.0**exponent, dict(zip(INPUTS, values, strict=True))
        last = last or here
        if form == 0.0:
            # Bodies approach with 0.3 m/s at most.
            way = here["approach"] - last["approach"]
            here["approach"] = last["approach"] + min(max(way, -0.3 * length), 0.3 * length)
        ends, before = [contact.t, contact.t + length], contact.x.copy()
        inputs = {name: partial(np.interp, xp=ends, fp=[last[name], here[name]]) for name in INPUTS}
        if contact.step(length, **inputs) != OK:
            assert np.array_equal(contact.x, before)
            for _ in range(100):
                assert contact.step(length / 100.0, **inputs) == OK
        whole(contact)
        last = here


# None below 1e-12 m/s but zero: 1e-50 m/s under an open contact is the pressure of rounding.
velocities = st.one_of(st.just(0.0), st.floats(-5.0, 5.0).map(lambda u: round(u, 12)))
walks = st.lists(
    st.tuples(
        st.floats(-6.0, -3.0),
        st.floats(-20e-6, 4e-6),
        st.one_of(st.just(0.0), st.floats(1.0, 3000.0)),
        velocities,
        st.floats(5e-3, 50e-3),
        velocities,
    ),
    min_size=1,
    max_size=8,
)


@pytest.mark.long
@pytest.mark.parametrize(("nodes", "examples"), [(51, 10), (101, 30), (301, 10), (701, 3)])
def test_random_walks_are_made_step_by_step(nodes, examples):
    @settings(max_examples=examples)
    @given(walks, st.sampled_from([0.0, 1.0]), st.floats(5e-3, 0.2), st.sampled_from([0.0, 5e6]))
    def walk(steps, form, viscosity, eyring_stress):
        walked(steps, form, nodes, viscosity=viscosity, eyring_stress=eyring_stress)

    walk()
