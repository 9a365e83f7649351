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

from ...compile.kernel import kernel
from ..fluid import Lubricant
from ..friction import Traction, find_sheared_share
from ..rheology import GRADUAL, Thermal, hot_log_viscosity, limited_stress

# Layers of either solid: from LEAST_DEPTH (m), reached within 0.1 us, each twice as thick as the one before,
# to 0.5 mm, not reached within the 3 ms that a body needs through the grid.
SOLID_LAYERS = 8
LEAST_DEPTH = 2e-6
# Stresses of more Eyring stresses than this are none of oils; sinh must not overflow.
_LARGEST = 200.0
_MOST_ITERATIONS = 30


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


class Heat(NamedTuple):
    """Scratch over nodes. Rises of temperature (K) over rows (n, rows): body 1 from the depth to its surface,
    film, body 2 to the depth; `flat` is `rise` as one vector, `guess` and `trail` (4) are such of the turns
    of film and heat. Over layers (n, layers): heat (W/m), its
    growth by the layer's own temperature, what all temperatures make of the stress (1/K), and velocity
    (m/s) less the mean. Over nodes: stress (Pa), how heat answers the stress, pressure at the base (Pa),
    heat of asperities (W/m)."""

    flat: Any
    guess: Any
    trail: Any
    rise: Any
    start: Any
    middle: Any
    base: Any
    heating: Any
    growth: Any
    softening: Any
    speed: Any
    stress: Any
    stress_middle: Any
    response: Any
    pressure_base: Any
    rough: Any
    columns: Any


