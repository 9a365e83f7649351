"""What is said of a design: both cams over the angle, their figures, and what holds the new one."""

import json
import math
from collections.abc import Mapping, Sequence
from importlib import metadata
from typing import NamedTuple

import numpy as np
import xarray
from rich.table import Column, Table

from models.core.quantities import Vector
from models.valve_train.worn_cam import PLACES

from ...assessment.figures_of_merit import measure
from ...assessment.motion import Motion
from ...reporter import Reporter
from ...scenario.display import format_number, show
from ..wear.report import describe_place
from .figures import AREA, Objective
from .lobe import Curve, Lobe
from .slp import Active
from .train import DesignedTrain
from .wanted import Improved, Wanted

RPM = 30.0 / math.pi
CAMS = ("before", "after")
# Figures that are compared, the first ones first.
COMPARED = (
    "lift_area", "largest_lift", "least_load", "peak_pressure", "least_film_ratio", "spring_margin",
    "seating_velocity", "bounce", "friction_power", "surge_force",
)  # fmt: skip
OUTPUTS = {"load": "N", "maximum_pressure": "Pa", "film_ratio": "1"}


class Check(NamedTuple):
    """The speed of separation (rad/s; None: contact is kept), and motions at speeds (rad/s)."""

    separation: float | None
    motions: Mapping[float, Motion]


def sample(lobe: Lobe, unknowns: Vector | None) -> Curve:
    """The lift at PLACES with three derivatives: the scenario's own cam (None), or a designed one."""
    if unknowns is None:
        columns = np.array([lobe.kind.lift(a) for a in PLACES]).T
    else:
        points = lobe.points(unknowns[: lobe.count])
        columns = np.array([points.lift, points.slope, points.curvature])
    s, ds, dds = columns
    jerk = np.gradient(np.append(dds, dds[0]), float(PLACES[1]))[:-1]
    return Curve(s, ds, dds, jerk)


def tabulate(
    train: DesignedTrain,
    wanted: Wanted,
    improved: Improved,
    checks: tuple[Check, Check],
    geometries: tuple[object, object],
) -> xarray.Dataset:
    """Both cams over the cam angle, and their contacts at the speeds of the motions."""
    lobe, unknowns = train.lobe, improved.found.unknowns
    curves = [sample(lobe, None), sample(lobe, unknowns)]
    touches = [lobe.touch(curve, g) for curve, g in zip(curves, geometries, strict=True)]
    motions = [one.motions for one in checks]
    speeds = list(motions[0])
    over_angle = {
        "lift": ([c.s for c in curves], "m"),
        "slope": ([c.ds for c in curves], "m/rad"),
        "acceleration": ([c.dds for c in curves], "m/rad2"),
        "jerk": ([c.ddds for c in curves], "m/rad3"),
        "curvature": ([t.turn / t.cam_rate for t in touches], "1/m"),
        "pressure_angle": ([t.pressure_angle for t in touches], "rad"),
    }
    table: dict[str, xarray.Variable] = {
        name: xarray.Variable(("cam", "angle"), values, {"units": unit})
        for name, (values, unit) in over_angle.items()
    }
    for contact in train.train.contacts:
        for output, unit in OUTPUTS.items():
            rows = [
                [_over_angle(train, found[speed], f"{contact}.{output}") for speed in speeds]
                for found in motions
            ]
            table[f"{contact}.{output}"] = xarray.Variable(("cam", "speed", "angle"), rows, {"units": unit})
    objective = wanted.objective
    asked = [one.name for one in wanted.figures] + [objective.name] * objective.is_figure
    figures = [_list_figures(found, asked) for found in motions]
    common = [name for name in figures[0] if name in figures[1]]
    table["value"] = xarray.Variable(
        ("cam", "speed", "figure"), [[[f[name][s] for name in common] for s in speeds] for f in figures]
    )
    shown = {
        f"{part}.{name}": show(quantity)
        for part, name, quantity, _ in measure(next(iter(motions[0].values())))
    }
    table["unit"] = xarray.Variable("figure", [shown[name].text for name in common])
    table["factor"] = xarray.Variable("figure", [shown[name].factor for name in common])
    limits = {
        **wanted.sizes,
        **{f"{name}.maximum_pressure": size for name, size in wanted.pressures.items()},
        "least_load": wanted.least_load,
        "film_ratio": wanted.film,
    }
    return xarray.Dataset(
        table, {"cam": list(CAMS), "angle": PLACES, "speed": speeds, "figure": common}
    ).assign_attrs(
        title=f"{train.scenario.name}: {train.cam} before and after",
        separation=[math.nan if one.separation is None else one.separation for one in checks],
        area=improved.found.area,
        reached=wanted.objective.sign * (improved.found.objective - 1.0) + 1.0,
        feasible=int(not improved.found.beyond),
        active=json.dumps([describe_active(*one, wanted.objective) for one in improved.active]),
        limits=json.dumps(limits),
        parameters=json.dumps(
            {name: [own, train.values(unknowns)[name]] for name, own in train.given.items()}
        ),
        objective=wanted.objective.name,
        cam_speed=max((*wanted.speeds, *wanted.kept)) * train.ratio,
        version=metadata.version("tribocosim"),
    )


