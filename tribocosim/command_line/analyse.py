"""tribocosim analyse."""

from pathlib import Path
from typing import Annotated, Any

import typer

from .apart import carry_out_apart
from .error_report import report_errors
from .json_output import Json, build_reporter, print_json
from .options import Overwrite, folder_option, parameter_option


@report_errors
def run_analysis(
    name: Annotated[
        str | None,
        typer.Argument(
            help="An analysis, your own as module:object, or a scenario to predict each master's error.",
            show_default="list the analyses",
        ),
    ] = None,
    set_: Annotated[
        list[str] | None,
        parameter_option("Set a parameter, e.g. damping=0.1; for a scenario PATH=VALUE."),
    ] = None,
    show_parameters: Annotated[bool, typer.Option("--parameters", help="Only list the parameters.")] = False,
    at: Annotated[
        list[str] | None,
        typer.Option(metavar="TIME", help="Also linearise the scenario at this instant, e.g. '30 ms'."),
    ] = None,
    out: Annotated[Path | None, folder_option("results/NAME, or results/SCENARIO-stability")] = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Run an analysis, or predict stability and error of a scenario's coupling; write tables and figure."""
    from orchestrator.analyses import list_analyses, load
    from orchestrator.analyses._evaluate import analyse, build_analyses_table, build_parameters_table
    from orchestrator.analyses.stability.analyse import analyse_scenario, is_scenario
    from orchestrator.analyses.stability.report import build_dataset
    from orchestrator.errors import MistakeError, Option
    from orchestrator.reporter import tell_interruption
    from orchestrator.scenario.files import load as load_scenario

    reporter = build_reporter(as_json)
    result: Any
    if name is None:
        result = {one: load(one).description for one in list_analyses()}
        reporter.console.print(build_analyses_table())
    elif is_scenario(name) and show_parameters:
        remedy = Option("set"), " changes any of its keys, as for run"
        raise MistakeError((Option("parameters"), f": {name} is a scenario"), remedy)
    elif is_scenario(name):
        carry_out_apart(load_scenario(name, set_ or []), None)
        with tell_interruption():
            found = analyse_scenario(name, set_ or [], at or [], out, overwrite, reporter)
        result = build_dataset(found).to_dict()
    elif at:
        raise MistakeError((Option("at"), f": belongs to a scenario, which {name} is not"), "leave it out")
    elif show_parameters:
        result = {one: parameter.fields for one, parameter in load(name).parameters.items()}
        reporter.console.print(build_parameters_table(name))
    else:
        with tell_interruption():
            result = analyse(name, set_ or [], out, overwrite, reporter)
    if as_json:
        print_json(result)
