"""Film and asperities that carry the load together, inside the solved film."""

import itertools
import math
from functools import cache

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.contact.analysis.line.fixed_grid import Mesh, cold_start, steady_on_grid, workspace
from models.contact.analysis.line.history import film_history
from models.contact.analysis.line.line_contact import LineContact
from models.contact.analysis.line.steady import SteadyFilm, solve_steady
from models.contact.asperities import Asperities, asperity_pressure, find_separation, mean_gap, pressure_scale
from models.contact.films import FILMS
from models.contact.films.groups import Conditions
from models.contact.fluid import Lubricant
from models.contact.hertz import elastic_compliance, half_width
from models.contact.line.grid import node_positions
from models.contact.line.hierarchical import BAND
from models.contact.line.mixed import BALANCED, TOUCHING, Bodies, couple_asperities, mean_plane_gap, touch
from models.contact.line.newton import deflection_factors
from models.contact.line.reynolds import Flow, balance, properties
from models.contact.load_sharing import formula_film, share_load
from models.core.integrator import OK
from models.core.quantities import Vector

from ...systems import outputs_of
from .cam_cycle import motion
from .stepped import NODES, Contact

STEEL = elastic_compliance(207e9, 0.3, 207e9, 0.3)
OIL = Lubricant(0.036, 1.8e-8)
LOAD, RADIUS, LENGTH = 300.0, 0.02, 0.012
FINE, COARSE = Asperities(0.2e-6, 0.05, 1e-3), Asperities(0.8e-6, 0.05, 1e-3)
# p_a is interpolated to 2e-8, and cavitated nodes count as open below 1e-9 of the highest pressure.
PRESSED = 1e-7
SPEEDS = (1e-4, 1e-2, 0.1, 10.0)
RUNNING = {"entraining_velocity": 0.5, "radius_of_curvature": RADIUS, "sliding_velocity": 1.0}


@cache
def steady(velocity: float, rough: Asperities | None) -> SteadyFilm:
    return solve_steady(LineContact(LOAD, velocity, RADIUS, LENGTH, STEEL, OIL, asperities=rough))


def bodies(rough: Asperities) -> Bodies:
    return Bodies(STEEL, LENGTH, rough.roughness, pressure_scale(rough, STEEL))


def pressed(film: Vector, rough: Asperities) -> Vector:
    """p_a under a mean gap, by the integral itself."""
    return np.array([asperity_pressure(find_separation(h / rough.roughness), rough, STEEL) for h in film])


@pytest.mark.parametrize("rough", [FINE, COARSE])
def test_oil_and_asperities_carry_the_load(rough):
    """Asperities from all to none as the speed rises; the film is never less than what they leave dry."""
    films = [steady(u, rough) for u in SPEEDS]
    for film in films[:-1]:
        asperities = pressed(film.film, rough)
        allowed = PRESSED * asperities.max()
        np.testing.assert_allclose(film.asperity_pressure, asperities, rtol=1e-6, atol=allowed)
        carried = [float(np.trapezoid(p, film.x)) * LENGTH / LOAD for p in (film.pressure, asperities)]
        assert sum(carried) == pytest.approx(1.0, abs=PRESSED)
        assert carried[1] == pytest.approx(film.asperity_load / LOAD, abs=PRESSED)
        assert np.all(film.pressure >= 0.0)
    shares = [film.asperity_load / LOAD for film in films]
    assert all(a > b for a, b in itertools.pairwise(shares))
    assert shares[0] > 0.99
    assert min(film.minimum_film for film in films) == films[0].minimum_film > 0.0
    assert steady(SPEEDS[-1], FINE).asperity_load < 1e-9 * LOAD


def test_surfaces_that_do_not_touch_have_the_film_of_smooth_ones():
    """Of a roughness of a thousandth of the film, to what Newton's method leaves."""
    smooth = steady(0.3, None)
    rough = steady(0.3, Asperities(1e-3 * smooth.minimum_film, 0.05, 1e-3))
    assert rough.asperity_load == 0.0
    assert rough.central_film == pytest.approx(smooth.central_film, rel=1e-5)
    assert rough.minimum_film == pytest.approx(smooth.minimum_film, rel=1e-5)


def grid(nodes: int, scale: float):
    w = workspace(Mesh(nodes))
    factor, offset = deflection_factors(scale, Bodies(STEEL, LENGTH))
    return w, w.X * scale, factor * (w.D.T + offset * w.weight[None, :]), w.weight * scale


