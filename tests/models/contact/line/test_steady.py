"""The steady line contact: known numbers and limits, laws of conservation, and what it says of its error."""

import dataclasses
import functools
import itertools
import math
import warnings

import numpy as np
import pytest

from models.contact.analysis.line.line_contact import LineContact, moes_contact
from models.contact.analysis.line.steady import LineContactError, LineContactWarning, solve_steady
from models.contact.asperities import Asperities
from models.contact.films.moes_venner import moes_film
from models.contact.fluid import Lubricant, density_ratio, thinning, viscosity_at
from models.contact.hertz import elastic_compliance

STEEL = elastic_compliance(207e9, 0.3, 207e9, 0.3)
CAM = LineContact(
    load=600.0,
    velocity=1.5,
    radius=0.03,
    length=0.012,
    compliance=STEEL,
    lubricant=Lubricant(viscosity=0.036, pressure_viscosity=1.8e-8),
)


@functools.cache
def film_of(M, L, tolerance=2e-3):
    """Moes' groups alone say nothing of the bodies' yield stress."""
    return solve_steady(moes_contact(M, L), tolerance)


@functools.cache
def on_nodes(M, L, nodes):
    """On that grid, however coarse; its reach is that of `film_of`."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LineContactWarning)
        return solve_steady(moes_contact(M, L), nodes=nodes)


@pytest.mark.parametrize(
    ("M", "L", "central", "minimum"),
    [(10, 0, 1.680, 1.324), (20, 0, 1.420, 1.125), (50, 0, 1.160, 0.923),
     (10, 5, 3.459, 2.826), (20, 5, 3.082, 2.567), (50, 5, 2.641, 2.262),
     (10, 10, 4.832, 4.103), (20, 10, 4.364, 3.777), (50, 10, 3.812, 3.374)],
)  # fmt: skip
def test_films_are_those_of_an_independent_solution(M, L, central, minimum, record):
    """Its own stated accuracy is 0.5 %."""
    film = film_of(M, L)
    for name, found, stated in (("central", film.H_central, central), ("smallest", film.H_minimum, minimum)):
        quantity = f"{name} steady film H, M = 10 to 50, L = 0 to 10"
        record("Field", quantity, found, stated, "independent numerical solution", relative=5e-3)


@pytest.mark.parametrize(("M", "L"), [(3, 5), (20, 0), (50, 10), (1000, 1)])
def test_mesh_error_is_of_second_order(M, L, record):
    """Order p of the central film from three grids, each with twice the nodes; 2 to 0.25."""
    H = [on_nodes(M, L, nodes).H_central for nodes in (301, 601, 1201)]
    order = math.log2((H[0] - H[1]) / (H[1] - H[2]))
    quantity = "order of the steady central film in the nodes, 301 to 1201"
    record("Field", quantity, order, 2.0, "second-order discretisation", tolerance=0.25)


@pytest.mark.long
@pytest.mark.parametrize(("M", "L"), [(1, 10), (10, 0), (1000, 5)])
def test_the_error_is_bounded_by_its_estimate(M, L):
    """Against the finest grid there is, whose error is a sixteenth of the one judged."""
    film, reference = film_of(M, L), on_nodes(M, L, 2401)
    bound = film.mesh_error + film.starvation
    assert bound <= 2e-3
    assert film.H_central == pytest.approx(reference.H_central, rel=bound)
    assert film.H_minimum == pytest.approx(reference.H_minimum, rel=bound)


CORNERS = [*itertools.product((1.0, 30.0, 1000.0), (0.0, 20.0))]
LOADS = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0)
VISCOSITIES = (0.0, 0.3, 1.0, 3.0, 5.0, 10.0, 15.0, 20.0)


@pytest.mark.long
@pytest.mark.parametrize(("M", "L"), [*itertools.product(LOADS, VISCOSITIES)])
def test_films_are_near_moes_fit(M, L, record):
    """The fit was made for the minimum film (Moes 1992, Venner 1991) and is some per cent off: 7 % at most
    here, at M = 1000, L = 20."""
    film = film_of(M, L)
    quantity, source = "smallest steady film H, M = 1 to 1000, L = 0 to 20", "formula of Moes and Venner"
    record("Field", quantity, film.H_minimum, moes_film(M, L), source, relative=0.07)
    assert film.H_minimum <= film.H_central
    assert film.warnings == ()


def test_rigid_bodies_have_martins_film(record):
    """H M tends to Martin's 2.448 (4.896 eta0 u R/w) as M falls."""
    films = [M * film_of(M, 0.0, 1e-3).H_central for M in (0.3, 0.1, 0.03, 0.01)]
    assert films == sorted(films, reverse=True)
    record("Field", "H M of rigid bodies, M = 0.01", films[-1], 2.448, "Martin's film", relative=1.5e-3)


