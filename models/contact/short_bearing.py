"""Short plain bearing: impedance and mobility of Ocvirk's film, with a cavitated half.

The centre of the journal is at e = c eps from that of the bush and moves with e'; the journal turns with
omega, the bush stands. The film is h = c - e.n in the direction n. In axes that turn with omega/2 the journal
squeezes the film and does nothing else (Booker 1965), with

    u = e' - omega/2 k x e

Oil flows out along the axis only (Ocvirk 1952), and has pressure on the half n.u > 0 of the circumference:

    p = 3/2 mu L^2 (1 - (2 z/L)^2) n.u/h^3

so that the force on the journal is -mu R L^3/c^3 A u, A = int n n^T/(h/c)^3 over this half. Childs, Moes and
van Leeuwen 1977 have it in closed form. It is half of the second derivatives of

    G(xi, zeta) = int (1 - xi cos - zeta sin)^-1 over the half = 2 B/kappa,
    kappa^2 = 1 - xi^2 - zeta^2,    tan B = -kappa/xi

with the components xi of eps along u and zeta across. The mobility is the inverse: the u under a given force.
"""

import math
from typing import NamedTuple

from ..compile.kernel import kernel

# Newton's steps for the direction of u end at this change (rad), or after so many.
CLOSE, STEPS = 1e-13, 80
# Bisections of a right angle for the place of the highest pressure, which is flat there.
HALVINGS = 30


class Squeeze(NamedTuple):
    """A velocity, or the force that it needs, along x and y."""

    x: float
    y: float


class Impedance(NamedTuple):
    """A in the axes of u, without unit: along u, across it, and between both."""

    along: float
    across: float
    mixed: float


class Search(NamedTuple):
    """For the angle of u from a force (rad): between which it is, where it is, and by how much it changed."""

    low: float
    high: float
    angle: float
    change: float


@kernel
def find_impedance(xi: float, zeta: float) -> Impedance:
    """int (cos^2, sin^2, sin cos)/(1 - xi cos - zeta sin)^3 over |angle| < pi/2, for xi^2 + zeta^2 < 1."""
    square = 1.0 - xi * xi - zeta * zeta
    kappa, side = math.sqrt(square), 1.0 - zeta * zeta
    angle = math.atan2(kappa, -xi) / (kappa * square * square)
    quotient = xi / (square * side)
    return Impedance(
        3.0 * xi / (square * square) + angle * (square + 3.0 * xi * xi),
        quotient * (1.0 + zeta * zeta * (3.0 / square + 2.0 / side)) + angle * (square + 3.0 * zeta * zeta),
        zeta * (2.0 + xi * xi / side) / (square * square) + 3.0 * angle * xi * zeta,
    )


@kernel
def find_force(squeeze: Squeeze, eps: Squeeze) -> Squeeze:
    """A u: what squeezes the film with u, over mu R L^3/c^3."""
    size = math.sqrt(squeeze.x**2 + squeeze.y**2)
    if size == 0.0:
        return Squeeze(0.0, 0.0)
    c, s = squeeze.x / size, squeeze.y / size
    k = find_impedance(c * eps.x + s * eps.y, c * eps.y - s * eps.x)
    return Squeeze(size * (c * k.along - s * k.mixed), size * (s * k.along + c * k.mixed))


@kernel
def turn_squeeze(search: Search, k: Impedance) -> Search:
    """Newton's step to the direction of u, or half of what is left where that leaves it.

    The force is the derivative of a convex potential, whose second derivative is A, so that it turns the same
    way as u.
    """
    ahead = search.angle + math.atan2(k.mixed, k.along)
    low, high = (search.low, search.angle) if ahead > 0.0 else (search.angle, search.high)
    angle = search.angle - ahead / ((k.along * k.across - k.mixed**2) / (k.along**2 + k.mixed**2))
    if not low <= angle <= high:
        angle = 0.5 * (low + high)
    return Search(low, high, angle, angle - search.angle)


@kernel
def find_squeeze(force: Squeeze, eps: Squeeze) -> Squeeze:
    """The u with A u = force, the inverse of `find_force` for |eps| < 1.

    It lies between the force and eps, at less than a right angle from the force.
    """
    size = math.sqrt(force.x**2 + force.y**2)
    if size == 0.0:
        return Squeeze(0.0, 0.0)
    c, s = force.x / size, force.y / size
    along, across = c * eps.x + s * eps.y, c * eps.y - s * eps.x
    low = -0.5 * math.pi if across > 0.0 else 0.0
    search = Search(low, low + 0.5 * math.pi, 0.0, 1.0)
    for _ in range(STEPS):
        cos, sin = math.cos(search.angle), math.sin(search.angle)
        k = find_impedance(cos * along + sin * across, cos * across - sin * along)
        search = turn_squeeze(search, k)
        if abs(search.change) <= CLOSE:
            break
    cos, sin = math.cos(search.angle), math.sin(search.angle)
    k = find_impedance(cos * along + sin * across, cos * across - sin * along)
    speed = size / math.sqrt(k.along**2 + k.mixed**2)
    return Squeeze(speed * (cos * c - sin * s), speed * (cos * s + sin * c))


@kernel
def highest_pressure(squeeze: Squeeze, eps: Squeeze) -> float:
    """The largest n.u/(h/c)^3 on the circumference: 3/2 mu L^2/c^3 of it is the pressure in the middle.

    It lies between u and the direction across it in which the film is thinner, where
    -sin (1 + 2 xi cos) + |zeta| (1 + 2 cos^2) falls through zero.
    """
    size = math.sqrt(squeeze.x**2 + squeeze.y**2)
    if size == 0.0:
        return 0.0
    c, s = squeeze.x / size, squeeze.y / size
    xi, zeta = c * eps.x + s * eps.y, abs(c * eps.y - s * eps.x)
    low, high = 0.0, 0.5 * math.pi
    for _ in range(HALVINGS):
        angle = 0.5 * (low + high)
        cos, sin = math.cos(angle), math.sin(angle)
        if zeta * (1.0 + 2.0 * cos * cos) > sin * (1.0 + 2.0 * xi * cos):
            low = angle
        else:
            high = angle
    cos, sin = math.cos(low), math.sin(low)
    # A step of Newton's method: by it the place, and with it the pressure's slope, has derivatives.
    rest = zeta * (1.0 + 2.0 * cos * cos) - sin * (1.0 + 2.0 * xi * cos)
    slope = 2.0 * xi * sin * sin - cos * (1.0 + 2.0 * xi * cos + 4.0 * zeta * sin)
    if abs(rest) < 1e-6 * abs(slope):
        cos, sin = math.cos(low - rest / slope), math.sin(low - rest / slope)
    return size * cos / (1.0 - xi * cos - zeta * sin) ** 3
