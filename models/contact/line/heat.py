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
`build_bodies` divides the bodies' rows once for an implicit step, `build_columns` the film's once for what is
known of it; each way through them then costs what its right sides do.
"""

from typing import Any, NamedTuple

from ...compile.kernel import inlined, kernel, uncounted
from .newton import FilmProblem
from .reynolds import Nodes, cell
from .shear import SOLID_LAYERS, Columns, Heat, HeatLaws, depth

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


@uncounted
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


@inlined
def reach_of(X: Any, face: float, near: int, far: int) -> float:
    """How far beyond the near node the face is, in steps from the far one; 0 where there is none."""
    if far < 0 or far >= X.shape[0]:
        return 0.0
    return (face - X[near]) / (X[near] - X[far])


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


@inlined
def find_faces(i: int, width: float, per_time: float, old: Any, X: Any, nodes: Any) -> Faces:
    """Those of node i, whose volume is so wide (m)."""
    left, right = 0.5 * (X[i - 1] + X[i]), 0.5 * (X[i] + X[i + 1])
    q_left, q_right = nodes.through[i - 1], nodes.through[i]
    return Faces(
        left, right, reach_of(X, left, i - 1, i - 2), reach_of(X, left, i, i + 1),
        reach_of(X, right, i + 1, i + 2), reach_of(X, right, i, i - 1),
        q_left, q_right, 0.5 * (nodes.mass[i - 1] + nodes.mass[i]), 0.5 * (nodes.mass[i] + nodes.mass[i + 1]),
        (nodes.mass[i] * width - old[i]) * per_time + q_right - q_left,
        0.5 * (q_left + q_right) / nodes.mass[i] if nodes.mass[i] > 0.0 else 0.0,
    )  # fmt: skip


@inlined
def carry(left: float, right: float, at: Faces, come: Any) -> float:
    """What flows through both faces (m2/s, ascending x) bring from the nodes beside and from those beyond,
    from the left to the right; their sum.

    Oil that comes in does so from the node next to the face and that beyond it; what leaves has the node's
    temperature, more by as much as it exceeds that of the node it came from.
    """
    gone_right, come_right = max(right, 0.0), max(-right, 0.0)
    gone_left, come_left = max(-left, 0.0), max(left, 0.0)
    come[0], come[3] = -come_left * at.from_left, -come_right * at.from_right
    come[1] = gone_right * at.to_right + come_left * (1.0 + at.from_left)
    come[2] = gone_left * at.to_left + come_right * (1.0 + at.from_right)
    return float(come[0] + come[1] + come[2] + come[3])


@kernel
def fill_constants(layers: int, laws: HeatLaws, c: Columns) -> None:
    """Of the bodies' rows: capacity (J/(m2 K)), and conductance to the next row towards the film (W/(m2 K)),
    or of the surfaces' rows their resistance to the surface (m2 K/W)."""
    rows = c.held.shape[0]
    for j in range(SOLID_LAYERS):
        for body in range(2):
            r, step = (rows - 1 - j, -1) if body == 1 else (j, 1)
            own = resistance(r, layers, 0.0, laws)
            c.held[r], c.linked[r] = capacity(r, layers, 0.0, 1.0, laws), own
            if j < SOLID_LAYERS - 1:
                c.linked[r] = 1.0 / (own + resistance(r + step, layers, 0.0, laws))


@inlined
def fill_body(i: int, body: int, kept: float, width: float, c: Columns) -> None:
    """The rows of one body at node i from its depth to below its surface, divided, and `bare` of its surface;
    `kept` (m2/s): width of the volume before, and what comes, over the time."""
    lower, inverse, upper, held, linked = c.lower[i], c.inverse[i], c.upper[i], c.held, c.linked
    before, share, step = 0.0, 0.0, 1 - 2 * body
    r = body * (held.shape[0] - 1)
    for _ in range(SOLID_LAYERS - 1):
        after = linked[r] * width
        inverse[r] = 1.0 / (held[r] * kept + after + before * (1.0 - share))
        share = after * inverse[r]
        upper[r], lower[r + step] = -share, -share
        before = after
        r += step
    c.bare[body, i] = held[r] * kept + before * (1.0 - share)


