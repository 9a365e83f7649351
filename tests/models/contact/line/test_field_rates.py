"""Rates of what a contact with a solved film shows: those of the outputs along a finely stepped motion."""

import functools
import itertools
import math
from collections.abc import Callable, Iterable

import numpy as np
import pytest

from models.contact.ehl_contact import ehl_contact
from models.contact.ehl_line_contact import ehl_line_contact
from models.contact.films import FILMS
from models.contact.line.differences import (
    INSTANTS,
    append_instant,
    estimate_rate,
    estimate_second_derivative,
    restart,
)
from models.core.quantities import Vector

from ...stepped import Stepped

NODES = 101
CONTACT = ehl_line_contact(nodes=NODES)
OMEGA = 2.0 * math.pi * 300.0
# The motion forgets its beginning before the one and ends with the other.
SETTLED, STOP = 1.2e-3, 2.4e-3
# Outputs that are smooth but for nodes that get or lose their pressure.
SMOOTH = (
    "load", "film_thickness", "minimum_film_thickness", "squeeze_velocity", "asperity_load",
    "film_ratio", "deflection", "half_width",
)  # fmt: skip


def drive(t: float) -> Vector:
    """Inputs that swing, as polynomials from t on."""
    U = CONTACT.input_polynomial()
    sine = [math.sin(OMEGA * t + k * math.pi / 2.0) * OMEGA**k for k in range(4)]
    cosine = [math.cos(OMEGA * t + k * math.pi / 2.0) * OMEGA**k for k in range(4)]
    swings = {
        "approach": (1.5e-6, 0.3e-6, sine),
        "approach_rate": (0.0, 0.3e-6 * OMEGA, cosine),
        "entraining_velocity": (2.0, 0.5, cosine),
        "sliding_velocity": (1.5, 0.5, cosine),
        "radius_of_curvature": (0.02, 0.002, sine),
    }
    for name, (mean, size, wave) in swings.items():
        U[:, CONTACT.inputs.index(name)] = size * np.array(wave)
        U[0, CONTACT.inputs.index(name)] += mean
    return U


class Run(Stepped):
    """The contact along the motion."""

    def __init__(self, tolerance: float = 0.1) -> None:
        """A tolerance that large lets every step be one micro-step."""
        super().__init__(CONTACT, {"field_tolerance": tolerance})
        self.u, self.du = drive(0.0)[0].copy(), drive(0.0)[1].copy()

    def step(self, h: float) -> int:
        self.U = drive(self.t)
        status = super().step(h)
        CONTACT.input_rates(self.U, h, self.du)
        return status


def course(lengths: Iterable[float]) -> tuple[Vector, Vector, Vector]:
    """Times after SETTLED, outputs and rates there."""
    run, rows = Run(), []
    for h in lengths:
        run.advance(h)
        if run.t > SETTLED:
            rows.append((run.t, run.y.copy(), np.array(list(run.rates(run.du).values()))))
    times, outputs, rates = (np.array(column) for column in zip(*rows, strict=True))
    return times, outputs, rates


FINE = 2.5e-6


@functools.cache
def exact() -> tuple[Vector, Vector]:
    """Times and rates of all outputs, by central differences of fourth order over fine steps."""
    times, y, _ = course([FINE] * round(STOP / FINE))
    return times[2:-2], (8.0 * (y[3:-1] - y[1:-3]) - (y[4:] - y[:-4])) / (12.0 * FINE)


def errors(lengths: list[float]) -> dict[str, Vector]:
    """Errors of rates by output, at all instants that the fine run has too."""
    times, _, rates = course(lengths)
    fine, truth = exact()
    shared = [(i, round((t - fine[0]) / FINE)) for i, t in enumerate(times)]
    pairs = [(i, k) for i, k in shared if k < len(fine) and abs(fine[k] - times[i]) < 1e-6 * FINE]
    assert len(pairs) >= 20
    rows = np.array(pairs)
    found = np.abs(rates[rows[:, 0]] - truth[rows[:, 1]])
    return {name: found[:, CONTACT.outputs.index(name)] for name in SMOOTH}


def test_rates_come_with_the_second_order_of_the_steps() -> None:
    """In the median, as a node that gets or loses its pressure makes a small kink."""
    coarse, fine = (errors([h] * round(STOP / h)) for h in (4e-5, 2e-5))
    for name in SMOOTH:
        assert math.log2(np.median(coarse[name]) / np.median(fine[name])) > 1.8, name


@pytest.mark.long
def test_rates_of_uneven_steps() -> None:
    """Films keep the order. Load and width follow what the method (of stage order 1) damps within a step with
    an error of that step, which does not change evenly: their rates are right to a hundredth (measured 0.5 %,
    0.3 % of the largest). Second derivatives lose an order."""
    pattern = np.array([0.75, 1.25, 0.5, 1.5])
    coarse, fine = (errors((h * np.tile(pattern, round(STOP / (4.0 * h)))).tolist()) for h in (4e-5, 2e-5))
    for name in ("film_thickness", "minimum_film_thickness", "deflection"):
        assert math.log2(np.median(coarse[name]) / np.median(fine[name])) > 1.8, name
    for name in ("load", "half_width"):
        largest = np.max(np.abs(exact()[1][:, CONTACT.outputs.index(name)]))
        assert np.max(coarse[name]) < 0.01 * largest
        assert np.max(fine[name]) < np.max(coarse[name])


def test_the_squeeze_velocity_is_the_rate_of_the_film() -> None:
    run = Run()
    for _ in range(10):
        run.advance(1e-5)
    # Differences of fourth order over 5e-4 s that a film which moves evenly has to rounding.
    squeeze = run.y[CONTACT.outputs.index("squeeze_velocity")]
    assert run.rates(run.du)["film_thickness"] == pytest.approx(squeeze, rel=1e-9)


