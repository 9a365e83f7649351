"""A cam that wears: its lift, less what has worn off, through the points of a fixed mesh.

At every cam angle the follower touches one place of the cam. What has worn off there along the normal (m)
lowers the follower by that depth over the overlap's derivative by the lift. Under a flat follower the normal
is that of the lift, and the depth is what its support function R0 + s loses.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..core.quantities import Vector
from .cams.lift import Lift
from .cams.profile import CamProfile
from .cams.table import TURN, Points
from .followers.shape import Follower

# Places of the wear over a turn, half a degree apart, and the edges between them (rad).
COUNT = 720
SPACING = TURN / COUNT
PLACES: Vector = np.asarray(SPACING * np.arange(COUNT), dtype=np.float64)
EDGES: Vector = np.asarray(SPACING * (np.arange(COUNT + 1) - 0.5), dtype=np.float64)
# Least standard deviation (rad) of the Gaussian that smooths wear: four places. Of waves as long as four
# places it leaves 3e-9, so that the spline's curvature does not depend on the mesh.
FINEST = math.radians(2.0)
# A wider one (rad) would hide where an event of some 120 deg wears.
WIDEST = math.radians(15.0)
BEND = 4.0 * math.exp(-1.5)
# Of a lift (m), to differentiate the overlap by it: positions have errors of 1e-18 m.
SHIFT = 1e-7


class CamKind(NamedTuple):
    """A component's cam: its profile with the record of its parameters, its follower with its geometry."""

    profile: CamProfile
    record: Any
    follower: Follower
    geometry: Any

    def lift(self, angle: float) -> Lift:
        return self.profile.lift(angle, self.record)


@dataclass(frozen=True)
class FreshCam:
    """An unworn cam: its base circle (m) and points of its lift; at PLACES by what the overlap grows with the
    lift, and the arc of its contour per cam angle (m)."""

    base_radius: float
    points: Points
    overlap_by_lift: Vector
    arc: Vector

    def interpolate(self, loss: Vector) -> Vector:
        """At the points, losses of lift, slope and curvature, by those of lift (m) at PLACES with a periodic
        quintic spline in between; linear in the latter."""
        from scipy.interpolate import make_interp_spline  # runs without wear need no scipy for it

        spline = make_interp_spline(
            np.append(PLACES, TURN), np.append(loss, loss[0]), k=5, bc_type="periodic"
        )
        return np.array([spline(self.points.angle, nu=nu) for nu in range(3)])

    def lower(self, losses: Vector) -> Points:
        """The points with these losses of lift, slope and curvature there."""
        p = self.points
        return Points(p.angle, *(a - b for a, b in zip((p.lift, p.slope, p.curvature), losses, strict=True)))

    def wear_off(self, loss: Vector) -> Points:
        """The points with these losses of lift (m) at PLACES."""
        return self.lower(self.interpolate(loss))


def sample_cam(cam: CamKind) -> FreshCam:
    """A point at every place; the nearest to a break of the profile is moved there.

    Always so many points have components compiled once.
    """
    angles = PLACES.copy()
    for at in find_all_breaks(cam):
        angles[round(at / SPACING) % COUNT] = at % TURN
    angles.sort()
    columns = np.array([cam.lift(a) for a in angles]).T
    arc = [cam.follower.touch(cam.lift(a), cam.geometry).cam_rate for a in PLACES]
    by_lift = [find_overlap_by_lift(cam, a) for a in PLACES]
    points = Points(angles, *columns)
    return FreshCam(cam.geometry.base_radius, points, np.array(by_lift), np.array(arc))


def find_all_breaks(cam: CamKind) -> list[float]:
    """Cam angles in a turn where s'' or s''' of its profile jumps."""
    found, angle = list[float](), 0.0
    while (angle := angle + cam.profile.find_breaks(angle, cam.record).ahead) <= TURN:
        found.append(angle)
    return found


def find_overlap_by_lift(cam: CamKind, angle: float) -> float:
    """n . dC/ds of the follower's centre C where the cam rests: 1 of a flat follower, the cosine of the
    pressure angle of one on a line."""
    radius = getattr(cam.geometry, "radius", 0.0)
    lift = cam.lift(angle)
    here, there = (
        cam.follower.touch(lift._replace(s=lift.s + shift), cam.geometry) for shift in (0.0, SHIFT)
    )
    n_x, n_y = here.normal_x, here.normal_y
    x = there.x - here.x + radius * (there.normal_x - n_x)
    y = there.y - here.y + radius * (there.normal_y - n_y)
    return (n_x * x + n_y * y) / SHIFT


def choose_filter(depth: float, arc: Vector) -> float:
    """Standard deviation (rad) of a Gaussian so wide that wear of this depth (m) leaves the cam convex.

    `arc` (m) is that of the cam per cam angle. A peak of such a width bends the lift beside it by
    2 exp(-3/2) depth/width^2, which may be half of the least arc.
    """
    return max(FINEST, math.sqrt(BEND * depth / float(arc.min())))


def find_most_depth(arc: Vector) -> float:
    """The depth (m) whose filter is WIDEST."""
    return WIDEST**2 * float(arc.min()) / BEND


def smooth(values: Vector, width: float) -> Vector:
    """By a Gaussian of this standard deviation (rad) around the turn, which keeps their sum."""
    from scipy.ndimage import gaussian_filter1d

    return np.asarray(gaussian_filter1d(values, width / SPACING, mode="wrap"))
