"""Pages drawn anew, and the one that computes the steady cycle of a run's train."""

from pathlib import Path

from models.compile.temporary import TemporaryFolder
from orchestrator.reporter import DRAWING, PAGE, Reporter
from orchestrator.store.output_folder import REPORT, SCENARIO, STORE, check_swept
from orchestrator.store.result_file import find_result

from .scenario import load
from .scenario_fmus import write_whole

CYCLE = "cycle.html"


def draw_page(folder: Path, path: Path | None, cycle: bool, reporter: Reporter) -> Path:
    """As `tribocosim.report`; the reporter shows the progress."""
    from orchestrator.report import draw_anew

    target = path / (CYCLE if cycle else REPORT) if path and path.is_dir() else path
    if cycle:
        return write_cycle_page(folder, target, reporter)
    check = check_swept if (folder / STORE).exists() else find_result
    check(folder)  # else a stage would begin before the mistake is told
    with reporter.stage(PAGE if path else DRAWING):
        return draw_anew(folder, target)


def write_cycle_page(folder: Path, path: Path | None, reporter: Reporter) -> Path:
    """Write the page for the run in `folder`, by default into it as cycle.html; its path. In the place of a
    folder a scenario may stand, by name or file.

    MistakeError for a train without a prescribed speed, with events or
    with a part that needs Python; NativeBuildError without the tools.
    """
    from fmus.native.cycle_module import cycle_module
    from fmus.native.machine_code import library_licenses
    from models.catalogue import find_factory
    from orchestrator.report import SAMPLES, Train, repeat, write_cycle
    from orchestrator.scenario.files import load as load_checked
    from orchestrator.scenario.system import build_system
    from orchestrator.study.speeds.subject import count_turns, find_flywheel

    source = folder / SCENARIO if folder.is_dir() else folder
    checked = load(source).check()
    flywheel = find_flywheel(checked)
    stage = "the train for browsers, minutes the first time on this machine"
    with TemporaryFolder() as here, reporter.stage(stage) as bar:
        bar.show(0.0, ", its parts")
        own = write_whole(checked, here)
        component = find_factory(own)()
        show = lambda done, words: bar.show(0.2 + 0.8 * done, f", {words}")  # noqa: E731
        code = cycle_module(own, component, SAMPLES, show)
    train = Train(
        checked, component, code, library_licenses(), flywheel, count_turns(build_system(checked)),
        repeat("run", source, folder if folder.is_dir() else Path("results") / checked.name),
        lambda text: load_checked(source, [text]),
    )  # fmt: skip
    return write_cycle(train, path or (folder / CYCLE if folder.is_dir() else Path(CYCLE)))
