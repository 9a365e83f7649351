"""Runs from Python: what the commands do, with results as xarray."""

from __future__ import annotations

import json
import time as clock
import weakref
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.compile.temporary import TemporaryFolder
from orchestrator.errors import MistakeError, RunError, one_of
from orchestrator.run.pipeline import run_plan
from orchestrator.store.output_folder import check_folder
from orchestrator.store.result_file import find_result, open_result

from .arguments import checks_arguments
from .cached_fmus import build_fmu as build_cached_fmu
from .fmu import build_fmu, compare_fmu, fmu_info, validate_fmu
from .planning import plan, resolve_run
from .reporting import Progress, SilentReporter
from .scenario import Scenario, load, scenarios
from .scenario_fmus import build_scenario_fmus
from .stepping import Session as session
from .studies import analyse, calibrate, cam, compare, design, sensitivities, speeds, study, tolerances, wear

if TYPE_CHECKING:
    import xarray

    from orchestrator.run.plan import Plan
    from orchestrator.run.summary import Summary

    from .pictures import Picture

__all__ = [
    "MistakeError", "Result", "RunError", "Scenario", "analyse", "build_fmu", "build_scenario_fmus",
    "calibrate", "cam", "compare", "compare_fmu", "design", "execute", "fmu_info", "load", "open", "plan",
    "report", "resume", "run", "scenarios", "sensitivities", "session", "speeds", "study", "tolerances",
    "validate_fmu", "wear",
]  # fmt: skip


@dataclass(frozen=True)
class Result:
    """A run: what was computed, in SI units, and how it compares with the reference.

    `coupled`, `reference` (None if there is none) and `steps` are over time; variables are called
    "component.variable" and have their unit in `attrs`. `summary` is the content of summary.json, with
    `errors` by variable. `folder` is where all of it lies, None if it was not kept.
    """

    coupled: xarray.Dataset
    reference: xarray.Dataset | None
    steps: xarray.Dataset | None
    summary: Mapping[str, Any]
    folder: Path | None
    # The files of a run that has no folder; they go when the result does.
    _kept: Path = field(default=Path(), repr=False, compare=False)

    def __repr__(self) -> str:
        return f"Result of {self.summary['scenario']}: {self.verdict}"

    @property
    def verdict(self) -> str:
        """Whether the run is within the scenario's tolerance."""
        return str(self.summary["verdict"])

    @property
    def within(self) -> bool:
        """True if it is complete and within its tolerance of the reference."""
        return int(self.summary["exit_status"]) == 0

    @property
    def notices(self) -> list[str]:
        """What the command prints of scenario, contacts, steps and FMUs, and details, line by line."""
        return list(self.summary.get("notices", []))

    @property
    def errors(self) -> dict[str, float]:
        """Relative RMS error of each variable against the reference; empty without one."""
        return {name: error["relative_rms"] for name, error in self.summary["errors"].items()}

    @checks_arguments
    def report(self, path: str | Path = "report.html") -> Path:
        """Write the run as a page for a browser, in one file: its mechanism in motion, plots, errors."""
        return report(self.folder or self._kept, path)

    def diagnose(self) -> list[str]:
        """What limited the macro steps, and what would help, line by line, as the command `diagnose` has."""
        from orchestrator.assessment.diagnosis.report import diagnose

        return list(diagnose(self.folder or self._kept).lines)

    @checks_arguments
    def friction(self, contact: str | None = None, *, wear_coefficient: float = 1e-17) -> xarray.Dataset:
        """Friction and wear of a contact under a cam over the last revolution, as the command `friction` has.

        `contact` may be left out where there is one. `wear_coefficient` is wear volume over load times
        sliding distance (m2/N). MistakeError if no contact slides under a cam, or several do.
        """
        from orchestrator.assessment.friction.judge import judge_friction
        from orchestrator.assessment.friction.report import tabulate

        _, found = judge_friction(self.folder or self._kept, contact, wear_coefficient, 1.0)
        if len(found) > 1:
            raise MistakeError(f"contact: must be one of {', '.join(one.cycle.contact for one in found)}")
        return tabulate(found[0].cycle, found[0].worn, found[0].coefficient)

    @checks_arguments
    def plot(self, *variables: str, over: str = "time") -> Picture:
        """Each variable, coupled and reference, below each other, in the units of figures and page.

        `over` is "time", "angle" (the cam's, else the crank's or shaft's), one of the angles `cam_angle`,
        `crank_angle` and `shaft_angle` that `coupled` has as coordinates, or a variable.
        """
        from .pictures import draw

        if not variables:
            raise MistakeError("variables: name at least one, e.g. result.plot('contact.load')")
        for name in variables:
            if name not in self.coupled:
                raise MistakeError(f"{name}: {one_of(map(str, self.coupled), name)}")
        angles = [str(name) for name in self.coupled.coords if name != "time"]
        if over == "angle" and angles:
            over = angles[0]
        if over not in self.coupled.variables:
            raise MistakeError(f"over = {over!r}: {one_of(['time', *angles, *map(str, self.coupled)], over)}")
        return draw(variables, over, self.coupled, self.reference)