@inlined
def fill_layers(
    i: int, held: float, grown: float, share: float, inner: float, width: float, at: Faces, laws: HeatLaws,
    h: float, heat: Heat,
) -> None:  # fmt: skip
    """The film's rows at node i, with the surfaces of both bodies, divided.

    `held`, `grown` (W/(m K)): heat capacity of a layer before over the time, and its growth; `inner`:
    conductance between layers; `share` (J/(m3 K)) of the oil's heat capacity.
    """
    c, layers = heat.columns, heat.speed.shape[1]
    first, end = SOLID_LAYERS, SOLID_LAYERS + layers
    lower, inverse, upper = c.lower[i], c.inverse[i], c.upper[i]
    v_left, v, v_right = heat.speed[i - 1], heat.speed[i], heat.speed[i + 1]
    half = 0.5 * h / (layers * laws.conductivity)
    crossing, across = 0.0, 0.0
    link = width / (c.linked[first - 1] + half)
    inverse[first - 1] = 1.0 / (c.bare[0, i] + link)
    upper[first - 1] = -link * inverse[first - 1]
    other = width / (c.linked[end] + half)
    inverse[end] = 1.0 / (c.bare[1, i] + other)
    upper[end] = -other * inverse[end]
    # What a row keeps of the one before, and the elements below and above the diagonal.
    below, above, diagonal = -link, 0.0, 0.0
    own, passed_on = inverse[first - 1], upper[first - 1]
    for k in range(layers):
        r = first + k
        q_left = share * (at.q_left + at.m_left * 0.5 * (v_left[k] + v[k]))
        q_right = share * (at.q_right + at.m_right * 0.5 * (v[k] + v_right[k]))
        diagonal = held + carry(q_left, q_right, at, c.come[i, 2 + k]) + c.diagonal[k]
        diagonal += link if k == 0 else across + 0.5 * crossing
        # What a layer has too much leaves it upwards. Crossing oil has the mean temperature of both sides
        # where conduction smooths that.
        crossing = crossing - grown - (q_right - q_left)
        across = max(inner, 0.5 * abs(crossing))
        if k == layers - 1:
            crossing, across = 0.0, 0.0
            diagonal += other + other * upper[end]
        diagonal += across - 0.5 * crossing
        above = -across + 0.5 * crossing
        lower[r] = below * own
        own = 1.0 / (diagonal - below * passed_on)
        passed_on = above * own
        inverse[r], upper[r] = own, passed_on
        below = -across - 0.5 * crossing
    upper[end - 1] = upper[end]


@inlined
def divide_film(lower: Any, inverse: Any, upper: Any, right: Any) -> None:
    """Right sides of the film's rows, from which the bodies are eliminated, become temperatures."""
    first, last = SOLID_LAYERS, right.shape[0] - SOLID_LAYERS - 1
    known = right[first]
    for r in range(first + 1, last + 1):
        known = right[r] - lower[r] * known
        right[r] = known
    known *= inverse[last]
    right[last] = known
    for r in range(last - 1, first - 1, -1):
        known = right[r] * inverse[r] - upper[r] * known
        right[r] = known


@inlined
def heat_layers(
    i: int, temperature: float, volume: float, pressed: float, gradient: float, passing: float, heat: Heat
) -> None:
    """Heat of shear and compression in the film's rows of a node; `volume` (m2) of a layer times the oil's
    expansion, mean velocity past the node (m/s), the pressure's rate and gradient."""
    c, first, T = heat.columns, SOLID_LAYERS, heat.rise[i]
    softening, heating, growth = heat.softening[i], heat.heating[i], heat.growth[i]
    source, answer, speed, fall = c.source[i], c.answer[i], heat.speed[i], 0.0
    response = heat.response[i]
    for k in range(softening.shape[0]):
        fall += softening[k] * T[first + k]
    for k in range(softening.shape[0]):
        at, own = T[first + k], heating[k]
        hot = volume * (pressed + (passing + speed[k]) * gradient)
        c.origin[i, k] = at
        c.diagonal[k] = -growth[k] - hot
        answer[first + k] = response * own
        source[first + k] += own + response * own * fall - growth[k] * at + temperature * hot


