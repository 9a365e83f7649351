"""Plain bearing with two axial grooves opposite to each other: mobility of the films on its two pads.

Grooves hold p = 0, so that each of the pads between them has a film of its own. With y = z/R, the film h and
a squeeze u as in `short_bearing`, Reynolds' equation over an angle t is that of `analysis.bearing`,

    d/dt(h^3 dp/dt) + h^3 d2p/dy2 >= -12 n.u,    p >= 0

As h depends on t alone, axial modes of the pressure part it into ordinary equations, for a source n.u:

    P' = M/h^3,    M' = (kappa D/L)^2 h^3 P - n.u

kappa and the weights of the modes' mean pressures are Galerkin's for (1 - Y^2) (1, Y^2) over Y = 2 z/L. Each
mode ends where its own P and M vanish: that is exact in a narrow film, in a wide one and where a pad is full,
and between these the only approximation. It keeps the force the gradient of a convex function of u.

From a groove on, P = R M + Q (Riccati). A film that ended at t would have the flux -m there, m = Q/R, and its
dissipation grows by m^2/h^3 with the place of the end (Hadamard), which is free where m.u = 0. So the
impedance of `short_bearing` needs no pressure:

    A = 3 (D/L)^2 sum weight int m m^T/h^3 dt    from a groove to the free end or to the other groove

Steps are Magnus' of fourth order (Iserles and Norsett 1999) between even places tau, which are closer to each
other at the thin place: tan(t/2) = (1 - eps)^1/4 tan(tau/2).
"""

import math
from typing import NamedTuple

from ..compile.kernel import kernel
from .finite_bearing import find_finite_squeeze
from .short_bearing import Impedance, Search, Squeeze, turn_squeeze

# Of the axial modes: kappa^2, and the weight of the mean pressure.
_ROOT = math.sqrt(133.0)
SQUARES = 14.0 - _ROOT, 14.0 + _ROOT
WEIGHTS = 7.0 / 15.0 + 119.0 / (30.0 * _ROOT), 7.0 / 15.0 - 119.0 / (30.0 * _ROOT)
# Along each pad.
CELLS = 32
# Steps for the direction of u end at this change (rad), or after so many; so do those for an end in a cell.
CLOSE, NEAR, STEPS = 1e-12, 3e-5, 60
GAUSS, TURN = 0.5 - math.sqrt(3.0) / 6.0, math.sqrt(3.0) / 12.0


class Grooves(NamedTuple):
    """L/D up to 1, the angle of a groove's middle from x, and the width of both (rad)."""

    ratio: float
    angle: float
    width: float


class Journal(NamedTuple):
    """eps, (1 - eps)^1/4, angle of the thin place; cosine and sine of the direction of u from there."""

    eps: float
    near: float
    angle: float
    cos: float
    sin: float


class Pad(NamedTuple):
    """As `Journal`, with a tau to begin at and a length; the sweep's share in the whole, 0 where no film
    begins."""

    eps: float
    near: float
    begin: float
    length: float
    cos: float
    sin: float
    share: float


class Point(NamedTuple):
    """By dtau: dt/h^3, h^3 dt, n.u dt, and n.v dt for v at a right angle to u."""

    ease: float
    hold: float
    along: float
    across: float


class Cell(NamedTuple):
    """From tau on, of a length: its ends, and the two places of Gauss between."""

    tau: float
    length: float
    low: Point
    one: Point
    two: Point
    high: Point


class Step(NamedTuple):
    """Magnus' exponent ((d, b), (c, -d)) of (P, M) over its determinant, and what becomes of R and 1/R, and
    shrinks Q."""

    b: float
    c: float
    d: float
    r: float
    stiff: float
    shrink: float


class Cubic(NamedTuple):
    """m over a cell, from 0 to 1."""

    value: float
    slope: float
    square: float
    cube: float


class Mode(NamedTuple):
    """At a place: R, 1/R, m for u and v, and the impedance up to there. The film has ended where m.u <= 0."""

    r: float
    stiff: float
    along: float
    across: float
    impedance: Impedance


@kernel
def has_ended(mode: Mode) -> bool:
    return mode.r > 0.0 and mode.along <= 0.0


@kernel
def point(angle: float) -> Squeeze:
    return Squeeze(math.cos(angle), math.sin(angle))


@kernel
def turn(at: Squeeze, by: Squeeze) -> Squeeze:
    return Squeeze(at.x * by.x - at.y * by.y, at.x * by.y + at.y * by.x)


@kernel
def see_film(at: Squeeze, pad: Pad) -> Point:
    """At cosine and sine of tau."""
    c, s, near = at.x, at.y, pad.near * pad.near * (1.0 - at.x)
    part = 1.0 / (1.0 + c + near)
    rate = 2.0 * pad.near * part
    cos, sin = (1.0 + c - near) * part, rate * s
    h = 1.0 - pad.eps + 2.0 * pad.eps * near * part
    along, across = cos * pad.cos + sin * pad.sin, sin * pad.cos - cos * pad.sin
    cube = h * h * h
    return Point(rate / cube, rate * cube, rate * along, rate * across)


