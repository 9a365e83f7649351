"""The energy equation of the film and of both bodies, on the volumes of `reynolds` cut into layers.

    rho c (dT/dt + u dT/dx + w dT/dz) = k d2T/dz2 + tau du/dz + epsilon T (dp/dt + u dp/dx)

and in the bodies, which pass with their own velocities, without sources: the flash temperature is what their
layers make of the film's heat. Bulk and entering oil have the temperature of the inlet. Heat is conducted
across only: along the film and the bodies it is carried (their Peclet numbers are large).

Implicit in time, with the base of any implicit method; second order upwind along, central across. Layers
exchange what the balance of mass of each leaves, so that heat is conserved to rounding; where the film
cavitates, oil that comes from nowhere comes with the temperature of its place. Along the film the columns are
solved one after the other, forth and back, as heat is carried both ways where bodies move against each other
and oil turns back in the inlet. In a column the heat that shear makes is linear in all its temperatures
(Newton's method, by Sherman's and Morrison's formula): cooler oil resists more, and all share one stress.
"""

import math
from typing import Any, NamedTuple

from ...compile.kernel import kernel
from .newton import FilmProblem
from .reynolds import Nodes, cell
from .shear import SOLID_LAYERS, Heat, HeatLaws, depth

# Vectors of a column in Heat.columns: elements of its matrix, right side, and the answer to the stress' heat;
# of bodies' rows heat capacity (J/(m2 K)) and conductance to the next row (W/(m2 K)).
BELOW, DIAGONAL, ABOVE, RIGHT, ANSWER, HELD, LINKED = range(7)


# Rises (K) below which changes are taken relative to this one.
COOL = 1.0


@kernel
def capacity(row: int, layers: int, mass: float, width: float, laws: HeatLaws) -> float:
    """Heat capacity (J/(m K)) of a row of a volume with so much oil (rho h times width, m2)."""
    if row < SOLID_LAYERS:
        return laws.capacity_1 * depth(SOLID_LAYERS - 1 - row) * width
    if row < SOLID_LAYERS + layers:
        return laws.capacity * mass / layers
    return laws.capacity_2 * depth(row - SOLID_LAYERS - layers) * width


@kernel
def store(X: Any, scale: float, mass: Any, rise: Any, weight: float, laws: HeatLaws, energy: Any) -> None:
    """energy (J/m) becomes (1 - weight) times itself plus weight times the heat of such temperatures."""
    n, rows = rise.shape
    for i in range(1, n - 1):
        for r in range(rows):
            held = capacity(r, rows - 2 * SOLID_LAYERS, mass[i], scale * cell(X, i), laws) * rise[i, r]
            energy[i, r] = weight * held + (1.0 - weight) * energy[i, r]


@kernel
def resistance(row: int, layers: int, film: float, laws: HeatLaws) -> float:
    """From the middle of a row to its edge (m2 K/W)."""
    if row < SOLID_LAYERS:
        return 0.5 * depth(SOLID_LAYERS - 1 - row) / laws.conductivity_1
    if row < SOLID_LAYERS + layers:
        return 0.5 * film / (layers * laws.conductivity)
    return 0.5 * depth(row - SOLID_LAYERS - layers) / laws.conductivity_2


@kernel
def fill_bodies(layers: int, laws: HeatLaws, column: Any) -> None:
    """What rows of the bodies are in every column."""
    for r in range(column.shape[1]):
        column[HELD, r], column[LINKED, r] = capacity(r, layers, 0.0, 1.0, laws), 0.0
    for first in (0, SOLID_LAYERS + layers):
        for r in range(first, first + SOLID_LAYERS - 1):
            column[LINKED, r] = 1.0 / (
                resistance(r, layers, 0.0, laws) + resistance(r + 1, layers, 0.0, laws)
            )


@kernel
def reach_of(X: Any, face: float, near: int, far: int) -> float:
    """How far beyond the near node the face is, in steps from the far one; 0 where there is none."""
    if far < 0 or far >= X.shape[0]:
        return 0.0
    return (face - X[near]) / (X[near] - X[far])


