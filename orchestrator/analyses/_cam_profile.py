"""The profile and the followers that the analysis of a cam is asked for, from its parameters."""

import math
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple, get_type_hints

import numpy as np

from models.core.component import Component
from models.core.quantities import Layout, Quantity
from models.plausible import CURVATURE, LEVER_ANGLE, OFFSET, PART_LENGTH
from models.valve_train.cams.law import LAW, LawParameters, law_lift
from models.valve_train.cams.lift import Lift
from models.valve_train.cams.profile import CamProfile
from models.valve_train.cams.ramps import RampParameters, ramp_turn
from models.valve_train.cams.rises import RISES
from models.valve_train.cams.smoothing import SmoothedLift
from models.valve_train.cams.table import TABLE, TURN, Points, table_lift
from models.valve_train.camshaft import camshaft
from models.valve_train.followers.shape import FOLLOWERS, CamShape, Follower

from ..errors import MistakeError
from ..scenario.angle_table import AngleTableError
from ..scenario.cam_files import read_contour
from ..scenario.lift_table import LiftTable, smooth_file
from .protocol import Parameter

# Of a follower: the geometry's field, and the parameter with its default.
GEOMETRY = {
    "radius": Parameter(10e-3, "m", "radius of roller or pad", positive=True, plausible=CURVATURE),
    "tilt": Parameter(
        0.0, "rad", "tilt of a flat follower's face from normal to its path", minimum=-1.0, maximum=1.0
    ),
    "offset": Parameter(
        0.0, "m", "offset of a translating follower's path from the cam's axis", plausible=OFFSET
    ),
    "cam_arm": Parameter(
        28e-3, "m", "finger: from the pivot to the centre of roller or pad", plausible=PART_LENGTH
    ),
    "pivot_angle": Parameter(
        math.radians(8.0),
        "rad",
        "finger: fall of that line from the pivot, valve closed",
        plausible=LEVER_ANGLE,
    ),
    "valve_arm": Parameter(
        40e-3, "m", "finger: from the pivot to the centre of the pad on the valve", plausible=PART_LENGTH
    ),
    "valve_angle": Parameter(
        math.radians(2.0), "rad", "finger: further fall of that line", plausible=LEVER_ANGLE
    ),
}
# A contour has a base circle to this part of its radius, and lifts from this part of its lift on.
ROUND = 1e-4
# A nose is level to this part of the lift.
LEVEL = 1e-6
TABLE_EVENT = {
    name: Parameter(0.0, "rad", f"lift table: cam angle at which the {ramp} ramp joins; 0: found")
    for name, ramp in (("event_begin", "opening"), ("event_end", "closing"))
}
FIELDS = {name: tuple(get_type_hints(one.geometry)) for name, one in FOLLOWERS.items()}


def list_lift_parameters() -> dict[str, Parameter]:
    """The parameters of a lift by a table or a law."""
    table = Parameter("", "1", "CSV file of cam angle and lift, instead of a law")
    return {"lift_table": table, **TABLE_EVENT, **list_law_parameters()}


def list_law_parameters() -> dict[str, Parameter]:
    """The parameters of a cam by a law, as those of an analysis."""
    return convert(LawParameters)


def convert(record: type) -> dict[str, Parameter]:
    """The parameters of a component as those of an analysis."""
    return {field.name: _convert(field.quantity, field.start) for field in Layout(record).fields}


def _convert(quantity: Quantity, default: Any) -> Parameter:
    kept = ("unit", "description", "minimum", "maximum", "choices", "positive", "plausible")
    known = quantity.choices[int(default)] if quantity.choices else default
    return Parameter(known, **{name: getattr(quantity, name) for name in kept})


class Profile(NamedTuple):
    """A lift over the cam angle, its event and breaks (rad), and table and smoothing of a lift table."""

    lift: Callable[[float], Lift]
    event: tuple[float, float]
    breaks: list[float]
    table: LiftTable | None = None
    smoothing: SmoothedLift | None = None

    @property
    def nose(self) -> float:
        """The middle of where it lifts most (rad)."""
        angles = np.linspace(0.0, TURN, 3601)
        lift = np.array([self.lift(a).s for a in angles])
        top = angles[lift >= lift.max() * (1.0 - LEVEL)]
        if top[-1] - top[0] > 0.5 * TURN:  # on both sides of zero
            top = (top + 0.5 * TURN) % TURN - 0.5 * TURN
        return float(np.mean(top) % TURN)