@kernel
def find_step(r: float, hardness: float, cell: Cell) -> Step:
    """hardness = (kappa D/L)^2."""
    one, two, step = cell.one, cell.two, cell.length
    b = 0.5 * step * (one.ease + two.ease)
    c = 0.5 * step * hardness * (one.hold + two.hold)
    d = TURN * step * step * hardness * (two.ease * one.hold - one.ease * two.hold)
    square = d * d + b * c
    size = math.sqrt(square)
    small = math.exp(-size)
    cosh, sinh = size * (1.0 + small * small), 1.0 - small * small
    whole = 1.0 / (cosh + sinh * (c * r - d))
    after, part = (cosh * r + sinh * (d * r + b)) * whole, 1.0 / square
    return Step(b * part, c * part, d * part, after, 1.0 / after, 2.0 * small * size * whole)


@kernel
def carry(m: float, r: float, by: Step, one: float, two: float, cell: Cell) -> float:
    """m at the end of a cell, with the sources at its two places, by the step's fixed point (p, flux)."""
    step = cell.length
    pull = TURN * step * step * (cell.one.ease * two - cell.two.ease * one)
    push = 0.5 * step * (one + two)
    p, flux = by.b * push - by.d * pull, -(by.c * pull + by.d * push)
    return ((r * (m + flux) - p) * by.shrink + p) * by.stiff - flux


@kernel
def bend(
    m: tuple[float, float], stiff: tuple[float, float], sources: tuple[float, float], cell: Cell
) -> Cubic:
    """Hermite's, with m' = n.u - m/(h^3 R), of which the groove has half of n.u; stiff = 1/R, there 0."""
    rise = sources[0] - m[0] * cell.low.ease * stiff[0] if stiff[0] > 0.0 else 0.5 * sources[0]
    rise, end = cell.length * rise, cell.length * (sources[1] - m[1] * cell.high.ease * stiff[1])
    more = m[1] - m[0]
    return Cubic(m[0], rise, 3.0 * more - 2.0 * rise - end, rise + end - 2.0 * more)


@kernel
def evaluate(m: Cubic, x: float) -> float:
    return m.value + x * (m.slope + x * (m.square + x * m.cube))


@kernel
def find_end(m: Cubic) -> float:
    """Where m, positive at first and not at 1, vanishes."""
    low, high, x = 0.0, 1.0, 0.5
    for _ in range(STEPS):
        value = evaluate(m, x)
        if value > 0.0:
            low = x
        else:
            high = x
        before, x = x, x - value / (m.slope + x * (2.0 * m.square + 3.0 * x * m.cube))
        if not low <= x <= high:
            x = 0.5 * (low + high)
        if abs(x - before) <= CLOSE:
            break
    return x


@kernel
def advance(at: Mode, hardness: float, cell: Cell, pad: Pad) -> Mode:
    """Over a cell, or to the end of the film in it: int m m^T/h^3 at two places of Gauss."""
    if has_ended(at):
        return at
    by = find_step(at.r, hardness, cell)
    one, two, stiff = cell.one, cell.two, (at.stiff, by.stiff)
    along = carry(at.along, at.r, by, one.along, two.along, cell)
    across = carry(at.across, at.r, by, one.across, two.across, cell)
    u = bend((at.along, along), stiff, (cell.low.along, cell.high.along), cell)
    v = bend((at.across, across), stiff, (cell.low.across, cell.high.across), cell)
    part = 1.0
    if along <= 0.0:
        part = find_end(u)
        one = see_film(point(cell.tau + part * GAUSS * cell.length), pad)
        two = see_film(point(cell.tau + part * (1.0 - GAUSS) * cell.length), pad)
    u_one, u_two = evaluate(u, part * GAUSS), evaluate(u, part * (1.0 - GAUSS))
    v_one, v_two = evaluate(v, part * GAUSS), evaluate(v, part * (1.0 - GAUSS))
    a, b = 0.5 * part * cell.length * one.ease, 0.5 * part * cell.length * two.ease
    total = Impedance(
        at.impedance.along + a * u_one * u_one + b * u_two * u_two,
        at.impedance.across + a * v_one * v_one + b * v_two * v_two,
        at.impedance.mixed + a * u_one * v_one + b * u_two * v_two,
    )
    return Mode(by.r, by.stiff, along, across, total)


@kernel
def add(total: Impedance, k: Impedance, share: float) -> Impedance:
    along, across = total.along + share * k.along, total.across + share * k.across
    return Impedance(along, across, total.mixed + share * k.mixed)


