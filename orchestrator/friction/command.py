"""Friction and wear of a run's contacts over a cam revolution, from its output folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from models.quantities import Vector

from ..errors import MistakeError
from ..output_folder import RESULT, SCENARIO
from ..plots.data import parameters_of
from ..results import open_result
from ..scenario import Scenario, ScenarioError, ends
from ..scenario_files import load
from .cycle import OF_CAM, OF_CONTACT, Cycle, Wear, last_revolution, summary, wear
from .table import written


def friction(
    folder: Path,
    contact: str | None,
    coefficient: float,
    cycles: float,
    table: Path | None,
    figure: Path | None,
    say: Callable[[str], None],
) -> None:
    """Say friction and wear of the cams' contacts, or of one; write table and figure of the first of them.

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
    names = [contact] if contact else list(cams)
    lengths = parameters_of(scenario)
    first: tuple[Cycle, Wear] | None = None
    for name in names:
        cycle = last_revolution(name, *_read(folder, name, cams[name]))
        worn = wear(cycle, "asperity_load", coefficient, lengths[f"{name}.length"])
        for line in lines(cycle, worn, coefficient, cycles):
            say(line)
        first = first or (cycle, worn)
    assert first
    try:
        if table:
            say(f"table in {written(*first, coefficient, table)}")
        if figure:
            from ..plots.friction import drawn
            from ..plots.style import saved

            say(f"figure in {saved(lambda: drawn(*first, cycles, scenario.name), figure)}")
    except OSError as error:
        raise MistakeError(
            f"{error.filename}: cannot be written ({error.strerror}); choose another"
        ) from None


def _checked(coefficient: float, cycles: float, table: Path | None, figure: Path | None) -> None:
    if not coefficient > 0.0:
        raise MistakeError(f"--wear-coefficient {coefficient:g} m2/N: must be > 0")
    if not cycles > 0.0:
        raise MistakeError(f"--cycles {cycles:g}: must be > 0")
    for option, path, ending in (("--table", table, ".nc"), ("--figure", figure, ".png")):
        if path and path.suffix != ending:
            raise MistakeError(f"{option} {path}: must end in {ending}")


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
    for source, target in map(ends, scenario.connections):
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


def lines(cycle: Cycle, worn: Wear, coefficient: float, cycles: float) -> list[str]:
    """What the reader should know, in sentences."""
    s = summary(cycle)
    cam, follower = (float(depth.max()) for depth in (worn.cam_depth, worn.follower_depth))
    at = np.degrees(worn.cam_angle[worn.cam_depth.argmax()])
    place = worn.follower_place[worn.follower_depth.argmax()]
    return [
        f"{cycle.contact}: mean friction torque {s.mean_torque:.4g} N m (at most {s.largest_torque:.4g}), "
        f"power {s.mean_power:.4g} W, {s.work:.4g} J a revolution, coefficient of friction "
        f"{s.coefficient:.4g}",
        f"{cycle.contact}: asperities carry {100.0 * s.asperity_share:.3g} % of the load and make "
        f"{100.0 * s.boundary_share:.3g} % of the friction work; film over roughness at least "
        f"{s.least_film_ratio:.3g}",
        f"{cycle.contact}: wear a revolution at {coefficient:g} m2/N at most {cam:.3g} m on the cam (at "
        f"{at:.0f} deg), {follower:.3g} m on the follower (at {1e3 * place:.2f} mm); {worn.volume:.3g} m3 "
        "each",
        f"{cycle.contact}: after {cycles:g} revolutions alike, of surfaces that keep their profile and a "
        f"follower that does not turn, {1e6 * cycles * cam:.3g} and {1e6 * cycles * follower:.3g} um",
    ]
