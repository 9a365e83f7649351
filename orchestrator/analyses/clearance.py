"""Clearance between valve and piston over the crank angle, for a range of phases, of a cam's lift."""

import math
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from models.core.quantities import Layout
from models.plausible import ANGLE, LASH
from models.slider_crank.piston_clearance import (
    REQUIREMENTS,
    Parameters,
    axial_clearance,
    piston_travel,
    radial_clearance,
)

from ..errors import MistakeError
from ..plots.style import ACCENT, COUPLED, MUTED, REFERENCE, create_subplots
from ._cam_profile import build_profile, convert, list_lift_parameters
from ._machine import column
from .protocol import Parameter, Result, declare, describe_values

MM = 1e3
# About the top dead centre of gas exchange, each half degree of the crank; and phases of the range.
ANGLES = np.radians(np.arange(-360.0, 360.1, 0.5))
PHASES = 21
# The component's own angles: here the crank's count from the top dead centre.
WATCHED = ("angle_ratio", "top_angle")


def _tabulate(values: Mapping[str, Any]) -> xarray.Dataset:
    layout = Layout(Parameters)
    given = {field.name: values[field.name] for field in layout.fields if field.name not in WATCHED}
    crank = layout.view(layout.vector(given))
    if faults := [fault for one in REQUIREMENTS if (fault := one.fault(crank))]:
        raise MistakeError(faults[0])
    if values["advance"] < -values["retard"]:
        raise MistakeError(
            f"advance = {math.degrees(values['advance']):g} deg: must be at least -retard, "
            f"{0.0 - math.degrees(values['retard']):g} deg"
        )
    profile = build_profile(values)
    nose, spread = profile.nose, values["timing_spread"]
    shifts = np.linspace(-values["advance"] - spread, values["retard"] + spread, PHASES)
    shifts = np.unique([*shifts, 0.0])
    travel = np.array([piston_travel(a, crank) for a in ANGLES])
    play = np.array([radial_clearance(x, crank) for x in travel])

    def lift(shift: float) -> Any:
        at = nose + 0.5 * (ANGLES - values["lobe_centre"] - shift)
        cam = np.array([profile.lift(a % (2.0 * math.pi)).s for a in at])
        return np.maximum(values["valve_ratio"] * cam - values["lash"], 0.0)

    def clear(lifted: Any) -> Any:
        return np.array([axial_clearance(x, s, crank) for x, s in zip(travel, lifted, strict=True)])

    lifts = np.array([lift(shift) for shift in shifts])
    axial = np.array([clear(lifted) for lifted in lifts])
    own, worst = int(np.argmin(np.abs(shifts))), int(np.argmin(axial.min(axis=1)))
    least = axial.min(axis=0)
    at_centre = int(np.argmin(np.abs(ANGLES)))
    inside = least < values["pocket_depth"]
    columns = {
        "lift": column("angle", lifts[own], "m", "lift of the valve"),
        "piston_travel": column("angle", travel, "m", "travel of the piston from top dead centre"),
        "clearance": column("angle", axial[own], "m", "clearance along the valve's axis"),
        "least_of_phases": column("angle", least, "m", "the least of all phases"),
        "radial_clearance": column(
            "angle", play, "m", "clearance to the pocket's wall, of a head in its pocket"
        ),
    }
    place = int(np.argmin(axial[own]))
    results = {
        "least_clearance": float(axial[own, place]),
        "at_angle": float(ANGLES[place]),
        "clearance_at_centre": float(axial[own, at_centre]),
        "lift_at_centre": float(lifts[own, at_centre]),
        "least_over_phases": float(axial.min()),
        "worst_phase": float(shifts[worst]),
        "worst_angle": float(ANGLES[np.argmin(axial[worst])]),
        "least_radial_clearance": float(play[inside].min()) if inside.any() else math.nan,
    }
    return xarray.Dataset(
        columns, {"angle": column("angle", ANGLES, "rad", "crank angle from top dead centre")}
    ).assign(results)


