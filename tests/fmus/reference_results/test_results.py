"""Reference results: two solvers and the component's own steps agree; files are as the rules have them."""

import dataclasses

import fmpy.util
import numpy as np
import pytest

from fmus.reference_results.files import Table, csv_text, read_csv, read_options
from fmus.reference_results.results import (
    LEAST,
    MARGIN,
    compute_results,
    largest,
    split_at_corners,
    step_component,
)
from fmus.stimuli import find_stimulus
from models.catalogue import CATALOGUE

from ..names import REFERENCED, mark_long

# What the files are written with (5e-10), and what two solvers of 1e-12 a step leave (3e-9 in the
# slider-crank, more in loads of stiff contacts; by other compilers and libraries perhaps twice that), over an
# output's largest value.
SAME = 1e-8


def written_inputs(name: str) -> Table:
    return read_csv(csv_text(*find_stimulus(name).table()), "in")


def apart(found: Table, wanted: Table) -> dict[str, float]:
    """By variable, over its largest value."""
    assert found.times.tolist() == wanted.times.tolist()
    assert list(found.columns) == list(wanted.columns)
    columns = wanted.columns.items()
    return {o: float(np.max(np.abs(found.columns[o] - values))) / largest(values) for o, values in columns}


@pytest.mark.parametrize("name", mark_long(REFERENCED, ["valve_spring", "flywheel", "piston_clearance"]))
def test_two_solvers_and_the_component_s_steps_agree(name, tmp_path, record):
    """Within the stated tolerance, which is not wider than the rule says; other tools read the files."""
    now, own = compute_results(name), find_stimulus(name)
    for file, text in now.files.items():
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_text(text)
    table = fmpy.util.read_csv(tmp_path / f"{name}_ref.csv")
    assert table.dtype.names == ("time", *own.outputs)
    assert (table["time"][0], table["time"][-1]) == (0.0, own.stop_time)
    for column in own.outputs:
        assert np.ptp(table[column]) > 0.0 or column in ("cam_speed", "speed"), f"{column} tells nothing"
    read = fmpy.util.read_ref_opt_file(str(tmp_path / f"{name}_ref.opt"))
    assert (read["StepSize"], read["StopTime"]) == (own.step_size, own.stop_time)
    stated = read_options(now.files[f"{name}_ref.opt"], "opt").tolerance
    for quantity, values in (
        ("difference of two solvers in the reference results", now.uncertainty.values()),
        ("deviation of the component's own steps", now.stepped.values()),
    ):
        record("FMUs", f"{quantity}, relative", max(values), 0.0, "CVODE and DOP853", tolerance=stated)
    measured = max(*now.stepped.values(), *now.uncertainty.values())
    assert measured < stated
    assert stated <= 10.0 * MARGIN * max(measured, LEAST)  # nor is it stated wider than the rule says


@pytest.mark.parametrize(
    ("name", "parameter"),
    [
        ("valve_spring", "valve_mass"),
        *(
            pytest.param(*case, marks=pytest.mark.long)
            for case in (("slider_crank", "restitution"), ("ehl_contact", "viscosity"))
        ),
    ],
)
def test_a_drift_of_a_millionth_in_the_physics_is_seen(name, parameter):
    component, own = CATALOGUE[name](), find_stimulus(name)
    instants = np.array(own.instants())
    pieces = split_at_corners(component, written_inputs(name))
    start = component.parameters.start
    start[component.parameters.index(parameter)] *= 1.0 + 1e-6
    rows = step_component(component, pieces, instants, own.step_size)
    columns = {o: rows[:, component.outputs.index(o)] for o in own.outputs}
    wanted = read_csv(compute_results(name).files[f"{name}_ref.csv"], "ref")
    assert max(apart(Table(instants, columns), wanted).values()) > SAME


def moved(name: str, state: str, error: float, output: str) -> np.ndarray:
    """How far the output is off along the stimulus, at its steps, when the state starts off by that much."""
    own, runs = find_stimulus(name), []
    for beside in (0.0, error):
        component = CATALOGUE[name]()
        component.state.start[component.state.index(state)] += beside
        pieces = split_at_corners(component, written_inputs(name))
        rows = step_component(component, pieces, np.array(own.instants()), own.step_size)
        runs.append(rows[:, component.outputs.index(output)])
    return np.abs(runs[1] - runs[0])


def test_the_slider_cranks_horizon():
    """As its README says: until the end a small error of the start grows less than a thousandfold."""
    assert 10.0 < np.max(moved("slider_crank", "psi", 1e-8, "psi")) / 1e-8 < 1000.0


def test_the_piston_cranks_forget_a_small_error():
    """As the README of `piston_crank` says: sequences of impacts end in sliding, and leave nothing of it."""
    off = moved("piston_crank", "offset", 1e-9, "piston_offset")
    assert off[-1] < 1e-15 < np.max(off)


@pytest.mark.parametrize("name", REFERENCED)
def test_steps_meet_corners_and_results(name):
    own, component = find_stimulus(name), CATALOGUE[name]()
    steps = np.asarray(own.corners) / own.step_size
    np.testing.assert_allclose(steps, np.rint(steps), atol=1e-9)
    wide = own.interval / own.step_size
    assert abs(wide - round(wide)) < 1e-9
    known = {f"{f.add_suffix(s)}" for f in component.inputs.fields for s in ("", "_der1")}
    assert set(written_inputs(name).columns) <= known


def test_inputs_are_read_back_as_the_broken_lines_that_they_are():
    """Values on both sides of every corner, slopes between; a jump has one row before and one after."""
    component = CATALOGUE["sprung_mass"]()
    stimulus = dataclasses.replace(
        find_stimulus("sprung_mass"), corners=[0.0, 1.0, 1.0, 3.0], inputs={"force": [0.0, 2.0, 5.0, 4.0]}
    )
    text = csv_text(*stimulus.table())
    assert text.splitlines()[1:] == ["0,0,2", "1,2,2", "1,5,-0.5", "3,4,-0.5"]
    pieces = split_at_corners(component, read_csv(text, "in"))
    assert [(p.start, p.u[0], p.du[0]) for p in pieces] == [(0.0, 0.0, 2.0), (1.0, 5.0, -0.5)]
    assert 1.0 not in stimulus.instants()
