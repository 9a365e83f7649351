"""`tribocosim analyse SCENARIO`: predict how a scenario's coupling behaves."""

from collections.abc import Sequence
from pathlib import Path

from threadpoolctl import threadpool_limits

from ...assessment.trains import check_lash
from ...errors import MistakeError, Option
from ...reporter import CHOICE, Reporter
from ...run.plan import plan_participants
from ...scenario.files import list_shipped, load
from ...scenario.system import Resolved, resolve
from ...scenario.units import UnitError, to_unit
from .._evaluate import create_folder, find_results
from .linearisation import open_linearisations
from .survey import EVERY, Scope, Survey, check_comparable, survey

FILE = "stability"


def is_scenario(name: str) -> bool:
    """Whether the name is that of a shipped scenario or the path of a file."""
    return name in list_shipped() or name.endswith(".toml") or Path(name).is_dir()


def analyse_scenario(
    name: str,
    settings: Sequence[str] = (),
    at: Sequence[str] = (),
    out: Path | None = None,
    overwrite: bool = False,
    reporter: Reporter | None = None,
) -> Survey:
    """Survey, print and write into `out` (default: results/NAME-stability).

    `settings` change the scenario ("path=value"). `at` are further instants to linearise at, in seconds or
    with a unit. Raises ScenarioError, ModelError, MistakeError or OutputFolderError.
    """
    from .report import build_table, describe, write_survey

    reporter = reporter or Reporter()
    scenario = load(name, settings)
    instants = parse_instants(at, scenario.stop_time)
    folder = out or Path("results") / f"{scenario.name}-{FILE}"
    held = find_results(folder, FILE, overwrite)
    with create_folder(folder):
        printed = folder / f"{FILE}.log"
        printed.unlink(missing_ok=True)
        with reporter.keep_prints(printed):
            found = survey_scenario(resolve(scenario), instants, reporter)
        for file in held:
            file.unlink()
        files = write_survey(found, folder)
    reporter.console.print(build_table(found))
    for line in describe(found):
        reporter.line(line)
    reporter.line(f"results in {folder}: {', '.join(file.name for file in files)}")
    return found


def survey_scenario(
    resolved: Resolved, instants: Sequence[float], reporter: Reporter, scope: Scope = EVERY
) -> Survey:
    """The survey about a scenario's start and these instants (s); `scope` is as in `survey`.

    Its matrices are small: a second thread of the linear algebra would only wait.
    """
    scenario, system = resolved.scenario, resolved.system
    check_comparable(scenario)
    check_lash(system)
    plans = plan_participants(scenario, resolved.assembly.linear, None)
    with (
        open_linearisations(scenario, system, plans) as participants,
        reporter.stage(CHOICE) as bar,
        threadpool_limits(limits=1, user_api="blas"),
    ):
        return survey(scenario, system, plans, participants, instants, bar.show, scope)


def parse_instants(at: Sequence[str], stop: float) -> list[float]:
    """Instants (s) between 0 and `stop`, given in seconds or with a unit; MistakeError for others."""
    instants = []
    for text in at:
        try:
            instants.append(to_unit(text, "s"))
        except UnitError as error:
            raise MistakeError((Option("at", text), ": ", error)) from None
        if not 0.0 <= instants[-1] <= stop:
            raise MistakeError((Option("at", text), f": must be between 0 and stop_time = {stop:g} s"))
    return instants
