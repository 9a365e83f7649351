"""What is said of a design: both cams over the angle, their figures, and what holds the new one."""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib import metadata
from typing import NamedTuple

import numpy as np
import xarray
from rich.table import Column, Table

from models.core.quantities import Vector
from models.valve_train.worn_cam import PLACES

from ...assessment.figures_of_merit import measure
from ...assessment.motion import Motion
from ...assessment.springs import list_clashing, list_springs, warn_of_clash
from ...assessment.trains import find_trains
from ...report.answer import Answer
from ...scenario.display import add_unit, format_number, show, show_unit
from ...scenario.system import list_quantities
from ..wear.report import describe_place
from .brief import FIGURES, OWN
from .figures import AREA, SMALL, TINY, Objective
from .limits import find_sizes, is_middle
from .lobe import Curve, Lobe
from .slp import Active
from .train import DesignedTrain
from .wanted import CONFIRMED, Improved, Wanted, describe_beyond

RPM = 30.0 / math.pi
CAMS = ("before", "after")
# Figures that are compared, the first ones first.
COMPARED = (
    "lift_area", "largest_lift", "largest_load", "least_load", "peak_pressure", "least_film_ratio",
    "spring_margin", "seating_velocity", "bounce", "friction_power", "surge_force", "least_gap",
)  # fmt: skip
# The worse of two values; other figures are shown at the highest of the speeds.
WORST: Mapping[str, Callable[..., float]] = {
    "largest_load": max, "least_load": min, "peak_pressure": max, "least_film_ratio": min,
    "spring_margin": min, "seating_velocity": max, "bounce": max, "friction_power": max, "surge_force": max,
    "least_gap": min,
}  # fmt: skip
# Of the cam alone, at the highest speed of the brief, in these units of so many SI ones.
SIZES = {
    "largest_acceleration": ("m/s²", 1.0), "largest_deceleration": ("m/s²", 1.0),
    "largest_jerk": ("m/s³", 1.0), "least_radius": ("mm", 1e3),
    "largest_duration": ("deg of the crank", 180.0 / math.pi),
}  # fmt: skip
# A figure that became worse by more than this share is said where no limit holds it. A quarter more load
# halves the life of a rolling contact on a line: 1.25^(10/3) = 2.1 (ISO 281).
WORSE = 0.25
# A flat nose: how long the lift is within 1 % of its largest, over that of the scenario's own cam. Flanks
# that differ by more than this part of the largest lift are not symmetric.
FLAT, NEAR_TOP, ALIKE = 1.25, 0.99, 2e-3
# A dip of this part of the largest lift is one.
DEEP = 1e-4
# Limits that no brief gives, as they are said.
LIMITED = {
    "dip of the nose": (
        "that the nose must not dip, with no acceleration above 0 in the middle third of the event,"
    ),
    "fall of a flank": "that the lift must not fall before its nose, nor rise after it,",
}
# Outputs over the angle, drawn at the speed where a figure of the new cam is worst.
DRAWN = {"load": "least_load", "maximum_pressure": "peak_pressure", "film_ratio": "least_film_ratio"}
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
    top = max((*wanted.speeds, *wanted.kept)) * train.ratio
    own = lobe.own, lobe.curve(unknowns[: lobe.count])
    sizes = [find_sizes(lobe, curve, g, top) for curve, g in zip(own, geometries, strict=True)]
    limits = {
        **wanted.sizes,
        **{f"{name}.maximum_pressure": size for name, size in wanted.pressures.items()},
        **({"least_load": wanted.least_load} if wanted.least_load or wanted.kept else {}),
        "film_ratio": wanted.film,
    }
    found = xarray.Dataset(table, {"cam": list(CAMS), "angle": PLACES, "speed": speeds, "figure": common})
    worse = list(describe_worse(found, train, wanted, sizes))
    names = {output: f"{train.train.contacts[0]}.{figure}" for output, figure in DRAWN.items()}
    filmed = found.sel(speed=[speed for speed in speeds if speed not in wanted.idle])
    over = {output: filmed if output == "film_ratio" else found for output in names}
    worst = {o: find_worst(over[o], n)[0][1] if n in common else speeds[-1] for o, n in names.items()}
    return found.assign_attrs(
        worst=json.dumps(worst),
        title=f"{train.scenario.name}: {train.cam} before and after",
        separation=[math.nan if one.separation is None else one.separation for one in checks],
        area=improved.found.area,
        reached=wanted.objective.sign * (improved.found.objective - 1.0) + 1.0,
        feasible=int(not improved.found.beyond),
        active=json.dumps([describe_active(*one, wanted.objective) for one in improved.active]),
        clashes=json.dumps(list(describe_clashes(motions[1], "with the designed cam"))),
        limits=json.dumps(limits),
        sizes=json.dumps(sizes),
        worse=json.dumps(worse),
        shape=json.dumps(list(describe_shape(lobe, *own, [one["largest_nose_radius"] for one in sizes]))),
        shaft=train.subject.flywheel,
        parameters=json.dumps(dict(_show_parameters(train, train.values(unknowns)))),
        objective=wanted.objective.name,
        cam_speed=top,
        top_speed=top / train.ratio,
        version=metadata.version("tribocosim"),
    )