@checks_arguments
def run(
    scenario: Scenario | str | Path,
    out: str | Path | None = None,
    *,
    overwrite: bool = False,
    figures: bool = False,
    progress: Progress | None = None,
) -> Result:
    """Run a scenario and compare it with its reference, as `tribocosim run` does.

    `out` keeps everything in a folder, as the command does; without it nothing is left behind. `figures` are
    drawn into that folder. `progress(stage, share)` is called with each stage and the share of it that is
    done; an error that it raises ends the run.
    MistakeError for a fault of the scenario, RunError if the run fails; its folder has what was computed.
    """
    began, reporter = clock.perf_counter(), SilentReporter(progress)
    checked = load(scenario).check()
    if out is not None:
        check_folder(Path(out), overwrite)
    plan = resolve_run(checked, reporter, figures)
    return _keep_result(out, lambda folder: run_plan(plan, folder, reporter, overwrite, began))


@checks_arguments
def execute(
    plan: Plan, out: str | Path | None = None, *, overwrite: bool = False, progress: Progress | None = None
) -> Result:
    """Make the run of a plan, as `run` does of a scenario; equal plans give equal bits."""
    reporter = SilentReporter(progress)
    return _keep_result(out, lambda folder: run_plan(plan, folder, reporter, overwrite))


def _keep_result(out: str | Path | None, make: Callable[[Path], Summary]) -> Result:
    """The result of a run that is made in `out`, or in a folder that goes when the result does."""
    if out is not None:
        return _open_complete(make(Path(out)), Path(out))
    kept = TemporaryFolder()
    folder = kept.path / "run"
    try:
        found = _open_complete(make(folder), folder)
    except BaseException:
        kept.delete()
        raise
    result = replace(found, folder=None, _kept=folder)
    weakref.finalize(result, kept.delete)
    return result


def _open_complete(summary: Summary, folder: Path) -> Result:
    if not summary.complete:
        raise RunError(summary.message)
    return open(folder)


@checks_arguments
def resume(
    folder: str | Path, *, figures: bool = True, progress: Progress | None = None, keep: bool = False
) -> Result:
    """Continue a run that was stopped, from its last checkpoint, with the same results.

    `figures` are drawn unless the run was begun without. `keep` makes the result of what was recorded, and
    does not go on. MistakeError if it cannot go on.
    """
    from orchestrator.run.pipeline import resume as resume_pipeline

    summary = resume_pipeline(Path(folder), build_cached_fmu, SilentReporter(progress), figures, keep)
    return open(Path(folder)) if keep else _open_complete(summary, Path(folder))


@checks_arguments
def report(
    folder: str | Path,
    path: str | Path | None = None,
    *,
    cycle: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Write the page of a run or a sweep over speed to `path`, a file or a folder; its path.

    Without `path` it is written into the folder, and a run's figures are drawn anew; RunError names those
    that fail, once all others are drawn. With `cycle` only the page cycle.html, which computes the steady
    cycle of the train as its sliders move; in the place of the folder a scenario may stand then, by name or
    file. MistakeError for trains with events.
    """
    from .cycle_page import draw_page

    return draw_page(Path(folder), None if path is None else Path(path), cycle, SilentReporter(progress))


@checks_arguments
def open(folder: str | Path) -> Result:
    """The result in the folder of a run, read into memory. MistakeError if there is none."""
    folder = Path(folder)
    with open_result(find_result(folder)) as tree:
        groups = {name: node.to_dataset().load() for name, node in tree.children.items()}
    summary = json.loads((folder / "summary.json").read_text("utf-8"))
    return Result(groups["coupled"], groups.get("reference"), groups.get("steps"), summary, folder)
