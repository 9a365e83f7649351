"""Shear of the oil across the film: velocities, heat and what temperatures make of Reynolds' equation.

At a node the film is cut into layers of equal thickness with temperatures of their own. With zeta = z/h from
surface 1, the shear stress is tau_c - (zeta - zeta_c) h p', and each layer is sheared at the rate f(tau)/eta
of its own viscosity, so that the rates add up to the sliding velocity u_s (surface 1 past surface 2). With
the fluidities phi = f(tau)/(tau eta) and their moments J_m over zeta^m (Yang and Wen 1990, Int. J. Mech. Sci.
32, 929; the density is that of the mean over the film):

    tau_c = u_s/(h J_0),   zeta_c = J_1/J_0
    flow by pressure:  - rho h^3 (J_2 - J_1^2/J_0) p'
    mean velocity by drag:  u + u_s (zeta_c - 1/2)

f = tau (Newton), or tau_0 sinh(tau/tau_0) (Eyring). The work of tau_c on the sliding is the friction's heat;
tau_c, not the flow, is cut by the limiting stress, as by `friction`.
"""

import math
from typing import Any, NamedTuple

from ...compile.kernel import inlined, kernel, uncounted
from ..fluid import ROELANDS, Lubricant, log_viscosity, thinning
from ..friction import Traction, find_sheared_share
from ..rheology import GRADUAL, Thermal, limited_stress, pressed_share, thin_by_heat

# Layers of either solid: from LEAST_DEPTH (m), reached within 0.1 us, each twice as thick as the one before,
# to 0.5 mm, not reached within the 3 ms that a body needs through the grid.
SOLID_LAYERS = 8
LEAST_DEPTH = 2e-6
# Stresses of more Eyring stresses than this are none of oils; sinh must not overflow.
_LARGEST = 200.0
_MOST_ITERATIONS = 30
# Slopes of the pressure across the film below this share of the Eyring stress count as this.
_LEAST_TILT = 1e-4


class HeatLaws(NamedTuple):
    """Of the oil: temperature law, expansion (1/K), heat capacity (J/(m3 K)) and conductivity (W/(m K); 0:
    isothermal); of the bodies: capacities and conductivities; the laws of friction; and by which share of the
    highest rise temperatures may still change when film and heat have settled together."""

    thermal: Thermal
    expansion: float
    capacity: float
    conductivity: float
    capacity_1: float
    conductivity_1: float
    capacity_2: float
    conductivity_2: float
    traction: Traction
    settled: float


class Columns(NamedTuple):
    """The equations of temperatures, divided. Over rows (n, rows): source (W/m), factors of the rows
    eliminated before, inverses of the diagonal, shares of the rows eliminated after, and the film's answers
    to the heat of the stress. `come` (n, 2 + layers, 4) of bodies (m2/s) and layers (W/(m K)): shares of the
    temperatures of two nodes to the left and two to the right; `bare` (2, n): diagonals of the surfaces'
    rows without the film; `origin` (n, layers): temperatures about which the heat of shear is linear;
    `softer` (n): how the stress answers itself. The rest is of one column."""

    source: Any
    lower: Any
    inverse: Any
    upper: Any
    answer: Any
    come: Any
    bare: Any
    origin: Any
    softer: Any
    held: Any
    linked: Any
    right: Any
    diagonal: Any


class Heat(NamedTuple):
    """Scratch over nodes. Rises of temperature (K) over rows (n, rows): body 1 from the depth to its surface,
    film, body 2 to the depth; `flat` is `rise` as one vector, `slope` its rate (K/s) at the start,
    in a last stage the temperatures from which that begins, `guess` what `flat` was before the columns were
    solved. Over layers (n, layers): heat (W/m), its growth
    by the layer's own temperature, what all temperatures make of the stress (1/K), velocity (m/s) less the
    mean, and what heat makes of ln(eta) at no pressure with its slope (1/K). Over nodes: stress (Pa), how
    heat answers the stress, pressure at the base (Pa), heat of asperities (W/m), growth of heat (1/Pa) by the
    pressure, zeta_c - 1/2, and what the pressure makes of the drift at these temperatures (m/(s Pa))."""

    flat: Any
    slope: Any
    guess: Any
    rise: Any
    start: Any
    middle: Any
    base: Any
    heating: Any
    growth: Any
    softening: Any
    speed: Any
    thinned: Any
    thinning: Any
    stress: Any
    stress_middle: Any
    response: Any
    pressure_base: Any
    rough: Any
    pressing: Any
    wedge: Any
    wedging: Any
    columns: Columns


@kernel
def depth(layer: int) -> float:
    """Thickness (m) of a body's layer, counted from the surface."""
    return float(LEAST_DEPTH * 2.0**layer)