@kernel
def no_heat(traction: Traction) -> HeatLaws:
    """Laws of an isothermal film."""
    return HeatLaws(Thermal(0.0, 0.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, traction, 0.0)


@kernel
def depth(layer: int) -> float:
    """Thickness (m) of a body's layer, counted from the surface."""
    return float(LEAST_DEPTH * 2.0**layer)


@kernel
def newtonian(fluid: Lubricant) -> Lubricant:
    """The oil without shear thinning, which factors of the nodes bring in."""
    return Lubricant(
        fluid.viscosity, fluid.pressure_viscosity, fluid.viscosity_law, fluid.density_law,
        fluid.roelands_exponent, fluid.roelands_pressure, 0.0,
    )  # fmt: skip


@kernel
def eyring_level(level: float, tilt: float, wanted: float, fluidity: Any, eyring_stress: float) -> float:
    """tau in the film's middle (Pa) at which layers of these fluidities slide by `wanted` in all (Pa).

    `level`: that of Newton's fluid; `tilt` (Pa) is h p'.
    """
    layers = fluidity.shape[0]
    x, slope = math.asinh(level / eyring_stress), tilt / eyring_stress
    wanted /= eyring_stress
    for _ in range(_MOST_ITERATIONS):
        total, rate = 0.0, 0.0
        for k in range(layers):
            at = x - ((k + 0.5) / layers - 0.5) * slope
            at = min(max(at, -_LARGEST), _LARGEST)
            grown = math.exp(at)
            total += fluidity[k] * 0.5 * (grown - 1.0 / grown)
            rate += fluidity[k] * 0.5 * (grown + 1.0 / grown)
        change = (total / layers - wanted) / (rate / layers)
        x -= min(max(change, -2.0), 2.0)
        if abs(change) <= 1e-10 * (1.0 + abs(x)):
            break
    return x * eyring_stress


@kernel
def shear_node(
    i: int, pressure: float, film: float, log_eta: float, tilt: float, sliding: float, width: float,
    sheared: float, fluid: Lubricant, laws: HeatLaws, heat: Heat,
) -> tuple[float, float]:  # fmt: skip
    """Fill what `heat` has of node i; factor of the pressure's flow, and drift u_s (zeta_c - 1/2) (m/s).

    `tilt` (Pa): h p'; width of the node's volume and of its sheared part (m).
    """
    layers = heat.speed.shape[1]
    share = 1.0 / layers
    fluidity = heat.speed[i]
    eta = fluid.viscosity * math.exp(log_eta)
    J0, J1, J2 = 0.0, 0.0, 0.0
    for k in range(layers):
        hot = hot_log_viscosity(pressure, heat.rise[i, SOLID_LAYERS + k], fluid, laws.thermal)
        fluidity[k] = math.exp(log_eta - hot.value)
        heat.softening[i, k] = -hot.by_temperature
        zeta = (k + 0.5) * share
        J0 += share * fluidity[k]
        J1 += share * fluidity[k] * zeta
    answer = 1.0
    if fluid.eyring_stress > 0.0:
        wanted = eta * sliding / film
        level = eyring_level(
            (wanted + tilt * (J1 - 0.5 * J0)) / J0, tilt, wanted, fluidity, fluid.eyring_stress
        )
        J0, J1, answer = 0.0, 0.0, 0.0
        for k in range(layers):
            zeta = (k + 0.5) * share
            x = abs(level - (zeta - 0.5) * tilt) / fluid.eyring_stress
            if x > 1e-4:
                x = min(x, _LARGEST)
                fluidity[k] *= math.sinh(x) / x
            J0 += share * fluidity[k]
            J1 += share * fluidity[k] * zeta
            answer += share * fluidity[k] * (x / math.tanh(x) if x > 1e-4 else 1.0)
        answer /= J0
    centre = J1 / J0
    for k in range(layers):
        J2 += share * fluidity[k] * (((k + 0.5) * share - centre) ** 2 + share * share / 12.0)
    stress = abs(sliding) * eta / (film * J0)
    limit = laws.traction.limiting_stress + laws.traction.limiting_coefficient * pressure
    limited = limited_stress(stress, limit, laws.traction.limiting_law)
    follows = 1.0 if limited == stress else 0.0
    if laws.traction.limiting_law == GRADUAL and 0.0 < stress < 30.0 * limit:
        follows = stress / (limit * math.expm1(stress / limit))
    heat.stress[i] = math.copysign(limited, sliding) if sheared > 0.0 and sliding != 0.0 else 0.0
    heat.response[i] = (follows + answer) / answer
    stress = math.copysign(stress, sliding)
    passed, mean = 0.0, 0.0
    for k in range(layers):
        leant = ((k + 0.5) * share - centre) * tilt
        part = share * fluidity[k] / J0
        slid = (stress - leant) * fluidity[k] / eta * film * share
        heat.heating[i, k] = heat.stress[i] * slid * sheared - leant * slid * width if sheared > 0.0 else 0.0
        heat.growth[i, k] = heat.softening[i, k] * heat.heating[i, k]
        heat.softening[i, k] *= part
        heat.speed[i, k] = -passed - 0.5 * slid
        passed += slid
        mean += heat.speed[i, k] * share
    for k in range(layers):
        heat.speed[i, k] -= mean
    return 12.0 * J2, sliding * (centre - 0.5)


@kernel
def shear_film(
    X: Any, scale: float, p: Any, h: Any, sliding: float, fluid: Lubricant, laws: HeatLaws, heat: Heat,
    nodes: Any,
) -> None:  # fmt: skip
    """`shear_node` of all nodes, with factors, drift and expansion (the mean over the film) into `nodes`."""
    n, layers = p.shape[0], heat.speed.shape[1]
    for i in range(n):
        before, after = max(i - 1, 0), min(i + 1, n - 1)
        width = 0.5 * scale * (X[after] - X[before])
        sheared, tilt = 0.0, 0.0
        if p[i] > 0.0:
            sheared = scale * (find_sheared_share(X, p, i, -1) + find_sheared_share(X, p, i, 1))
            tilt = h[i] * (p[after] - p[before]) / (2.0 * width)
        log_eta = hot_log_viscosity(p[i], 0.0, fluid, laws.thermal).value
        nodes.factor[i], nodes.drift[i] = shear_node(
            i, p[i], h[i], log_eta, tilt, sliding, width, sheared, fluid, laws, heat
        )
        mean = 0.0
        for k in range(layers):
            mean += heat.rise[i, SOLID_LAYERS + k] / layers
        nodes.expansion[i] = math.exp(-laws.expansion * mean)