def describe_clashes(motions: Mapping[float, Motion], cam: str) -> Iterator[str]:
    """A warning of each spring whose coils clash at some speed (rad/s), and what keeps them apart."""
    system = next(iter(motions.values())).system
    names = [f"{name}.least_gap" for train in find_trains(system) for name in list_springs(train)]
    found = {name: np.array([one.column(name).min() for one in motions.values()]) for name in names}
    for spring, gaps in list_clashing(system, found):
        worst = list(motions)[int(np.argmin(gaps))]
        said = warn_of_clash(spring, f"{cam}, most at {RPM * worst:.0f} r/min", float(gaps.min()))
        yield f"{said}; limits.least_gap keeps travel, if a cam can"


def _show_parameters(
    train: DesignedTrain, designed: Mapping[str, float]
) -> Iterator[tuple[str, tuple[float, float]]]:
    """Each that varied with its unit, before and after."""
    quantities = list_quantities(train.scenario)
    for name, own in train.given.items():
        wire = train.wires.get(name)
        shown = show_unit(wire.unit, "mm" * (wire.unit == "m")) if wire else show(quantities[name])
        yield add_unit(name, shown), (shown.factor * own, shown.factor * designed[name])


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


def describe_shape(lobe: Lobe, own: Curve, designed: Curve, radii: Sequence[float]) -> Iterator[str]:
    """What a designed lift has lost: symmetry, a round nose, or having one nose, and what forbids that.
    `radii` are the largest ones (m) of both noses."""
    before, after = (float(np.abs(one.s - one.s[::-1]).max()) for one in (own, designed))
    if after > max(2.0 * before, ALIKE * float(designed.s.max())):
        yield (
            f"the flanks differ by up to {1e3 * after:.2g} mm of lift, before by {1e3 * before:.2g} mm; "
            "symmetric = true forbids it"
        )
    step = math.degrees(lobe.angles[1] - lobe.angles[0])
    short, long = (step * np.count_nonzero(one.s > NEAR_TOP * one.s.max()) for one in (own, designed))
    if long > FLAT * short:
        yield (
            f"the nose is flat: within 1 % of the largest lift for {long:.0f} deg of the cam, before for "
            f"{short:.0f} deg; a limits.largest_nose_radius below {1e3 * radii[1]:.3g} mm forbids it, "
            f"before it was {1e3 * radii[0]:.3g} mm"
        )
    s = designed.s
    sides = np.maximum.accumulate(s), np.maximum.accumulate(s[::-1])[::-1]
    deep = int(np.argmax(dips := np.minimum(*sides) - s))
    if dips[deep] > DEEP * float(s.max()):
        where = "on a flank, as the scenario's own; correct that one"
        if is_middle(s.size)[deep]:
            where = "between two noses; limits.largest_nose_radius forbids it"
        place = describe_place(float(lobe.angles[deep]))
        yield f"the lift dips by {1e6 * dips[deep]:.3g} µm {place}, {where}"


def describe_worse(
    table: xarray.Dataset, train: DesignedTrain, wanted: Wanted, sizes: Sequence[Mapping[str, float]]
) -> Iterator[str]:
    """Each figure of the table that became worse by more than `WORSE` and that no limit holds, with the key
    that would. `sizes` are those of both cams."""
    for name, (unit, factor) in SIZES.items():
        before, after = (factor * one[name] for one in sizes)
        worse = before - after if name.startswith("least") else after - before
        if name not in wanted.sizes and worse > WORSE * before:
            what = f"{name.replace('_', ' ')} of the cam"
            yield _describe_change(what, before, after, unit, f"limits.{name}")
    contacts = train.train.contacts
    limits = {
        **{f"{one}.peak_pressure": one in wanted.pressures for one in contacts},
        **{f"{one}.least_load": wanted.least_load > 0.0 for one in contacts},
        **{f"{one}.least_gap": one in wanted.gaps for one in list_springs(train.train)},
        f"{contacts[0]}.least_film_ratio": wanted.film > 0.0,
    }
    held = {wanted.objective.name, *(one.name for one in wanted.figures), *filter(limits.get, limits)}
    bounded = {figure: f"limits.{limit}" for limit, (figure, _) in FIGURES.items()}
    for name, unit, factor in zip(*(table[key].values for key in ("figure", "unit", "factor")), strict=True):
        kind = name.rpartition(".")[2]
        if kind in WORST and name not in held:
            before, after = find_worst(table, name)[1]
            most = WORST[kind] is max
            key = f'figures."{name}".{"most" if most else "least"}'
            key = f"limits.{kind}" if name in limits else bounded.get(kind, key)
            worse = after - before if most else before - after
            if worse > WORSE * max(abs(before), SMALL.get(kind, TINY)):
                yield _describe_change(name, factor * before, factor * after, unit, key)


