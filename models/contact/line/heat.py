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

from typing import Any, NamedTuple

from ...compile.kernel import kernel
from .newton import FilmProblem
from .reynolds import Nodes, cell
from .shear import SOLID_LAYERS, Heat, HeatLaws, depth

# Vectors of a column in Heat.columns: below, diagonal, above, right side, and the stress' answer.
BELOW, DIAGONAL, ABOVE, RIGHT, ANSWER = range(5)
COLUMNS = 5


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
def carried(
    flow: float, outward: float, near: int, far: int, behind: int, reach: float, back: float, i: int,
    r: int, rise: Any, column: Any,
) -> None:  # fmt: skip
    """What `flow` (W/(m K), ascending x) through a face carries into or out of node i.

    `outward`: +1 at the right face. Oil that comes in does so from near and far of it, by `reach`; what
    leaves has the node's temperature, by `back` less like that behind it.
    """
    out = flow * outward
    if out > 0.0:
        column[DIAGONAL, r] += out * back
        column[RIGHT, r] += out * back * rise[behind, r]
    else:
        column[DIAGONAL, r] -= out
        column[RIGHT, r] -= out * ((1.0 + reach) * rise[near, r] - reach * rise[far, r])


@kernel
def reach_of(X: Any, face: float, near: int, far: int) -> float:
    """How far beyond the near node the face is, in steps from the far one; 0 where there is none."""
    if far < 0 or far >= X.shape[0]:
        return 0.0
    return (face - X[near]) / (X[near] - X[far])


@kernel
def solve_column(i: int, heat: Heat) -> float:
    """New temperatures of a column; the largest change (K)."""
    c, rows = heat.columns, heat.rise.shape[1]
    layers = rows - 2 * SOLID_LAYERS
    for r in range(1, rows):
        factor = c[BELOW, r] / c[DIAGONAL, r - 1]
        c[DIAGONAL, r] -= factor * c[ABOVE, r - 1]
        c[RIGHT, r] -= factor * c[RIGHT, r - 1]
        c[ANSWER, r] -= factor * c[ANSWER, r - 1]
    for r in range(rows - 1, -1, -1):
        if r < rows - 1:
            c[RIGHT, r] -= c[ABOVE, r] * c[RIGHT, r + 1]
            c[ANSWER, r] -= c[ABOVE, r] * c[ANSWER, r + 1]
        c[RIGHT, r] /= c[DIAGONAL, r]
        c[ANSWER, r] /= c[DIAGONAL, r]
    plain, softer = 0.0, 1.0
    for k in range(layers):
        plain += heat.softening[i, k] * c[RIGHT, SOLID_LAYERS + k]
        softer += heat.softening[i, k] * c[ANSWER, SOLID_LAYERS + k]
    largest = 0.0
    for r in range(rows):
        c[RIGHT, r] -= c[ANSWER, r] * plain / softer
        largest = max(largest, abs(c[RIGHT, r] - heat.rise[i, r]))
    # Heat and stress that go with the new temperatures.
    fall = 0.0
    for k in range(layers):
        fall += heat.softening[i, k] * (c[RIGHT, SOLID_LAYERS + k] - heat.rise[i, SOLID_LAYERS + k])
    for k in range(layers):
        r = SOLID_LAYERS + k
        change = heat.growth[i, k] * (c[RIGHT, r] - heat.rise[i, r])
        heat.heating[i, k] += change - heat.response[i] * heat.heating[i, k] * fall
    heat.stress[i] *= 1.0 - (heat.response[i] - 1.0) * fall
    for r in range(rows):
        heat.rise[i, r] = c[RIGHT, r]
    return largest


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


@kernel
def carry_along(i: int, r: int, left: float, right: float, at: Faces, rise: Any, column: Any) -> None:
    """What flows (W/(m K)) through both faces carry."""
    far_left, far_right = max(i - 2, 0), min(i + 2, rise.shape[0] - 1)
    carried(left, -1.0, i - 1, far_left, i + 1, at.from_left, at.to_left, i, r, rise, column)
    carried(right, 1.0, i + 1, far_right, i - 1, at.from_right, at.to_right, i, r, rise, column)


