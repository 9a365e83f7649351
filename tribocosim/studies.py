"""Analyses, sweeps over speed and parameter studies from Python, with results as xarray."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.compile.temporary import TemporaryFolder
from orchestrator.analyses import load as load_analysis

from .arguments import checks_arguments
from .cached_fmus import build_fmu
from .packages import check_fit_packages, check_study_packages
from .reporting import Progress, SilentReporter
from .scenario import Scenario, load, read_tables

if TYPE_CHECKING:
    import xarray


@checks_arguments
def analyse(
    subject: Scenario | str | Path,
    settings: Mapping[str, Any] | None = None,
    *,
    at: Sequence[str] = (),
    progress: Progress | None = None,
) -> xarray.Dataset:
    """An analysis by name with its `settings`, or how each master will do with a scenario.

    Of a scenario: `settings` change it, `at` are further instants to linearise at. The
    same tables as the command `analyse` writes.
    """
    from orchestrator.analyses._evaluate import compute_table
    from orchestrator.analyses.stability.analyse import is_scenario, parse_instants, survey_scenario
    from orchestrator.analyses.stability.report import build_dataset
    from orchestrator.scenario.system import resolve

    if not isinstance(subject, Scenario) and not is_scenario(str(subject)):
        analysis = load_analysis(str(subject))
        with SilentReporter(progress).stage(analysis.description):
            return compute_table(analysis, analysis.complete(dict(settings or {})))
    scenario = load(subject)
    checked = scenario.with_(settings or {}).check()
    instants = parse_instants(at, checked.stop_time)
    return build_dataset(survey_scenario(resolve(checked), instants, SilentReporter(progress)))


@checks_arguments
def cam(
    source: str | Path,
    settings: Mapping[str, Any] | None = None,
    *,
    component: str | None = None,
    out: str | Path | None = None,
    overwrite: bool = False,
) -> xarray.Dataset:
    """What a cam is like: of a lift table (.csv), a law such as "cycloidal", or a scenario's `component`.

    `settings` are parameters of the analysis `cam`, such as {"follower": "roller", "radius": "8 mm"}. With a
    folder `out` its table, figure, drawings and lift tables are written, as by the command `cam`.
    """
    from orchestrator.analyses._cam_source import find_settings
    from orchestrator.analyses._evaluate import compute_table, evaluate

    analysis = load_analysis("cam")
    given = {**find_settings(str(source), component), **(settings or {})}
    if out is None:
        return compute_table(analysis, analysis.complete(given))
    return evaluate(analysis, given, Path(out), overwrite, SilentReporter())


@checks_arguments
def compare(
    first: str | Path,
    second: str | Path,
    figure: str | Path | None = None,
    *,
    low: str | None = None,
    high: str | None = None,
    at: str | None = None,
    lost: bool = False,
) -> dict[str, Any]:
    """Two designs side by side, from the folders of their sweeps or runs, as the command `compare` does.

    The worst is taken from the speed `low` to `high`, or `at` one, where both keep contact, or also where it
    is `lost`. `worst` has by number its unit, and of each design the worst value, its speed (r/min) and,
    where it has one, its cam angle (degrees); `separation` and `second_separation` are those of each design.
    `figure` is a file for both over speed. Of the folders of two runs, `merits` has the figures of merit of
    both, each with its angle (degrees) and time (ms), and `figure` shows both valve trains over the angle.
    """
    check_study_packages()
    from orchestrator.store.output_folder import is_run
    from orchestrator.study.run_overlay import compare_runs
    from orchestrator.study.speeds.compare import compare as compare_sweeps
    from orchestrator.study.speeds.compare import parse_choice

    file = None if figure is None else Path(figure)
    if is_run(Path(first)) or is_run(Path(second)):
        return compare_runs(Path(first), Path(second), file, SilentReporter())
    choice = parse_choice(low, high, at, lost)
    return compare_sweeps(Path(first), Path(second), file, SilentReporter(), choice)


@checks_arguments
def speeds(
    scenario: Scenario | str | Path,
    low: str = "500 rpm",
    high: str = "4000 rpm",
    count: int = 36,
    *,
    out: str | Path | None = None,
    workers: int | None = None,
    second_film: str | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xarray.Dataset:
    """The steady cycles of a valve train over the speed of its flywheel, as the command `speeds` finds them.

    The attribute `separation` says in words from which speed contact is lost, `separation_speed` is that
    speed (r/min; nan: none was found). `second_separation` and `second_separation_speed` are those with
    another film formula in the contacts: `second_film`, by default "dowson_toyoda" (the contacts' own: not
    found). `out` keeps table, cycles and figures in a folder; a sweep that was
    stopped goes on there.
    """
    check_study_packages()
    from orchestrator.study.run import Where
    from orchestrator.study.speeds.sweep import parse_range, sweep

    chosen = parse_range(low, high, count)
    with _open_folder(out, "speeds") as folder:
        where, reporter = Where(workers=workers), SilentReporter(progress)
        found = sweep(read_tables(scenario), chosen, folder, where, reporter, overwrite, second_film)
    attributes: dict[str, Any] = {}
    for name in ("separation", "second_separation"):
        stated = found.summary.get(name) or {}
        speed = stated.get("speed")
        attributes[name] = stated.get("text", "")
        attributes[f"{name}_speed"] = math.nan if speed is None else speed
    return found.table.assign_attrs(attributes)


@checks_arguments
def design(
    brief: str | Path,
    settings: Sequence[str] = (),
    *,
    out: str | Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xarray.Dataset:
    """The cam with the most lift area within the limits of a `brief`: a shipped one, a file, or a scenario,
    whose own cam gives the limits; `settings` ("path=value") change the scenario.

    Both cams over the cam angle, with their contacts at some speeds. Attributes: `area`, that of the lift
    over the one before; `separation` (rad/s) before and after; `active`, what holds the cam, in words;
    `feasible`, 0 where no cam keeps all limits, also in its coupled run. `out` keeps scenario, lift table and
    figure; a call that was stopped goes on there.
    """
    from orchestrator.study.design.brief import read_brief
    from orchestrator.study.design.run import design as design_cam

    asked = read_brief(str(brief), settings)
    with _open_folder(out, "design") as folder:
        return design_cam(asked, folder, build_fmu, SilentReporter(progress), overwrite)


@checks_arguments
def sensitivities(
    scenario: Scenario | str | Path,
    speed: str | None = None,
    parameters: Sequence[str] = (),
    *,
    period: str | None = None,
    run: bool = False,
    out: str | Path | None = None,
    workers: int | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xarray.Dataset:
    """How the figures of merit of the steady cycle at `speed`, by default the scenario's, or of the `run` of
    the scenario from its start, change with `parameters`, over (figure, parameter): `elasticity`, the
    relative change over that of the parameter, its `error`, and those of both sides, `below` and `above`.
    The attribute `method` is "tangents" where derivatives are exact, else "differences" of whole cycles or
    runs. Scenarios with FMUs of other tools are coupled; where no flywheel drives them their cycle has the
    `period`, as "20 ms".

    Parameters are called "component.parameter", or "speed"; by default they are the speed and all continuous
    ones but zeros and elements of arrays. `out` keeps the cycles in a folder; a call that was stopped goes on
    there. RunError where the scenario's own motion is not steady, MistakeError where a run has no tangents.
    """
    check_study_packages()
    from orchestrator.study.run import Where
    from orchestrator.study.speeds.sensitivities import Asked, find_asked_sensitivities

    content, asked = read_tables(scenario), Asked(parameters, speed, period, run)
    with _open_folder(out, "sensitivities") as folder:
        where, reporter = Where(workers=workers), SilentReporter(progress)
        return find_asked_sensitivities(content, asked, folder, where, build_fmu, reporter, overwrite)


@checks_arguments
def calibrate(  # noqa: PLR0913  # options of the command
    scenario: Scenario | str | Path,
    data: str | Path | Sequence[str | Path],
    parameters: Sequence[str],
    *,
    signals: Sequence[str] = (),
    bounds: Sequence[str] = (),
    starts: int = 1,
    profile: Sequence[str] = (),
    out: str | Path | None = None,
    workers: int | None = 1,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xarray.Dataset:
    """Fit `parameters` "component.parameter" of a scenario to measured signals, as the command `calibrate`.

    `data` are CSV files; the other arguments are as the options. Over `parameter` the result has `start`,
    `fitted`, `low` and `high` (95 %), `deviation`, `identified`, and `correlation`; its attribute `notes`
    says what the signals do not show. `out` keeps results, fitted scenario and figure. With None `workers`
    are one a core.
    """
    check_fit_packages()
    from orchestrator.study.calibration.run import Asked, Source
    from orchestrator.study.calibration.run import calibrate as fit
    from orchestrator.study.run import Where

    files = [Path(data)] if isinstance(data, str | Path) else [Path(one) for one in data]
    asked = Asked(parameters, bounds, signals, starts, profile)
    source = Source(read_tables(scenario), "" if isinstance(scenario, Scenario) else str(scenario))
    with _open_folder(out, "calibration") as folder:
        reporter = SilentReporter(progress)
        return fit(source, files, asked, folder, Where(workers=workers), build_fmu, reporter, overwrite)


@checks_arguments
def study(
    tables: Mapping[str, Any] | str | Path,
    scenario: Scenario | None = None,
    *,
    out: str | Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    overwrite: bool = False,
    retry_failed: bool = False,
    progress: Progress | None = None,
) -> xarray.Dataset:
    """A parameter study: a shipped one, a file, or its tables, on all cores or on a dask `scheduler`.

    `scenario` is its subject; without it the tables name one. The variable `status` is 1 where a point is
    done; `message` says why one failed. `out` keeps the zarr store; a study that was stopped goes on there.
    `progress` gets a line with the time left, and the share that is done: `progress=print` prints both.
    """
    check_study_packages()
    import xarray

    from orchestrator.study.files import build_scenario_subject, build_subject, parse_study, resolve
    from orchestrator.study.files import load as load_study
    from orchestrator.study.run import Where, run

    if isinstance(tables, Mapping):
        named = {"scenario": scenario.name} if scenario else {}
        parsed = parse_study({"name": "study", **tables, **named})
        subject = (
            build_scenario_subject(parsed, copy.deepcopy(dict(scenario.content)), build_fmu)
            if scenario
            else build_subject(parsed, Path.cwd(), build_fmu)
        )
        plan = resolve(parsed, subject)
    else:
        plan = load_study(str(tables), build_fmu)
    where = Where(scheduler, workers)
    with _open_folder(out, "study.zarr") as store:
        run(plan, store, where, SilentReporter(progress), overwrite, retry_failed)
        with xarray.open_zarr(store) as found:
            return found.load()


@checks_arguments
def tolerances(
    scenario: Scenario | str | Path,
    given: Mapping[str, Any] | str | Path,
    *,
    out: str | Path | None = None,
    workers: int | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xarray.Dataset:
    """What scatter of parameters and grinding errors do to a train, as the command `tolerances` finds it.

    `given` is a tolerance file or its tables. `percentile` and `mean` are over figures; `first` and `total`
    are Sobol' indices over (figure, factor); `yield` is over limits, `yield_without` has that of the trains
    amid a factor. `end` is the value or the low or high end of its interval of confidence (95 %). `linear` is
    the answer of first order. `out` keeps the trains in a folder; a call that was stopped goes on there.
    """
    check_study_packages()
    from orchestrator.study.run import Where
    from orchestrator.study.tolerances.run import find_tolerances
    from orchestrator.study.tolerances.table import parse_tolerances, read_tolerances

    content = read_tables(scenario)
    read = parse_tolerances(dict(given)) if isinstance(given, Mapping) else read_tolerances(Path(given))
    with _open_folder(out, "tolerances") as folder:
        where, reporter = Where(workers=workers), SilentReporter(progress)
        return find_tolerances(content, read, folder, where, reporter, overwrite)


@checks_arguments
def wear(  # noqa: PLR0913  # options of the command
    scenario: Scenario | str | Path,
    until: str = "0.127 mm",
    *,
    wear_coefficient: str = "1e-18,1e-16",
    speed: str | None = None,
    contact: str | None = None,
    tolerance: float = 0.01,
    wear_follower: bool = False,
    out: str | Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xarray.Dataset:
    """How a valve train's cam wears until it has lost the depth `until`, as the command `wear` finds it.

    The attribute `answer` says it in words, with the fewest and the most cycles by the `wear_coefficient`
    (m2/N: one, or the least and the largest). Ages are steps of the wear, with depths over cam angle and
    follower. With `wear_follower` the follower's wear comes back into the motion too, and the depth is that
    of the first of both bodies. `speed` is that of the flywheel. `tolerance` is the extrapolation's error as
    a part of the depth, which the shortest steps may exceed; `error` is estimated (m).
    `out` keeps table, worn lift table and figure; what was stopped goes on there.
    """
    check_study_packages()
    from orchestrator.study.wear.run import parse_asked
    from orchestrator.study.wear.run import wear as wear_cam

    asked = parse_asked(until, wear_coefficient, tolerance, contact, speed, wear_follower)
    with _open_folder(out, "wear") as folder:
        return wear_cam(read_tables(scenario), asked, folder, SilentReporter(progress), overwrite)


@contextmanager
def _open_folder(out: str | Path | None, name: str) -> Iterator[Path]:
    """`out`, or one that is deleted afterwards."""
    if out is not None:
        yield Path(out)
        return
    with TemporaryFolder() as folder:
        yield folder / name