@uncounted
def build_bodies(problem: FilmProblem, laws: HeatLaws, X: Any, nodes: Nodes, heat: Heat) -> None:
    """The bodies' rows of all nodes, which neither pressure nor temperatures change."""
    drive, scale_rate = problem.drive, problem.scale_rate
    fill_constants(heat.speed.shape[1], laws, heat.columns)
    for i in range(1, X.shape[0] - 1):
        width = problem.scale * cell(X, i)
        at = find_faces(i, width, 0.0, nodes.mass, X, nodes)
        kept = width / problem.time_step - scale_rate * cell(X, i)
        for body in range(2):
            velocity = drive.velocity + (0.5 - body) * drive.sliding
            left, right = velocity - scale_rate * at.left, velocity - scale_rate * at.right
            came = carry(left, right, at, heat.columns.come[i, body])
            fill_body(i, body, kept + came, width, heat.columns)


@inlined
def pressed(i: int, heat: Heat) -> float:
    """The share of a node's answer to its stress that a pressure makes there (1/Pa)."""
    return float(heat.pressing[i] / heat.response[i] * heat.columns.softer[i])


@uncounted
def foresee_drift(
    p: Any, h: Any, problem: FilmProblem, laws: HeatLaws, X: Any, nodes: Nodes, heat: Heat
) -> None:  # fmt: skip
    """What the pressures of a node and of those beside it make of its drift by heat: by that of their stress,
    which layers carry to it from either side, and by that of the slope, which shears and compresses one half
    of the film more. One adjoint column of the node serves all."""
    c, layers, first = heat.columns, heat.speed.shape[1], SOLID_LAYERS
    middle, wanted, sliding = 0.5 * (layers - 1), c.right, problem.drive.sliding
    for i in range(1, p.shape[0] - 1):
        own, left, right, slope = 0.0, 0.0, 0.0, 0.0
        softening, answer, come = heat.softening[i], c.answer[i], c.come[i]
        lower, inverse, upper = c.lower[i], c.inverse[i], c.upper[i]
        if p[i] > 0.0 and heat.stress[i] != 0.0:
            for k in range(layers):
                wanted[first + k] = ((k - middle) / layers - heat.wedge[i]) * softening[k]
                own += wanted[first + k] * answer[first + k]
            for k in range(layers):
                wanted[first + k] -= own * c.softer[i] * softening[k]
            for r in range(first + 1, first + layers):
                wanted[r] -= upper[r - 1] * wanted[r - 1]
            volume = laws.expansion * h[i] * problem.scale * cell(X, i) / layers
            passing, after = 0.5 * (nodes.through[i - 1] + nodes.through[i]) / nodes.mass[i], 0.0
            for k in range(layers - 1, -1, -1):
                r = first + k
                after = wanted[r] * inverse[r] - lower[r + 1] * after
                left += after * come[2 + k, 1] * c.answer[i - 1, r]
                right += after * come[2 + k, 2] * c.answer[i + 1, r]
                leant = 2.0 * ((k - middle) / layers - heat.wedge[i]) * h[i] / heat.stress[i]
                hot = volume * (laws.thermal.temperature + heat.rise[i, r])
                slope += after * (hot * (passing + heat.speed[i, k]) - leant * heat.heating[i, k])
        slope *= sliding / (problem.scale * (X[i + 1] - X[i - 1]))
        nodes.drift_p[i] = sliding * pressed(i, heat) * own + heat.wedging[i]
        nodes.drift_left[i] = sliding * pressed(i - 1, heat) * left - slope
        nodes.drift_right[i] = sliding * pressed(i + 1, heat) * right + slope


