"""Energies of a contact whose film is solved for: what it stores, loses and is given.

The gap is h = -A + kappa x^2/2 + v with the approach A of the bodies, the curvature kappa = 1/R and the
deflection v = K p. Times the load W is the integral of p, K is symmetric, and so

    W dA/dt = d/dt (integral of p v/2) - integral of p dh/dt + dkappa/dt integral of p x^2/2

v has an arbitrary constant, in two dimensions; it is here the one by which A is defined, so that the load is
conjugate to A and W dA/dt does not depend on it. The oil has the elastic energy e(p) per mass, with
de = p/rho^2 drho, and the enthalpy H = e + p/rho = integral of dp/rho. Reynolds' balance times H, over the
film (a cavity has H = 0, whatever oil it gains):

    d/dt (integral of rho e h) = - integral of p dh/dt + u integral of h dp/dx
                                 - integral of h^3/(12 eta) (dp/dx)^2

Together: what is stored, in the bodies and in the compressed oil, grows by W dA/dt, by the work of the
surfaces that drag oil up the pressure and by that of a changing curvature, less what the pressure's flow
loses. Nothing of p dh/dt is left: it only passes from bodies to oil. Sliding gives what the film's shear and
the asperities' friction lose at once.

All of this is exact for the finite volumes of `reynolds` with H at their nodes, but for the deflection at
nodes (K is symmetric to the square of their distance only) and for the motion of the grid, likewise.

Rough surfaces deflect under p + p_a and come closer by their mean planes' gap d, by which the asperities
store the integral of p_a. The oil has only the mean gap h > d to leave: what its pressure p does where
asperities take the room, integral of p d(h - d)/dt, goes to nobody in that model and stays unaccounted; it
is noticed where films are thinner than three roughnesses, and comes back as they part.

What the pressure works on oil that expands with heat stays unaccounted likewise, about 1e-3 of the friction.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from ...compile.kernel import kernel
from ...core.component import DISSIPATED_POWER, SOURCE_POWER, STORED
from ...core.integrator import copy
from ..asperities import below, pressure_under
from ..fluid import Lubricant, build_lubricant, density_ratio, enthalpy
from .cavities import fill_partly, find_filled, start_filling
from .field_state import begin, build_bodies
from .grid import node_positions
from .heat_state import laws_of
from .heated import is_heated
from .hierarchical import BAND
from .mixed import Bodies, mean_plane_gap
from .reynolds import Flow, Nodes, balance, cell, properties
from .shear import Heat, HeatLaws, shear_film, thin_film
from .workspace import FIELDS, heat_in, heat_size, keep_cold, nodes_in

# Vectors besides those of Nodes and the two bands: pressure, film, no masses, a balance, and the drift.
_VECTORS = 5


class Touching(NamedTuple):
    """Of asperities: gap of the mean planes (m), pressure (Pa) and elastic energy per area (J/m2)."""

    gap: float
    pressure: float
    energy: float


@kernel
def asperities_at(film: float, bodies: Bodies) -> Touching:
    """Under a film of that mean gap.

    Their energy is the integral of p_a over the gap d from here outwards, S sigma 2/7 F_7/2; as F_7/2 =
    5/2 F_3/2 - lambda F_5/2 (integrate s phi(s) by parts) and F_5/2' = -5/2 F_3/2, it is
    -2/7 (sigma^2 dp_a/dd + d p_a).
    """
    if bodies.roughness == 0.0:
        return Touching(film, 0.0, 0.0)
    gap = mean_plane_gap(film, bodies.roughness)
    pressed = pressure_under(film, bodies.roughness, bodies.asperity_scale)
    stiffness = pressed.slope * below(gap / bodies.roughness)
    energy = -2.0 / 7.0 * (bodies.roughness**2 * stiffness + gap * pressed.pressure)
    return Touching(gap, pressed.pressure, energy)


@kernel
def oil_energy(p: float, h: float, fluid: Lubricant) -> float:
    """rho e h, the elastic energy of the oil per area (J/m2)."""
    return h * (density_ratio(p, fluid) * enthalpy(p, fluid) - p)


@kernel
def stored_energy(x: Any, u: Any, p: Any, X: Any, fluid: Lubricant, bodies: Bodies) -> float:
    """Energy of bodies and oil (J).

    Where approach and radius of the inputs are not those of the state, they jumped: the film has no time to
    change, and the bodies take the jump up under the pressure that there was.
    """
    a = x.grid_scale
    moved = u.approach - u.retreat - x.rigid_approach if p.load_is_given == 0.0 else 0.0
    bent = 1.0 / u.radius_of_curvature - x.curvature
    total = 0.0
    for i in range(1, X.shape[0] - 1):
        square = (a * X[i]) ** 2 / 2.0
        rough = asperities_at(x.film[i], bodies)
        deflected = rough.gap + x.rigid_approach - x.curvature * square
        by_jump = moved - bent * square
        elastic = (x.pressure[i] + rough.pressure) * (0.5 * deflected + by_jump) + rough.energy
        total += a * cell(X, i) * (elastic + oil_energy(x.pressure[i], x.film[i], fluid))
    return total * bodies.length


@kernel
def shape_power(x: Any, X: Any, bodies: Bodies) -> float:
    """What a curvature that changes does to the contact (W): it falls where surfaces come closer."""
    total = 0.0
    for i in range(1, X.shape[0] - 1):
        pressure = x.pressure[i] + asperities_at(x.film[i], bodies).pressure
        total += pressure * X[i] ** 2 * cell(X, i)
    return -0.5 * x.curvature_rate * x.grid_scale**3 * total * bodies.length


@kernel
def flow_powers(
    x: Any, u: Any, X: Any, fluid: Lubricant, bodies: Bodies, laws: HeatLaws, heat: Heat, f: Nodes,
    bands: Any, room: Any,
) -> tuple[float, float]:  # fmt: skip
    """What the pressure's flow loses, and what the surfaces give that drag oil along (W).

    From two balances of the volumes, with the surfaces' velocity and without: summed up by parts, flows
    times differences of H. `f`, `bands` (2, BAND, n) and `room` (_VECTORS, n) are scratch.
    """
    n = X.shape[0]
    pressure, film, none, residual = room[0], room[1], room[2], room[3]
    for i in range(n):
        pressure[i], film[i], none[i] = x.pressure[i], x.film[i], 0.0
        f.filled[i], f.share[i] = 1.0, 1.0
    keep_cold(f)
    find_filled(pressure, x.filling, f)
    if is_heated(laws):
        thin_film(fluid, laws, heat, f)
        shear_film(X, x.grid_scale, pressure, film, u.sliding_velocity, fluid, laws, heat, f)
    properties(pressure, film, fluid, f)
    copy(room[4], f.drift)
    fill_partly(pressure, x.filling, f)
    lost, left = 0.0, 0.0
    for driven in range(2):
        velocity = u.entraining_velocity if driven == 1 else 0.0
        for i in range(n):
            f.drift[i] = driven * room[4, i]
        flow = Flow(velocity, u.sliding_velocity, u.radius_of_curvature)
        balance(X, x.grid_scale, 0.0, pressure, film, f, flow, fluid, none, math.inf, residual,
                bands[0], bands[1])  # fmt: skip
        total = 0.0
        for i in range(1, n - 1):
            total += enthalpy(pressure[i], fluid) * residual[i]
        if driven == 1:
            left = total
        else:
            lost = total
    return lost * bodies.length, (lost - left) * bodies.length


class SolvedFilm(NamedTuple):
    """What energies see of a contact's state (see `field_state`)."""

    pressure: Any
    film: Any
    grid_scale: float
    rigid_approach: float
    approach_rate: float
    curvature: float
    curvature_rate: float
    filling: Any


