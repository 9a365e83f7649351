"""`tribocosim design`: the scenario's own cam, the search for a better one, and a check of both."""

import math
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path

import numpy as np
import xarray

from models.compile.temporary import TemporaryFolder
from models.valve_train.cams.smoothing import find_ramp
from models.valve_train.cams.table import Points

from ...analyses._evaluate import create_folder, find_results
from ...assessment.figures_of_merit import CONTACT
from ...assessment.friction.remarks import remark_friction
from ...assessment.motion import Motion, Part
from ...assessment.notices import list_notices
from ...assessment.springs import list_springs
from ...errors import MistakeError, Words
from ...plots.design import draw_design
from ...plots.style import save_figure
from ...report.answer import Answer
from ...reporter import Bar, Reporter, follow, tell_interruption
from ...run.pipeline import run_part
from ...scenario.files import load, read_changed
from ...scenario.system import Builder, build_system
from ..speeds.finder import CycleFinder
from ..speeds.separation import bisect_separation, is_separated
from ..speeds.subject import SpeedSubject, describe_numbers, find_flywheel, to_motion
from .brief import FREE, OWN, Asked, Limits, Ramps, Size, read_bounds
from .deliverables import deliver
from .figures import Bound, find_objective, list_bounds, read_figures
from .files import (
    CAM,
    DESIGN,
    FIGURE,
    FILES,
    LIFTS,
    PAGE,
    PROGRESS,
    SCENARIO,
    TABLE,
    describe_kept,
    keep,
    read_kept,
)
from .limits import find_sizes
from .report import Check, describe_clashes, report, tabulate
from .search import Search, Seen
from .train import DesignedTrain, open_train
from .wanted import CONFIRMED, Found, Improved, Wanted

RPM = 30.0 / math.pi
# The scenario's own separation is sought from its own speed to this part of it, in so many steps.
TO, STEPS = 6.0, 16
# Speeds up to the one of separation that a search keeps in sight, and the lowest one, as parts of it. Figures
# are compared at the lowest and at one below separation, where contact is kept. At a tenth, about idle,
# inertia takes 1 % of the load on the nose: there pressures are largest.
KEPT, LOW, BELOW, IDLE = (1.0, 0.95, 0.88), 0.5, 0.95, 0.1
# The speed of separation of the designed cam is looked for from and to these parts of that asked for.
AGAIN, TRIES = (0.8, 1.3), 10
# It is found to this part of it.
CLOSE = 1e-3


class _Cycles:
    """The motions of a scenario at speeds (rad/s), each found once; `bar` shows the share of `count`."""

    def __init__(self, finder: CycleFinder, bar: Bar, count: int) -> None:
        self._finder, self._bar, self._count = finder, bar, count
        self._found: dict[float, Motion] = {}

    def __getitem__(self, speed: float) -> Motion:
        if speed not in self._found:
            self._found[speed] = to_motion(self._finder.begin({}, speed), self._finder.subject.flywheel)
            self._bar.show(min(0.99, len(self._found) / self._count))
        return self._found[speed]

    def is_lost(self, speed: float) -> bool:
        return is_separated(self[speed], "lost")


def find_own_limits(train: DesignedTrain, limits: Limits, speed: float) -> dict[str, float]:
    """The sizes that are asked for the limits of the cam itself (SI); `speed` is the cam's (rad/s)."""
    found = {}
    for name, size in find_sizes(train.lobe, train.lobe.own, train.lobe.kind.geometry, speed).items():
        asked = getattr(limits, name)
        if asked != FREE and not (asked == OWN and size < 1e-9):
            found[name] = size if asked == OWN else float(asked)
    return found


def find_own_separation(asked: Asked, cycles: _Cycles, speed: float) -> float | None:
    """That of the scenario's own cam (rad/s), from its own `speed` on."""
    highest = asked.brief.highest_speed or TO * speed
    if highest <= speed:
        raise MistakeError(
            f"highest_speed = {highest * RPM:.6g} r/min: must be above the scenario's own speed, "
            f"{speed * RPM:.6g} r/min"
        )
    if asked.brief.limits.separation_speed == OWN and cycles.is_lost(speed):
        raise MistakeError(
            f"limits.separation_speed: the scenario's own cam has lost contact at the scenario's own speed, "
            f"{speed * RPM:.6g} r/min; begin with a lower speed of the flywheel, or give a limit"
        )
    return find_separation(cycles.is_lost, speed, highest, STEPS)


