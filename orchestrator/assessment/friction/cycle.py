"""A contact over the last whole revolution of its cam: friction, its torque and power, and wear."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from models.contact.wear import trapezoidal, worn_depth
from models.core.quantities import Quantity, Vector

from ...errors import MistakeError, Words
from ..figures_of_merit import SHARE
from ..lost_contact import LOST, ContactLaw
from ..trains import OPEN

TURN = 2.0 * math.pi
# The least movement of a contact over the cam, in radii of curvature per cam angle: it stands.
STANDING = 1e-6
# Bins of the wear: half a degree of the cam, and as fine along the follower.
BINS = 720

OF_CONTACT = (
    "load", "asperity_load", "friction_force", "viscous_friction", "boundary_friction", "half_width",
    "film_ratio",
)  # fmt: skip
OF_CAM = (
    *("cam_angle", "cam_speed", "sliding_velocity", "entraining_velocity", "radius_of_curvature"),
    *("contact_offset", "cam_lift", "cam_sliding"),
)


@dataclass(frozen=True)
class Cycle:
    """Records of one revolution: the variables of OF_CONTACT and OF_CAM with their units, and the time."""

    contact: str
    time: Vector
    values: Mapping[str, Vector]
    law: ContactLaw = ContactLaw()
    units: Mapping[str, str] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Vector:
        return self.values[name]

    def mean(self, value: Vector) -> float:
        """Over the time."""
        return float(trapezoidal(self.time) @ value / (self.time[-1] - self.time[0]))

    @property
    def turned(self) -> float:
        """Angle of the cam from the first record to the last (rad)."""
        angle = self["cam_angle"]
        return float(angle[-1] - angle[0])

    @property
    def lost(self) -> NDArray[np.bool_]:
        """Where contact is lost."""
        return self.law.judge(self["load"], self["cam_lift"]) == LOST

    @property
    def arc(self) -> Vector:
        """By what the contact moves along the cam's contour per cam angle (m), u/omega + u_s/(2 omega): rho
        under a flat follower, under an arc rho times the turn of the normal in the cam per cam angle. The
        sliding is that of the cam's motion; a tappet that spins changes the contact's."""
        moved = np.abs(self["entraining_velocity"] + 0.5 * self["cam_sliding"]) / self["cam_speed"]
        return np.asarray(np.maximum(moved, STANDING * np.abs(self["radius_of_curvature"])))

    @property
    def power(self) -> Vector:
        """Friction power F u_s (W)."""
        return np.asarray(self["friction_force"] * self["sliding_velocity"])

    @property
    def torque(self) -> Vector:
        """Friction torque on the camshaft (N m): F (R0 + s), with R0 + s = u_s/omega."""
        return np.asarray(self.power / self["cam_speed"])


def last_revolution(contact: str, time: Vector, values: Mapping[str, Vector], remedy: Words = "") -> Cycle:
    """The last whole revolution; MistakeError if the cam turns back, or does not turn one, with the `remedy`,
    by default a later stop_time."""
    angle = values["cam_angle"]
    turned = angle[-1] - angle[0]
    forwards = np.diff(angle) > 0.0
    if abs(turned) < TURN * (1.0 - OPEN):
        needed = (time[-1] - time[0]) * TURN / abs(turned) if turned else math.inf
        later = f"a stop_time of {needed:.4g} s would do" if needed < math.inf else "the cam stands still"
        raise MistakeError(
            f"{contact}: its cam turns {math.degrees(abs(turned)):.4g} deg in the run: must be a revolution",
            remedy or later,
        )
    if turned < 0.0 or not forwards.all():
        raise MistakeError(f"{contact}: its cam does not turn forwards all the time; there is no cycle")
    begin = max(angle[0], angle[-1] - TURN)
    first = int(np.searchsorted(angle, begin, side="right"))

    def whole(column: Vector) -> Vector:
        return np.concatenate([[np.interp(begin, angle, column)], column[first:]])

    return Cycle(contact, whole(time), {name: whole(column) for name, column in values.items()})


# Of one revolution, in the order in which it is told.
SUMMARY: Mapping[str, Quantity] = {
    "mean_torque": Quantity("N.m", "mean friction torque"),
    "largest_torque": Quantity("N.m", "largest friction torque"),
    "mean_power": Quantity("W", "mean friction power"),
    "work": Quantity("J", "friction work"),
    "coefficient": Quantity("1", "coefficient of friction: work over load times sliding distance"),
    "asperity_share": SHARE.of("asperities' share of the load"),
    "boundary_share": SHARE.of("asperities' share of the work"),
    "least_film_ratio": Quantity("1", "least film of the oil under load over the roughness"),
    "lost": SHARE.of("time in which contact is lost"),
}


def summarise(cycle: Cycle) -> dict[str, float]:
    """The numbers of SUMMARY: of the torque a mean over the angle, of the power over the time."""
    time = trapezoidal(cycle.time)
    work = float(time @ cycle.power)
    loaded = float(time @ (cycle["load"] * np.abs(cycle["sliding_velocity"])))
    boundary = float(time @ (cycle["boundary_friction"] * cycle["sliding_velocity"]))
    load = cycle.mean(cycle["load"])
    return {
        "mean_torque": work / cycle.turned,
        "largest_torque": float(np.abs(cycle.torque).max()),
        "mean_power": work / float(cycle.time[-1] - cycle.time[0]),
        "work": work,
        "coefficient": work / loaded if loaded else 0.0,
        "asperity_share": cycle.mean(cycle["asperity_load"]) / load if load else 0.0,
        "boundary_share": boundary / work if work else 0.0,
        "least_film_ratio": float(np.min(cycle["film_ratio"], where=cycle["load"] > 0.0, initial=np.inf)),
        "lost": cycle.mean(cycle.lost.astype(float)),
    }


@dataclass(frozen=True)
class Wear:
    """Depth (m) of one revolution over the cam's angle (rad, from 0) and the place on the follower (m).

    The volumes (m3) are those that Archard's law gives directly: k times load times sliding distance.
    """

    cam_angle: Vector
    cam_depth: Vector
    follower_place: Vector
    follower_depth: Vector
    volume: float


def wear(cycle: Cycle, load: str, coefficient: float, length: float) -> Wear:
    """Wear of each body under the variable `load`, if it has the wear coefficient (m2/N) to itself."""
    rubbed = cycle[load] * np.abs(cycle["sliding_velocity"]) * trapezoidal(cycle.time)
    dose, width = rubbed / length, cycle["half_width"]
    edges = np.linspace(0.0, TURN, BINS + 1)
    arc = cycle.arc
    cam = worn_depth(edges, np.mod(cycle["cam_angle"], TURN), width / arc, dose / arc, TURN)
    offset = cycle["contact_offset"]
    reach = float(width.max()) or 1e-6
    along = np.linspace(offset.min() - reach, offset.max() + reach, BINS + 1)
    follower = worn_depth(along, offset, width, dose)
    return Wear(
        cam_angle=0.5 * (edges[:-1] + edges[1:]),
        cam_depth=coefficient * cam,
        follower_place=0.5 * (along[:-1] + along[1:]),
        follower_depth=coefficient * follower,
        volume=coefficient * float(rubbed.sum()),
    )