@kernel
def eyring_level(level: float, tilt: float, wanted: float, fluidity: Any, eyring_stress: float) -> float:
    """tau in the film's middle (Pa) at which layers of these fluidities slide by `wanted` in all (Pa).

    `level`: that of Newton's fluid; `tilt` (Pa) is h p'.
    """
    layers = fluidity.shape[0]
    x, slope = math.asinh(level / eyring_stress), tilt / eyring_stress
    slope = min(max(slope, -_LARGEST), _LARGEST)
    wanted /= eyring_stress
    fall = math.exp(-slope / layers)
    rise, first = 1.0 / fall, 0.5 * (1.0 - 1.0 / layers) * slope
    for _ in range(_MOST_ITERATIONS):
        total, rate = 0.0, 0.0
        x = min(max(x, -_LARGEST), _LARGEST)
        grown = math.exp(x + first)
        shrunk = 1.0 / grown
        for k in range(layers):
            total += fluidity[k] * (grown - shrunk)
            rate += fluidity[k] * (grown + shrunk)
            grown, shrunk = grown * fall, shrunk * rise
        change = (total - 2.0 * layers * wanted) / rate
        x -= min(max(change, -2.0), 2.0)
        if abs(change) <= 1e-10 * (1.0 + abs(x)):
            break
    return x * eyring_stress


@inlined
def thin_layers(
    J0: float, J1: float, tilt: float, wanted: float, fluidity: Any, eyring_stress: float
) -> tuple[float, float, float]:
    """Newton's fluidities of layers, with their moments, become those of an Eyring oil that slides by
    `wanted` (Pa); its moments, and by which power of the viscosity's fall the stress grows less."""
    layers = fluidity.shape[0]
    share = 1.0 / layers
    level = eyring_level((wanted + tilt * (J1 - 0.5 * J0)) / J0, tilt, wanted, fluidity, eyring_stress)
    J0, J1, answer = 0.0, 0.0, 0.0
    for k in range(layers):
        zeta = (k + 0.5) * share
        x = abs(level - (zeta - 0.5) * tilt) / eyring_stress
        steep = 1.0
        if x > 1e-4:
            x = min(x, _LARGEST)
            grown = math.exp(x)
            sinh, cosh = 0.5 * (grown - 1.0 / grown), 0.5 * (grown + 1.0 / grown)
            fluidity[k] *= sinh / x
            steep = x * cosh / sinh
        J0 += share * fluidity[k]
        J1 += share * fluidity[k] * zeta
        answer += share * fluidity[k] * steep
    return J0, J1, answer / J0


class Sheared(NamedTuple):
    """A node's oil: viscosity (Pa s) with its logarithm's derivative (1/Pa), by which power heat thins it
    more under the pressure; J_0, zeta_c, by which power of the viscosity's fall the stress grows less;
    h p' (Pa); width of the node's volume (m)."""

    eta: float
    by_pressure: float
    pressed: float
    J0: float
    centre: float
    answer: float
    tilt: float
    width: float


@inlined
def fill_flow(
    i: int, X: Any, scale: float, p: Any, h: Any, sliding: float, fluid: Lubricant, heat: Heat, nodes: Any
) -> Sheared:
    """Of node i the fluidities into heat.speed, and into `nodes` factor and drift, at temperatures that
    `thin_film` saw: of an Eyring oil the drift without the pressure's slope, the factor over `thinning`'s."""
    n, layers = heat.speed.shape
    before, after = max(i - 1, 0), min(i + 1, n - 1)
    share, film, width = 1.0 / layers, h[i], 0.5 * scale * (X[after] - X[before])
    tilt = film * (p[after] - p[before]) / (2.0 * width) if p[i] > 0.0 else 0.0
    fluidity, thinned = heat.speed[i], heat.thinned[i]
    log_eta, by_pressure = log_viscosity(p[i], fluid)
    eta, pressed = fluid.viscosity * math.exp(log_eta), pressed_share(p[i], fluid)
    J0, J1, J2 = 0.0, 0.0, 0.0
    for k in range(layers):
        fluidity[k] = math.exp(-pressed * thinned[k])
        zeta = (k + 0.5) * share
        J0 += share * fluidity[k]
        J1 += share * fluidity[k] * zeta
    leaning = tilt  # that by which an Eyring oil's flow is divided
    if fluid.eyring_stress > 0.0 and abs(tilt) < _LEAST_TILT * fluid.eyring_stress:
        leaning = _LEAST_TILT * fluid.eyring_stress
    answer, plain_centre = 1.0, J1 / J0
    if fluid.eyring_stress > 0.0:
        J0, J1, answer = thin_layers(J0, J1, leaning, eta * sliding / film, fluidity, fluid.eyring_stress)
    centre = J1 / J0
    for k in range(layers):
        J2 += share * fluidity[k] * (((k + 0.5) * share - centre) ** 2 + share * share / 12.0)
    nodes.factor[i] = 12.0 * J2
    if fluid.eyring_stress > 0.0:
        # What the pressure's slope makes of the drift flows by it; Conry's factor is that of cold oil.
        slope = 12.0 * J2 - 12.0 * eta * sliding * (centre - plain_centre) / (film * leaning)
        nodes.factor[i] = slope / thinning(eta, film, leaning / film, sliding, fluid.eyring_stress).factor
    nodes.drift[i] = sliding * (plain_centre - 0.5) * nodes.filled[i]
    beside = nodes.drift_left[i] * p[before] + nodes.drift_right[i] * p[after]
    nodes.drift_0[i] = nodes.drift[i] - nodes.drift_p[i] * p[i] - beside
    return Sheared(eta, by_pressure, pressed, J0, centre, answer, tilt, width)