def test_heavily_loaded_contacts_have_hertz_pressure(record):
    """The largest deviation of the pressure from Hertz's away from the edges, falling as M rises."""
    deviations = []
    for M in (10.0, 100.0, 1000.0):
        film = film_of(M, 0.0)
        x = film.x / film.contact.half_width
        inside = np.abs(x) < 0.9
        hertz = film.contact.hertz_pressure * np.sqrt(1.0 - x[inside] ** 2)
        deviations.append(np.max(np.abs(film.pressure[inside] / hertz - 1.0)))
    assert deviations == sorted(deviations, reverse=True)
    quantity = "deviation of the pressure within 0.9 half widths, M = 1000"
    record("Field", quantity, deviations[-1], 0.0, "Hertz's pressure", tolerance=0.01)
    found, hertz = film_of(1000.0, 0.0).maximum_pressure, film.contact.hertz_pressure
    record("Field", "largest pressure (Pa), M = 1000", found, hertz, "Hertz's pressure", relative=2e-3)


def test_films_depend_on_two_groups_and_the_viscosity_law():
    """Bodies half as stiff and twice as round, sixteen times the speed group: same M, L and alpha, same H.

    The grids are alike, so that only the accuracy of Newton's method is left, 1e-7 of the pressure."""
    modulus = 1.0 / STEEL
    factor = 16.0 * 0.5 * 2.0  # of eta0 u, for U = eta0 u/(E' R)
    other = LineContact(
        load=CAM.load * 4.0 * 0.5 * 2.0 * 1.5,
        velocity=CAM.velocity * factor * 3.0,
        radius=2.0 * CAM.radius,
        length=1.5 * CAM.length,
        compliance=2.0 / modulus,
        lubricant=CAM.lubricant._replace(viscosity=CAM.lubricant.viscosity / 3.0),
    )
    np.testing.assert_allclose((other.M, other.L), (CAM.M, CAM.L), rtol=1e-12)
    film, same = solve_steady(CAM), solve_steady(other)
    assert same.H_minimum == pytest.approx(film.H_minimum, rel=1e-6)
    assert same.maximum_pressure == pytest.approx(film.maximum_pressure, rel=1e-6)
    moes = solve_steady(moes_contact(CAM.M, CAM.L, pressure_viscosity=CAM.lubricant.pressure_viscosity))
    assert moes.H_central == pytest.approx(film.H_central, rel=1e-6)


def test_reversed_entrainment_mirrors_the_film():
    contact = moes_contact(10.0, 10.0)
    film = solve_steady(contact)
    mirrored = solve_steady(dataclasses.replace(contact, velocity=-contact.velocity))
    # To what Newton's method leaves, 1e-7 of the largest pressure.
    np.testing.assert_allclose(
        mirrored.pressure[::-1], film.pressure, rtol=0, atol=1e-6 * film.maximum_pressure
    )
    np.testing.assert_allclose(mirrored.film[::-1], film.film, rtol=1e-6)
    assert mirrored.second_peak.x == pytest.approx(-film.second_peak.x, rel=1e-9)


def flux(film):
    """The middle of each cell and the mass flow there, with film and properties at the middle and central
    differences: another discretisation than the solver's."""
    c, middle = film.contact, 0.5 * (film.x[1:] + film.x[:-1])
    p, h = (0.5 * (v[1:] + v[:-1]) for v in (film.pressure, film.film))
    rho = np.array([density_ratio(v, c.lubricant) for v in p])
    eta = np.array([viscosity_at(v, c.lubricant) for v in p])
    return middle, rho * h * (c.velocity - h**2 / (12.0 * eta) * np.diff(film.pressure) / np.diff(film.x))


def uneven_flux(film):
    """By how much the mass flow through the loaded zone varies, relative."""
    (middle, q), p = flux(film), film.pressure
    wet = (p[1:] > 0.0) & (p[:-1] > 0.0) & (np.abs(middle) < 1.5 * film.contact.half_width)
    return np.max(np.abs(q[wet] / q[np.argmax(p[1:] + p[:-1])] - 1.0))


def test_oil_flows_through_evenly():
    """The same mass everywhere, but for differences between discretisations, of second order."""
    coarse, fine = (uneven_flux(on_nodes(10, 1, nodes)) for nodes in (301, 1201))
    assert fine < 2e-3
    assert fine < coarse / 8.0