def make_field_energy(nodes: int, filled: int, layers: int = 0) -> Any:
    """energy(t, x, u, p, e) of records, as `Component.energy`, also of a field that is to begin."""
    X, build_laws = node_positions(nodes), laws_of(layers)
    hot = int(heat_size(nodes, layers))

    @kernel
    def solved_energy(film: SolvedFilm, x: Any, u: Any, p: Any, e: Any) -> None:
        bodies, fluid = build_bodies(p), build_lubricant(p, p.density_law)
        r = np.empty((FIELDS + _VECTORS, nodes))
        bands = np.empty((2, BAND, nodes))
        heat = heat_in(np.empty(hot), nodes, layers)
        copy(heat.flat, x.temperature)
        lost, dragged = flow_powers(
            film, u, X, fluid, bodies, build_laws(p), heat, nodes_in(r), bands, r[FIELDS:]
        )
        rubbed = (x.field_shear + x.field_boundary_friction) * u.sliding_velocity
        e[STORED] = stored_energy(film, u, p, X, fluid, bodies)
        e[DISSIPATED_POWER] = lost + rubbed
        e[SOURCE_POWER] = dragged + rubbed + shape_power(film, X, bodies)
        if p.load_is_given != 0.0:
            # The bodies approach as they must, and not as inputs say by which the bonds count.
            e[SOURCE_POWER] += x.field_load * (film.approach_rate - u.approach_rate + u.retreat_rate)

    @kernel
    def field_energy(t: float, x: Any, u: Any, p: Any, e: Any) -> None:
        pressure, film, filling = np.empty(nodes), np.empty(nodes), np.empty(filled)
        if x.grid_scale == 0.0:
            begun = begin(x.film_thickness, u, p, X, pressure, film)
            start_filling(pressure, film, p.oil_supply, filling)
            scale, approach, curvature = begun.grid_scale, begun.rigid_approach, 1.0 / u.radius_of_curvature
        else:
            copy(pressure, x.pressure)
            copy(film, x.film)
            copy(filling, x.filling)
            scale, approach, curvature = x.grid_scale, x.rigid_approach, x.curvature
        found = SolvedFilm(
            pressure, film, scale, approach, x.approach_rate, curvature, x.curvature_rate, filling
        )
        solved_energy(found, x, u, p, e)

    return field_energy