@pytest.mark.parametrize("rough", [pytest.param(FINE, marks=pytest.mark.long), COARSE])
def test_a_dense_solution_has_the_same_film(rough):
    """Pressure, gap of the mean planes and approach as unknowns of one dense system on the same volumes, p_a
    by its integral, Newton's method with differences from the film of 0.8 u. The cavity is taken over, and
    judged by what it is: no pressure, and gaps that open faster than oil flows in.
    """
    nodes, scale, velocity = 51, 1.5e-4, 0.1
    w, x, deflected, weight = grid(nodes, scale)
    flow = Flow(velocity, 0.0, RADIUS)

    def ours(flow: Flow) -> Vector:
        start = cold_start(LOAD, 2e-7, RADIUS, bodies(rough), scale, Mesh(nodes))
        found = steady_on_grid(start, flow, LOAD, bodies(rough), OIL, 0.0, at_once=False)
        assert found is not None
        gap = [mean_plane_gap(h, rough.roughness) for h in found.h]
        return np.concatenate([found.p * 1e-8, np.array(gap) * 1e6, [found.approach * 1e6]])

    def residual(unknown: Vector) -> Vector:
        p, d, approach = 1e8 * unknown[:nodes], 1e-6 * unknown[nodes:-1], 1e-6 * unknown[-1]
        h = np.array([rough.roughness * mean_gap(s / rough.roughness) for s in d])
        q = p + np.array([asperity_pressure(s / rough.roughness, rough, STEEL) for s in d])
        left, A, B = np.empty(nodes), np.empty((BAND, nodes)), np.empty((BAND, nodes))
        properties(np.maximum(p, 0.0), h, OIL, w.nodes)
        balance(w.X, scale, 0.0, p, h, w.nodes, flow, OIL, np.zeros(nodes), math.inf, left, A, B)
        balanced = np.where(cavity, unknown[:nodes], left / (2e-7 * velocity))
        gap = x**2 / (2.0 * RADIUS) - approach + deflected @ q - d
        return np.concatenate([balanced, 1e6 * gap, [weight @ q * LENGTH / LOAD - 1.0]])

    dense, exact = ours(flow._replace(velocity=0.8 * velocity)), ours(flow)
    cavity = exact[:nodes] == 0.0
    dense[:nodes][cavity] = 0.0
    assert np.max(np.abs(residual(dense))) > 1e-2
    for _ in range(40):
        missing = residual(dense)
        if np.max(np.abs(missing)) < 1e-10:
            break
        moved = [residual(dense + 1e-7 * e) for e in np.eye(dense.size)]
        change = np.linalg.solve((np.array(moved) - missing).T / 1e-7, missing)
        dense -= min(1.0, 0.3 / np.max(np.abs(change))) * change
    assert np.max(np.abs(missing)) < 1e-9
    assert np.all(dense[:nodes][~cavity] > 0.0)
    cavity = np.zeros(nodes, dtype=bool)
    assert np.all(residual(dense)[1 : nodes - 1] > -1e-9)
    # Newton's method of the film leaves 1e-6 of the highest pressure.
    np.testing.assert_allclose(dense, exact, rtol=1e-5, atol=1e-5 * exact[:nodes].max())


def test_the_jacobian_by_total_pressure_is_its_differences():
    """The balance at some nodes, the cavity's q = p_a(d) at others, by q: film and p follow from the gap."""
    nodes, scale = 51, 1.5e-4
    w, x, deflected, _ = grid(nodes, scale)
    b, m = bodies(COARSE), w.mixed
    q = 2e8 * np.maximum(1.0 - (w.X / 1.5) ** 2, 0.0) ** 0.5 + 1e7 * np.exp(-(w.X**2))
    approach = float(np.min(x**2 / (2.0 * RADIUS) + deflected @ q)) - 2e-7
    touching = (w.X > 0.9) & (w.X < 2.0)
    A, B, left = np.empty((BAND, nodes)), np.empty((BAND, nodes)), np.empty(nodes)

    def conditions(q: Vector) -> Vector:
        m.total[:], m.gap[:] = q, x**2 / (2.0 * RADIUS) - approach + deflected @ q
        h = np.empty(nodes)
        touch(b, m, h)
        p = m.total - m.asperities
        properties(p, h, OIL, w.nodes)
        flow, old = Flow(0.7, 0.0, RADIUS), np.full(nodes, 1e-12)
        balance(w.X, scale, 0.3, p, h, w.nodes, flow, OIL, old, 1e-5, left, A, B)
        return np.where(touching, p, left)

    conditions(q)
    assert m.asperities[touching].min() > 0.0
    assert m.asperities.max() > 0.05 * q.max()
    m.sides[:], m.excess[:] = np.where(touching, TOUCHING, BALANCED), 0.0
    couple_asperities(A, B, m, np.zeros(nodes))
    bands = np.zeros((2, nodes, nodes))
    for i in range(nodes):
        for k in range(max(0, 2 - i), min(BAND, nodes + 2 - i)):
            bands[:, i, i + k - 2] = A[k, i], B[k, i]
    jacobian = bands[0] + bands[1] @ deflected
    for j in range(nodes):
        d = 1e-6 * q.max()
        moved = [q + sign * d * (np.arange(nodes) == j) for sign in (1.0, -1.0)]
        difference = (conditions(moved[0]) - conditions(moved[1])) / (2.0 * d)
        inner = slice(1, nodes - 1)
        # Of each row's largest element: differences lose half the digits.
        size = np.abs(jacobian[inner]).max(axis=1)
        assert np.max(np.abs(jacobian[inner, j] - difference[inner]) / size) < 1e-6


