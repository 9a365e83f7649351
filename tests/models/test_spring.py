"""Springs: the coil masses' frequencies, static rate and limit of the continuous spring, coils that close."""

import math

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.system import Instance, System
from models.monolithic.cycle import find_cycle
from models.valve_train.valve_spring import lumping

from .systems import outputs_of, rates_of, state_matrix, turn, wheel

K0, F0 = 35e3, 504.5


def clamped_frequencies(masses):
    """Hz, of the component's own derivative: undamped with a follower too heavy to move."""
    spring = CATALOGUE["valve_spring"](coil_masses=masses)
    a = state_matrix(spring, {"valve_mass": 1e12, "damping_ratio": 0.0, "preload": 0.0})
    rates = np.linalg.eigvals(a[2:, 2:])
    return np.sort(rates.imag[rates.imag > 0.0]) / (2 * math.pi)


def test_clamped_frequencies_of_kushwahas_spring_are_f0_and_twice_f0(record):
    found = clamped_frequencies(2)
    for order, frequency in enumerate(found, 1):
        name = f"frequency {order} of the clamped spring (Hz), two masses"
        record("Spring", name, frequency, order * F0, "Kushwaha et al. (2000)", relative=1e-6)


@pytest.mark.parametrize("masses", [1, 3, 5, 8, 20])
def test_clamped_frequencies_of_more_masses(masses, record):
    """The chain's modes: f0 sin(j pi/2N) / sin(pi/2N), which tends to j f0."""
    orders = np.arange(1, masses + 1) * math.pi / (2 * masses)
    exact = 504.5 * np.sin(orders) / math.sin(orders[0])
    found = clamped_frequencies(masses)
    record("Spring", "frequencies (Hz), 1-20 masses", found, exact, "closed form of a chain", relative=1e-9)


@pytest.mark.parametrize("masses", [1, 2, 20])
def test_static_rate_is_k0(masses, record):
    spring = CATALOGUE["valve_spring"](coil_masses=masses)
    share = lumping(masses)
    coils = 1e-3 * (1.0 - 1.0 / share.end_rate - np.arange(masses) / share.inner_rate)
    state = {"position": 1e-3} | {f"coil_position[{i + 1}]": y for i, y in enumerate(coils)}
    rates = rates_of(spring, {"preload": 0.0}, state)
    # Rounding of a balance of forces of 100 N on a mass of grams.
    assert max(abs(rates[f"coil_velocity[{i + 1}]"]) for i in range(masses)) < 1e-6
    rate = outputs_of(spring, {"preload": 0.0}, state)["spring_force"] / 1e-3
    record("Spring", "static rate, 1 to 20 masses", rate, K0, "parameter k0", relative=1e-12)


def moving_end_stiffness(masses: int, frequency: float) -> float:
    """Force over displacement at the follower for a harmonic motion, undamped."""
    share = lumping(masses)
    rates = np.full(masses + 1, share.inner_rate * K0)
    rates[[0, -1]] = share.end_rate * K0
    mass = share.mass * K0 / (math.pi * F0) ** 2
    matrix = np.diag(rates[:-1] + rates[1:]) - np.diag(rates[1:-1], 1) - np.diag(rates[1:-1], -1)
    matrix -= mass * (2 * math.pi * frequency) ** 2 * np.eye(masses)
    drive = np.zeros(masses)
    drive[0] = rates[0]
    return rates[0] * (1.0 - np.linalg.solve(matrix, drive)[0])


@pytest.mark.parametrize("frequency", [50.0, 200.0, 350.0, 700.0])
def test_many_masses_converge_to_the_continuous_spring(frequency, record):
    """k lambda cot(lambda) with lambda = pi f / f0."""
    turned = math.pi * frequency / F0
    exact = K0 * turned / math.tan(turned)
    coarse, fine = (abs(moving_end_stiffness(n, frequency) - exact) / K0 for n in (20, 40))
    # Second order in 1/N; the ceiling is that of 40 masses at the highest frequency.
    source, order = "k λ cot λ of the continuous spring", math.log2(coarse / fine)
    record("Spring", "order of convergence from 20 to 40 masses", order, 2.0, source, tolerance=0.1)
    record("Spring", "error of the end's stiffness / k0, 40 masses", fine, 0.0, source, tolerance=4e-3)


def test_no_coil_masses_are_refused():
    with pytest.raises(ValueError, match="coil_masses = 0"):
        lumping(0)


def test_coils_clash_at_the_end_of_their_travel():
    """All segments close together: the rate rises where the clearance is used up, not before."""
    spring = CATALOGUE["valve_spring"]()
    share = lumping(2)

    def force(position: float) -> float:
        coils = position * (1.0 - 1.0 / share.end_rate - np.arange(2) / share.inner_rate)
        state = {"position": position, "coil_position[1]": coils[0], "coil_position[2]": coils[1]}
        return outputs_of(spring, {"clash_clearance": 9e-3, "clash_stiffness": 1e7}, state)["spring_force"]

    assert force(8.999e-3) == pytest.approx(330.0 + K0 * 8.999e-3, rel=1e-12)
    # The end segment's excess compression is its share of the travel's excess.
    excess = 1e-4 / share.end_rate
    assert force(9.1e-3) == pytest.approx(330.0 + K0 * 9.1e-3 + 1e7 * excess, rel=1e-9)


