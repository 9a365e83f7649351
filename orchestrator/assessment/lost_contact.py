"""Lost contact: its one definition, speeds at which it is met; where films and friction have a meaning."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.compile.compiled import compiled
from models.core.quantities import Vector

if TYPE_CHECKING:
    import xarray  # takes long to import

# A load (N) below this is rounding.
ROUNDING = 1e-9
# What a contact does: it carries load, or is open at rest, on a ramp, or lost.
LOADED, AT_REST, ON_RAMP, LOST = range(4)


@compiled
def judge(load: float, lift: float, lash: float, lobe: float, before: int) -> int:
    """What a contact does at this load (N) and lift of its cam (m), after `before`, by its `ContactLaw`."""
    if load > ROUNDING:
        return LOADED
    if lift > lobe:
        return LOST
    if lift <= lash:
        return AT_REST
    return LOST if before == LOST else ON_RAMP


@compiled
def judge_rows(load: Any, lift: Any, lash: float, lobe: float, found: Any) -> None:
    before = LOADED
    for i in range(len(load)):
        before = found[i] = judge(load[i], lift[i], lash, lobe, before)


class ContactLaw(NamedTuple):
    """What a contact without load is, by the lift of its cam (m).

    - Up to the `lash`, on base circle and ramps, it is open as designed: a seat bears the valve.
    - On the lobe it is lost: above a tenth of the largest lift, and above the lash (`lobe`).
    - On a ramp between them it has rebounded, as the lash was taken up or the valve put down. A flight that
      has been on the lobe is lost there too, until load returns or the cam comes down to the lash.

    The lash is that at the valve as the cam has it (`Train.lash`). A valve without a seat is borne by its cam
    alone, a lash adjuster has to keep contact on the base circle, and a contact without a cam has no base
    circle: there nothing is at rest, and every contact without load is lost. That is the default.
    """

    lash: float = -math.inf
    lobe: float = -math.inf

    @property
    def rests(self) -> bool:
        """Whether a seat may bear the valve."""
        return self.lobe > -math.inf

    def judge(self, load: Vector, lift: Vector) -> NDArray[np.int8]:
        """What the contact does in these rows, from the first to the last."""
        found = np.zeros(len(load), np.int8)
        judge_rows(load, lift, self.lash, self.lobe, found)
        return found


def list_shares(table: xarray.Dataset, number: str = "lost") -> list[str]:
    """The names of this share of the cycle, one of each contact."""
    return [name for name in map(str, table.data_vars) if name.endswith(f".{number}")]


def find_lost(table: xarray.Dataset, number: str = "lost") -> NDArray[np.bool_]:
    """By speed, whether any contact has this share."""
    shares = [table[name].values for name in list_shares(table, number)]
    return np.any(np.reshape(shares, (len(shares), table.sizes["speed"])) > 0.0, axis=0)


def find_unsteady(table: xarray.Dataset) -> Vector:
    """The speeds (rad/s) at which no steady cycle was found."""
    from models.monolithic.cycle import STEADY  # with scipy's integrators, which a run does without

    return np.asarray(table["speed"].values[table["change"].values > STEADY] if "change" in table else [])


def find_rippled(table: xarray.Dataset) -> NDArray[np.bool_]:
    """By speed, whether a period changes the motion so much that its figures are none of a cycle."""
    from models.monolithic.cycle import USABLE

    return np.asarray(table["change"].values > USABLE) if "change" in table else find_lost(table) & False


def bound_speeds(speeds: Vector, separation: float | None) -> Vector:
    """Ends of the stretches for which ascending speeds stand, in their unit: half-way to the next, but at the
    separation between two of them."""
    edges = np.concatenate([speeds[:1], 0.5 * (speeds[1:] + speeds[:-1]), speeds[-1:]])
    if separation is not None and 0 < (after := int(np.searchsorted(speeds, separation))) < speeds.size:
        edges[after] = separation
    return edges


# Film variables of a contact.
FILMS = ("film_thickness", "minimum_film_thickness", "steady_film_thickness", "film_ratio")
# Of the contact's largest load. Under less, asperities alone hold the surfaces apart: film_ratio rises
# without bound as the load goes to zero, within a microsecond of touch or separation.
LIGHT = 0.01
# Of the largest sliding velocity. Below it a contact is at rest but for elastic vibrations: boundary friction
# has its full size, and a sign that they change at random.
SLOW = 1e-3


def has_film(variable: str, load: Vector) -> NDArray[np.bool_]:
    """Rows in which one of FILMS has a meaning: under load; film_ratio under more than a LIGHT one of its
    cycle, the last axis."""
    light = LIGHT * np.max(load, axis=-1, keepdims=True, initial=0.0) if variable == "film_ratio" else 0.0
    return np.asarray(load > light)


def slides(velocity: Vector) -> NDArray[np.bool_]:
    """Rows in which friction has a sign."""
    size = np.abs(velocity)
    return np.asarray(size >= SLOW * float(np.max(size, initial=0.0)))
