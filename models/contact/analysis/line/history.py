"""The film along a given motion: load, entraining velocity and radius of curvature as functions of time."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from ....core.component import Component
from ....core.integrator import FAILURES, OK
from ....core.quantities import Vector
from ....core.system import ModelError
from ...ehl_contact import ehl_contact
from ...ehl_line_contact import ehl_line_contact
from ...films import FILMS
from ...line.grid import node_positions


@dataclass(frozen=True)
class FilmHistory:
    """Fields of n instants: central and minimum film (m), highest pressure (Pa), load (N) and what of it
    asperities carry (N); oil's `pressure` (Pa), `film` (m) and `x` (m), (n, nodes)."""

    times: Vector
    film_thickness: Vector
    minimum_film_thickness: Vector
    maximum_pressure: Vector
    load: Vector
    asperity_load: Vector
    x: Vector
    pressure: Vector
    film: Vector


def film_history(
    times: Vector,
    load: Vector,
    entraining_velocity: Vector,
    radius_of_curvature: Vector,
    nodes: int = 301,
    parameters: Mapping[str, float] | None = None,
    film_thickness: float = 1e-6,
    sliding_velocity: Vector | None = None,
    **structure: int,
) -> FilmHistory:
    """The transient film under a load (N) with velocity (m/s) and radius (m) given at ascending `times` (s),
    and the sliding (m/s), in pure rolling without. `structure`: `mass_conserving` and `layers`.

    Between the instants they follow cubic splines. It begins with Hertz's pressure over `film_thickness`
    (m), and forgets that within a few passages through the contact. `parameters` of `ehl_line_contact` by
    name; surfaces are smooth unless a roughness is among them.
    ModelError for parameters out of range and where a step does not converge.
    """
    component = ehl_line_contact(nodes=nodes, **structure)
    given = dict(zip(_MOTION, (load, entraining_velocity, radius_of_curvature), strict=True))
    if sliding_velocity is not None:
        given["sliding_velocity"] = sliding_velocity
    chosen = {"roughness": 0.0, **(parameters or {})}
    states = _step_through(component, times, given, chosen, film_thickness)
    return _collect_fields(np.asarray(times[1:]), states, component)


def formula_history(
    formula: str, times: Vector, load: Vector, entraining_velocity: Vector, radius_of_curvature: Vector
) -> Vector:
    """As `film_history`, the film (m) of one of FILMS with its squeeze term: the contact's relaxation."""
    component = ehl_contact()
    given = dict(zip(_MOTION, (load, entraining_velocity, radius_of_curvature), strict=True))
    chosen = {"film_model": float(list(FILMS).index(formula))}
    states = _step_through(component, times, given, chosen, 1e-6)
    return np.asarray(states[:, component.state.index("film_thickness")])


# The contact's names for load, entraining velocity and radius.
_MOTION = ("applied_load", "entraining_velocity", "radius_of_curvature")


def _step_through(
    component: Component,
    times: Vector,
    given: Mapping[str, Vector],
    parameters: Mapping[str, float],
    film_thickness: float,
) -> Vector:
    """The states at all times but the first."""
    p = component.parameters.vector({**parameters, "load_is_given": 1.0})
    if faults := component.parameter_faults(p):
        raise ModelError("; ".join(faults))
    x = component.state.vector({"film_thickness": film_thickness})
    inputs = component.inputs
    splines = {inputs.index(name): CubicSpline(times, values) for name, values in given.items()}
    U = component.input_polynomial()
    u, y = component.inputs.vector(), np.zeros(component.outputs.size)
    states, work = np.empty((len(times) - 1, component.state.size)), np.zeros(component.work_size)
    for k, (t, h) in enumerate(zip(times[:-1], np.diff(times), strict=True)):
        for i, spline in splines.items():
            U[:, i] = [spline(t, order) for order in range(4)]
        status = component.step(t, h, x, U, p, component.state.nominal, work, u, y)
        if status != OK:
            raise ModelError(f"film at t = {t:g} s: {FAILURES[status]}; give closer times")
        states[k] = x
    return states


def _collect_fields(times: Vector, states: Vector, component: Component) -> FilmHistory:
    rows = [component.state.view(state) for state in states]

    def along(name: str) -> Vector:
        return np.array([getattr(row, name) for row in rows])

    return FilmHistory(
        times=times,
        film_thickness=along("film_thickness"),
        minimum_film_thickness=along("least_film"),
        maximum_pressure=along("highest_pressure"),
        load=along("field_load"),
        asperity_load=along("field_asperity_load"),
        x=along("grid_scale")[:, None] * node_positions(component.structure["nodes"])[None, :],
        pressure=along("pressure"),
        film=along("film"),
    )
