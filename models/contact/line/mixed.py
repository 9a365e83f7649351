"""Asperities inside the film: the bodies are deformed, and the load carried, by q = p + p_a.

The gap d of the mean planes of the rough surfaces is that of the deflected bodies; it may be negative. Where
asperities meet, they press with Greenwood and Tripp's p_a(d), and the oil has what room is left, a film of
the mean gap h = sigma (lambda Phi(lambda) + phi(lambda)), lambda = d/sigma (see `asperities`), which is never
zero. p obeys Reynolds' equation with h, p = 0 where it cavitates.

Unknown is q. With p = q - p_a(d), dp = dq - p_a' dd, and with h' = Phi the Jacobian A + B D of smooth bodies
becomes A + (B h' - A p_a') D, of the same form; cavitated nodes ask for q = p_a(d) in place of q = 0. So only
the row of a node that changes sides changes, and Newton's method stays quadratic.
"""

from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ..asperities import APART, below, find_separation, gap_at, mean_gap, pressure_under

# A cavitated node whose asperities press less than this share of the highest pressure counts as open: a
# thousandth of what Newton's method leaves.
OPEN_SHARE = 1e-9
# The sides of a node for the Jacobian: the balance, no pressure at all, or that of asperities alone; the
# balance where oil comes out of a cavity that keeps it, next to the node or one node before.
BALANCED, FREE, TOUCHING, FED, FED_BEFORE = 0.0, 1.0, 2.0, 3.0, 4.0
# An iteration may bring mean planes nearer by this many roughnesses: p_a then grows less than tenfold where
# it matters.
NEARER = 1.0


class Bodies(NamedTuple):
    """The elastic pair: compliance (1/Pa) as `hertz.elastic_compliance`, contact length (m), and of the rough
    surfaces sigma (m; 0: smooth), the scale of `asperities.pressure_scale` (Pa), and eta beta sigma."""

    compliance: float
    length: float
    roughness: float = 0.0
    asperity_scale: float = 0.0
    roughness_parameter: float = 0.0


class Mixed(NamedTuple):
    """Fields over the nodes: total pressure q (Pa) and that at the step's start, gap d of the mean planes
    (m), p_a (Pa), dp_a/dd (Pa/m), dh/dd, p - (q - p_a) (Pa) and the sides for the Jacobian."""

    total: Any
    total_start: Any
    gap: Any
    asperities: Any
    stiffness: Any
    opening: Any
    excess: Any
    sides: Any


@kernel
def touch(bodies: Bodies, m: Mixed, h: Any) -> None:
    """Mean gap h, asperities' pressure and both derivatives from the gap of the mean planes in m."""
    for i in range(h.shape[0]):
        separation = m.gap[i] / bodies.roughness
        m.asperities[i], m.stiffness[i], m.opening[i] = 0.0, 0.0, 1.0
        if separation >= APART:
            h[i] = m.gap[i]
            continue
        m.opening[i] = below(separation)
        h[i] = bodies.roughness * gap_at(separation, m.opening[i])
        pressed = pressure_under(h[i], bodies.roughness, bodies.asperity_scale)
        m.asperities[i] = pressed.pressure
        m.stiffness[i] = pressed.slope * m.opening[i]


@kernel
def fill_total(p: Any, h: Any, bodies: Bodies, q: Any) -> None:
    """q = p + p_a(h)."""
    for i in range(p.shape[0]):
        q[i] = p[i]
        if bodies.roughness > 0.0:
            q[i] += pressure_under(h[i], bodies.roughness, bodies.asperity_scale).pressure


@kernel
def film_of(gap: float, roughness: float) -> float:
    """The mean gap (m) of rough surfaces whose mean planes are `gap` (m) apart."""
    if gap >= APART * roughness:
        return gap
    return roughness * mean_gap(gap / roughness)


@kernel
def mean_plane_gap(film: float, roughness: float) -> float:
    """Its inverse: the gap of the mean planes (m) under a film (m)."""
    if film >= APART * roughness:
        return film
    return roughness * find_separation(film / roughness)


@kernel
def fluid_pressure(p: Any, fixed: Any, m: Mixed) -> None:
    """p from the total pressure: q - p_a, or 0 where it cavitates."""
    for i in range(p.shape[0]):
        p[i] = m.total[i] - m.asperities[i] if fixed[i] == 0.0 else 0.0


@kernel
def is_open(asperities: float, highest: float) -> bool:
    """A cavitated node counts as without pressure."""
    return asperities <= OPEN_SHARE * highest


@kernel
def is_balanced_side(side: float) -> bool:
    """The node has pressure, which follows from its balance."""
    return side != FREE and side != TOUCHING


@kernel
def fill_sides(p: Any, fixed: Any, highest: float, m: Mixed) -> None:
    """Sides, and how far p, which is not negative, is from q - p_a."""
    for i in range(p.shape[0]):
        m.sides[i] = fixed[i]
        if fixed[i] != 0.0 and 0 < i < p.shape[0] - 1 and not is_open(m.asperities[i], highest):
            m.sides[i] = TOUCHING
        m.excess[i] = 0.0 if m.sides[i] == FREE else p[i] - (m.total[i] - m.asperities[i])


@kernel
def couple_asperities(A: Any, B: Any, m: Mixed, right: Any) -> None:
    """A and B of the balance become those by q and d, `right` what is asked of the changes."""
    n = right.shape[0]
    for i in range(n):
        if m.sides[i] == FREE:
            continue
        if m.sides[i] == TOUCHING:
            for k in range(A.shape[0]):
                A[k, i], B[k, i] = 0.0, 0.0
            A[2, i], B[2, i] = 1.0, -m.stiffness[i]
            right[i] = m.excess[i]
            continue
        for k in range(A.shape[0]):
            j = i + k - 2
            if 0 <= j < n:
                right[i] += A[k, i] * m.excess[j]
                B[k, i] = B[k, i] * m.opening[j] - A[k, i] * m.stiffness[j]