@kernel
def fill_column(
    i: int, p: Any, h: Any, problem: FilmProblem, old: Any, rough: float, laws: HeatLaws, X: Any,
    nodes: Nodes, heat: Heat,
) -> None:  # fmt: skip
    """The equations of node i's temperatures; `rough` (W/m): heat of its asperities, half to either body."""
    c, rows = heat.columns, heat.rise.shape[1]
    layers = rows - 2 * SOLID_LAYERS
    width, per_time = problem.scale * cell(X, i), 1.0 / problem.time_step
    base_width = width - problem.scale_rate * problem.time_step * cell(X, i)
    at = find_faces(i, width, per_time, old, X, nodes)
    share = laws.capacity / layers
    grown = share * ((nodes.mass[i] * width - old[i]) * per_time - at.over)
    crossing, across = 0.0, 0.0
    for r in range(rows):
        k = r - SOLID_LAYERS
        in_film = 0 <= k < layers
        c[BELOW, r], c[DIAGONAL, r], c[ANSWER, r] = -across - 0.5 * crossing, across + 0.5 * crossing, 0.0
        c[RIGHT, r] = heat.base[i, r] * per_time
        if in_film:
            c[DIAGONAL, r] += share * old[i] * per_time
            left = at.q_left + at.m_left * 0.5 * (heat.speed[i - 1, k] + heat.speed[i, k])
            right = at.q_right + at.m_right * 0.5 * (heat.speed[i, k] + heat.speed[i + 1, k])
            carry_along(i, r, share * left, share * right, at, heat.rise, c)
            # What a layer has too much leaves it upwards; none of the last.
            crossing = crossing - grown - share * (right - left) if k < layers - 1 else 0.0
        else:
            one = capacity(r, layers, 0.0, 1.0, laws)
            c[DIAGONAL, r] += one * base_width * per_time
            half = 0.5 if r < SOLID_LAYERS else -0.5
            velocity = problem.drive.velocity + half * problem.drive.sliding
            left, right = velocity - problem.scale_rate * at.left, velocity - problem.scale_rate * at.right
            carry_along(i, r, one * left, one * right, at, heat.rise, c)
        if r < rows - 1:
            # Crossing oil has the mean temperature of both sides where conduction smooths that.
            across = width / (resistance(r, layers, h[i], laws) + resistance(r + 1, layers, h[i], laws))
            across = max(across, 0.5 * abs(crossing))
            c[DIAGONAL, r] += across - 0.5 * crossing
            c[ABOVE, r] = -across + 0.5 * crossing
    heat_layers(i, p, h, problem, at.passing, laws, X, heat)
    c[RIGHT, SOLID_LAYERS - 1] += 0.5 * rough
    c[RIGHT, SOLID_LAYERS + layers] += 0.5 * rough


@kernel
def heat_layers(
    i: int, p: Any, h: Any, problem: FilmProblem, passing: float, laws: HeatLaws, X: Any, heat: Heat
) -> None:
    """Heat of shear and compression in the film's rows of node i; mean velocity past the node (m/s)."""
    c, layers = heat.columns, heat.speed.shape[1]
    pressed = (p[i] - heat.pressure_base[i]) / problem.time_step
    gradient = (p[i + 1] - p[i - 1]) / (problem.scale * (X[i + 1] - X[i - 1])) if p[i] > 0.0 else 0.0
    volume = h[i] * problem.scale * cell(X, i) / layers
    fall = 0.0
    for k in range(layers):
        fall += heat.softening[i, k] * heat.rise[i, SOLID_LAYERS + k]
    for k in range(layers):
        r = SOLID_LAYERS + k
        answer, rise = heat.response[i] * heat.heating[i, k], heat.rise[i, r]
        c[DIAGONAL, r] -= heat.growth[i, k]
        c[ANSWER, r] = answer
        c[RIGHT, r] += heat.heating[i, k] - heat.growth[i, k] * rise + answer * fall
        changing = pressed + (passing + heat.speed[i, k]) * gradient
        c[RIGHT, r] += laws.expansion * (laws.thermal.temperature + rise) * changing * volume
