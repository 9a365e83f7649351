"""Two runs of a valve train in one figure."""

from dataclasses import replace
from pathlib import Path

import xarray

from ..errors import Command, MistakeError, Option
from ..plots import valve_train
from ..plots.data import POINTS, FigureData
from ..plots.style import save_figure
from ..reporter import Reporter
from ..scenario.files import load
from ..scenario.system import build_system
from ..store.output_folder import RESULT, SCENARIO


def is_run(folder: Path) -> bool:
    return (folder / RESULT).is_file()


def overlay(first: Path, second: Path, out: Path, reporter: Reporter) -> Path:
    """Draw the design-review figure of the first run with the second one beneath it; MistakeError where the
    second has no such train."""
    one, other = map(read_run, (first, second))
    if not valve_train.applies(one):
        raise MistakeError(f"{first}: has no valve train with all its outputs recorded")
    parts = {part for train in one.trains for part in train.parts}
    wanted = [name for name in one.coupled if name.split(".")[0] in parts]
    if missing := [name for name in wanted if name not in other.coupled]:
        raise MistakeError(f"{second}: has no {missing[0]}, which {first} has; compare runs of one train")
    same = first.name == second.name
    names = (f"{first.name} (1)", f"{second.name} (2)") if same else (first.name, second.name)
    both = replace(
        one, title=" and ".join(names), names=names, reference=other.coupled, reference_time=other.time
    )
    path = save_figure(lambda: valve_train.draw(both), out)
    reporter.line(f"figure: {path}")
    return path


def read_run(folder: Path) -> FigureData:
    """The coupled run of a result, thinned; MistakeError if the folder has none."""
    if not is_run(folder):
        remedy = Command("run", (...,), (Option("out", folder),))
        raise MistakeError(f"{folder}: holds no finished run", ("make one with ", remedy))
    scenario = load(str(folder / SCENARIO))
    system = build_system(scenario)
    with xarray.open_dataset(folder / RESULT, group="coupled", engine="h5netcdf") as data:
        thinned = data.isel(time=slice(None, None, -(-data.sizes["time"] // POINTS) or 1)).load()
    quantities = {
        f"{name}.{field.name}": field.quantity
        for name, instance in system.instances.items()
        for field in instance.component.outputs.fields
    }
    return FigureData(
        title=scenario.name,
        time=thinned["time"].values,
        coupled={str(n): values.values for n, values in thinned.data_vars.items() if n in quantities},
        reference_time=thinned["time"].values[:0],
        reference={},
        quantities=quantities,
        drivers={str(c.target): str(c.source) for c in system.connections},
        parameters=dict(zip(system.parameters.names, system.p.tolist(), strict=True)),
        system=system,
    ).over(scenario.figures_over)
