"""Masters on a linear two-mass problem: order of convergence, stability, iteration, errors."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from orchestrator.engine.signals import History, extrapolate, interpolate
from orchestrator.errors import NonConvergenceError, UnstableCouplingError
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.masters.acceleration import ACCELERATIONS
from orchestrator.masters.newton import Correction
from orchestrator.stepping.controlled import PI

from .coupled import Recorder, Wrapper, build_participants, run_coupled
from .two_masses import exact, two_masses

STOP = 2.0


def error(master, step, stop=STOP, **parameters):
    recorder = run_coupled(two_masses(**parameters), master, step, stop)
    truth = exact(recorder.times, **parameters)
    return max(
        np.abs(recorder["first.position"] - truth[:, 0]).max(),
        np.abs(recorder["second.position"] - truth[:, 1]).max(),
    )


# A signal of degree k has a local error of order k + 1, start-up included (the start is probed). The quarter
# car has every master and signal.
@pytest.mark.parametrize(
    ("master", "order", "ceiling"),
    [(Jacobi("linear"), 2, 6e-5), (GaussSeidel("quadratic"), 3, 4e-7), (Iterated("hold"), 1, 6e-3)],
    ids=lambda value: f"{type(value).__name__}-{value.extrapolation}" if hasattr(value, "step") else None,
)
def test_order_of_convergence_on_the_finest_pair(master, order, ceiling, record):
    coarse, fine = error(master, 2e-3), error(master, 1e-3)
    case, slope = (
        f"two masses, {type(master).__name__}, {master.extrapolation} inputs",
        np.log2(coarse / fine),
    )
    record("Coupling", f"{case}: order", slope, order, "order of the signals", tolerance=0.1)
    record("Coupling", f"{case}: error at 1 ms (m)", fine, 0.0, "matrix exponential", tolerance=ceiling)


STIFF = {"coupling_stiffness": 4e4, "coupling_damping": 1.0}


@pytest.mark.parametrize("step", [4e-3, 2e-2])
def test_explicit_coupling_of_a_stiff_split_is_named_unstable(step):
    """The difference mode has 283 rad/s and hardly any damping: an explicit exchange is unstable."""
    with pytest.raises(UnstableCouplingError, match="macro_step"):
        run_coupled(two_masses(**STIFF), GaussSeidel("linear"), step, 20.0)


@pytest.mark.parametrize("acceleration", ["aitken", "anderson"])
def test_the_iterated_master_converges_where_the_explicit_one_is_unstable(acceleration):
    recorder = run_coupled(two_masses(**STIFF), Iterated("linear", acceleration=acceleration), 8e-3, STOP)
    assert recorder.statistics.iterations > recorder.statistics.macro_steps
    # At 2.8 steps per swing the difference mode is hardly resolved; it must stay bounded by the start.
    assert np.abs(recorder["second.position"]).max() <= 1.0


def test_the_iterated_master_converges_at_second_order_on_the_stiff_split():
    coarse, fine = error(Iterated(), 5e-4, 0.5, **STIFF), error(Iterated(), 2.5e-4, 0.5, **STIFF)
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.1)
    assert fine < 2e-2


def test_a_fixed_point_that_does_not_contract_is_an_error_with_connection_iterations_and_contraction():
    master = Iterated("linear", acceleration="none", maximum_iterations=12)
    with pytest.raises(NonConvergenceError, match=r"first\.force -> second\.force.*12 iterations"):
        run_coupled(two_masses(**STIFF), master, 5e-2, STOP)


def test_participants_may_be_listed_in_any_order_for_jacobi():
    """Symmetry: Jacobi's result does not depend on the order."""
    system = two_masses()
    reverse = system.with_instances(dict(reversed(system.instances.items())))
    one, two = (run_coupled(s, Jacobi("linear"), 1e-2, STOP) for s in (system, reverse))
    np.testing.assert_array_equal(one["first.force"], two["first.force"])


def test_the_last_step_ends_exactly_at_the_stop_time():
    recorder = run_coupled(two_masses(), Jacobi(), 0.3, 1.0)
    assert recorder.times[-1] == 1.0
    assert recorder.statistics.macro_steps == 4


