"""What the line contact's solver is made of: grid and deflection, balance and its derivatives, factors."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad

from models.contact.analysis.line.fixed_grid import Mesh, workspace
from models.contact.fluid import Lubricant
from models.contact.hertz import deflection, half_width, maximum_pressure
from models.contact.line.grid import fill_kernel_matrix, place_nodes
from models.contact.line.hierarchical import BAND, Jacobian
from models.contact.line.mixed import Bodies
from models.contact.line.newton import fill_film
from models.contact.line.reynolds import Flow, balance, mean_fluidity, properties
from models.contact.line.woodbury import EXCHANGES, correct_factors, factorise_anew, solve_corrected

BODIES = Bodies(8.8e-12, 0.012)
LUBRICANTS = {
    "roelands": Lubricant(0.036, 1.8e-8),
    "barus, constant density": Lubricant(0.036, 1.8e-8, 1.0, 1.0),
    "constant": Lubricant(0.036, 0.0, 2.0, 1.0),
}


@pytest.mark.parametrize(
    ("nodes", "reach", "sharpness"), [(51, 10.0, 0.0), (301, 160.0, 0.0), (1201, 10.0, 256.0)]
)
def test_nodes_ascend_and_are_symmetric(nodes, reach, sharpness):
    X = np.empty(nodes)
    place_nodes(X, reach, sharpness)
    assert np.all(np.diff(X) > 0.0)
    np.testing.assert_array_equal(X, -X[::-1])
    assert X[-1] == reach
    # Neighbouring steps differ little: order of accuracy is lost where they jump.
    steps = np.diff(X)
    if nodes > 51:
        assert np.max(np.maximum(steps[1:] / steps[:-1], steps[:-1] / steps[1:])) < 1.5


def test_kernel_matrix_is_the_quadrature_of_its_definition():
    """-integral of hat function j times ln|X[i] - S|, by adaptive quadrature with the pole at its limits."""
    X = np.empty(51)
    place_nodes(X)
    weight, D = np.empty(51), np.empty((51, 51))
    fill_kernel_matrix(X, weight, D)
    for i, j in ((0, 0), (0, 50), (3, 4), (20, 20), (20, 21), (20, 30), (25, 25), (25, 0), (50, 49)):
        total, area = 0.0, 0.0
        for left in (j - 1, j):
            if not 0 <= left < 50:
                continue
            a, b = X[left], X[left + 1]
            rises = left == j - 1

            def hat(S, a=a, b=b, rises=rises):
                return (S - a) / (b - a) if rises else (b - S) / (b - a)

            total -= quad(lambda S, hat=hat, i=i: hat(S) * math.log(abs(X[i] - S)), a, b, epsabs=1e-13)[0]
            area += 0.5 * (b - a)
        assert D[j, i] == pytest.approx(total, abs=1e-11)
        assert weight[j] == pytest.approx(area, rel=1e-12)


def test_hertz_pressure_flattens_the_bodies():
    """Deflection plus x^2/2R is the approach of the finite line contact (K 9) all over the contact, and less
    than the gap beyond it; linear pressure between nodes errs with step^3/2 at the edges, 1e-4 here."""
    load, radius = 500.0, 0.02
    b = half_width(load, radius, BODIES.length, BODIES.compliance)
    p0 = maximum_pressure(load, radius, BODIES.length, BODIES.compliance)
    errors = []
    for nodes in (301, 1201):
        w = workspace(Mesh(nodes))
        x = b * w.X
        p = p0 * np.sqrt(np.maximum(1.0 - (x / b) ** 2, 0.0))
        gap = np.empty(nodes)
        fill_film(p, deflection(load, radius, BODIES.length, BODIES.compliance), radius, b, BODIES, w, gap)
        inside = np.abs(x) < b
        errors.append(np.max(np.abs(gap[inside])) / (b**2 / (2.0 * radius)))
        assert np.all(np.diff(gap[x > 1.05 * b]) > 0.0)
    assert errors[0] < 2e-3
    assert errors[1] < errors[0] / 6.0


@pytest.mark.parametrize(
    ("first", "second"), [(0.0, 0.0), (1.0, 1.0001), (1.0, 1.0), (2.0, 7.0), (40.0, 3.0)]
)
def test_mean_fluidity_is_the_exact_mean_of_an_exponential(first, second):
    """Integral of exp(-e) from one to the other, over the way; its derivatives by differences."""

    def mean_of(first, second):
        return mean_fluidity(second - first, math.exp(-first), math.exp(-second))

    mean, by_first, by_second = mean_of(first, second)
    exact = quad(lambda s: math.exp(-(first + s * (second - first))), 0.0, 1.0, epsrel=1e-12)[0]
    assert mean == pytest.approx(exact, rel=1e-8)
    d = 1e-4
    for slope, a, b in ((by_first, d, 0.0), (by_second, 0.0, d)):
        difference = (mean_of(first + a, second + b)[0] - mean_of(first - a, second - b)[0]) / (2 * d)
        assert slope == pytest.approx(difference, rel=1e-6, abs=1e-9 * mean)


def state_of(nodes, velocity=1.5):
    """A loaded contact that moves, with film and pressure of no special relation to each other."""
    w = workspace(Mesh(nodes))
    scale = 1.5e-4
    p = 4e8 * np.maximum(1.0 - w.X**2, 0.0) ** 0.5 * (1.0 + 0.1 * np.sin(9.0 * w.X)) + 1e5 * np.exp(-(w.X**2))
    h = 5e-7 * (1.0 + 0.2 * np.cos(4.0 * w.X)) + scale**2 * np.maximum(w.X**2 - 1.0, 0.0) / 0.04
    return w, scale, p, h, Flow(velocity, 0.0, 0.02)


def balanced(w, scale, p, h, drive, fluid, old, step):
    """Residual, A and B; the rate of the grid's scale is that of a quickly growing contact."""
    residual, A, B = np.empty(p.size), np.empty((BAND, p.size)), np.empty((BAND, p.size))
    properties(p, h, fluid, w.nodes)
    balance(w.X, scale, 0.3, p, h, w.nodes, drive, fluid, old, step, residual, A, B)
    return residual, A, B


