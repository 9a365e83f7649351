"""Runs a tolerance study and finds what it says."""

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from models.core.quantities import Vector
from models.core.system import System
from models.core.words import tally
from models.monolithic.cycle import STEADY as LARGEST_CHANGE
from models.monolithic.cycle import USABLE
from models.valve_train.worn_cam import sample_cam

from ...analyses import Result
from ...assessment.friction.remarks import remark_friction
from ...assessment.notices import list_notices
from ...assessment.springs import list_clashing, warn_of_clash
from ...errors import MistakeError, RunError
from ...reporter import Reporter
from ...scenario import build_scenario
from ...scenario.cams import read_cam
from ...scenario.files import to_full_toml
from ...scenario.system import build_system, list_quantities
from ...scenario.units import is_bare
from ..files import plan_axis
from ..run import Where, run
from ..speeds.subject import SPEED, STEADY, describe_numbers, find_flywheel
from ..store import DONE
from ..wear.train import put_points
from .design import BESIDE, MIXED, SAMPLE, Design, Parameters
from .distributions import read_samples
from .limits import Limit, parse_limits
from .statistics import (
    PERCENTS,
    find_first_order,
    find_indices,
    find_middle_yield,
    find_percentile,
    find_yield,
)
from .subject import ToleranceSubject, make_design
from .table import Tolerances

TRAINS = "trains.zarr"
ENDS = ("value", "low", "high")
# Of the yield of all limits together.
ALL = "all limits"
RPM = 30.0 / math.pi


def make_subject(tables: Mapping[str, Any], tolerances: Tolerances) -> tuple[ToleranceSubject, list[Limit]]:
    """MistakeError for a fault of the scenario, the distributions or the limits."""
    scenario = build_scenario(tables)
    flywheel = find_flywheel(scenario)
    speed = _read_speed(str(tolerances.speed))
    tolerances = read_samples(tolerances, list_quantities(scenario))
    limits = parse_limits(tolerances.limits, describe_numbers(scenario))
    make_design(tolerances, scenario)
    given, running = to_full_toml(scenario), dict(tables)
    for cam in tolerances.grinding:
        running = put_points(running, cam, sample_cam(read_cam(scenario.components[cam])))
    text = to_full_toml(build_scenario(running)) if tolerances.grinding else given
    return ToleranceSubject(given, text, flywheel, speed, tolerances.model_dump_json()), limits


def _read_speed(text: str) -> float:
    if is_bare(text):
        raise MistakeError(f'speed = {text}: write the unit, e.g. "{text} rpm"')
    return float(SPEED.check_value("speed", text))


def find_tolerances(
    tables: Mapping[str, Any],
    tolerances: Tolerances,
    out: Path,
    where: Where,
    reporter: Reporter,
    overwrite: bool = False,
) -> xarray.Dataset:
    """Percentiles, yields and indices of all figures; all trains are kept in the folder `out`. MistakeError
    before anything is computed, RunError where no train has a cycle."""
    subject, limits = make_subject(tables, tolerances)
    scenario, design = build_scenario(tables), subject.design
    name = scenario.name
    reporter.notice(list_notices(scenario))
    reporter.line(
        f"{len(design)} trains: the mean one, {2 * len(design.names)} beside it, {2 * design.half} sampled"
        + (f", {len(design.factors) * design.half} for indices" if design.mixed else "")
    )
    description = f"{name}: trains within their tolerances at {subject.speed:.6g} rad/s"
    plan = plan_axis(name, description, subject, "train", (0.0, len(design) - 1.0), len(design))
    status = run(plan, out / TRAINS, where, reporter, overwrite)
    with xarray.open_zarr(out / TRAINS) as stored:
        trains = stored.load()
    usable = find_usable(trains, design)
    figures = [
        figure
        for figure in subject.results
        if figure not in {*STEADY, *design.names} and not figure.endswith("_angle")
    ]
    values = {figure: np.where(usable, trains[figure].values, np.nan) for figure in figures}
    values = {figure: found for figure, found in values.items() if np.isfinite(found).any()}
    for limit in limits:
        if limit.figure not in values:
            reporter.line(
                f"{limit.text}: no train has this number (as a valve without a seat has no seating "
                "velocity); leave the limit out"
            )
    parts = [_describe(values, subject.results), _percentiles(values, design), _compare(values, design)]
    found = xarray.merge([*parts, find_yields(values, usable, design, limits)])
    steady = int(usable[_rows(design, SAMPLE)].sum())
    counts = {"trains": len(design), "sampled": 2 * design.half, "steady": steady}
    friction = "\n".join(remark_friction(system := build_system(scenario), values))
    told = "\n".join([*describe_cycles(trains, design, usable), *describe_clashes(values, system)])
    return found.assign_attrs(
        speed_rpm=RPM * subject.speed, status=status, friction=friction, cycles=told, **counts
    )


