"""A run whose cam does not lift lacks figures of merit; page, figures and tables are there without them."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from models.core import roles
from orchestrator.assessment.contacts import summarise_rows, with_angles
from orchestrator.assessment.merits import describe, list_merits, write_merits
from orchestrator.assessment.trains import find_trains, list_parts
from orchestrator.report import draw_pictures
from orchestrator.run.summary import Summary
from orchestrator.scenario.files import load, to_full_toml
from orchestrator.scenario.system import build_system, list_outputs
from orchestrator.store.output_folder import MERITS, SCENARIO, SUMMARY
from orchestrator.store.result_file import ResultFile

TIMES = np.array([0.0, 0.5e-3, 1e-3])


@pytest.mark.parametrize(
    ("name", "loaded"),
    [("finger-follower", 5.0), ("pushrod-train", 0.0), ("direct-acting-hla", 5.0), ("coil-clash", 0.0)],
)
def test_a_run_on_the_base_circle_has_its_page_and_figures(name: str, loaded: float, tmp_path: Path) -> None:
    """Contacts carry next to no load, or none, and nothing else moves."""
    scenario = load(name)
    system = build_system(scenario)
    quantities = list_outputs(scenario)
    given = {f"{part}.load": loaded for part in list_parts(system, roles.Contact)}
    given |= {f"{train.cam}.cam_lift": 0.0 for train in find_trains(system)}
    rows = np.tile([given.get(variable, 1e-3) for variable in quantities], (TIMES.size, 1))
    (tmp_path / SCENARIO).write_text(to_full_toml(scenario), "utf-8")
    with ResultFile(tmp_path / "result.nc", {"scenario": name}) as made:
        made.write("coupled", TIMES, quantities, rows)
        contacts = with_angles(system, summarise_rows(system, made.column), made.column)
        merits = list_merits(system, contacts, made.column)
        told = describe(system, merits, made.column)
        write_merits(system, merits, [], made.column, tmp_path / MERITS)
        made.finish(True, "")
    summary = Summary(name, "", "", {}, 1e-5, True, {}, complete=True, contacts=contacts, merits=told)
    summary.write(tmp_path / SUMMARY)
    assert draw_pictures(tmp_path) == []
    said = " ".join(map(str, summary.tell()))
    assert not any(word in said for word in ("nan", "inf ", "None")), said
    known = json.loads((tmp_path / SUMMARY).read_text())["contacts"]
    assert (loaded > 0.0) == bool(known)
    assert all(math.isfinite(merit.value) for merit in merits)
