"""The reference of systems with pressure fields: two implicit methods, their orders, what checks them."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.contact.ehl_contact import ehl_contact
from models.contact.ehl_line_contact import ehl_line_contact
from models.core.component import Component
from models.core.difference import difference
from models.core.quantities import Vector
from models.core.system import Instance, ModelError, System
from models.monolithic import check_ode, check_solvable, equilibrium, solve
from models.monolithic.implicit import ImplicitProblem
from models.monolithic.implicit_methods import Bdf3, Sdirk4, Trajectory, march_implicit, step_lengths
from tests.models import exact_oscillators as exact
from tests.models.systems import column, valve_train
from tests.models.test_benchmark_oscillators import STATES, oscillator

LOAD, LEAST = "contact.load", "contact.minimum_film_thickness"
# The first oscillations of the valve on its film, which is 0.4 um thick and as wide as that of the formula.
TIMES = np.linspace(0.0, 3e-4, 16)


def put_in(contact: Component) -> System:
    """The valve train with that contact."""
    system = valve_train()
    return system.with_instances({**system.instances, "contact": Instance(contact)})


def balance(contact: Component) -> System:
    """The valve train with that contact, at rest in balance."""
    system = put_in(contact)
    state = equilibrium(system)

    def at_rest(name: str, instance: Instance) -> Instance:
        layout = instance.component.state
        named = layout.named(state[system.state.of(name)])
        return replace(instance, start={key: named[key] for key in layout.variables})

    return system.with_instances({n: at_rest(n, i) for n, i in system.instances.items()})


@cache
def ringing() -> System:
    return balance(ehl_line_contact(101))


@cache
def course(method: type, longest: float) -> Trajectory:
    """Of the ringing valve."""
    problem = ImplicitProblem(ringing())
    return march_implicit(problem, method(problem), ringing().x0, 0.0, TIMES, longest)


def apart(first: Trajectory, second: Trajectory, name: str) -> float:
    system = ringing()
    return difference(*(column(system, c.outputs, name) for c in (first, second))).relative_rms


@pytest.mark.parametrize(("method", "order"), [(Sdirk4, 4), pytest.param(Bdf3, 3, marks=pytest.mark.long)])
def test_without_fields_the_methods_have_their_orders(method: type, order: int) -> None:
    """On the quarter car, of which the exact solution is known."""
    system, times = oscillator("quarter-car", {}, {}), np.linspace(0.0, 0.2, 3)
    truth, places = exact.quarter_car(times), [system.state.names.index(name) for name in STATES]
    problem = ImplicitProblem(system)
    errors = []
    for longest in (0.002, 0.001, 0.0005):
        found = march_implicit(problem, method(problem), system.x0, 0.0, times, longest)
        errors.append(np.max(np.abs(found.state[:, places] - truth)))
    for coarse, fine in pairwise(errors):
        assert np.log2(coarse / fine) == pytest.approx(order, abs=0.35)


def test_a_formula_film_gives_what_the_reference_of_odes_gives() -> None:
    """Of a valve that is pushed on its film; the methods' difference bounds the better one's error."""
    system = balance(ehl_contact())
    x0 = system.x0.copy()
    x0[system.state.names.index("valve_spring.velocity")] = 1e-3
    exactly = solve(system, TIMES, x0=x0)
    problem = ImplicitProblem(system)
    first, second = (
        march_implicit(problem, method(problem), x0, 0.0, TIMES, longest)
        for method, longest in ((Sdirk4, 4e-6), (Bdf3, 1e-6))
    )
    for name in ("contact.load", "contact.film_thickness"):
        one, other = column(system, first.outputs, name), column(system, second.outputs, name)
        apart = difference(other, one).max_abs
        assert difference(one, exactly[name]).max_abs < apart
        assert apart < 1e-3 * np.ptp(exactly[name])


def test_a_formula_is_solved_as_an_ode_and_a_field_is_not() -> None:
    check_ode(put_in(ehl_contact()))
    with pytest.raises(ModelError, match=r"contact: ehl_line_contact with nodes = 101 has no form as"):
        check_ode(put_in(ehl_line_contact(101)))


@pytest.mark.long
def test_both_methods_tend_to_one_course() -> None:
    """BDF3 with its order, as far as pressures that are right to 1e-6 let it be seen: the spread of load and
    film here is a fiftieth and a twentieth of their size."""
    best = course(Sdirk4, 2e-6)
    for name, least_order in ((LOAD, 2.5), (LEAST, 2.0)):
        coarse, fine = (apart(course(Bdf3, h), best, name) for h in (4e-6, 2e-6))
        assert least_order < np.log2(coarse / fine) < 3.5
        assert apart(course(Sdirk4, 8e-6), best, name) < 1e-3


@pytest.mark.long
def test_the_reference_publishes_the_difference_of_its_methods() -> None:
    found = solve(ringing(), TIMES, longest_step=8e-6)
    assert found.method_names == ("SDIRK4, steps of 8e-06 s", "BDF3, steps of 2e-06 s")
    assert found.uncertainty[LOAD].relative_rms == pytest.approx(
        apart(course(Bdf3, 2e-6), course(Sdirk4, 8e-6), LOAD), rel=1e-12
    )
    assert np.array_equal(found[LOAD], column(ringing(), course(Sdirk4, 8e-6).outputs, LOAD))


@pytest.mark.parametrize(
    ("make", "times", "longest", "tolerance"),
    [
        (lambda: oscillator("quarter-car", {}, {}), np.linspace(0.0, 0.2, 16), 5e-4, 1e-7),
        pytest.param(ringing, TIMES, 8e-6, 1e-3, marks=pytest.mark.long),
    ],
    ids=["quarter car", "valve on a solved film"],
)
def test_energies_close_per_component(
    make: Callable[[], System], times: Vector, longest: float, tolerance: float
) -> None:
    """To the method's error; the field's (see `energies`) to that of its nodes, measured 0.12 % of what the
    film loses with 51 (101: 0.03 %; smooth surfaces and 201: 0.004 %)."""
    system = make()
    problem = ImplicitProblem(system)
    found = march_implicit(problem, Sdirk4(problem), system.x0, 0.0, times, longest)
    energy = problem.energies.balances(found.stored, found.energies, found.state)
    received = sum(balance.received for balance in energy.values())
    largest = max(np.ptp(balance.received) for balance in energy.values())
    assert largest > 1e-6
    assert np.max(np.abs(received)) < 1e-12 * largest
    for name, balance in energy.items():
        size = 3.0 * np.ptp(balance.dissipated) if name == "contact" else largest
        assert np.max(np.abs(balance.residual)) < tolerance * size, name


def test_steps_reach_all_instants_and_grow_slowly() -> None:
    times = np.array([0.0, 1e-9, 2e-5, 2.1e-5, 7e-5])
    steps = list(step_lengths(0.0, times, 8e-6))
    reached = np.cumsum([h for h, _ in steps])[[i for i, (_, last) in enumerate(steps) if last]]
    np.testing.assert_allclose(reached, times[1:], rtol=1e-12)
    lengths = [h for h, _ in steps]
    assert max(lengths) <= 8e-6 * (1.0 + 1e-9)
    assert max(after / before for before, after in pairwise(lengths)) < 1.3 * (1.0 + 1e-9)


@pytest.mark.long
def test_a_step_that_cannot_be_solved_names_contact_time_and_remedy() -> None:
    system = put_in(ehl_line_contact(101))
    x0 = system.x0.copy()
    x0[system.state.names.index("valve_spring.velocity")] = -1e6
    with pytest.raises(ModelError, match=r"SDIRK4 failed at t = .*contact: .*longest_step = 8e-06 s"):
        solve(system, TIMES, x0=x0)


def test_a_step_of_no_length_is_refused() -> None:
    with pytest.raises(ModelError, match=r"longest_step = 0 s: must be > 0"):
        solve(put_in(ehl_line_contact(101)), TIMES, longest_step=0.0)


def test_events_beside_a_field_are_refused() -> None:
    system = put_in(ehl_line_contact(101))
    crank = Instance(CATALOGUE["slider_crank"]())
    connections = [(str(c.source), str(c.target)) for c in system.connections]
    with pytest.raises(ModelError, match=r"crank: slider_crank has events.*contact \(nodes = 101\)"):
        check_solvable(System({**system.instances, "crank": crank}, connections))
