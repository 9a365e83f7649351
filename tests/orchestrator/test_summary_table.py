"""The table of the figures of merit of a run."""

import csv
from collections import defaultdict

import numpy as np
import pytest

from models.core.quantities import Vector
from orchestrator.assessment.merits import HEAD, list_merits, write_merits
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system


def test_each_number_has_its_unit_angle_time_and_speed(tmp_path):
    """A turn of 60 ms in ten parts, 1000 r/min: row 3 is at 108 deg and 18 ms."""
    columns: dict[str, Vector] = defaultdict(lambda: np.zeros(11))
    columns["time"] = np.linspace(0.0, 0.06, 11)
    columns["flywheel.angle"] = columns["camshaft.cam_angle"] = np.linspace(0.0, 2.0 * np.pi, 11)
    columns["valve_spring.spring_force"] = np.where(np.arange(11) == 3, 500.0, 300.0)
    columns["valve_spring.valve_lift"] = np.where(np.arange(11) == 5, 8e-3, 0.0)

    system, read = build_system(load("valve-train")), columns.__getitem__
    write_merits(system, list_merits(system, {}, read), read, tmp_path / "summary.csv")
    text = (tmp_path / "summary.csv").read_bytes()
    assert text.startswith(b"\xef\xbb\xbf")  # by which a spreadsheet knows UTF-8
    head, *rows = csv.reader(text.decode("utf-8-sig").splitlines())
    assert tuple(head) == HEAD
    found = {(row[0], row[1]): row[2:] for row in rows}
    force = found["valve_spring", "largest spring force"]
    assert force == ["500", "N", "108.00", "cam", "18", "1000"]
    lift = found["valve_spring", "largest lift"]
    assert (float(lift[0]), lift[1]) == (pytest.approx(8.0), "mm")