@pytest.mark.parametrize(("name", "velocity"), [*zip(LUBRICANTS, (1.5, -1.5, 1.5), strict=True)])
def test_derivatives_of_the_balance_are_its_differences(name, velocity):
    """A by pressure and B by film, element by element, against central differences."""
    fluid = LUBRICANTS[name]
    w, scale, p, h, drive = state_of(51, velocity)
    old = 0.9 * h * scale * 0.1
    _, A, B = balanced(w, scale, p, h, drive, fluid, old, 1e-5)
    for derivative, values, share in ((A, p, 1e-5), (B, h, 1e-6)):
        for j in range(1, 50):
            d = share * (values[j] + 0.01 * values.max())
            sides = []
            for sign in (1.0, -1.0):
                moved = values.copy()
                moved[j] += sign * d
                state = (moved, h) if values is p else (p, moved)
                sides.append(balanced(w, scale, *state, drive, fluid, old, 1e-5)[0])
            difference = (sides[0] - sides[1]) / (2.0 * d)
            for i in range(max(j - 2, 1), min(j + 3, 50)):
                scale_of = np.abs(derivative[:, i]).max()
                assert derivative[j - i + 2, i] == pytest.approx(difference[i], rel=1e-4, abs=1e-5 * scale_of)
            far = [i for i in range(51) if abs(i - j) > 2]
            assert np.all(difference[far] == 0.0)


def test_the_balance_conserves_mass():
    """Summed over all cells, what is left is inflow less outflow and storage: fluxes cancel between cells."""
    fluid = LUBRICANTS["roelands"]
    w, scale, p, h, drive = state_of(301)
    cells = 0.5 * scale * (w.X[2:] - w.X[:-2])
    properties(p, h, fluid, w.nodes)
    mass = w.nodes.mass[1:-1] * cells
    old = np.zeros(301)
    old[1:-1] = 0.7 * mass
    whole, _, _ = balanced(w, scale, p, h, drive, fluid, old, 1e-5)
    unchanged = np.zeros(301)
    unchanged[1:-1] = mass
    still, _, _ = balanced(w, scale, p, h, drive, fluid, unchanged, 1e-5)
    assert np.sum(whole) - np.sum(still) == pytest.approx(0.3 * np.sum(mass) / 1e-5, rel=1e-12)
    # At both ends of this grid, which grows faster than oil flows, oil enters, and is only carried.
    ends = [(0.5 * (w.X[0] + w.X[1]), w.nodes.mass[0]), (0.5 * (w.X[-2] + w.X[-1]), w.nodes.mass[-1])]
    inflow, outflow = ((drive.velocity - 0.3 * face) * upstream for face, upstream in ends)
    assert np.sum(still) == pytest.approx(outflow - inflow, rel=1e-9)