def _describe(values: Mapping[str, Vector], results: Mapping[str, Result]) -> xarray.Dataset:
    """Units of the figures."""
    units = {"unit": [results[name].unit for name in values]}
    units["display_unit"] = [results[name].display_unit for name in values]
    return xarray.Dataset({key: ("figure", texts) for key, texts in units.items()}, {"figure": list(values)})


def find_usable(trains: xarray.Dataset, design: Design) -> NDArray[np.bool_]:
    """The trains that are judged: a period changes their motion by no more than USABLE. RunError without."""
    done = trains["status"].values == DONE
    usable = np.asarray(done & (trains["change"].values <= USABLE))
    if not usable[_rows(design, SAMPLE)].any():
        raise RunError("no sampled train has a steady cycle at this speed: there is nothing to compare")
    return usable


def describe_cycles(trains: xarray.Dataset, design: Design, usable: NDArray[np.bool_]) -> Iterator[str]:
    """Sentences on the trains without a steady cycle, with the first one's values, and on those that change a
    little from turn to turn."""
    sampled, changes = _rows(design, SAMPLE), trains["change"].values
    lost, rippled = np.flatnonzero(~usable), usable & (changes > LARGEST_CHANGE)
    if lost.size:
        first = int(lost[0])
        settings = ", ".join(f"{name} = {trains[name].values[first]:.6g}" for name in design.names[:8])
        message = str(trains["message"].values[first]) or (
            f"a period still changes the motion by {100.0 * float(changes[first]):.2g} %"
        )
        yield (
            f"no steady cycle: {lost.size} of {tally(usable.size, 'train')}, {int(sum(~usable[sampled]))} of "
            f"them among the {sampled.size} sampled; percentiles and yields are of the others; the first is "
            f"train {first} with {settings}: {message}"
        )
    if rippled.any():
        yield (
            f"of {tally(int(rippled.sum()), 'train')} counted as steady a period still changes the motion, "
            f"by up to {100.0 * float(changes[rippled].max()):.2g} %"
        )


def describe_clashes(values: Mapping[str, Vector], system: System) -> Iterator[str]:
    """A warning of each spring whose coils clash in some of the judged trains."""
    for spring, gaps in list_clashing(system, values):
        of = f"in {int((gaps < 0.0).sum())} of {tally(int(np.isfinite(gaps).sum()), 'train')}"
        yield warn_of_clash(spring, of, float(np.nanmin(gaps)))


def _rows(design: Design, kind: str) -> NDArray[np.int64]:
    return np.flatnonzero(np.array(design.kinds) == kind)


