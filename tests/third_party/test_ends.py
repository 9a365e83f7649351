"""A third-party FMU that asks to end the simulation: records go to the time that it reached."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from .c_fmus import fmu
from .runs import CASES, ran, scenario

# A rounding for each of at most a few hundred steps, of product and exponential.
ROUNDING = 1000 * 2.0**-52
MASTERS: dict[str, dict[str, Any]] = {
    "jacobi": {"master": {"name": "jacobi"}},
    "gauss_seidel": {"master": {"name": "gauss_seidel"}},
    "iterated": {"master": {"name": "iterated"}},
    "control": {
        "master": {"name": "jacobi"},
        "step_control": {"estimator": "step_doubling", "minimum_step": 1e-9, "relative": 1e-2},
    },
    "located": {"master": {"name": "jacobi"}, "event_tolerance": 1e-7},
}
SUBDIVIDING = ("control", "located")


def landed(
    until: float, version: int, process: str, out: Path, beside: bool = True, **changes: Any
) -> dict[str, np.ndarray]:
    """The records of a run in which an FMU asks for the end at the time `until`; alone or among others."""

    def table(name: str) -> dict[str, Any]:
        return {"participant": fmu(name, version, out.parent), "process": process}

    tables = {"landing": table("landing") | {"parameters": {"until": until}}}
    if beside:
        tables = {"before": table("dahlquist"), **tables, "after": table("vanderpol")}
        changes["connections"] = ["landing.x * 1 -> after.force"]
    summary, found = ran(scenario(tables, **changes), out)
    assert summary.exit_status == 3
    assert not summary.complete
    said = f"landing: the FMU asks to end the simulation at t = {until} s: has landed; set stop_time to that"
    assert said in summary.message
    np.testing.assert_allclose(found["landing.x"], np.exp(-found["time"]), rtol=ROUNDING)
    return found


@pytest.mark.parametrize(("version", "process"), CASES)
@pytest.mark.parametrize("until", [0.5, 0.505])
def test_one_alone_is_recorded_to_its_end(until, version, process, tmp_path):
    """At a communication point and between two."""
    found = landed(until, version, process, tmp_path / "out", beside=False, master={"name": "jacobi"})
    assert found["time"][-1] == pytest.approx(until, rel=1e-12)
    assert len(found["time"]) == 51 + (until > 0.5)


@pytest.mark.parametrize(
    ("master", "version", "process"),
    [(master, 2, "shared") for master in MASTERS if master != "jacobi"] + [("jacobi", 3, "own")],
)
def test_all_are_recorded_to_the_end_of_its_step(master, version, process, tmp_path):
    """As far as they come in a run that stops there."""
    found = landed(0.51, version, process, tmp_path / "out", **MASTERS[master])
    tables = {
        name: {"participant": fmu(kind, version, tmp_path), "process": process}
        for name, kind in (("before", "dahlquist"), ("landing", "dahlquist"), ("after", "vanderpol"))
    }
    lines = ["landing.x * 1 -> after.force"]
    whole, expected = ran(
        scenario(tables, connections=lines, **MASTERS[master] | {"stop_time": 0.51}), tmp_path / "whole"
    )
    assert whole.complete
    assert found["time"][-1] == pytest.approx(0.51, rel=1e-12)
    if master == "control":  # what is due at the stop time shortens steps before it
        np.testing.assert_allclose(found["after.x"][-1], expected["after.x"][-1], rtol=1e-2)
        return
    assert list(found) == list(expected)
    for name in found:
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-12, err_msg=name)


@pytest.mark.parametrize(
    ("master", "version", "process"),
    [(master, 3, "shared") for master in MASTERS if master != "control"] + [("control", 2, "own")],
)
def test_between_two_points_the_others_follow_where_steps_are_gone_back(master, version, process, tmp_path):
    """Else the records end at the last communication point: the others have made the whole step."""
    found = landed(0.505, version, process, tmp_path / "out", **MASTERS[master])
    last = 0.505 if master in SUBDIVIDING else 0.5
    assert found["time"][-1] == pytest.approx(last, rel=1e-12)
    np.testing.assert_allclose(found["before.x"], np.exp(-found["time"]), rtol=ROUNDING)