@kernel
def solve_column(
    c: Any, rise: Any, softening: Any, heating: Any, growth: Any, response: float
) -> tuple[float, float, float]:
    """New temperatures of a column, with their heat; the largest change and the largest rise (K), and the
    stress' factor.

    The bodies are eliminated from their depth, the film from body 1; the diagonal becomes its inverse.
    """
    rows = rise.shape[0]
    first, last = SOLID_LAYERS, rows - SOLID_LAYERS - 1
    below, diagonal, above, right, answer = c[BELOW], c[DIAGONAL], c[ABOVE], c[RIGHT], c[ANSWER]
    diagonal[0], diagonal[rows - 1] = 1.0 / diagonal[0], 1.0 / diagonal[rows - 1]
    for j in range(1, SOLID_LAYERS):
        r = rows - 1 - j
        one, other = below[j] * diagonal[j - 1], above[r] * diagonal[r + 1]
        right[j] -= one * right[j - 1]
        right[r] -= other * right[r + 1]
        diagonal[j] = 1.0 / (diagonal[j] - one * above[j - 1])
        diagonal[r] = 1.0 / (diagonal[r] - other * below[r + 1])
    one, other = below[first] * diagonal[first - 1], above[last] * diagonal[last + 1]
    right[first] -= one * right[first - 1]
    right[last] -= other * right[last + 1]
    diagonal[last] -= other * below[last + 1]
    diagonal[first] = 1.0 / (diagonal[first] - one * above[first - 1])
    for r in range(first + 1, last + 1):
        one = below[r] * diagonal[r - 1]
        right[r] -= one * right[r - 1]
        answer[r] -= one * answer[r - 1]
        diagonal[r] = 1.0 / (diagonal[r] - one * above[r - 1])
    plain, softer, after, after_answer = 0.0, 1.0, 0.0, 0.0
    for r in range(last, first - 1, -1):
        after = (right[r] - above[r] * after) * diagonal[r] if r < last else right[r] * diagonal[r]
        after_answer = (
            (answer[r] - above[r] * after_answer) * diagonal[r] if r < last else answer[r] * diagonal[r]
        )
        right[r], answer[r] = after, after_answer
        plain += softening[r - first] * after
        softer += softening[r - first] * after_answer
    plain /= softer
    # Heat and stress that go with the new temperatures.
    fall = 0.0
    for k in range(softening.shape[0]):
        right[first + k] -= answer[first + k] * plain
        fall += softening[k] * (right[first + k] - rise[first + k])
    for k in range(softening.shape[0]):
        change = growth[k] * (right[first + k] - rise[first + k])
        heating[k] += change - response * heating[k] * fall
    for j in range(SOLID_LAYERS - 1, -1, -1):
        r = rows - 1 - j
        right[j] = (right[j] - above[j] * right[j + 1]) * diagonal[j]
        right[r] = (right[r] - below[r] * right[r - 1]) * diagonal[r]
    largest, highest = 0.0, 0.0
    for r in range(rows):
        largest = max(largest, abs(right[r] - rise[r]))
        highest = max(highest, abs(right[r]))
        rise[r] = right[r]
    # A sum, as the larger of a number and nan is the number.
    return largest + 0.0 * plain, highest, 1.0 - (response - 1.0) * fall


class Faces(NamedTuple):
    """Of a volume: positions of its faces in X, how far they are beyond the nodes from which oil comes, and
    farther nodes; mean flows (m2/s) and masses (m) at the faces of the film's, what is left of its balance
    (m2/s), and capacity flow over capacity (m/s)."""

    left: float
    right: float
    from_left: float
    to_left: float
    from_right: float
    to_right: float
    q_left: float
    q_right: float
    m_left: float
    m_right: float
    over: float
    passing: float


@kernel
def find_faces(i: int, width: float, per_time: float, old: Any, X: Any, nodes: Any) -> Faces:
    """Those of node i, whose volume is so wide (m)."""
    left, right = 0.5 * (X[i - 1] + X[i]), 0.5 * (X[i] + X[i + 1])
    q_left, q_right = nodes.through[i - 1], nodes.through[i]
    return Faces(
        left, right, reach_of(X, left, i - 1, i - 2), reach_of(X, left, i, i + 1),
        reach_of(X, right, i + 1, i + 2), reach_of(X, right, i, i - 1),
        q_left, q_right, 0.5 * (nodes.mass[i - 1] + nodes.mass[i]), 0.5 * (nodes.mass[i] + nodes.mass[i + 1]),
        (nodes.mass[i] * width - old[i]) * per_time + q_right - q_left,
        0.5 * (q_left + q_right) / nodes.mass[i],
    )  # fmt: skip


