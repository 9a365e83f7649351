"""tribocosim masters."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ..packages import check_study_packages
from .apart import carry_out_apart
from .completion import ScenarioName
from .error_report import report_errors
from .json_output import Json, build_reporter, print_json
from .options import Overwrite, Settings, folder_option


@report_errors
def run_masters(
    scenario: ScenarioName,
    set_: Settings = None,
    master: Annotated[
        list[str] | None, typer.Option(metavar="MODULE:OBJECT", help="Also run a master of your own.")
    ] = None,
    out: Annotated[Path | None, folder_option("results/SCENARIO-masters")] = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Run a scenario with every master that its FMUs can take: the error of each against its work."""
    check_study_packages()
    from orchestrator.scenario.files import read
    from orchestrator.scenario.system import build_system
    from orchestrator.study.masters import compare_masters

    from ..cached_fmus import build_fmu
    from ..scenario import Scenario

    content = Scenario(*read(scenario, set_ or []))
    carry_out_apart(checked := content.check(), None)
    build_system(checked)  # a mistake in it would be each master's
    found = compare_masters(
        lambda changes: content.with_(changes).check(), master or [], out, overwrite, build_fmu,
        build_reporter(as_json),
    )  # fmt: skip
    if as_json:
        print_json([asdict(one) for one in found])