@uncounted
def build_columns(
    p: Any, h: Any, problem: FilmProblem, old: Any, laws: HeatLaws, X: Any, nodes: Nodes, heat: Heat
) -> None:
    """The columns of all nodes, after `build_bodies`, under p and h, about the temperatures that `shear` saw;
    and in `nodes` what heat makes of the drift where pressures change."""
    c, n, layers, rows = heat.columns, p.shape[0], heat.speed.shape[1], heat.rise.shape[1]
    per_time = 1.0 / problem.time_step
    share, end = laws.capacity / layers, SOLID_LAYERS + layers
    for i in range(1, n - 1):
        width = problem.scale * cell(X, i)
        at = find_faces(i, width, per_time, old, X, nodes)
        source = c.source[i]
        for r in range(rows):
            source[r] = heat.base[i, r] * per_time
        source[SOLID_LAYERS - 1] += 0.5 * heat.rough[i]
        source[end] += 0.5 * heat.rough[i]
        gradient = (p[i + 1] - p[i - 1]) / (problem.scale * (X[i + 1] - X[i - 1])) if p[i] > 0.0 else 0.0
        heat_layers(
            i, laws.thermal.temperature, laws.expansion * h[i] * width / layers,
            (p[i] - heat.pressure_base[i]) * per_time, gradient, at.passing, heat,
        )  # fmt: skip
        held = share * old[i] * per_time
        grown = share * ((nodes.mass[i] * width - old[i]) * per_time - at.over)
        inner = width * layers * laws.conductivity / h[i]
        fill_layers(i, held, grown, share, inner, width, at, laws, h[i], heat)
        if p[i] > 0.0:
            divide_film(c.lower[i], c.inverse[i], c.upper[i], c.answer[i])
        softer = 1.0
        for k in range(layers):
            softer += heat.softening[i, k] * c.answer[i, SOLID_LAYERS + k]
        c.softer[i] = 1.0 / softer
    foresee_drift(p, h, problem, laws, X, nodes, heat)


@uncounted
def warm(heat: Heat, step: int) -> None:
    """Temperatures by the columns, along the film (step = 1) or back (-1)."""
    c, rise, right = heat.columns, heat.rise, heat.columns.right
    n, rows = rise.shape
    layers = rows - 2 * SOLID_LAYERS
    first, last = SOLID_LAYERS, rows - SOLID_LAYERS - 1
    for count in range(1, n - 1):
        i = count if step > 0 else n - 1 - count
        T, T_left, T_right = rise[i], rise[i - 1], rise[i + 1]
        T_far_left, T_far_right = rise[max(i - 2, 0)], rise[min(i + 2, n - 1)]
        source, lower, inverse, upper = c.source[i], c.lower[i], c.inverse[i], c.upper[i]
        softening, answer = heat.softening[i], c.answer[i]
        for body in range(2):
            come, begin = c.come[i, body], body * (last + 1)
            left, right_share, far_left, far_right = come[1], come[2], come[0], come[3]
            for r in range(begin, begin + SOLID_LAYERS):
                brought = far_left * T_far_left[r] + left * T_left[r]
                brought += right_share * T_right[r] + far_right * T_far_right[r]
                right[r] = source[r] + c.held[r] * brought
        for k in range(layers):
            r, come = first + k, c.come[i, 2 + k]
            right[r] = source[r] + come[0] * T_far_left[r] + come[1] * T_left[r]
            right[r] += come[2] * T_right[r] + come[3] * T_far_right[r]
        one, other = right[0], right[rows - 1]
        for j in range(1, SOLID_LAYERS):
            r = rows - 1 - j
            one = right[j] - lower[j] * one
            other = right[r] - lower[r] * other
            right[j], right[r] = one, other
        right[first] -= lower[first] * one
        right[last] -= upper[last] * other
        divide_film(lower, inverse, upper, right)
        plain = 0.0
        for k in range(layers):
            plain += softening[k] * right[first + k]
        plain *= c.softer[i]
        for k in range(layers):
            T[first + k] = right[first + k] - answer[first + k] * plain
        one, other = T[first], T[last]
        for j in range(SOLID_LAYERS - 1, -1, -1):
            r = rows - 1 - j
            one = right[j] * inverse[j] - upper[j] * one
            other = right[r] * inverse[r] - upper[r] * other
            T[j], T[r] = one, other


@kernel
def settle_heat(heat: Heat) -> None:
    """Heat and stress that go with the temperatures."""
    c, first = heat.columns, SOLID_LAYERS
    for i in range(1, heat.rise.shape[0] - 1):
        fall = 0.0
        for k in range(heat.softening.shape[1]):
            fall += heat.softening[i, k] * (heat.rise[i, first + k] - c.origin[i, k])
        for k in range(heat.softening.shape[1]):
            change = heat.growth[i, k] * (heat.rise[i, first + k] - c.origin[i, k])
            heat.heating[i, k] += change - heat.response[i] * heat.heating[i, k] * fall
        heat.stress[i] *= 1.0 - (heat.response[i] - 1.0) * fall
