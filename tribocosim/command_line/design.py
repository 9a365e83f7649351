"""tribocosim design."""

from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors
from .json_output import Json, build_reporter, print_json
from .options import Restart, Settings, folder_option


@report_errors
def design_cam(
    brief: Annotated[
        str, typer.Argument(help="A scenario, whose own cam gives the limits, or the .toml file of a brief.")
    ],
    out: Annotated[Path | None, folder_option("results/BRIEF-design")] = None,
    set_: Settings = None,
    overwrite: Restart = False,
    as_json: Json = False,
) -> int:
    """Find the cam with the most lift area within limits on contacts, curvature, acceleration and separation.

    Writes a scenario with the cam's lift table. The same command continues an interrupted search. Exit status
    0: all limits are kept, 1: no such cam was found, 2: a mistake in the brief, 130: interrupted.
    """
    from orchestrator.run.interruption import tell_interruption
    from orchestrator.study.design.brief import read_brief
    from orchestrator.study.design.files import describe_kept
    from orchestrator.study.design.run import design

    from ..cached_fmus import build_fmu

    asked = read_brief(brief, set_ or [])
    folder = out or Path("results") / f"{Path(brief).stem}-design"
    with tell_interruption(lambda: describe_kept(folder)):
        found = design(asked, folder, build_fmu, build_reporter(as_json), overwrite)
    if as_json:
        print_json(found.to_dict())
    return 0 if found.attrs["feasible"] else 1