@pytest.mark.parametrize("masses", [1, 2, 6, 20])
def test_the_travel_left_to_coil_bind_is_the_clearance_less_the_lift(masses):
    """At rest, for any number of coil masses, of both kinds of springs."""
    clearance, lift, share = 11.5e-3, 9.37e-3, lumping(masses)
    uneven = lift * (1.0 - 1.0 / share.end_rate - np.arange(masses) / share.inner_rate)
    even = lift * (1.0 - np.arange(1, masses + 1) / (masses + 1))
    rigid, apart = ({f"coil_position[{i}]": y for i, y in enumerate(c, 1)} for c in (uneven, even))
    whole = outputs_of(
        CATALOGUE["valve_spring"](masses), {"clash_clearance": clearance}, {"position": lift} | rigid
    )
    gaps = {f"gap[{i + 1}]": clearance / (masses + 1) for i in range(masses + 1)}
    coil = outputs_of(CATALOGUE["coil_spring"](masses + 1), gaps, apart, {"position": lift})
    assert [one["least_gap"] for one in (whole, coil)] == pytest.approx([clearance - lift] * 2, abs=1e-15)


# A third of the coils, those at the head, closes at 6 mm.
TWO_RATE = {"spring_rate": 30e3, "surge_frequency": 456.4355, "preload": 0.0, "stop_stiffness": 1e11}
TWO_RATE |= {"damping_ratio": 0.0, "stop_damping": 0.0}
TWO_RATE |= {f"gap[{i}]": 0.1e-3 if i > 40 else 1.0 for i in range(1, 61)}


def compressed(position, closed=0.1e-3):
    """Coils at rest: equal segments, or forty and twenty that are closed so far."""
    if position < 6e-3:
        return {f"coil_position[{i}]": position * (1.0 - i / 60) for i in range(1, 60)}
    free = (position - 20 * closed) / 40
    return {
        f"coil_position[{i}]": position - i * free if i <= 40 else (60 - i) * closed for i in range(1, 60)
    }


def first_coil_frequency(coils, position):
    """From the stiffness about these coils (Hz)."""
    c = CATALOGUE["coil_spring"](segments=60)
    a = state_matrix(c, TWO_RATE, {"position": position}, coils, step=1e-9)
    return math.sqrt(np.min(np.linalg.eigvals(-a[59:, :59]).real)) / (2.0 * math.pi)


def test_a_spring_of_two_rates(record):
    """30 N/mm to 6 mm, then 45: what is left of the spring is higher by 3/2 in rate and frequency."""
    c = CATALOGUE["coil_spring"](segments=60)
    for position, expected in ((4e-3, 120.0), (12e-3, 450.0)):
        found = outputs_of(c, TWO_RATE, compressed(position), {"position": position})["force"]
        quantity = f"two-rate spring: force at {1e3 * position:g} mm (N)"
        record("Spring", quantity, found, expected, "closed form", tolerance=1e-9 * expected)
    # Closed a little further, so that their stops bear. Sixty segments: 2e-4 below the continuous spring.
    for position, expected in ((1e-3, 456.4355), (12e-3, 684.6532)):
        found = first_coil_frequency(compressed(position, closed=0.1001e-3), position)
        quantity = f"two-rate spring: natural frequency at {1e3 * position:g} mm (Hz)"
        record("Spring", quantity, found, expected, "continuous spring", tolerance=2e-4 * expected)


@pytest.mark.long
def test_coils_that_clash(record):
    """A prescribed valve motion at 3400 r/min, nine segments with 0.92 mm of room each."""
    room = {f"gap[{i + 1}]": 0.92e-3 for i in range(9)}
    system = System(
        {
            "flywheel": wheel(3400.0 * math.pi / 30.0),
            "camshaft": Instance(CATALOGUE["camshaft"](), {}),
            "spring": Instance(CATALOGUE["coil_spring"](), room),
        },
        (
            ("flywheel.angle", "camshaft.drive_angle"),
            ("flywheel.speed", "camshaft.drive_speed"),
            ("camshaft.surface_position", "spring.position"),
            ("camshaft.surface_velocity", "spring.velocity"),
        ),
    )
    cycle = find_cycle(system, turn(3400.0), ["flywheel.angle"], samples=18000)
    assert cycle.steady
    coils = [cycle["spring.position"], *(cycle[f"spring.coil_position[{i}]"] for i in range(1, 9))]
    compression = -np.diff(np.column_stack([*coils, np.zeros_like(coils[0])]), axis=1)
    closed = compression > 0.92e-3
    clashes = int(np.sum(closed[1:] & ~closed[:-1]))
    record("Spring", "clashes of coils in a turn", clashes, 12, "independent evaluation", tolerance=0)
    peak = float(cycle["spring.clash_force"].max())
    record("Spring", "largest force of a clash (N)", peak, 33.26, "independent evaluation", tolerance=0.05)