def test_steps_that_nobody_records_read_no_outputs():
    """An observer's `outputs()` reads every participant once a step; a step without it reads none."""

    class Sparse(Recorder):
        def observe(self, time, outputs, step):
            if round(time / 1e-2) % 10 == 0:
                super().observe(time, outputs, step)

    class Counting(Wrapper):
        reads = 0

        def read_all(self, values):
            self.reads += 1
            self._inner.read_all(values)

    system = two_masses()
    units = {name: Counting(unit) for name, unit in build_participants(system).items()}
    sparse = run_coupled(system, Jacobi(), 1e-2, 1.0, Sparse(), recorder=Sparse(), **units)
    assert [unit.reads for unit in units.values()] == [11, 11]
    dense = run_coupled(system, Jacobi(), 1e-2, 1.0)
    np.testing.assert_array_equal(sparse["second.position"], dense["second.position"][::10])


def test_an_interrupt_reaches_the_observers():
    class Interrupting(Recorder):
        def observe(self, time, outputs, step):
            super().observe(time, outputs, step)
            if len(self._times) == 10:
                raise KeyboardInterrupt

    recorder = Interrupting()
    with pytest.raises(KeyboardInterrupt):
        run_coupled(two_masses(), Jacobi(), 1e-2, 1.0, recorder=recorder)
    assert recorder.ended == (False, "interrupted")


@settings(max_examples=50, deadline=None)
@given(
    st.lists(st.floats(-10, 10), min_size=3, max_size=3),
    st.lists(st.floats(0.1, 2.0), min_size=3, max_size=3),
    st.integers(0, 2),
)
def test_signals_reproduce_polynomials_of_their_degree(coefficients, gaps, degree):
    """Exactness: through points of a polynomial of degree k, a signal of degree k is that polynomial."""
    polynomial = np.polynomial.Polynomial(coefficients[: degree + 1])
    times = np.cumsum(gaps)
    none = np.zeros(1)
    history = History(times[0], np.array([polynomial(times[0])]))
    for time in times[1:]:
        history.append(time, np.array([polynomial(time)]), none)
    wanted = np.array([polynomial(times[-1]), polynomial.deriv(1)(times[-1]), polynomial.deriv(2)(times[-1])])
    got = np.zeros((3, 1))
    extrapolate(history, degree, got)
    # Rounding of divided differences: two divisions by gaps of 0.1 and more of values up to 10 * 6^2.
    np.testing.assert_allclose(got[:, 0], wanted, atol=1e-9)
    end = times[-1] + 0.7
    interpolate(history, degree, end, np.array([polynomial(end)]), none, got)
    if degree > 0:
        np.testing.assert_allclose(got[:, 0], wanted, atol=1e-9)


@pytest.mark.parametrize("name", ["aitken", "anderson", "quasi_newton"])
def test_acceleration_solves_a_linear_fixed_point_that_plain_iteration_cannot(name, record):
    """v = a v + b with a = -1.8: the plain iteration diverges, one accelerated step after two is exact."""
    acceleration = ACCELERATIONS[name]({}, 1.0)
    guess = np.array([0.0])
    for _ in range(4):
        guess = acceleration.next(guess, -1.8 * guess + 1.0)
    quantity = f"fixed point of v = 1 - 1.8 v by {name}"
    record("Coupling", quantity, guess, 1.0 / 2.8, "closed form", relative=1e-12)


def test_newtons_correction_solves_a_linear_interface_at_once():
    """v = J v + b."""
    random = np.random.default_rng(2)
    J, b, guess = random.normal(size=(4, 4)), random.normal(size=4), random.normal(size=4)
    found = Correction(J).next(guess, J @ guess + b)
    np.testing.assert_allclose(found, J @ found + b, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("error", "grows"), [(0.1, True), (0.9, False)])
def test_a_step_follows_its_error_to_what_is_aimed_at(error, grows):
    """Equal steps of equal errors: longer where the error is below 0.4 of what is allowed, else shorter."""
    control = PI(previous=error)
    assert (control.after(error, 3.0, 1e-3) > 1.0) == grows
