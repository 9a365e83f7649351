"""A cam by segments of its acceleration in a scenario, which becomes the points of its profile."""

import math
from typing import Annotated, Any

import numpy as np
from pydantic import Field, ValidationError

from models.valve_train.cams.segments import Rise, join_sides, scale_rise

from .fields import Table, in_unit
from .lift_table import check_no_law
from .messages import place_faults
from .values import Faults

Angle = Annotated[float, in_unit("rad", zero=True)]
Side = list[tuple[Angle, float]]
EXAMPLE = '[["0 deg", 0], ["12 deg", 1], ["24 deg", 1], ["34 deg", -0.3], ["65 deg", -0.4]]'


class LiftSegments(Table):
    """Accelerations at angles from the foot of the cam, straight lines between them."""

    lift: Annotated[float, in_unit("m")] = Field(description="Lift (m)")
    rise: Side = Field(
        description="Rows of angle from the opening's foot and relative acceleration", min_length=3
    )
    fall: Side | None = Field(
        None, description="The same from the closing's foot; left out: as the rise", min_length=3
    )
    dwell: Angle = Field(0.0, description="Angle of the dwell at the nose (rad)")
    nose: Angle = Field(math.pi, description="Cam angle of the nose (rad)")


def insert_lift_segments(table: dict[str, Any]) -> dict[str, Any]:
    """A component's table with the points of its `lift_segments` among structure and parameters."""
    check_no_law(table, "lift_segments")
    try:
        given = LiftSegments.model_validate(table["lift_segments"])
    except ValidationError as error:
        raise place_faults("lift_segments", error) from None
    rise = _scale("rise", given.rise, given.lift)
    fall = _scale("fall", given.fall, given.lift) if given.fall else rise
    try:
        points = join_sides(rise, fall, given.nose, given.dwell)
    except ValueError as error:
        raise Faults(("lift_segments", f": {error}")) from None
    turned = points.angle[-1] - points.angle[0]
    if turned > 2.0 * math.pi:
        raise Faults(("lift_segments", f": spans {math.degrees(turned):.4g} deg: must be at most 360 deg"))
    event = {"event_begin": float(points.angle[0]), "event_end": float(points.angle[-1])}
    rest = {key: value for key, value in table.items() if key != "lift_segments"}
    return rest | {
        "structure": {**table.get("structure", {}), "table_points": points.angle.size},
        "parameters": {**points.parameters(), **event, **table.get("parameters", {})},
    }


def _scale(name: str, rows: Side, lift: float) -> Rise:
    angle, acceleration = np.array(rows).T
    if angle[0] != 0.0 or acceleration[0] != 0.0 or not np.all(np.diff(angle) > 0.0):
        raise Faults(
            (
                f"lift_segments.{name}",
                f": must begin with angle and acceleration 0, and ascend; e.g. {EXAMPLE}",
            )
        )
    try:
        return scale_rise(angle, acceleration, lift)
    except ValueError as error:
        raise Faults((f"lift_segments.{name}", f": {error}")) from None