def test_rates_behind_a_jump_are_those_of_the_motion_after_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A twentieth of what the jump would make over its step, in which the load relaxes fast."""
    run, h = Run(tolerance=1e-4), 1e-5
    for _ in range(100):
        run.advance(h)
    before, way = run.y[CONTACT.outputs.index("load")], drive
    approach = CONTACT.inputs.index("approach")
    jumped = np.zeros_like(drive(0.0))
    jumped[0, approach] = 2e-6
    monkeypatch.setitem(globals(), "drive", lambda t: way(t) + jumped)
    run.advance(h)
    jump = run.y[CONTACT.outputs.index("load")] - before
    assert jump > 500.0
    assert abs(run.rates(run.du)["load"]) < 0.1 * jump / h


@pytest.mark.parametrize("short", [pytest.param(1e-7, marks=pytest.mark.long), 1e-12])
def test_a_step_that_was_cut_short_does_not_spoil_rates(short: float) -> None:
    """To a twentieth; over so short a time the load's differences were made of rounding and of what a
    method leaves of fast motions (1e-12 s: ten times the rate)."""
    run, whole = Run(tolerance=1e-4), Run(tolerance=1e-4)
    for _ in range(130):
        run.advance(1e-5)
        whole.advance(1e-5)
    run.advance(short)
    for _ in range(3):
        assert run.rates(run.du)["load"] == pytest.approx(whole.rates(whole.du)["load"], rel=0.05)
        run.advance(1e-5)
        whole.advance(1e-5)


def test_rates_before_the_first_step_are_those_of_hertz_and_the_relaxation() -> None:
    """Those of the formula contact without damping, of Moes' and Venner's film."""
    formula, run = ehl_contact(), Run()
    settings = {"film_model": float(list(FILMS).index("moes_venner")), "contact_damping": 0.0}
    p, expected = formula.parameters.vector(settings), np.zeros(formula.outputs.size)
    work = np.zeros(formula.rates_work_size)
    formula.flat_rates(run.t, run.x[:1], run.u, run.du, p, work, expected)
    rates = formula.outputs.named(expected)
    # The ratio is that of the film shown, of the formula a thicker one.
    roughness = run.p[CONTACT.parameters.index("roughness")]
    rates["film_ratio"] = pytest.approx(run.rates(run.du)["film_thickness"] / roughness, rel=1e-9)
    assert run.rates(run.du) == {name: rates[name] for name in CONTACT.outputs.names}


def followed(function: Callable[[float], float], instants: Vector) -> tuple[float, float]:
    """Rate and second derivative at the last of the instants."""
    table, ages = np.ones((INSTANTS, 1)), np.ones(INSTANTS - 1)
    restart(table, ages, np.array([function(instants[0])]))
    for before, now in itertools.pairwise(instants):
        append_instant(table, ages, np.array([function(now)]), now - before)
    return estimate_rate(table, ages, 0), estimate_second_derivative(table, ages, 0)


UNEVEN = np.array([0.0, 0.3, 0.4, 1.1, 1.35])


@pytest.mark.parametrize("degree", range(INSTANTS))
def test_polynomials_that_the_instants_tell_have_their_rates(degree: int) -> None:
    """Also the first instants of a history: one more than the degree is enough."""
    polynomial = np.polynomial.Polynomial(np.arange(1.0, degree + 2.0) * (-1.0) ** np.arange(degree + 1))
    for count in range(degree + 1, len(UNEVEN) + 1):
        instants = UNEVEN[:count]
        rate, second = followed(polynomial, instants)
        # A hundred roundings of terms of some ten over spaces of a tenth, and over their squares.
        assert rate == pytest.approx(polynomial.deriv(1)(instants[-1]), abs=1e-12)
        assert second == pytest.approx(polynomial.deriv(2)(instants[-1]), abs=1e-11)


def test_a_jump_is_left_behind() -> None:
    """A history that is begun anew behind it has the rates of what came after."""
    table, ages = np.zeros((INSTANTS, 1)), np.zeros(INSTANTS - 1)
    for value in (0.0, 1.0, 2.0, 3.0):
        append_instant(table, ages, np.array([value]), 0.1)
    restart(table, ages, np.array([100.0]))
    assert (estimate_rate(table, ages, 0), estimate_second_derivative(table, ages, 0)) == (0.0, 0.0)
    append_instant(table, ages, np.array([99.5]), 0.1)
    assert estimate_rate(table, ages, 0) == pytest.approx(-5.0, rel=1e-12)


def test_an_instant_that_follows_too_soon_is_passed_over() -> None:
    """Over 1e-14 s a difference would be a rounding's: 1e-16/1e-14. Passed over, cubics keep their rates."""
    table, ages = np.zeros((INSTANTS, 1)), np.zeros(INSTANTS - 1)
    cubic = np.polynomial.Polynomial([0.1, 2.0, -1.0, 0.5])
    restart(table, ages, np.array([cubic(0.0)]))
    for k in range(1, 5):
        assert append_instant(table, ages, np.array([cubic(0.1 * k)]), 0.1)
    assert not append_instant(table, ages, np.array([cubic(0.4)]), 1e-14)
    assert estimate_rate(table, ages, 0, 1e-14) == pytest.approx(cubic.deriv(1)(0.4), rel=1e-12)
    assert append_instant(table, ages, np.array([cubic(0.5)]), 0.1)
    assert estimate_rate(table, ages, 0) == pytest.approx(cubic.deriv(1)(0.5), rel=1e-12)
