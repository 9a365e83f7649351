"""tribocosim ssp."""

from pathlib import Path
from typing import Annotated

import typer

from ..messages import show
from .completion import complete_scenario
from .error_report import report_errors
from .options import Settings, folder_option


@report_errors
def ssp_export(
    scenario: Annotated[
        str,
        typer.Argument(
            help="A shipped scenario, the path of a .toml file, or a run's folder.",
            autocompletion=complete_scenario,
        ),
    ],
    out: Annotated[Path | None, typer.Option(help="Output file.", show_default="SCENARIO.ssp")] = None,
    set_: Settings = None,
    version: Annotated[
        str, typer.Option(help="Of SSP: 1.0, or 2.0 for arrays and types of FMI 3.0.")
    ] = "1.0",
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an existing file.")] = False,
) -> None:
    """Write a scenario as an SSP package with its FMUs, for other tools.

    Of a run's folder also, beside the package, its verdict, versions and checksums in a .srmd file, and its
    steps with their files in a .stmd file.
    """
    from orchestrator.errors import REPLACE, MistakeError, Option, another, one_of
    from orchestrator.scenario.files import load
    from orchestrator.scenario.ssp import VERSIONS, export
    from orchestrator.scenario.ssp.task import TASK_SUFFIX, write_task
    from orchestrator.scenario.ssp.traceability import SUFFIX, describe_run, write_metadata
    from orchestrator.store import atomic_write
    from orchestrator.store.output_folder import SCENARIO, is_run, writing

    from ..cached_fmus import build_fmu

    if version not in VERSIONS:
        raise MistakeError((Option("version", version), f": {one_of(VERSIONS)}"))
    run = Path(scenario) if is_run(Path(scenario)) else None
    if run and set_:
        alone = f"leave it out, or give {run / SCENARIO} for a package without the run's metadata"
        raise MistakeError((Option("set"), f": the run in {run} was of the scenario as it is"), alone)
    loaded = load(run / SCENARIO if run else scenario, set_ or [])
    target = out or Path(f"{loaded.name}.ssp")
    if target.suffix != ".ssp":
        remedy = "give ", Option("out", f"{target}.ssp")
        raise MistakeError(f"{target}: the file of a package ends in .ssp", remedy)
    written = [target, *(target.with_suffix(one) for one in (SUFFIX, TASK_SUFFIX) if run)]
    for path in written:
        if path.exists() and not overwrite:
            raise MistakeError(f"{path}: is already there", another(), REPLACE)
    described = describe_run(run) if run else None
    with writing(target):
        export(loaded, target, build_fmu, version)
        if run:
            atomic_write.write_whole(written[1], write_metadata(described, run, target))
            atomic_write.write_whole(written[2], write_task(described, run, target))
    show("\n".join(map(str, written)))


@report_errors
def ssp_import(
    file: Annotated[Path, typer.Argument(help="The .ssp file.")],
    out: Annotated[Path | None, folder_option("the file's name")] = None,
) -> None:
    """Convert an SSP package into an editable scenario file with its FMUs. `run` also accepts packages."""
    from orchestrator.errors import MistakeError, another
    from orchestrator.scenario import build_scenario
    from orchestrator.scenario.files import find, load, to_short_toml
    from orchestrator.scenario.ssp import unpack_package
    from orchestrator.store.output_folder import refuse_unwritable

    source = find(file)
    if source.suffix != ".ssp":
        raise MistakeError(f"{source}: is no package; give an .ssp file (scenario files are run as they are)")
    load(source)  # writes nothing if the package is refused
    folder = out or Path(file.stem)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise MistakeError(f"{folder}: is not an empty folder", another())
    empty = folder.is_dir()
    try:
        scenario = build_scenario(unpack_package(source, folder))
        target = folder / f"{scenario.name}.toml"
        target.write_text(to_short_toml(scenario, folder), "utf-8")
    except OSError as error:
        _clear_folder(folder, empty)  # half a package is useless
        raise refuse_unwritable(folder, error) from None
    show(target)


def _clear_folder(folder: Path, kept: bool) -> None:
    """Delete the folder's content, and the folder unless it is `kept`."""
    import shutil

    for path in folder.iterdir() if kept else [folder]:
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)