@pytest.mark.parametrize(("M", "L"), CORNERS)
def test_pressure_carries_the_load(M, L, record):
    """Trapezoids, which are exact for pressure linear between nodes; Newton's last correction left 1e-7.
    p >= 0 everywhere; where p = 0 behind the film, the gap opens, and would take more oil than comes."""
    film = film_of(M, L)
    p, h = film.pressure, film.film
    assert np.all(p >= 0.0)
    assert np.all(h > 0.0)
    outlet = np.flatnonzero(p > 0.0)[-1]
    assert np.all(np.diff(h[outlet:]) > 0.0)
    assert np.all(p[1 : outlet + 1] > 0.0)
    found = np.trapezoid(p, film.x) * film.contact.length
    quantity = "load that the steady pressure carries (N)"
    record("Field", quantity, found, film.contact.load, "load given", relative=1e-7)
    assert film.warnings == ()


def test_the_film_is_the_gap_of_the_deflected_bodies():
    """h = -approach + x^2/2R + (2 compliance/pi) int p(s) ln(L_c/|x - s|) ds, by a quadrature of its own: the
    midpoint rule, which errs by 1e-3 of a cell's share about the logarithm's pole."""
    film = on_nodes(10, 0, 301)
    c = film.contact
    fine = np.linspace(film.x[0], film.x[-1], 400_001)
    middle, step = 0.5 * (fine[1:] + fine[:-1]), fine[1] - fine[0]
    p = np.interp(middle, film.x, film.pressure)
    for i in (40, 120, 150, 180, 260):
        integral = np.sum(p * np.log(c.length / np.abs(film.x[i] - middle))) * step
        gap = -film.approach + film.x[i] ** 2 / (2.0 * c.radius) + 2.0 * c.compliance / math.pi * integral
        assert gap == pytest.approx(film.film[i], rel=1e-3)


def test_compressible_oil_makes_a_second_peak_and_isoviscous_none():
    film = film_of(10.0, 10.0)
    assert film.second_peak is not None
    assert 0.5 < film.second_peak.x / film.contact.half_width < 1.0
    assert film_of(10.0, 0.0).second_peak is None


def test_shear_thinning_makes_no_thicker_film():
    """Eyring, with one surface at rest; a stress that is never reached changes nothing."""
    thin, thick = (
        solve_steady(
            dataclasses.replace(
                CAM, sliding=2.0 * CAM.velocity, lubricant=CAM.lubricant._replace(eyring_stress=stress)
            )
        ).central_film
        for stress in (1e6, 1e12)
    )
    newtonian = solve_steady(CAM).central_film
    assert thick == pytest.approx(newtonian, rel=1e-6)
    assert thin < 0.99 * newtonian


@pytest.mark.parametrize(("M", "L", "stress"), [(20.0, 10.0, 5e6), (50.0, 10.0, 3e6), (50.0, 10.0, 1e6)])
def test_eyring_oil_rolls_without_sliding(M, L, stress):
    """Without sliding the gradient alone thins it, which lets it out the more the lower the stress: by less
    than 5 % at 1 MPa, and by nothing in the limit of a large stress."""
    newtonian = film_of(M, L)
    oil = newtonian.contact.lubricant._replace(eyring_stress=stress)
    film = solve_steady(dataclasses.replace(newtonian.contact, lubricant=oil))
    assert 0.95 < film.central_film / newtonian.central_film < 1.0
    assert 0.95 < film.minimum_film / newtonian.minimum_film < 1.0


@pytest.mark.parametrize("gradient", [1e6, 1e13, 3e14])
@pytest.mark.parametrize("sliding", [0.0, 1e-4, 2.0])
def test_derivatives_of_the_thinning_are_its_differences(gradient, sliding):
    """Central differences of ln S: error by rounding 1e-16/1e-5, by the step 1e-10."""
    at = (40.0, 3e-7, gradient, sliding, 5e6)

    def log(place, sign):
        return math.log(
            thinning(*(x * math.exp(sign * 1e-5) if i == place else x for i, x in enumerate(at))).factor
        )

    viscosity, film, by_gradient = ((log(place, 1) - log(place, -1)) / 2e-5 for place in range(3))
    found = thinning(*at)
    assert found.by_viscosity == pytest.approx(viscosity, abs=1e-8)
    assert found.by_gradient == pytest.approx(by_gradient, rel=1e-7, abs=1e-8)
    assert found.by_gradient - found.by_viscosity == pytest.approx(film, rel=1e-7, abs=1e-8)