def _describe_change(name: str, before: float, after: float, unit: str, key: str) -> str:
    one, other = format_number(before), format_number(after)
    return f'{name} goes from {one} to {other} {unit}: no limit holds it; {key} = "{OWN}" would'


def describe_active(active: Active, angle: float, objective: Objective) -> str:
    """E.g. "least_radius limits 3 deg after the nose: 1 % more of it gives -0.4 % of area"; a limit that the
    cam does not reach would limit the next one."""
    gain = 100.0 * active.gain * objective.sign
    place = "" if math.isnan(angle) else f" {describe_place(angle)}"
    wanted = "area" if objective.name == AREA else objective.name.replace("_", " ")
    effect = f": 1 % more of it changes the {wanted} by {gain:+.2g} %" if abs(gain) > 1e-3 else ""
    name = LIMITED.get(active.name, active.name.replace("_", " "))
    if active.spare > CONFIRMED:
        return f"{name} is not reached, {100.0 * active.spare:.2g} % to spare, and limits next{place}{effect}"
    return f"{name} limits{place}{effect}"


def report(table: xarray.Dataset, improved: Improved, answer: Answer) -> None:
    """A table of both cams, and what holds the new one."""
    rpm = [f"{RPM * speed:.0f}" for speed in table["speed"].values]
    shown = Table(
        Column("figure", no_wrap=True), f"r/min of {table.attrs['shaft']}", "before", "after", "change",
        title=f"{table.attrs['title']}, each where it is worst at {', '.join(rpm[:-1])} and {rpm[-1]} r/min",
        title_justify="left", padding=0,
    )  # fmt: skip
    before, after = table.attrs["separation"]
    if math.isfinite(before) and math.isfinite(after):
        shown.add_row("separation speed (r/min)", "", *_cells(RPM * before, RPM * after))
    shown.add_row("area of the cam's lift, its ramps left out", "", "1", f"{table.attrs['area']:.4f}",
                  f"{100.0 * (table.attrs['area'] - 1.0):+.2f} %")  # fmt: skip
    sizes, top = json.loads(table.attrs["sizes"]), f"{RPM * table.attrs['top_speed']:.0f}"
    for name, (unit, factor) in SIZES.items():
        cells = _cells(*(factor * one[name] for one in sizes))
        shown.add_row(f"{name.replace('_', ' ')} of the cam ({unit})", top, *cells)
    for name, unit, factor in zip(
        table["figure"].values, table["unit"].values, table["factor"].values, strict=True
    ):
        at, values = find_worst(table, str(name))
        where = " and ".join(f"{RPM * speed:.0f}" for speed in dict.fromkeys(at))
        shown.add_row(f"{name} ({unit})".removesuffix(" ()"), where, *_cells(*(float(factor) * values)))
    for name, values in json.loads(table.attrs["parameters"]).items():
        shown.add_row(name, "", *_cells(*values))
    answer.table(shown)
    for text in [
        line for kind in ("clashes", "worse", "active", "shape") for line in json.loads(table.attrs[kind])
    ]:
        answer.line(text)
    if improved.ended:
        answer.line(improved.ended)
    if worst := describe_beyond(improved.found.beyond):
        answer.line(f"no cam within all limits was found; the nearest one is beyond {worst}")


def find_worst(table: xarray.Dataset, name: str) -> tuple[Vector, Vector]:
    """The speeds (rad/s) and values of a figure "part.name" of both cams."""
    values, speeds = table["value"].sel(figure=name).values, table["speed"].values
    worse = WORST.get(name.rpartition(".")[2], lambda row: row[-1])
    columns = [list(row).index(worse(row)) for row in values]
    return speeds[columns], values[[0, 1], columns]


def _cells(before: float, after: float) -> tuple[str, str, str]:
    change = round(100.0 * (after / before - 1.0), 2) + 0.0 if before else 0.0
    return format_number(before), format_number(after), f"{change:+.2f} %" if before else ""