def find_wanted(asked: Asked, train: DesignedTrain, cycles: _Cycles, own: float | None) -> Wanted:
    """The limits in SI units."""
    limits = asked.brief.limits
    free = limits.separation_speed == FREE
    target = own if limits.separation_speed == OWN else limits.separation_speed
    if target is None:
        raise MistakeError(
            "limits.separation_speed: the scenario's own cam keeps contact at all speeds that were tried; "
            "give a speed, or a highest_speed where it loses contact"
        )
    if free and not asked.brief.speeds:
        raise MistakeError('limits.separation_speed = "free": needs speeds = [...] at which limits are kept')
    kept = () if free else tuple(float(target) * part for part in KEPT)
    top = max(asked.brief.speeds) if free else float(target)
    speeds = tuple(asked.brief.speeds) or (LOW * top,)
    idle = (IDLE * top,) if min(speeds) > IDLE * top else ()
    landings = [speed for speed in kept if not cycles.is_lost(speed)]
    below = [*speeds, *landings]
    parts = train.train.contacts

    def find_pressure(part: str) -> float:
        return max(float(cycles[v].column(f"{part}.maximum_pressure").max()) for v in (*idle, *below))

    def find_gap(part: str) -> float:
        return min(float(cycles[v].column(f"{part}.least_gap").min()) for v in (*idle, *below))

    def find_load() -> float:
        loads = (CONTACT["least_load"][1](Part(cycles[s], p)).value for p in parts for s in (*idle, *below))
        return min(filter(math.isfinite, loads), default=0.0)

    def find_film() -> float:
        return min(float(np.nanmin(train.film_ratios(cycles[speed].column))) for speed in below)

    pressures = {part: _choose(limits.peak_pressure, partial(find_pressure, part)) for part in parts}
    gaps = {part: _choose(limits.least_gap, partial(find_gap, part)) for part in list_springs(train.train)}
    film = _choose(limits.least_film_ratio, find_film) if train.has_film else None

    def figure(name: str, speed: float) -> float:
        return read_figures(cycles[speed], [name])[name].value

    def worst(name: str, side: float) -> float:
        at = below if Bound(name, side, 0.0).lands else speeds
        return side * max(side * figure(name, speed) for speed in at)

    known = describe_numbers(train.scenario)
    asked_area = limits.least_lift_area
    area = asked_area if isinstance(asked_area, float) else float(asked_area == OWN)
    bounds = list(list_bounds(asked.brief, known, worst))
    return Wanted(
        find_own_limits(train, limits, top * train.ratio),
        {part: size for part, size in pressures.items() if size is not None},
        {part: size for part, size in gaps.items() if size is not None},
        _choose(limits.least_load, find_load) or 0.0, speeds, kept, film or 0.0,
        bounds, area, find_objective(asked.brief, known, figure, speeds), idle,
        landings if any(one.lands for one in bounds) else (),
    )  # fmt: skip


def _choose(asked: Size, own: Callable[[], float]) -> float | None:
    """The size of a limit; None where there is none."""
    if asked == FREE:
        return None
    return own() if asked == OWN else float(asked)


