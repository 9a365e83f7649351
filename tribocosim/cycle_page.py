"""The page that computes the steady cycle of a run's train."""

from pathlib import Path

from models.compile.temporary import TemporaryFolder

from .scenario import load
from .scenario_fmus import write_whole

CYCLE = "cycle.html"


def write_cycle_page(folder: Path, path: Path | None = None) -> Path:
    """Write the page for the run in `folder`, by default into it as cycle.html; its path. In the place of a
    folder a scenario may stand, by name or file.

    MistakeError for a train without a prescribed speed, with events or
    with a part that needs Python; NativeBuildError without the tools.
    """
    from fmus.native.cycle_module import cycle_module
    from models.catalogue import find_factory
    from orchestrator.report import SAMPLES, Train, write_cycle
    from orchestrator.scenario.files import load as load_checked
    from orchestrator.scenario.system import build_system
    from orchestrator.store.output_folder import SCENARIO
    from orchestrator.study.speeds.subject import count_turns, find_flywheel

    source = folder / SCENARIO if folder.is_dir() else folder
    checked = load(source).check()
    flywheel = find_flywheel(checked)
    with TemporaryFolder() as here:
        own = write_whole(checked, here)
        component = find_factory(own)()
        code = cycle_module(own, component, SAMPLES)
    train = Train(
        checked, component, code, flywheel, count_turns(build_system(checked)), str(source),
        lambda text: load_checked(source, [text]),
    )  # fmt: skip
    return write_cycle(train, path or (folder / CYCLE if folder.is_dir() else Path(CYCLE)))