def _percentiles(values: Mapping[str, Vector], design: Design) -> xarray.Dataset:
    rows = _rows(design, SAMPLE)
    found, means, deviations = [], [], []
    for column in values.values():
        known = np.sort(column[rows][np.isfinite(column[rows])])
        found.append([find_percentile(known, percent) for percent in PERCENTS])
        means.append(known.mean() if known.size else np.nan)
        deviations.append(known.std(ddof=1) if known.size > 1 else np.nan)
    return xarray.Dataset(
        {
            "percentile": (("figure", "percent", "end"), np.array(found)),
            "sample": (("figure", "train"), np.array([column[rows] for column in values.values()])),
            "mean": ("figure", np.array(means)),
            "deviation": ("figure", np.array(deviations)),
        },
        {"figure": list(values), "percent": list(PERCENTS), "end": list(ENDS)},
    )


def judge(values: Mapping[str, Vector], limits: Sequence[Limit]) -> dict[str, NDArray[np.bool_]]:
    """Which trains keep each limit, and all of them."""
    none = np.full(next(iter(values.values())).size, np.nan)
    kept = {limit.text: limit.holds(values.get(limit.figure, none)) for limit in limits}
    return {**kept, ALL: np.all(list(kept.values()), axis=0)} if kept else {}


def find_yields(
    values: Mapping[str, Vector], usable: NDArray[np.bool_], design: Design, limits: Sequence[Limit]
) -> xarray.Dataset:
    """Of every limit and of all, among the `usable` trains: the yield, that of the trains amid each factor,
    and the pass's indices."""
    kept, rows = judge(values, limits), _rows(design, SAMPLE)
    shares, rows = design.sample[usable[rows]], rows[usable[rows]]
    factors = list(design.factors)
    middle = np.full((len(kept), len(factors), 3), np.nan)
    total = np.full((len(kept), len(factors), 3), np.nan)
    for i, good in enumerate(kept.values()):
        for k, factor in enumerate(design.factors.values()):
            if isinstance(factor, Parameters) and factor.size == 1:
                middle[i, k] = find_middle_yield(good[rows], shares[:, design.columns(k).start])
        if design.mixed:
            found = _index(np.where(usable, good, np.nan), design)
            total[i] = np.column_stack([found.total, *found.total_interval])
    yields = np.array([find_yield(good[rows]) for good in kept.values()]).reshape(-1, 3)
    return xarray.Dataset(
        {
            "yield": (("limit", "end"), yields),
            "yield_without": (("limit", "factor", "end"), middle),
            "yield_index": (("limit", "factor", "end"), total),
        },
        {"limit": list(kept), "factor": factors, "end": list(ENDS)},
    )


def _index(values: Vector, design: Design) -> Any:
    a, b = values[_rows(design, SAMPLE)].reshape(2, -1)
    return find_indices(a, b, values[_rows(design, MIXED)].reshape(-1, design.half), design.seed)


def _compare(values: Mapping[str, Vector], design: Design) -> xarray.Dataset:
    """Sobol' indices, and the answer of first order beside the sample's."""
    covariances = {name: factor.covariance for name, factor in design.factors.items()}
    beside, count = _rows(design, BESIDE), len(design.factors)
    first, total, linear, parts = [], [], [], []
    for column in values.values():
        if design.mixed:
            found = _index(column, design)
            first.append(np.column_stack([found.first, *found.first_interval]))
            total.append(np.column_stack([found.total, *found.total_interval]))
        else:
            first.append(np.full((count, 3), np.nan))
            total.append(np.full((count, 3), np.nan))
        about = find_first_order(column[0], column[beside].reshape(-1, 2), design.deviations, covariances)
        linear.append([about.percentile(percent) for percent in PERCENTS])
        parts.append(about.parts)
    return xarray.Dataset(
        {
            "first": (("figure", "factor", "end"), np.array(first)),
            "total": (("figure", "factor", "end"), np.array(total)),
            "linear": (("figure", "percent"), np.array(linear)),
            "linear_part": (("figure", "factor"), np.array(parts)),
        },
        {
            "figure": list(values),
            "factor": list(design.factors),
            "percent": list(PERCENTS),
            "end": list(ENDS),
        },
    )