def mixed(nodes: int = NODES, sliding: float = 1.0, **parameters: float) -> Contact:
    """A contact in the middle of mixed lubrication, settled."""
    contact = Contact(nodes=nodes, load_is_given=1.0, roughness=COARSE.roughness, **parameters)
    for _ in range(200):
        assert contact.step(2e-5, **{**RUNNING, "sliding_velocity": sliding}, applied_load=LOAD) == OK
    return contact


def test_load_and_friction_are_counted_once():
    """Film and asperities carry the load; at its limiting stress gamma p the film rubs by gamma times its
    share, whatever the pressure's shape."""
    contact = mixed(sliding=1e7, limiting_shear_stress=0.0, limiting_shear_coefficient=0.05, viscosity=0.2)
    asperities = contact["asperity_load"]
    assert 0.02 * LOAD < asperities < 0.98 * LOAD
    scale = contact.x[contact.component.state.index("grid_scale")]
    x = scale * node_positions(contact.nodes)
    oil = float(np.trapezoid(contact.field("pressure"), x)) * LENGTH
    assert contact["load"] == pytest.approx(LOAD, rel=1e-6)
    assert oil + asperities == pytest.approx(LOAD, rel=PRESSED)
    assert contact["boundary_friction"] == pytest.approx(0.1 * asperities, rel=1e-12)
    # The trapezoidal rule of the friction against the field's own weights: h^2 of 101 nodes.
    assert contact["viscous_friction"] == pytest.approx(0.05 * oil, rel=2e-3)


def test_friction_is_odd_in_the_sliding():
    one, other = (mixed(sliding=velocity) for velocity in (1.5, -1.5))
    for name in ("viscous_friction", "boundary_friction", "friction_force"):
        assert one[name] == pytest.approx(-other[name], rel=1e-12)
        assert one[name] > 0.0
    assert one["friction_force"] == one["viscous_friction"] + one["boundary_friction"]
    assert one["film_ratio"] == pytest.approx(one["film_thickness"] / COARSE.roughness, rel=1e-12)


def test_friction_of_a_heavy_contact_is_near_that_of_the_formula_with_its_film():
    """M = 25: Hertz's pressure over the central film against the solved profiles."""
    solved = Contact(load_is_given=1.0)
    drive = {"applied_load": 3e3, "entraining_velocity": 0.3, "sliding_velocity": 0.1}
    for _ in range(10):
        assert solved.step(1e-4, **drive) == OK
    given = {"load_is_given": 1.0, "film_model": float(list(FILMS).index("moes_venner"))}
    formula = outputs_of(
        CATALOGUE["ehl_contact"](), given, {"film_thickness": solved["film_thickness"]}, drive
    )
    # What is left is the inlet's and the constriction's shear and the pressure's departure from Hertz's.
    assert formula["viscous_friction"] == pytest.approx(solved["viscous_friction"], rel=0.15)


@pytest.mark.long
def test_it_settles_to_the_steady_film():
    contact = mixed(201)
    film = steady(RUNNING["entraining_velocity"], COARSE)
    # 201 nodes against 601: 0.3 % of the film, as between smooth surfaces, 0.7 % of the pressure.
    assert contact["film_thickness"] == pytest.approx(film.central_film, rel=1e-2)
    assert contact["asperity_load"] == pytest.approx(film.asperity_load, rel=1e-2)
    assert contact["maximum_pressure"] == pytest.approx(film.maximum_pressure, rel=1e-2)


def test_approach_given_is_the_inverse_of_load_given():
    """Along a load that varies: the approach that follows from it gives it back."""
    given, back = mixed(), Contact(roughness=COARSE.roughness)
    place = given.component.state.index("rigid_approach")
    back.x[:], back.t = given.x, given.t
    begun = given.t

    def swelling(t: float) -> float:
        return LOAD * (1.0 + 0.2 * math.sin((t - begun) / 1e-4) ** 2)

    for _ in range(40):
        before, start = given.x[place], given.t
        assert given.step(1e-6, **RUNNING, applied_load=swelling) == OK
        rate = (given.x[place] - before) / 1e-6
        assert back.step(1e-6, **RUNNING, approach=lambda t, a=before, r=rate, s=start: a + r * (t - s)) == OK
        # The approach within a step is not quite linear.
        assert back["load"] == pytest.approx(given["load"], rel=1e-4)
    assert given["load"] > 1.02 * LOAD
    assert back["asperity_load"] == pytest.approx(given["asperity_load"], rel=1e-4)