@inlined
def shear_node(
    i: int, node: Sheared, pressure: float, film: float, sliding: float, sheared: float, fluid: Lubricant,
    laws: HeatLaws, heat: Heat,
) -> None:  # fmt: skip
    """Fill what `heat` has of node i after `fill_flow`; `sheared`: width of the sheared part (m)."""
    layers = heat.speed.shape[1]
    share, centre, pressed = 1.0 / layers, node.centre, node.pressed
    fluidity, softening, heating, growth = heat.speed[i], heat.softening[i], heat.heating[i], heat.growth[i]
    thinned, thinning_slope = heat.thinned[i], heat.thinning[i]
    stress = abs(sliding) * node.eta / (film * node.J0)
    limit = laws.traction.limiting_stress + laws.traction.limiting_coefficient * pressure
    limited = limited_stress(stress, limit, laws.traction.limiting_law)
    follows = 1.0 if limited == stress else 0.0
    if laws.traction.limiting_law == GRADUAL and 0.0 < stress < 30.0 * limit:
        follows = stress / (limit * math.expm1(stress / limit))
    heat.stress[i] = math.copysign(limited, sliding) if sheared > 0.0 and sliding != 0.0 else 0.0
    heat.response[i] = (follows + node.answer) / node.answer
    heat.pressing[i] = follows / node.answer * node.by_pressure
    if follows < 1.0 and limit > 0.0:
        heat.pressing[i] += (1.0 - follows) * laws.traction.limiting_coefficient / limit
    stress = math.copysign(stress, sliding)
    passed, mean, wedging, part, easing = 0.0, 0.0, 0.0, share / node.J0, film * share / node.eta
    rubbed = heat.stress[i] * sheared
    for k in range(layers):
        away = (k + 0.5) * share - centre
        leant, flows, softer = away * node.tilt, fluidity[k], -pressed * thinning_slope[k]
        wedging -= flows * away * thinned[k]
        slid = (stress - leant) * (flows * easing)
        heating[k] = (rubbed - leant * node.width) * slid if sheared > 0.0 else 0.0
        growth[k] = softer * heating[k]
        softening[k] = softer * (flows * part)
        fluidity[k] = -passed - 0.5 * slid
        passed += slid
        mean += fluidity[k] * share
    wedging *= pressed * part
    for k in range(layers):
        fluidity[k] -= mean
    heat.wedge[i] = centre - 0.5
    heat.wedging[i] = 0.0
    if fluid.viscosity_law == ROELANDS:
        by_pressed = fluid.roelands_exponent / (pressure + fluid.roelands_pressure)
        heat.wedging[i] = sliding * wedging * by_pressed


@uncounted
def thin_film(fluid: Lubricant, laws: HeatLaws, heat: Heat, nodes: Any) -> None:
    """What temperatures make of the oil: heat.thinned, and the expansion of the film's mean into `nodes`."""
    n, layers = heat.thinned.shape
    for i in range(n):
        rise, thinned, slopes, total = heat.rise[i], heat.thinned[i], heat.thinning[i], 0.0
        for k in range(layers):
            hot = thin_by_heat(rise[SOLID_LAYERS + k], fluid.viscosity, laws.thermal)
            thinned[k], slopes[k] = hot.value, hot.slope
            total += rise[SOLID_LAYERS + k]
        nodes.expansion[i] = math.exp(-laws.expansion * total / layers)


@uncounted
def flow_film(
    X: Any, scale: float, p: Any, h: Any, sliding: float, fluid: Lubricant, heat: Heat, nodes: Any
) -> None:
    """`fill_flow` of all nodes."""
    for i in range(p.shape[0]):
        fill_flow(i, X, scale, p, h, sliding, fluid, heat, nodes)


@uncounted
def shear_film(
    X: Any, scale: float, p: Any, h: Any, sliding: float, fluid: Lubricant, laws: HeatLaws, heat: Heat,
    nodes: Any,
) -> None:  # fmt: skip
    """As `flow_film`, with `shear_node` of all nodes."""
    for i in range(p.shape[0]):
        node, sheared = fill_flow(i, X, scale, p, h, sliding, fluid, heat, nodes), 0.0
        if p[i] > 0.0:
            sheared = scale * (find_sheared_share(X, p, i, -1) + find_sheared_share(X, p, i, 1))
        shear_node(i, node, p[i], h[i], sliding, sheared, fluid, laws, heat)
