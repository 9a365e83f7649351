"""Friction and wear of a run's contacts over a cam revolution, from its output folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path

import numpy as np

from models.core.quantities import Vector

from ...errors import MistakeError
from ...plots.data import list_parameters
from ...run.output_folder import RESULT, SCENARIO
from ...run.report import Reporter
from ...scenario import Scenario, ScenarioError, parse_ends
from ...scenario.files import load
from ...store.result_file import open_result
from .cycle import OF_CAM, OF_CONTACT, last_revolution, wear
from .report import Judged, remarks, tables
from .table import write

# Endings of the files.
TABLES, FIGURES = (".csv", ".json", ".nc"), (".png", ".svg", ".pdf")


def friction(
    folder: Path,
    contact: str | None,
    coefficient: float,
    cycles: float,
    table: Path | None,
    figure: Path | None,
    reporter: Reporter,
) -> None:
    """Report friction and wear of the cams' contacts, or of one; write a table and a figure of each.

    MistakeError if there is no result, or none with a contact under a cam.
    """
    _checked(coefficient, cycles, table, figure)
    scenario = _scenario(folder)
    cams = cams_of(scenario)
    if contact and contact not in cams:
        raise MistakeError(
            f"--contact {contact}: must be one of {', '.join(cams) or 'none'}, which slide under a cam"
        )
    if not cams:
        raise MistakeError(f"{folder}: no contact takes its sliding_velocity from a camshaft")
    values = list_parameters(scenario)
    found = []
    for name in [contact] if contact else list(cams):
        cycle = last_revolution(name, *_read(folder, name, cams[name]))
        worn = wear(cycle, "asperity_load", coefficient, values[f"{name}.length"])
        found.append(Judged(cycle, worn, coefficient, cycles, values[f"{name}.roughness"]))
    for page in tables(found):
        reporter.console.print(page)
    for line in chain.from_iterable(map(remarks, found)):
        reporter.line(line)
    try:
        for each in found:
            own_table, own_figure = (contact_file(path, each, found) for path in (table, figure))
            _write(each, scenario.name, own_table, own_figure, reporter)
    except OSError as error:
        raise MistakeError(
            f"{error.filename}: cannot be written ({error.strerror}); choose another"
        ) from None


def contact_file(path: Path | None, one: Judged, all_of_them: Sequence[Judged]) -> Path | None:
    """The file's name, with the contact's where there are several."""
    several = path and len(all_of_them) > 1
    return path.with_stem(f"{path.stem}-{one.cycle.contact}") if path and several else path


def _write(found: Judged, title: str, table: Path | None, figure: Path | None, reporter: Reporter) -> None:
    if table:
        files = write(found.cycle, found.worn, found.coefficient, table)
        reporter.line(f"table in {', '.join(map(str, files))}")
    if figure:
        from ...plots.friction import drawn
        from ...plots.style import save_figure

        file = save_figure(lambda: drawn(found.cycle, found.worn, found.cycles, title), figure)
        reporter.line(f"figure in {file}")


def _checked(coefficient: float, cycles: float, table: Path | None, figure: Path | None) -> None:
    if not coefficient > 0.0:
        raise MistakeError(f"--wear-coefficient {coefficient:g} m2/N: must be > 0")
    if not cycles > 0.0:
        raise MistakeError(f"--cycles {cycles:g}: must be > 0")
    for option, path, endings in (("--table", table, TABLES), ("--figure", figure, FIGURES)):
        if path and path.suffix not in endings:
            raise MistakeError(f"{option} {path}: must end in {', '.join(endings)}")


def _scenario(folder: Path) -> Scenario:
    for name in (RESULT, SCENARIO):
        if not (folder / name).is_file():
            raise MistakeError(f"{folder}: there is no {name}; give the output folder of a finished run")
    try:
        return load(folder / SCENARIO)
    except ScenarioError as error:
        raise MistakeError(f"{error}; friction is judged with the scenario of the run") from None


def cams_of(scenario: Scenario) -> dict[str, str]:
    """The cam of each contact: what drives its sliding velocity and has an angle of its own."""
    found = {}
    for source, target in map(parse_ends, scenario.connections):
        cam, contact = source.split(".")[0], target.split(".")[0]
        if target.endswith(".sliding_velocity") and scenario.components[cam].component == "camshaft":
            found[contact] = cam
    return found


def _read(folder: Path, contact: str, cam: str) -> tuple[Vector, Mapping[str, Vector]]:
    wanted = [f"{contact}.{name}" for name in OF_CONTACT] + [f"{cam}.{name}" for name in OF_CAM]
    with open_result(folder) as result:
        group = result["coupled"].ds
        if missing := [name for name in wanted if name not in group]:
            raise MistakeError(f"{folder / RESULT}: has no {', '.join(missing)}; run the scenario again")
        columns = {name.split(".")[1]: np.asarray(group[name].values, float) for name in wanted}
        return np.asarray(group["time"].values, float), columns