def test_a_grid_that_is_too_coarse_is_reported():
    with pytest.warns(LineContactWarning, match="too coarse"):
        film = solve_steady(moes_contact(1000.0, 20.0), nodes=75)
    assert "nodes" in film.warnings[0]
    assert film.mesh_error > 2e-3


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: solve_steady(moes_contact(1000.0, 20.0), tolerance=1e-6), "allow a larger tolerance"),
        (lambda: solve_steady(dataclasses.replace(CAM, velocity=1e-15)), "use the transient line contact"),
        (
            lambda: solve_steady(dataclasses.replace(CAM, squeeze=10.0), nodes=75),
            "squeeze = 10 m/s: must be well below",
        ),
    ],
)
def test_films_that_are_not_found_are_refused(call, words):
    with pytest.raises(LineContactError, match=words):
        call()


def test_a_short_inlet_is_seen():
    """The load that oil from beyond the grid would carry bounds what four times the reach changes."""
    from models.contact.analysis.line import steady

    contact = moes_contact(1.0, 0.0)
    films = {}
    for share in (5.0, 0.01):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(steady, "STARVED_SHARE", share)
            films[share] = solve_steady(contact, tolerance=0.02, nodes=1201)
    near, far = films.values()
    assert np.max(far.x) >= 4.0 * np.max(near.x)
    missing = 1.0 - near.central_film / far.central_film
    assert 5.0 * near.mesh_error < missing < near.starvation


def test_pressure_beyond_the_elastic_limit_is_reported():
    with pytest.warns(LineContactWarning, match=r"1\.\d+e\+09 Pa, above the elastic limit of 1e\+09 Pa"):
        film = solve_steady(dataclasses.replace(CAM, load=2e4, elastic_limit=1e9))
    assert film.maximum_pressure > 1e9
    assert len(film.warnings) == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [({"load": 0.0}, r"load = 0 N \(without any .*\): must be > 0"), ({"load": math.nan}, "load = nan N"),
     ({"velocity": 0.0}, "velocity = 0 m/s.*transient"), ({"sliding": math.nan}, "sliding = nan"),
     ({"elastic_limit": -1.0}, "elastic_limit = -1 Pa"),
     ({"load": np.ones(2)}, "load = array.*: must be one real number"),
     ({"lubricant": Lubricant("thick", 1e-8)}, "viscosity = 'thick': must be one real number"),
     ({"lubricant": Lubricant(0.0, 1e-8)}, "viscosity = 0 Pa.s"),
     ({"lubricant": Lubricant(0.03, 1e-8, 7.0)}, "viscosity_law = 7 .*: must be one of roelands, barus, con"),
     ({"lubricant": Lubricant(0.03, 1e-8, eyring_stress=-1.0)}, "eyring_stress = -1 Pa"),
     ({"lubricant": Lubricant(0.03, 1e-8, roelands_exponent=0.0)}, "roelands_exponent = 0"),
     ({"asperities": Asperities(0.0, 0.05, 1e-3)}, "roughness = 0 .*smooth")],
)  # fmt: skip
def test_what_is_no_contact_is_refused(change, words):
    with pytest.raises(ValueError, match=words):
        dataclasses.replace(CAM, **change)


@pytest.mark.parametrize(
    ("call", "words"),
    [(lambda: moes_contact(1.0, -1.0), "L = -1"),
     (lambda: moes_contact(1.0, 1.0, pressure_viscosity=0.0), "pressure_viscosity = 0"),
     (lambda: solve_steady(CAM, tolerance=0.0), "tolerance = 0"),
     (lambda: solve_steady(CAM, nodes=300), "nodes = 300: must be odd, a whole number and from 51 to 4801"),
     (lambda: solve_steady(CAM, nodes=301.0), "nodes = 301.0: must be odd, a whole number"),
     (lambda: moes_contact("1", 1.0), "M = '1': must be one real number")],
)  # fmt: skip
def test_what_cannot_be_solved_is_refused(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_closing_bodies_squeeze_oil_out():
    """With the gap closing at a rate V, the flow through the rigid, isoviscous contact falls by V dx: the
    flux of another discretisation, with what is squeezed out between, is even."""
    contact = moes_contact(0.3, 0.0)
    closing = dataclasses.replace(contact, squeeze=-2e-3 * contact.velocity)
    film = solve_steady(closing, nodes=1201)
    assert film.central_film > 1.05 * solve_steady(contact, nodes=1201).central_film
    middle, q = flux(film)
    near = (np.abs(middle) < np.sqrt(contact.radius * film.central_film)) & (film.pressure[1:] > 0.0)
    even = q[near] + closing.squeeze * middle[near]
    # Differences of second order between discretisations; without the squeeze term it varies by a tenth.
    np.testing.assert_allclose(even / even[0], 1.0, atol=1e-3)
    assert np.ptp(q[near]) > 0.05 * even[0]