@pytest.mark.long
def test_through_the_cam_cycle_asperities_bear_most_where_entrainment_reverses():
    degrees = np.linspace(95.0, 225.0, 261)
    m = motion(degrees, 1000.0)
    film = film_history(m.times, m.load, m.velocity, m.radius, NODES, {"roughness": FINE.roughness})
    assert np.max(np.abs(film.load / m.load[1:] - 1.0)) < 1e-6
    asperities = [
        np.trapezoid(pressed(h, FINE), x) for h, x in zip(film.film[::20], film.x[::20], strict=True)
    ]
    np.testing.assert_allclose(film.asperity_load[::20], np.array(asperities) * LENGTH, rtol=1e-6, atol=1e-6)
    share = film.asperity_load / film.load
    angle = degrees[1:]
    reversals = [share[(angle > a - 6.0) & (angle < a + 6.0)].max() for a in (144.0, 168.0, 192.0, 216.0)]
    assert min(reversals) > 10.0 * np.interp(180.0, angle, share)
    assert max(reversals) == share[angle > 120.0].max() < 0.2
    smooth = film_history(m.times, m.load, m.velocity, m.radius, NODES)
    # Oil that is relieved of load makes a thicker film.
    assert np.min(film.minimum_film_thickness) > np.min(smooth.minimum_film_thickness)


def test_a_mixed_contact_stops_stands_and_starts_again():
    """The film is squeezed out, asperities come to carry all but a little, and let go again."""
    contact = mixed()
    before = contact["film_thickness"]

    def stopping(t: float) -> float:
        return 0.5 * max(0.0, 1.0 - (t - 4e-3) / 1e-3)

    for _ in range(150):
        assert contact.step(4e-5, **{**RUNNING, "entraining_velocity": stopping}, applied_load=LOAD) == OK
    assert contact["asperity_load"] > 0.9 * LOAD
    assert 0.0 < contact["minimum_film_thickness"] < before
    for _ in range(100):
        assert contact.step(4e-5, **RUNNING, applied_load=LOAD) == OK
    assert contact["film_thickness"] == pytest.approx(before, rel=1e-3)


@pytest.mark.parametrize("velocity", SPEEDS[1:3])
@pytest.mark.parametrize("rough", [FINE, COARSE])
def test_sharing_by_a_formula_is_near_that_of_the_solved_film(velocity, rough):
    """Johnson, Greenwood and Poon's spreads asperities evenly over Hertz's area. Coarse ones touch on a wider
    area, and bear up to 0.15 of the load more; of fine ones edges press less, and they bear up to 0.08 less.
    """
    number, area = (
        float(list(FILMS).index("moes_venner")),
        2.0 * half_width(LOAD, RADIUS, LENGTH, STEEL) * LENGTH,
    )
    at = Conditions(velocity, RADIUS, LENGTH, STEEL, OIL.viscosity, OIL.pressure_viscosity)
    model = share_load(LOAD, formula_film(number, LOAD, at), area, rough, number, at)
    film = steady(velocity, rough)
    more = (film.asperity_load - model.asperity_load) / LOAD
    assert (0.0 if rough == COARSE else -0.08) < more < (0.15 if rough == COARSE else 0.0)
    assert model.film < film.central_film


@pytest.mark.parametrize("roughness", [0.2e-6, pytest.param(3e-6, marks=pytest.mark.long)])
def test_random_walks_between_rough_surfaces_are_made(roughness):
    """Jerks of approach up to 11 um within 1 us to 0.5 ms, from mean planes that overlap: none is
    discarded, no film is nothing, and asperities bear no more than the load.

    Newton's method runs away from some of the guesses.
    """
    draw = np.random.default_rng(7)
    contact = Contact(roughness=roughness)
    at = {"approach": 0.3e-6, "entraining_velocity": 1.0, "radius_of_curvature": 0.02}
    for _ in range(100):
        to = {
            "approach": draw.uniform(-3e-6, 8e-6),
            "entraining_velocity": draw.choice([0.0, 1e-3, draw.uniform(-3.0, 3.0)]),
            "radius_of_curvature": draw.uniform(0.005, 0.05),
        }
        h, t = 10.0 ** draw.uniform(-6.0, -3.3), contact.t
        ramps = {k: lambda s, a=at[k], b=to[k], h=h, t=t: a + (b - a) * (s - t) / h for k in at}
        assert contact.step(h, **ramps) == OK
        at = to
        assert contact["minimum_film_thickness"] > 0.0
        assert 0.0 <= contact["asperity_load"] <= contact["load"] * (1.0 + 1e-6)
        assert contact["load"] < 2e4
