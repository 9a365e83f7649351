"""Oil grooves of bearings: how far the load points from them, and where they would not thin the film."""

import math

import numpy as np

from models.core import roles
from models.core.system import Instance

from ..scenario.display import format_number
from .motion import NONE, Found, Part
from .trains import parameter_of


def find_load_from_groove(bearing: Part) -> Found:
    """The angle (rad) from the nearest groove's middle to the load at the least film; none without grooves.

    The load is along x where the bearing has no components of its force.
    """
    parameters = bearing.component.parameters
    films = parameters.field("film_model").quantity.choices if "groove_angle" in parameters.names else ()
    if not films or films[int(bearing.parameter("film_model"))] != "grooved":
        return NONE
    row, load = int(np.argmin(bearing["minimum_film_thickness"])), 0.0
    if "force_x" in bearing.component.outputs.names:
        load = math.atan2(-bearing["force_y"][row], -bearing["force_x"][row])
    return Found(math.remainder(load - bearing.parameter("groove_angle"), math.pi), row)


def describe_groove(name: str, bearing: Instance, away: float) -> str:
    """What a groove does that the load is `away` from (rad), and the remedy; "" outside the load zone."""
    if abs(away) >= roles.Bearing.load_zone:
        return ""
    across = (parameter_of(bearing, "groove_angle") + away + 0.5 * math.pi) % math.pi
    distance, better = (format_number(math.degrees(angle), 3) for angle in (abs(away), across))
    return (
        f"; at the least film the load points {distance} deg beside the middle of a groove, where films are "
        f"down to a twentieth as thick: set components.{name}.parameters.groove_angle = '{better} deg', at a "
        "right angle to the load"
    )