class Come(NamedTuple):
    """What flows of both faces bring from the nodes beside (m2/s), less what they bring from those beyond."""

    left: float
    far_left: float
    right: float
    far_right: float


@kernel
def carry(left: float, right: float, at: Faces) -> Come:
    """Of flows through both faces (m2/s, ascending x).

    Oil that comes in does so from the node next to the face and that beyond it; what leaves has the node's
    temperature, more by as much as it exceeds that of the node it came from.
    """
    gone_right, come_right = max(right, 0.0), max(-right, 0.0)
    gone_left, come_left = max(-left, 0.0), max(left, 0.0)
    return Come(
        gone_right * at.to_right + come_left * (1.0 + at.from_left), come_left * at.from_left,
        gone_left * at.to_left + come_right * (1.0 + at.from_right), come_right * at.from_right,
    )  # fmt: skip


@kernel
def fill_body(
    i: int, first: int, kept: float, width: float, per_time: float, come: Come, c: Any, base: Any, rise: Any
) -> None:
    """The equations of one body's rows at node i, without what they exchange with the film; `kept` (m2/s):
    width of the volume before over the time."""
    end, n = first + SOLID_LAYERS, rise.shape[0]
    kept += come.left + come.right - come.far_left - come.far_right
    held, linked = c[HELD, first:end], c[LINKED, first:end]
    below, diagonal = c[BELOW, first:end], c[DIAGONAL, first:end]
    above, right, stored = c[ABOVE, first:end], c[RIGHT, first:end], base[i, first:end]
    T_left, T_right = rise[i - 1, first:end], rise[i + 1, first:end]
    T_far_left, T_far_right = rise[max(i - 2, 0), first:end], rise[min(i + 2, n - 1), first:end]
    before = 0.0
    for j in range(SOLID_LAYERS):
        after = linked[j] * width
        below[j], above[j] = -before, -after
        diagonal[j] = held[j] * kept + before + after
        before = after
    for j in range(SOLID_LAYERS):
        right[j] = stored[j] * per_time + held[j] * (
            come.left * T_left[j] - come.far_left * T_far_left[j]
            + come.right * T_right[j] - come.far_right * T_far_right[j]
        )  # fmt: skip


@kernel
def fill_layers(
    i: int, held: float, grown: float, share: float, inner: float, per_time: float, at: Faces, c: Any,
    base: Any, rise: Any, speed: Any,
) -> None:  # fmt: skip
    """The equations of the film's rows at node i, without their heat and what they exchange with the bodies.

    `held`, `grown` (W/(m K)): heat capacity of a layer before over the time, and its growth; `inner`:
    conductance between layers; `share` (J/(m3 K)) of the oil's heat capacity.
    """
    layers, n = speed.shape[1], rise.shape[0]
    first, end = SOLID_LAYERS, SOLID_LAYERS + layers
    below, diagonal, above = c[BELOW, first:end], c[DIAGONAL, first:end], c[ABOVE, first:end]
    right, stored = c[RIGHT, first:end], base[i, first:end]
    T_left, T_right = rise[i - 1, first:end], rise[i + 1, first:end]
    T_far_left, T_far_right = rise[max(i - 2, 0), first:end], rise[min(i + 2, n - 1), first:end]
    v_left, v, v_right = speed[i - 1], speed[i], speed[i + 1]
    crossing, across = 0.0, 0.0
    for k in range(layers):
        q_left = at.q_left + at.m_left * 0.5 * (v_left[k] + v[k])
        q_right = at.q_right + at.m_right * 0.5 * (v[k] + v_right[k])
        come = carry(q_left, q_right, at)
        right[k] = stored[k] * per_time + share * (
            come.left * T_left[k] - come.far_left * T_far_left[k]
            + come.right * T_right[k] - come.far_right * T_far_right[k]
        )  # fmt: skip
        below[k] = -across - 0.5 * crossing
        diagonal[k] = held + share * (come.left + come.right - come.far_left - come.far_right)
        diagonal[k] += across + 0.5 * crossing
        # What a layer has too much leaves it upwards. Crossing oil has the mean temperature of both sides
        # where conduction smooths that.
        crossing = crossing - grown - share * (q_right - q_left)
        across = max(inner, 0.5 * abs(crossing))
        if k == layers - 1:
            crossing, across = 0.0, 0.0
        diagonal[k] += across - 0.5 * crossing
        above[k] = -across + 0.5 * crossing