def draw_clearance(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """Lift and piston above, clearance below."""
    own, least = (MM * data[name].item() for name in ("least_clearance", "least_over_phases"))
    title = f"Valve and piston: least clearance {own:.3g} mm, over all phases {least:.3g} mm"
    figure, (motion, clear) = create_subplots(2, 1, title, (7.2, 5.4), sharex=True)
    degrees = np.degrees(data["angle"].values)
    motion.plot(degrees, MM * data["lift"].values, color=COUPLED, label="lift of the valve")
    room = values["valve_recess"] + values["pocket_depth"]
    along = MM * (data["clearance"].values + data["lift"].values)
    motion.plot(degrees, along, color=MUTED, label="floor of the pocket, along the valve's axis")
    motion.set_ylabel("From the closed valve (mm)")
    top = MM * max(1.3 * float(data["lift"].max()), room)
    motion.set_ylim(0.0, 1.25 * top)
    motion.legend(loc="upper left")
    inside = data["least_of_phases"].values < values["pocket_depth"]
    clear.plot(degrees, MM * data["clearance"].values, color=COUPLED, label="at this phase")
    least_of_all = MM * data["least_of_phases"].values
    clear.plot(degrees, least_of_all, color=REFERENCE, lw=1.0, label="least of all phases")
    radial = MM * np.where(inside, data["radial_clearance"].values, np.nan)
    clear.plot(degrees, radial, color=ACCENT, lw=1.0, ls="--", label="radial, in the pocket")
    clear.axhline(0.0, color="0.4", lw=0.7)
    clear.plot(np.degrees(data["at_angle"].item()), MM * data["least_clearance"].item(), "v", color=COUPLED)
    clear.set_ylim(min(-0.5, 1.2 * MM * float(data["least_of_phases"].min())), top)
    clear.set_xlim(-120.0, 120.0)
    clear.xaxis.set_major_locator(MultipleLocator(30.0))
    clear.set_xlabel("Crank angle from top dead centre (°)")
    clear.set_ylabel("Clearance (mm)")
    clear.legend(loc="upper right")
    return figure


PLACE = {
    **{name: one for name, one in convert(Parameters).items() if name not in WATCHED},
    "lobe_centre": Parameter(
        math.radians(108.0),
        "rad",
        "crank angle of the largest lift after top dead centre; negative: before it (exhaust)",
        plausible=ANGLE,
    ),
    "advance": Parameter(0.0, "rad", "how far a phaser advances the cam (crank angle)", plausible=ANGLE),
    "retard": Parameter(0.0, "rad", "how far it retards the cam (crank angle)", plausible=ANGLE),
    "timing_spread": Parameter(
        0.0, "rad", "tolerance of the timing to both sides (crank angle)", minimum=0.0, plausible=ANGLE
    ),
    "valve_ratio": Parameter(1.0, "1", "lift of the valve over that of the cam", positive=True),
    "lash": Parameter(0.0, "m", "lash at the valve", minimum=0.0, plausible=LASH),
}
ANALYSIS = declare(
    name="clearance",
    description="Clearance between a valve and the piston over the crank angle, by the lift of a cam",
    parameters={**list_lift_parameters(), **PLACE},
    results={
        "least_clearance": Result("m", "least clearance along the valve's axis", display_unit="mm"),
        "at_angle": Result("rad", "crank angle there, from top dead centre", display_unit="deg"),
        "clearance_at_centre": Result("m", "clearance at top dead centre", display_unit="mm"),
        "lift_at_centre": Result("m", "lift of the valve there", display_unit="mm"),
        "least_over_phases": Result("m", "least clearance over phases and timing spread", display_unit="mm"),
        "worst_phase": Result("rad", "retard of the cam (crank angle) that has it", display_unit="deg"),
        "worst_angle": Result("rad", "crank angle there, from top dead centre", display_unit="deg"),
        "least_radial_clearance": Result(
            "m", "least clearance to the pocket's wall while the head is in the pocket", display_unit="mm"
        ),
    },
    table=_tabulate,
    draw=draw_clearance,
    describe=partial(describe_values, PLACE),
)