def _over_angle(train: DesignedTrain, motion: Motion, name: str) -> Vector:
    angle = motion.column(f"{train.cam}.{train.train.role.angle}") % (2.0 * math.pi)
    order = np.argsort(angle, kind="stable")
    return np.asarray(np.interp(PLACES, angle[order], motion.column(name)[order], period=2.0 * math.pi))


def _list_figures(motions: Mapping[float, Motion], asked: Sequence[str]) -> dict[str, dict[float, float]]:
    found: dict[str, dict[float, float]] = {}
    for speed, motion in motions.items():
        for part, name, _, value in measure(motion):
            if (name in COMPARED or f"{part}.{name}" in asked) and np.isfinite(value.value):
                found.setdefault(f"{part}.{name}", {})[speed] = value.value
    whole = {name: by for name, by in found.items() if len(by) == len(motions)}
    order = [*asked, *(name for kind in COMPARED for name in whole if name.endswith(f".{kind}"))]
    return {name: whole[name] for name in order if name in whole}


def describe_active(active: Active, angle: float, objective: Objective) -> str:
    """E.g. "least_radius limits 3 deg after the nose: 1 % more of it gives -0.4 % of area"."""
    gain = 100.0 * active.gain * objective.sign
    place = "" if math.isnan(angle) else f" {describe_place(angle)}"
    wanted = "area" if objective.name == AREA else objective.name.replace("_", " ")
    effect = f": 1 % more of it changes the {wanted} by {gain:+.2g} %" if abs(gain) > 1e-3 else ""
    return f"{active.name.replace('_', ' ')} limits{place}{effect}"


def report(table: xarray.Dataset, improved: Improved, reporter: Reporter) -> None:
    """A table of both cams, and what holds the new one."""
    speed = float(table["speed"].values[-1])
    shown = Table(
        Column("figure", no_wrap=True), "before", "after", "change",
        title=f"{table.attrs['title']}, at {speed * RPM:.0f} r/min", title_justify="left", padding=0,
    )  # fmt: skip
    before, after = table.attrs["separation"]
    if math.isfinite(before) and math.isfinite(after):
        shown.add_row("separation speed (r/min)", *_cells(RPM * before, RPM * after))
    shown.add_row("area of the cam's lift, its ramps left out", "1", f"{table.attrs['area']:.4f}",
                  f"{100.0 * (table.attrs['area'] - 1.0):+.2f} %")  # fmt: skip
    for name, unit, factor in zip(
        table["figure"].values, table["unit"].values, table["factor"].values, strict=True
    ):
        values = float(factor) * table["value"].sel(figure=name).values[:, -1]
        shown.add_row(f"{name} ({unit})".removesuffix(" ()"), *_cells(*values))
    for name, values in json.loads(table.attrs["parameters"]).items():
        shown.add_row(name, *_cells(*values))
    reporter.console.print(shown)
    for text in json.loads(table.attrs["active"]):
        reporter.line(text)
    if beyond := improved.found.beyond:
        worst = ", ".join(f"{name} by {100.0 * share:.2g} %" for name, share in beyond.items())
        reporter.line(f"no cam within all limits was found; the nearest one is beyond {worst}")


def _cells(before: float, after: float) -> tuple[str, str, str]:
    change = round(100.0 * (after / before - 1.0), 2) + 0.0 if before else 0.0
    return format_number(before), format_number(after), f"{change:+.2f} %" if before else ""