@kernel
def sweep(pad: Pad, ratio: float) -> Impedance:
    """Of a pad whose film begins at its first groove."""
    dry = Impedance(0.0, 0.0, 0.0)
    first, second = Mode(0.0, 0.0, 0.0, 0.0, dry), Mode(0.0, 0.0, 0.0, 0.0, dry)
    step, at = pad.length / CELLS, point(pad.begin)
    high, whole = see_film(at, pad), point(step)
    nearer, farther = point(GAUSS * step), point((1.0 - GAUSS) * step)
    for i in range(CELLS):
        low, one, two = high, see_film(turn(at, nearer), pad), see_film(turn(at, farther), pad)
        at = turn(at, whole)
        high = see_film(at, pad)
        cell = Cell(pad.begin + i * step, step, low, one, two, high)
        first = advance(first, SQUARES[0] / ratio**2, cell, pad)
        second = advance(second, SQUARES[1] / ratio**2, cell, pad)
        if has_ended(first) and has_ended(second):
            break
    total = add(dry, first.impedance, 3.0 * WEIGHTS[0] / ratio**2)
    return add(total, second.impedance, 3.0 * WEIGHTS[1] / ratio**2)


@kernel
def find_tau(angle: float, near: float) -> float:
    turns = 2.0 * math.pi * math.floor(0.5 * angle / math.pi + 0.5)
    half = 0.5 * (angle - turns)
    return turns + 2.0 * math.atan2(math.sin(half), near * math.cos(half))


@kernel
def find_journal(u: Squeeze, eps: Squeeze) -> Journal:
    """For a unit squeeze u."""
    far = math.sqrt(eps.x**2 + eps.y**2)
    c, s = (eps.x / far, eps.y / far) if far > 0.0 else (1.0, 0.0)
    near = math.sqrt(math.sqrt(1.0 - far))
    return Journal(far, near, math.atan2(s, c), c * u.x + s * u.y, c * u.y - s * u.x)


@kernel
def find_pad(i: int, journal: Journal, grooves: Grooves) -> Pad:
    """Of the four edges of grooves; those before a groove in a mirror.

    A full film is swept from both its ends, so that nothing jumps where it leaves one of them.
    """
    cos, side = journal.cos, 1.0 - 2.0 * (i % 2)
    sin = side * journal.sin
    begin = side * (grooves.angle + math.pi * (i // 2) - journal.angle) + 0.5 * grooves.width
    end = begin + math.pi - grooves.width
    low = max(cos * math.cos(begin) + sin * math.sin(begin), 0.0) ** 2
    if low == 0.0:
        return Pad(journal.eps, journal.near, 0.0, 0.0, cos, sin, 0.0)
    high = max(cos * math.cos(end) + sin * math.sin(end), 0.0) ** 2
    tau = find_tau(begin, journal.near)
    length = find_tau(end, journal.near) - tau
    return Pad(journal.eps, journal.near, tau, length, cos, sin, low / (low + high))


@kernel
def find_grooved_impedance(u: Squeeze, eps: Squeeze, grooves: Grooves) -> Impedance:
    """A for a unit squeeze u, in its axes."""
    journal, total = find_journal(u, eps), Impedance(0.0, 0.0, 0.0)
    for i in range(4):
        pad = find_pad(i, journal, grooves)
        if pad.share > 0.0:
            k = sweep(pad, grooves.ratio)
            total = add(total, Impedance(k.along, k.across, (1.0 - 2.0 * (i % 2)) * k.mixed), pad.share)
    return total


@kernel
def find_grooved_squeeze(force: Squeeze, eps: Squeeze, grooves: Grooves) -> Squeeze:
    """The squeeze u under a force over mu R L^3/c^3, as `find_squeeze`, for |eps| < 1."""
    size = math.sqrt(force.x**2 + force.y**2)
    if size == 0.0:
        return Squeeze(0.0, 0.0)
    toward = Squeeze(force.x / size, force.y / size)
    plain = find_finite_squeeze(force, eps, grooves.ratio)
    near = math.atan2(toward.x * plain.y - toward.y * plain.x, toward.x * plain.x + toward.y * plain.y)
    search = Search(-0.5 * math.pi, 0.5 * math.pi, near, 1.0)
    k, u = Impedance(1.0, 1.0, 0.0), toward
    for _ in range(STEPS):
        u = turn(toward, point(search.angle))
        k = find_grooved_impedance(u, eps, grooves)
        search = turn_squeeze(search, k)
        if abs(search.change) <= NEAR:
            break
    # A^-1 F: to the square of the last change.
    along, across = u.x * force.x + u.y * force.y, u.x * force.y - u.y * force.x
    found = Squeeze(k.across * along - k.mixed * across, k.along * across - k.mixed * along)
    scale = k.along * k.across - k.mixed**2
    return turn(u, Squeeze(found.x / scale, found.y / scale))