def design(
    asked: Asked, out: Path, build: Builder, reporter: Reporter, overwrite: bool = False
) -> xarray.Dataset:
    """Find the cam of a brief and write it into `out`; returns both cams over the cam angle.

    What an interrupted search found is in `out`, from where the same call goes on. `build` makes the FMUs of
    the coupled run. MistakeError or ModelError before anything is written.
    """
    begun = None if overwrite else read_kept(out, asked)
    held = [] if begun is not None else find_results(out, DESIGN, overwrite, *FILES)
    brief = asked.brief
    train = open_train(asked.tables, brief.coefficients, brief.cam, brief.event, brief.ramps, brief.symmetric)
    bounds = read_bounds(brief, train.scenario, train.subject.flywheel, train.wires)
    train = train.with_parameters(bounds)
    reporter.notice([*list_notices(train.scenario), *filter(None, [describe_own_ramp(train)])])
    with create_folder(out):
        with reporter.stage("cycles of the scenario's own cam") as bar:
            cycles = _Cycles(train.finder, bar, 2 * STEPS)
            free = brief.limits.separation_speed == FREE
            separation = None if free else find_own_separation(asked, cycles, train.own_speed)
            wanted = find_wanted(asked, train, cycles, separation)
            speeds = [*wanted.idle, *wanted.speeds, *(BELOW * speed for speed in wanted.kept[:1])]
            before = Check(separation, {speed: cycles[speed] for speed in speeds})
            own = {speed: cycles[speed] for speed in (*speeds, *wanted.kept)}
        for file in held:
            file.unlink()
        reporter.notice(describe_clashes(own, "with the scenario's own cam"))
        reporter.line(_introduce(wanted, train.subject.flywheel))
        if brief.ramps:
            reporter.notice(describe_fast_ramps(brief.ramps, wanted, own))
        area = float(np.trapezoid(train.lobe.own.s - train.lobe.ramps.s, train.lobe.angles))
        top = max((*wanted.speeds, *wanted.kept)) * train.ratio
        search = Search(
            train, wanted, np.array(list(bounds.values())).reshape(-1, 2), top, area, reporter.line,
            brief.starts, brief.seed,
        )  # fmt: skip
        best: list[tuple[Found, Mapping[float, Seen]]] = []

        def note(found: Found, seen: Mapping[float, Seen]) -> None:
            keep(out, asked, train, found)
            best.append((found, seen))

        def describe() -> str:
            if best:
                save_figure(lambda: draw_design(tabulate_best(search, before, *best[-1])), out / FIGURE)
            return describe_kept(out, drawn=bool(best))

        # Of the rounds that are allowed few are needed: their share foretells nothing.
        stage = reporter.stage("search for a better cam", estimate=lambda share, seconds: "")
        with tell_interruption(describe), stage:
            improved = search.improve(begun, note)
        with reporter.stage("check of the designed cam") as bar:
            after = check(out, wanted, speeds, bar)
        with reporter.stage("coupled run of the designed cam") as bar:
            coupled, kept = couple(out, train.own_speed, wanted, build, follow(bar.show))
            said = [*deliver(out, train, improved.found.unknowns), *coupled]
        geometries = train.lobe.kind.geometry, search.geometry(improved.found.unknowns)
        table = tabulate(train, wanted, improved, (before, after), geometries)
        table.attrs["feasible"] = int(table.attrs["feasible"] and kept)
        table.to_netcdf(out / TABLE, engine="h5netcdf")
        save_figure(lambda: draw_design(table), out / FIGURE)
        (out / PROGRESS).unlink()
    answer = Answer(table.attrs["title"], reporter)
    report(table, improved, answer)
    for text in said:
        answer.line(text)
    _, find_ratio = CONTACT["least_film_ratio"]
    ratios = {
        f"{part}.least_film_ratio": [find_ratio(Part(one, part)).value for one in after.motions.values()]
        for part in train.train.contacts
    }
    for text in remark_friction(build_system(train.scenario), ratios):
        answer.line(text)
    answer.write(out, PAGE, (FIGURE, SCENARIO, LIFTS, TABLE, f"{CAM}/"))
    return table


def describe_own_ramp(train: DesignedTrain) -> str:
    """That the event, with its ramps left out, has ramps itself: those of a lift table, which have no law."""
    lobe, own = train.lobe, train.lobe.own
    s, ds, dds, _ = (np.subtract(*both) for both in zip(own, lobe.ramps, strict=True))
    if not (height := find_ramp(Points(lobe.angles, s, ds, dds))):
        return ""
    return (
        f"the designed event replaces the ramps of {train.cam}, up to {1e3 * height:.2g} mm, which are a "
        "part of its lift table; to keep ramps, take them out of the table, and give the cam a ramp_height "
        "or the brief [ramps]"
    )


def describe_fast_ramps(ramps: Ramps, wanted: Wanted, own: Mapping[float, Motion]) -> Iterator[str]:
    """That a valve of the scenario's own cam (motions by rad/s) lands harder on asked ramps than it may: no
    event changes them."""
    for bound in (one for one in wanted.figures if one.figure == "seating_velocity"):
        speeds = [*wanted.speeds, *wanted.landings]
        found = {speed: read_figures(own[speed], [bound.name])[bound.name].value for speed in speeds}
        worst = max(speeds, key=lambda speed: found[speed])
        if (share := bound.size / found[worst]) < 1.0 - CONFIRMED:
            slope = 1e3 * math.radians(ramps.velocity)
            yield (
                f"limits.largest_seating_velocity, {bound.size:.4g} m/s, contradicts [ramps]: on them "
                f"{bound.name} is {found[worst]:.4g} m/s at {RPM * worst:.0f} r/min with the scenario's own "
                f"cam; a velocity of about {share * slope:.3g} mm/deg instead of {slope:.4g} keeps it"
            )


