"""Reference results of a component along its stimulus, and how far its own steps are from them."""

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from models.catalogue import CATALOGUE
from models.core.component import Component
from models.core.quantities import Vector
from models.monolithic.driven import Driven, Piece, solve_driven

from ..stimuli import find_stimulus
from .files import Options, Table, csv_text, read_csv
from .stimulus import Stimulus, slope_name

# Of both solvers together; an integrator's own is a hundredth of it.
TOLERANCE = 1e-10
# Digits of results: half a unit of the last is 5e-10 of a value at most.
DIGITS = 10
# Other mathematical libraries, compilers and hosts may differ so many times more than was measured here.
MARGIN = 10.0
# No smaller tolerance is stated: twenty roundings of the file.
LEAST = 1e-8


@dataclass(frozen=True)
class Results:
    """The files of a reference by name, and by output what was measured, over the output's largest value.

    `uncertainty`: difference of the two solvers. `stepped`: difference of the component's own steps from the
    results as they stand in the file.
    """

    files: Mapping[str, str]
    uncertainty: Mapping[str, float]
    stepped: Mapping[str, float]
    tolerance: float


@cache
def compute_results(name: str) -> Results:
    """The reference results of the FMU `name`, which has a stimulus, with the component's own sizes."""
    component, stimulus = CATALOGUE[name](), find_stimulus(name)
    assert stimulus
    inputs = csv_text(*stimulus.table())
    pieces = split_at_corners(component, read_csv(inputs, f"{name}_in.csv"))
    instants = np.array(stimulus.instants())
    solved = solve_driven(component, pieces, instants, TOLERANCE)
    columns = [component.outputs.index(output) for output in stimulus.outputs]
    rows = np.column_stack([instants, solved.outputs[:, columns]])
    written = csv_text(["time", *stimulus.outputs], rows.tolist(), DIGITS)
    values = read_csv(written, f"{name}_ref.csv").columns
    steps = step_component(component, pieces, instants, stimulus.step_size)
    size = {output: largest(values[output]) for output in stimulus.outputs}
    by_output = list(zip(stimulus.outputs, columns, strict=True))
    uncertainty = {o: float(np.max(solved.difference[:, i])) / size[o] for o, i in by_output}
    apart = {o: float(np.max(np.abs(steps[:, i] - values[o]))) / size[o] for o, i in by_output}
    tolerance = round_tolerance(max(*apart.values(), *uncertainty.values()))
    return Results(
        files={
            f"{name}_in.csv": inputs,
            f"{name}_ref.csv": written,
            f"{name}_ref.opt": Options(
                0.0, stimulus.stop_time, stimulus.step_size, tolerance, stimulus.interval
            ).text(),
            "README.md": _readme(name, stimulus, solved, uncertainty, apart, tolerance),
        },
        uncertainty=uncertainty,
        stepped=apart,
        tolerance=tolerance,
    )


def round_tolerance(measured: float) -> float:
    """The tolerance for a difference: the next power of ten above ten times as much, at least 1e-8."""
    return float(f"1e{math.ceil(math.log10(max(MARGIN * measured, LEAST)))}")


def largest(values: Vector) -> float:
    """The measure of an output's differences: its largest value along the stimulus, 1 if it is zero."""
    return float(np.max(np.abs(values))) or 1.0


def split_at_corners(component: Component, inputs: Table) -> list[Piece]:
    """The inputs from one corner to the next, as their file says."""
    pieces = []
    for i in np.flatnonzero(np.diff(inputs.times) > 0.0):
        u, du = component.inputs.start.copy(), np.zeros(component.inputs.size)
        for name, column in inputs.columns.items():
            if name in component.inputs:
                place = component.inputs.index(name)
                u[place] = column[i]
                if slope_name(name) in inputs.columns:
                    du[place] = inputs.columns[slope_name(name)][i]
        pieces.append(Piece(float(inputs.times[i]), u, du))
    return pieces


def step_component(component: Component, pieces: Sequence[Piece], instants: Vector, h: float) -> Vector:
    """Outputs at `instants`, rows, of the component moved by its own steps of h (s), as an FMU is.

    ValueError if a step fails.
    """
    x, p = component.state.start.copy(), component.parameters.start
    U, u, y = component.input_polynomial(), pieces[0].u.copy(), np.zeros(component.outputs.size)
    work = np.zeros(component.work_size)
    component.flat_output(pieces[0].start, x, u, p, y)
    wanted = np.rint(instants / h).astype(int)
    begins = np.rint(np.array([piece.start for piece in pieces]) / h).astype(int)
    rows = np.empty((instants.size, y.size))
    for k in range(int(wanted[-1]) + 1):
        rows[wanted == k] = y
        piece = pieces[int(np.searchsorted(begins, k, side="right")) - 1]
        U[0], U[1] = piece.u + piece.du * (k * h - piece.start), piece.du
        if component.step(k * h, h, x, U, p, component.state.nominal, work, u, y):
            raise ValueError(f"{component.name}: the step at t = {k * h:g} s failed")
    return rows


def _readme(
    name: str,
    stimulus: Stimulus,
    solved: Driven,
    uncertainty: Mapping[str, float],
    apart: Mapping[str, float],
    tolerance: float,
) -> str:
    first, second = solved.method_names
    events = f"On the way are {len(solved.events)} impacts and releases." if solved.events else ""
    paragraphs = [
        stimulus.says,
        "Parameters and start values are the FMU's own, the start time is 0.",
        f"""**Inputs** (`{name}_in.csv`) are straight lines between corners; those without a column keep
        their start values. Columns `<input>_der1` are slopes, which are inputs of the FMU, too. A host of
        co-simulation that sets all columns at the beginning of each step, at a corner from its last row, has
        the inputs exactly, without interpolating within the step.""",
        f"""**Results** (`{name}_ref.csv`, {DIGITS} digits) were not computed by the FMU. The component's
        equations were solved with these inputs by two methods that locate events, begun afresh at every
        corner. The results are those of {first}. The table has how far two others are from them, over the
        largest value of each output: the second method, {second}; and the component, moved by its own steps
        of {stimulus.step_size:g} s as the FMU is. {events}""",
        f"""**Tolerance**: co-simulation in steps of {stimulus.step_size:g} s agrees within {tolerance:.0e} of
        an output's largest value (`RelTol` in `{name}_ref.opt`): the next power of ten above {MARGIN:g} times
        what the table has, at least {LEAST:.0e}.""",
        "`tribocosim fmu compare FILE` runs the FMU and compares.",
    ]
    filled = [textwrap.fill(" ".join(paragraph.split()), 116) for paragraph in paragraphs]
    rows = "\n".join(f"| {o} | {uncertainty[o]:.0e} | {apart[o]:.0e} |" for o in stimulus.outputs)
    table = f"| Output | second method | component's steps |\n|---|---|---|\n{rows}"
    return "\n\n".join([f"# Reference results of {name}", *filled[:4], table, *filled[4:]]) + "\n"