@kernel
def heat_layers(
    c: Any, rise: Any, softening: Any, heating: Any, growth: Any, speed: Any, response: float,
    temperature: float, volume: float, pressed: float, gradient: float, passing: float,
) -> None:  # fmt: skip
    """Heat of shear and compression in the film's rows of a node; `volume` (m2) of a layer times the oil's
    expansion, mean velocity past the node (m/s), the pressure's rate and gradient."""
    first, end = SOLID_LAYERS, SOLID_LAYERS + softening.shape[0]
    diagonal, right, answer = c[DIAGONAL, first:end], c[RIGHT, first:end], c[ANSWER, first:end]
    T = rise[first:end]
    fall = 0.0
    for k in range(softening.shape[0]):
        fall += softening[k] * T[k]
    for k in range(softening.shape[0]):
        answer[k] = response * heating[k]
        hot = (temperature + T[k]) * volume * (pressed + (passing + speed[k]) * gradient)
        diagonal[k] -= growth[k]
        right[k] += heating[k] - growth[k] * T[k] + answer[k] * fall + hot


@kernel
def exchange(c: Any, film: int, body: int, link: float) -> None:
    """Conduction (W/(m K)) between the surface's rows of film and body."""
    to_film, to_body = (BELOW, ABOVE) if body < film else (ABOVE, BELOW)
    c[to_film, film], c[to_body, body] = -link, -link
    c[DIAGONAL, film] += link
    c[DIAGONAL, body] += link


@kernel
def warm(
    p: Any,
    h: Any,
    problem: FilmProblem,
    old: Any,
    laws: HeatLaws,
    X: Any,
    nodes: Nodes,
    heat: Heat,
    step: int,
) -> float:
    """Temperatures after the time step under p and h, along the film (step = 1) or back (-1); the largest
    change over the highest rise.

    nan where a temperature is not finite.
    """
    c, n, layers = heat.columns, p.shape[0], heat.speed.shape[1]
    rise, base, end = heat.rise, heat.base, SOLID_LAYERS + layers
    largest, highest, total = 0.0, COOL, 0.0
    drive, scale_rate, per_time = problem.drive, problem.scale_rate, 1.0 / problem.time_step
    share = laws.capacity / layers
    fill_bodies(layers, laws, c)
    for k in range(1, n - 1):
        i = k if step > 0 else n - 1 - k
        width = problem.scale * cell(X, i)
        at = find_faces(i, width, per_time, old, X, nodes)
        kept = width * per_time - scale_rate * cell(X, i)
        for body in range(2):
            velocity = drive.velocity + (0.5 - body) * drive.sliding
            come = carry(velocity - scale_rate * at.left, velocity - scale_rate * at.right, at)
            fill_body(i, body * end, kept, width, per_time, come, c, base, rise)
        held = share * old[i] * per_time
        grown = share * ((nodes.mass[i] * width - old[i]) * per_time - at.over)
        inner = width * layers * laws.conductivity / h[i]
        fill_layers(i, held, grown, share, inner, per_time, at, c, base, rise, heat.speed)
        gradient = (p[i + 1] - p[i - 1]) / (problem.scale * (X[i + 1] - X[i - 1])) if p[i] > 0.0 else 0.0
        heat_layers(
            c, rise[i], heat.softening[i], heat.heating[i], heat.growth[i], heat.speed[i], heat.response[i],
            laws.thermal.temperature, laws.expansion * h[i] * width / layers,
            (p[i] - heat.pressure_base[i]) * per_time, gradient, at.passing,
        )  # fmt: skip
        half = resistance(SOLID_LAYERS, layers, h[i], laws)
        exchange(
            c,
            SOLID_LAYERS,
            SOLID_LAYERS - 1,
            width / (resistance(SOLID_LAYERS - 1, layers, 0.0, laws) + half),
        )
        exchange(c, end - 1, end, width / (resistance(end, layers, 0.0, laws) + half))
        c[RIGHT, SOLID_LAYERS - 1] += 0.5 * heat.rough[i]
        c[RIGHT, end] += 0.5 * heat.rough[i]
        changed, hottest, weaker = solve_column(
            c, rise[i], heat.softening[i], heat.heating[i], heat.growth[i], heat.response[i]
        )
        heat.stress[i] *= weaker
        largest, highest, total = max(largest, changed), max(highest, hottest), total + changed
    return largest / highest if math.isfinite(total) else math.nan