def loaded(nodes, sharpness, velocity):
    """Jacobian of a loaded contact, cavitated beyond its outlet and at the inlet's end; its workspace."""
    w = workspace(Mesh(nodes, sharpness=sharpness))
    fluid = LUBRICANTS["roelands"]
    scale = 1.5e-4
    p = 4e8 * np.maximum(1.0 - w.X**2, 0.0) ** 0.5 + 1e5 * np.exp(-(w.X**2))
    h = 5e-7 + scale**2 * np.maximum(w.X**2 - 1.0, 0.0) / 0.04
    _, A, B = balanced(w, scale, p, h, Flow(velocity, 0.0, 0.02), fluid, np.zeros(nodes), 1e-4)
    factor, offset = 2.0 * BODIES.compliance * scale / math.pi, math.log(BODIES.length / scale)
    fixed = np.where((w.X > 1.2) | (w.X < -9.9), 1.0, 0.0)
    fixed[[0, -1]] = 1.0
    return Jacobian(A, B, w.D, w.weight, factor, offset), fixed, w


def assembled(J, fixed):
    """The dense matrix."""
    nodes = fixed.size
    dense = np.zeros((nodes, nodes))
    for k in range(BAND):
        rows = np.arange(max(0, 2 - k), min(nodes, nodes + 2 - k))
        dense[rows] += J.factor * J.B[k, rows, None] * (J.D.T[rows + k - 2] + J.offset * J.weight)
        dense[rows, rows + k - 2] += J.A[k, rows]
    dense[fixed != 0.0] = np.eye(nodes)[fixed != 0.0]
    return dense


def errors_of_corrections(J, fixed, w):
    """Errors relative to numpy's solution after each correction of what is left, as Newton's method makes."""
    dense = assembled(J, fixed)
    right = np.random.default_rng(1).standard_normal(fixed.size) * np.abs(dense).max(axis=1)
    right[fixed != 0.0] = 0.0
    exact = np.linalg.solve(dense, right)
    x, errors = np.zeros(fixed.size), []
    for _ in range(3):
        left = (right - dense @ x)[None, :] * (fixed == 0.0)
        solve_corrected(J, fixed, w.hierarchy, w.exchange, left)
        x += left[0]
        errors.append(np.max(np.abs(x - exact)) / np.max(np.abs(exact)))
    return errors


def shrink(errors):
    """The Jacobian's condition makes a few per cent of COMPRESSION at worst; each correction of what is left
    shrinks the error as much again, down to rounding."""
    return all(after < 0.1 * before + 1e-9 for before, after in itertools.pairwise([1.0, *errors]))


@pytest.mark.parametrize(
    ("nodes", "sharpness", "velocity"), [(51, 0.0, 1.5), (151, 0.0, -1.5), (601, 128.0, 1.5)]
)
def test_hierarchical_factors_solve_as_dense_ones(nodes, sharpness, velocity):
    """Against numpy on the assembled Jacobian; also after nodes have changed sides: one comes to cavitate
    within the film, two beside it at its end no longer do, and one goes there and back."""
    J, fixed, w = loaded(nodes, sharpness, velocity)
    factorise_anew(J, fixed, w.hierarchy, w.exchange)
    assert shrink(errors_of_corrections(J, fixed, w))
    last = np.flatnonzero(fixed == 0.0)[-1]
    fixed[last - 1] = 1.0
    assert correct_factors(fixed, w.hierarchy, w.exchange)
    fixed[last - 1] = 0.0
    fixed[nodes // 2] = 1.0
    fixed[last + 1 : last + 3] = 0.0
    assert correct_factors(fixed, w.hierarchy, w.exchange)
    assert shrink(errors_of_corrections(J, fixed, w))


def test_factors_do_not_serve_after_many_changes_or_far_from_the_film():
    J, fixed, w = loaded(301, 0.0, 1.5)
    factorise_anew(J, fixed, w.hierarchy, w.exchange)
    last = np.flatnonzero(fixed == 0.0)[-1]
    for nodes, side in ((np.arange(last - EXCHANGES, last + 1), 1.0), (np.array([298]), 0.0)):
        changed = fixed.copy()
        changed[nodes] = side
        assert not correct_factors(changed, w.hierarchy, w.exchange)