def _introduce(wanted: Wanted, shaft: str) -> str:
    """Which speeds the lines of the search name, and at which limits hold."""
    at = ", ".join(f"{RPM * speed:.0f}" for speed in wanted.speeds)
    idle = "".join(f", of loads and pressures at {RPM * speed:.0f} too" for speed in wanted.idle)
    kept = f"; contact is to be kept up to {RPM * wanted.kept[0]:.0f}" if wanted.kept else ""
    return f"speeds are those of {shaft} in r/min: limits hold at {at}{idle}{kept}"


def tabulate_best(search: Search, before: Check, found: Found, seen: Mapping[float, Seen]) -> xarray.Dataset:
    """A cam that may not be the last one, with its contacts at the speeds of the brief."""
    own = {speed: before.motions[speed] for speed in search.wanted.speeds}
    after = {speed: search.to_motion(seen[speed].cycle) for speed in own}
    checks = before._replace(motions=own), Check(None, after)
    geometries = search.train.lobe.kind.geometry, search.geometry(found.unknowns)
    return tabulate(search.train, search.wanted, Improved(found, []), checks, geometries)


def couple(
    out: Path, speed: float, wanted: Wanted, build: Builder, reporter: Reporter
) -> tuple[list[Words], bool]:
    """A coupled run of the written scenario at its own speed (rad/s), its cycle there, and the limits; and
    whether it keeps them."""
    scenario = load(out / SCENARIO)
    with TemporaryFolder() as folder:
        summary = run_part(scenario, folder / "coupled", build, reporter)
    if not summary.complete:
        return [("the coupled run of the designed cam failed: ", summary.message)], False
    said, kept = list[Words](), True
    subject = SpeedSubject(read_changed(out / SCENARIO), find_flywheel(scenario))
    motion = subject.find_motion_at(speed)
    for name, contact in summary.contacts.items():
        pressure = CONTACT["peak_pressure"][1](Part(motion, name)).value
        most = wanted.pressures.get(name, math.inf)
        kept &= contact.pressure <= (1.0 + CONFIRMED) * most
        said.append(
            f"coupled run at {speed * RPM:.0f} r/min: largest pressure in {name} "
            f"{1e-6 * contact.pressure:.1f} MPa, of the cycle {1e-6 * pressure:.1f} MPa"
            f"{describe_excess(contact.pressure, most)}"
        )
    return said, kept


def describe_excess(pressure: float, most: float) -> str:
    """The limit of a pressure (Pa), and by how much it is exceeded."""
    share = pressure / most - 1.0
    said = f": exceeds the limit of {1e-6 * most:.1f} MPa by {100.0 * share:.2g} %"
    kept = f", limit {1e-6 * most:.1f} MPa" if math.isfinite(most) else ""
    return said if share > CONFIRMED else kept


def check(out: Path, wanted: Wanted, speeds: list[float], bar: Bar) -> Check:
    """What the written scenario does, found as that of the brief."""
    tables = read_changed(out / SCENARIO)
    subject = SpeedSubject(tables, find_flywheel(SpeedSubject(tables, "").scenario))
    cycles = _Cycles(CycleFinder(subject), bar, 2 * STEPS)
    separation = None
    if wanted.kept:
        low, high = (part * wanted.kept[0] for part in AGAIN)
        separation = find_separation(cycles.is_lost, low, high, TRIES)
    return Check(separation, {speed: cycles[speed] for speed in speeds})


def find_separation(
    is_lost: Callable[[float], bool], low: float, high: float, steps: int = 12
) -> float | None:
    """The lowest of `steps` speeds (rad/s) from `low` to `high` at which contact is lost, found closer
    between it and the one before; None where it is kept at all of them."""
    kept = None
    for speed in np.geomspace(low, high, steps):
        if is_lost(float(speed)):
            return float(speed) if kept is None else bisect_separation(is_lost, kept, float(speed), CLOSE)
        kept = float(speed)
    return None
