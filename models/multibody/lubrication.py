"""The oil film between a cam and a flat face: the contact's law of the components, between two bodies."""

from typing import Any, NamedTuple

from ..compile.kernel import kernel
from ..contact.ehl_contact import contact
from .constraints import Curve, carry, differ, point_at
from .loads import close, push_apart
from .tables import Evaluation
from .vectors import cross, dot


class Film(NamedTuple):
    """State of a contact, as its law reads it."""

    film_thickness: float


class Surfaces(NamedTuple):
    """Inputs of a contact, as its law reads them."""

    approach: float
    approach_rate: float
    retreat: float
    retreat_rate: float
    entraining_velocity: float
    sliding_velocity: float
    radius_of_curvature: float
    applied_load: float


@kernel
def find_drift(e: Evaluation, row: Any) -> float:
    """Velocity of the cam's axis along the face, against the motion of its surface.

    Kushwaha et al. 2000, section 5, call the speed that it adds fictitious.
    """
    n, axis = carry(e, row.j, row.b), cross(carry(e, row.i, row.a).value, carry(e, row.i, row.a2).value)
    arm_i, arm_j = carry(e, row.i, row.p_i), carry(e, row.j, row.p_j)
    apart = differ(point_at(e, row.i, arm_i), point_at(e, row.j, arm_j))
    return dot(cross(n.value, axis), apart.rate)


@kernel
def meet(e: Evaluation, k: int, row: Any, curve: Curve, turning: float) -> Surfaces:
    """The surfaces of the contact k, whose row of `touch` is filled.

    R = R0 + s + s''; u = psi' (R0 + s + 2 s'')/2 + w/2, sliding psi' (R0 + s) - w, w the axis's drift.
    """
    base_radius, profile, drift = curve.base_radius, curve.lift, find_drift(e, row)
    return Surfaces(
        e.touch.value[k],
        close(e, k),
        0.0,
        0.0,
        0.5 * (turning * (base_radius + profile.s + 2.0 * profile.dds) + drift),
        turning * (base_radius + profile.s) - drift,
        base_radius + profile.s + profile.dds,
        0.0,
    )


@kernel
def lubricate(e: Evaluation, k: int, row: Any, curve: Curve, turning: float, film: float, oil: Any) -> None:
    """Load and film rate of the contact k, and its forces f = -J^T W."""
    # The law reads its records by name.
    state: Any = Film(film)
    surfaces: Any = meet(e, k, row, curve, turning)
    found = contact(state, surfaces, oil)
    e.film_rate[k] = found.film_rate
    push_apart(e, k, found.load)
