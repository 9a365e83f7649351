"""A cam with its follower: shape, curvature, pressure angle, entrainment and derivatives of the lift."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from scipy.optimize import brentq

from models.core.quantities import Vector
from models.plausible import SPEED
from models.valve_train.cams.lift import Lift
from models.valve_train.cams.profile import RADII, name_convex_base
from models.valve_train.cams.table import TURN
from models.valve_train.followers.shape import (
    FOLLOWERS,
    Follower,
    find_least_radius,
    sample_angles,
    trace_shape,
)

from ..plots.style import ACCENT, COUPLED, MUTED, RPM, create_subplots
from ..scenario.cam_files import write_contour, write_lift, write_s96
from ..scenario.display import format_with_error
from ._cam_profile import (
    FIELDS,
    GEOMETRY,
    Profile,
    build_follower,
    build_profile,
    check_reach,
    list_lift_parameters,
)
from ._cam_timing import PARAMETERS, RESULTS, find_timing
from ._contour import write_dxf, write_svg
from ._machine import column
from .protocol import Parameter, Result, declare

if TYPE_CHECKING:
    from models.valve_train.cams.smoothing import SmoothedLift  # its libraries take long to import

POINTS = 720
# Half a step of differences (rad) for the jerk.
STEP = 1e-5
UNDERCUT = "undercut"
# Points of a contour's file stand no farther apart (rad), which so many halvings of POINTS allow.
APART, HALVINGS = math.radians(0.6), 6
# A jump of s'' is more than this part of its largest value within twice this angle (rad).
JUMP, NEAR = 1e-4, 1e-8


def _tabulate(values: Mapping[str, Any]) -> xarray.Dataset:
    profile = build_profile(values)
    follower, geometry = build_follower(values["follower"], values)
    check_reach(values["follower"], geometry, profile, values)
    angles = sample_angles(POINTS, profile.breaks)
    s, ds, dds = np.array([profile.lift(a) for a in angles]).T
    _, _, n_x, n_y, arm, radius, cam_rate, follower_rate, _ = _touch(angles, profile, follower, geometry)
    if follower.rolling:
        follower_rate = cam_rate
    shape = trace_shape(angles, profile.lift, follower, geometry)
    columns = {
        "lift": column("angle", s, "m", "lift"),
        "slope": column("angle", ds, "m", "derivative of the lift by the cam angle (rad)"),
        "curvature": column("angle", dds, "m", "second derivative of the lift"),
        "jerk": column("angle", _differentiate(profile, angles), "m", "third derivative of the lift"),
        "pressure_angle": column("angle", np.arctan2(n_x, n_y), "rad", "angle of the contact's normal"),
        "radius_of_curvature": column("angle", radius, "m", "of the cam; negative where hollow"),
        "entraining_velocity": column(
            "angle", 0.5 * (cam_rate + follower_rate), "m", "entraining velocity over the cam's speed"
        ),
        "lubrication_characteristic": column(
            "angle", cam_rate + follower_rate, "m", "2 u/omega; R0 + s + 2 s'' of a flat follower"
        ),
        "sliding_velocity": column(
            "angle", cam_rate - follower_rate, "m", "sliding velocity over the cam's speed"
        ),
        "load_ratio": column("angle", _divide(ds, arm), "1", "contact load over the force on what is lifted"),
        "contour_x": column("angle", shape.x, "m", "contour of the cam, x, with the cam angle at zero"),
        "contour_y": column("angle", shape.y, "m", "contour of the cam, y"),
    }
    table = xarray.Dataset(columns, coords={"angle": column("angle", angles, "rad", "cam angle")})
    return table.assign(_evaluate_table(table, profile, follower, geometry, values))


def _entrain(lift: Lift, follower: Follower, geometry: Any) -> float:
    """u/omega."""
    contact = follower.touch(lift, geometry)
    return contact.cam_rate if follower.rolling else 0.5 * (contact.cam_rate + contact.follower_rate)


def _touch(angles: Vector, profile: Profile, follower: Follower, geometry: Any) -> Vector:
    return np.asarray([follower.touch(profile.lift(a), geometry) for a in angles]).T


def _differentiate(profile: Profile, angles: Vector) -> Vector:
    """s''' by central differences of s''; at a break that of the steeper side, infinite where s'' jumps."""
    jerk = _differ(profile, angles - STEP, angles + STEP)
    breaks = np.isin(angles, np.array(profile.breaks) % TURN)
    at = angles[breaks]
    if not at.size:
        return jerk
    before, after = (_differ(profile, at + d - STEP, at + d + STEP) for d in (-STEP - NEAR, STEP + NEAR))
    jump = np.abs(_differ(profile, at - NEAR, at + NEAR)) * 2.0 * NEAR
    jumps = jump > JUMP * max(abs(profile.lift(a).dds) for a in angles)
    jerk[breaks] = np.where(jumps, np.inf, np.where(np.abs(before) > np.abs(after), before, after))
    return jerk


def _differ(profile: Profile, before: Vector, after: Vector) -> Vector:
    """The slope of s'' between these angles."""
    low, high = (np.array([profile.lift(a).dds for a in angles]) for angles in (before, after))
    return np.asarray((high - low) / (after - before))


def _divide(part: Vector, whole: Vector) -> Vector:
    """The quotient; not a number where the cam is round."""
    round_there = np.abs(whole) < 1e-12
    return np.where(round_there, np.nan, part / np.where(round_there, 1.0, whole))


def _evaluate_table(
    table: xarray.Dataset, profile: Profile, follower: Follower, geometry: Any, values: Mapping[str, Any]
) -> dict[str, float | str]:
    """The results."""
    angle, lift, speed = table["angle"].values, table["lift"].values, values["speed"]
    slope, bend, jerk = (table[name].values for name in ("slope", "curvature", "jerk"))
    radius, pressure = table["radius_of_curvature"].values, table["pressure_angle"].values
    begin, end = profile.event
    dense = TURN * np.arange(RADII) / RADII
    *_, radii, rates, _, _ = _touch(dense, profile, follower, geometry)
    least = find_least_radius(radii, rates)
    zeros, slopes = _find_reversals(angle, lambda a: _entrain(profile.lift(a), follower, geometry))
    read, smoothing = profile.table, profile.smoothing
    doubts = read.list_doubts(smoothing, values["ramp_height"]) if read and smoothing else []
    return {
        "largest_lift": float(lift.max()),
        "at_angle": float(angle[np.argmax(lift)]),
        "event": float(end - begin),
        "ample_factor": float(np.trapezoid(lift, angle) / (lift.max() * (end - begin))),
        "largest_velocity": float(np.abs(slope).max() * speed),
        "largest_acceleration": float(bend.max() * speed**2),
        "least_acceleration": float(bend.min() * speed**2),
        "largest_jerk": float(np.abs(jerk).max() * speed**3),
        "least_radius": float(radii[least]),
        "least_radius_at": float(dense[least]),
        "shape": _describe_shape(radius, float(radii[least]), values),
        "largest_pressure_angle": float(np.abs(pressure).max()),
        **find_timing(profile, values),
        "reversals": ", ".join(_format_reversals(zeros, slopes, smoothing)) or "none",
        "slope_at_reversals": float(max(slopes, default=math.nan)),
        "table_choices": "; ".join(read.list_notes()) or "none" if read else "",
        "table_doubts": "; ".join(doubts) or "none" if read else "",
        "table_residual": smoothing.residual if smoothing else math.nan,
        "table_resolution": smoothing.resolution if smoothing else math.nan,
        "curvature_uncertainty": smoothing.curvature_error if smoothing else math.nan,
    }


def _find_reversals(angles: Vector, entraining: Callable[[float], float]) -> tuple[list[float], list[float]]:
    """Cam angles at which the entraining velocity vanishes, and the slopes of the lubrication characteristic,
    2 u/omega, there (m/rad)."""
    found = [entraining(a) for a in angles]
    zeros = [
        float(brentq(entraining, angles[i], angles[i + 1]))
        for i in range(len(found) - 1)
        if found[i] * found[i + 1] < 0.0 or found[i] == 0.0
    ]
    slopes = [abs(entraining(a + STEP) - entraining(a - STEP)) / STEP for a in zeros]
    return zeros, slopes


def _format_reversals(
    zeros: Sequence[float], slopes: Sequence[float], smoothing: SmoothedLift | None
) -> Iterator[str]:
    """In degrees, of a lift table with what the errors of s'' make of them: 2 u/omega has twice those."""
    for zero, slope in zip(zeros, slopes, strict=True):
        error = math.degrees(2.0 * smoothing.curvature_error / slope) if smoothing and slope else 0.0
        yield format_with_error(math.degrees(zero), error) if error else f"{math.degrees(zero):.2f}"


def _list_errors(values: Mapping[str, Any], results: Mapping[str, Any]) -> dict[str, float]:
    """Of a lift table: lifts are known to its resolution, s'' and the radius that follows from it to its
    error, jerks and slopes to that share of them at best."""
    bend, square = results["curvature_uncertainty"], values["speed"] ** 2
    if math.isnan(bend):
        return {}
    share = bend * square / results["largest_acceleration"]
    steep = {name: share * results[name] for name in ("largest_jerk", "slope_at_reversals")}
    return {
        **{"largest_lift": results["table_resolution"], "least_radius": bend, **steep},
        **dict.fromkeys(("largest_acceleration", "least_acceleration"), bend * square),
    }


def _describe_shape(radius: Vector, least: float, values: Mapping[str, Any]) -> str:
    """Whether the cam can be made, by its radii and the least one of them."""
    if least <= 0.0:
        remedy = "enlarge base_radius, or take a smaller radius"
        if values["follower"] == "flat":  # its rho = R_0 + s + s'' is as much larger as the base circle
            remedy = f"base_radius > {name_convex_base(values['base_radius'], least):.3f} mm is needed"
        return f"{UNDERCUT}: the contour crosses itself; {remedy}"
    if np.any(radius < 0.0):
        return f"hollow flank: takes a grinding wheel of at most {-1e3 * radius[radius < 0.0].max():.4g} mm"
    return "convex"


def _describe(values: Mapping[str, Any]) -> str:
    """What the results are of; radii, reversals and velocities depend on it, opening and overlap too."""
    fields = FIELDS[values["follower"]]
    radius = f" of radius {1e3 * values['radius']:g} mm" if "radius" in fields else ""
    shown = {"speed": (RPM, "r/min"), **dict.fromkeys(PARAMETERS, (180.0 / math.pi, "deg"))}
    told = [
        f"{name} {values[name] * factor:g} {unit}"
        + " (default)" * (values[name] == ANALYSIS.parameters[name].default)
        for name, (factor, unit) in shown.items()
    ]
    return (
        f"{values['follower'].replace('_', ' ')} follower{radius}, base circle radius "
        f"{1e3 * values['base_radius']:g} mm, {', '.join(told)}"
    )


def _warn(results: Mapping[str, Any]) -> list[str]:
    found = [results["shape"]] if results["shape"].startswith(UNDERCUT) else []
    return [*found, *([doubts] if (doubts := results["table_doubts"]) not in ("", "none") else [])]


MM = 1e3


def draw_cam(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """The contour on the left; over the cam angle lift and derivatives, and what the contact has of them."""
    name = Path(values["lift_table"]).stem or values["law"]
    title = f"Cam {name} with follower {values['follower']}, {values['speed'] * RPM:.0f} r/min"
    figure, axes = create_subplots(4, 3, title, (12.0, 7.2), width_ratios=(1.8, 1.0, 1.0))
    grid = axes[0, 0].get_gridspec()
    for panel in axes[:, 0]:
        panel.remove()
    _draw_contour(figure.add_subplot(grid[:, 0]), data, values)
    degrees, speed = np.degrees(data["angle"].values), values["speed"]
    _plot(axes[0, 1], degrees, MM * data["lift"].values, "Lift (mm)")
    _plot(axes[1, 1], degrees, speed * data["slope"].values, "Velocity (m/s)")
    _plot(axes[2, 1], degrees, speed**2 * data["curvature"].values, "Acceleration (m/s²)")
    _plot(axes[3, 1], degrees, 1e-3 * speed**3 * data["jerk"].values, "Jerk (km/s³)")
    entraining = speed * data["entraining_velocity"].values
    _plot(axes[0, 2], degrees, entraining, "Velocity of contact (m/s)", "entraining")
    axes[0, 2].plot(degrees, speed * data["sliding_velocity"].values, color=ACCENT, label="sliding")
    axes[0, 2].legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), ncols=2)
    _plot(axes[1, 2], degrees, MM * data["lubrication_characteristic"].values, "Lubrication char. (mm)")
    _plot(axes[2, 2], degrees, 1.0 / data["radius_of_curvature"].values, "Curvature of cam (1/m)")
    _plot(axes[3, 2], degrees, np.degrees(data["pressure_angle"].values), "Pressure angle (°)")
    if not data["pressure_angle"].values.any():
        axes[3, 2].text(180.0, 0.1, "zero everywhere", ha="center", color=MUTED)
        axes[3, 2].set_ylim(-1.0, 1.0)
    for panel in axes[3, 1:]:
        panel.set_xlabel("Cam angle (°)")
    return figure


def _plot(axes: Axes, degrees: Vector, curve: Vector, label: str, name: str | None = None) -> None:
    axes.axhline(0.0, color=MUTED, lw=0.8)
    axes.plot(degrees, curve, color=COUPLED, label=name)
    axes.set_ylabel(label)
    axes.set_xlim(0.0, 360.0)
    axes.xaxis.set_major_locator(MultipleLocator(90.0))


def _draw_contour(axes: Axes, data: xarray.Dataset, values: Mapping[str, Any]) -> None:
    x, y = (MM * data[name].values for name in ("contour_x", "contour_y"))
    axes.fill(x, y, facecolor=COUPLED, alpha=0.15)
    axes.plot(np.append(x, x[0]), np.append(y, y[0]), color=COUPLED)
    turned = np.linspace(0.0, 2.0 * math.pi, 181)
    base = MM * values["base_radius"]
    axes.plot(base * np.cos(turned), base * np.sin(turned), color=MUTED, lw=0.8, ls="--")
    axes.plot(0.0, 0.0, marker="+", color=MUTED, ms=8.0)
    axes.set_aspect("equal")
    axes.set_title("Contour (mm), dashed the base circle", loc="left")


def _lift(values: Mapping[str, Any]) -> Callable[[float], float]:
    profile = build_profile(values)
    return lambda angle: profile.lift(angle).s


def _write_contour(table: xarray.Dataset, values: Mapping[str, Any]) -> str:
    """Of the table's angles, and between those whose points stand far apart, as where a flank is hollow."""
    profile, (follower, geometry) = build_profile(values), build_follower(values["follower"], values)
    angles = table["angle"].values
    for _ in range(HALVINGS):
        shape = trace_shape(angles, profile.lift, follower, geometry)
        polar = np.unwrap(np.arctan2(shape.x, shape.y))
        far = np.diff(polar, append=polar[0] + TURN) > APART
        middles = angles + 0.5 * np.diff(angles, append=angles[0] + TURN)
        angles = np.sort(np.append(angles, middles[far]))
    return write_contour(shape.x, shape.y)


def _write_lift(table: xarray.Dataset, values: Mapping[str, Any], unit: str) -> str:
    return write_lift(_lift(values), unit)


ANALYSIS = declare(
    name="cam",
    description="A cam by a law or lift table: shape, curvature, pressure angle, entrainment, derivatives",
    parameters={
        **list_lift_parameters(),
        "contour": Parameter("", "1", "CSV file of polar angle and radius of a contour, instead of a law"),
        **PARAMETERS,
        "speed": Parameter(
            1000.0 * math.pi / 30.0, "rad/s", "speed of the cam", positive=True, plausible=SPEED
        ),
        "follower": Parameter("flat", "1", "the follower that has the lift", choices=tuple(FOLLOWERS)),
        **GEOMETRY,
    },
    results={
        "largest_lift": Result("m", "largest lift", display_unit="mm"),
        "at_angle": Result("rad", "cam angle of the largest lift", display_unit="deg"),
        "event": Result(
            "rad",
            "cam angle of any lift, with ramps; of a table: above its noise and 0.1 % of the largest lift",
            display_unit="deg",
        ),
        "ample_factor": Result("1", "mean lift of the event over the largest"),
        "largest_velocity": Result("m/s", "largest velocity of the lift at this speed"),
        "largest_acceleration": Result("m/s2", "largest acceleration"),
        "least_acceleration": Result("m/s2", "largest deceleration"),
        "largest_jerk": Result("m/s3", "largest jerk; infinite where the acceleration jumps"),
        "least_radius": Result("m", "least radius of curvature; < 0: undercut", display_unit="mm"),
        "least_radius_at": Result("rad", "cam angle there", display_unit="deg"),
        "shape": Result("1", "what the radii say", text=True),
        "largest_pressure_angle": Result("rad", "largest pressure angle", display_unit="deg"),
        **RESULTS,
        "reversals": Result("deg", "cam angles at which the entraining velocity vanishes", text=True),
        "slope_at_reversals": Result("m/rad", "slope of the lubrication characteristic 2 u/omega there"),
        "table_choices": Result("1", "lift table: what reading it chose", text=True),
        "table_doubts": Result("1", "lift table: what may be wrong with it", text=True),
        "table_residual": Result(
            "m", "lift table: rms of its differences from the smoothed lift", display_unit="um", digits=2
        ),
        "table_resolution": Result("m", "lift table: resolution found", display_unit="um"),
        "curvature_uncertainty": Result(
            "m", "lift table: about the largest error of s'', per rad^2", display_unit="mm", digits=2
        ),
    },
    table=_tabulate,
    draw=draw_cam,
    texts={
        "svg": write_svg,
        "dxf": write_dxf,
        "contour.csv": _write_contour,
        "s96": lambda table, values: write_s96(_lift(values), build_profile(values).nose),
        **{f"{unit}.csv": partial(_write_lift, unit=unit) for unit in ("mm", "in")},
    },
    describe=_describe,
    warn=_warn,
    list_errors=_list_errors,
)