def build_profile(values: Mapping[str, Any]) -> Profile:
    """By the law, or through the lift table; MistakeError for a fault."""
    if values["lift_table"]:
        return _build_table_profile(values)
    if values.get("contour"):
        return _build_contour_profile(values)
    given = {name: values[name] for name in list_law_parameters()}
    given["law"] = float(tuple(RISES).index(given["law"]))
    record = _check_record(LAW, camshaft(), given)
    breaks = _list_breaks(LAW, record)
    return Profile(lambda angle: law_lift(angle, record), (breaks[0], breaks[-1]), breaks)


def _build_table_profile(values: Mapping[str, Any]) -> Profile:
    try:
        table, smoothed = smooth_file(Path(values["lift_table"]).expanduser())
    except AngleTableError as error:
        raise MistakeError(f"lift_table: {error}") from None
    points = smoothed.points
    begin, end = (values[name] or found for name, found in zip(TABLE_EVENT, smoothed.event, strict=True))
    ramps = {field.name: values[field.name] for field in fields(RampParameters)}
    given = {**points.parameters(), "event_begin": begin, "event_end": end, **ramps}
    record = _check_record(TABLE, camshaft(table_points=points.angle.size), given)
    event = (begin - ramp_turn(True, record), end + ramp_turn(False, record))
    return Profile(
        lambda angle: table_lift(angle, record), event, _list_breaks(TABLE, record), table, smoothed
    )


def _build_contour_profile(values: Mapping[str, Any]) -> Profile:
    """The lift of the follower on the shape of a file."""
    shape, least = _read_contour(values["contour"])
    if abs(least - values["base_radius"]) > ROUND * least:
        raise MistakeError(
            f"base_radius = {1e3 * values['base_radius']:.6g} mm: must be the contour's least radius, "
            f"{1e3 * least:.6g} mm"
        )
    follower, geometry = build_follower(values["follower"], values)
    try:
        points = follower.follow(shape, geometry)
    except ValueError as error:
        raise MistakeError(f"contour: {error}") from None
    lifted = points.angle[points.lift > ROUND * points.lift.max()]
    return Profile(interpolate(points), (float(lifted[0]), float(lifted[-1])), [])


def read_base_radius(path: str) -> float:
    """The least radius of a contour's file (m)."""
    return _read_contour(path)[1]


def _read_contour(path: str) -> tuple[CamShape, float]:
    """The shape of a file, and its least radius (m)."""
    try:
        shape = read_contour(Path(path).expanduser())
    except AngleTableError as error:
        raise MistakeError(f"contour: {error}") from None
    return shape, float(np.hypot(shape.x, shape.y).min())


def _check_record(profile: CamProfile, component: Component, values: Mapping[str, float]) -> Any:
    record = component.parameters.view(component.parameters.vector(values))
    for requirement in profile.requirements:
        if fault := requirement.fault(record):
            raise MistakeError(fault)
    return record


def interpolate(points: Points) -> Callable[[float], Lift]:
    """The lift between points."""
    layout = camshaft(table_points=points.angle.size).parameters
    record = layout.view(layout.vector(points.parameters()))
    return lambda angle: table_lift(angle, record)


def _list_breaks(profile: CamProfile, record: Any) -> list[float]:
    """All over a turn, each from the one before."""
    found, angle = [], 0.0
    while (angle := angle + profile.find_breaks(angle, record).ahead) < 2.0 * math.pi:
        found.append(float(angle))
    return found


def build_follower(name: str, values: Mapping[str, Any]) -> tuple[Follower, Any]:
    """The kind of that name, and its geometry."""
    follower = FOLLOWERS[name]
    given = {field: values[field] for field in FIELDS[name]}
    pitch = given["base_radius"] + given.get("radius", 0.0)
    if abs(given.get("offset", 0.0)) >= pitch:
        raise MistakeError(
            f"offset = {1e3 * given['offset']:g} mm: must be less than base_radius + radius = "
            f"{1e3 * pitch:g} mm"
        )
    for arm in ("cam_arm", "valve_arm"):
        if given.get(arm) == 0.0:
            raise MistakeError(f"{arm} = 0 mm: must not be zero; < 0 puts the pivot on the other side")
    return follower, follower.geometry(**given)


def check_reach(name: str, geometry: Any, profile: Profile, values: Mapping[str, Any]) -> None:
    """MistakeError, with the angle, where a finger cannot reach the lift."""
    if not name.startswith("finger"):
        return
    for angle in np.radians(np.arange(0.0, 360.0)):
        sine = profile.lift(angle).s / geometry.valve_arm - math.sin(
            geometry.pivot_angle + geometry.valve_angle
        )
        if not -1.0 < sine < 1.0:
            raise MistakeError(
                f"valve_arm = {1e3 * geometry.valve_arm:g} mm: the finger cannot lift the valve by "
                f"{1e3 * profile.lift(angle).s:g} mm, at {math.degrees(angle):g} deg; make it longer"
            )
