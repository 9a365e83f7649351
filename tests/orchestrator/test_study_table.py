"""What a study writes beside its store: a table of its points, and a figure of one or two axes."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

from orchestrator.errors import MistakeError
from orchestrator.study.figure import draw_figure
from orchestrator.study.table import write_table
from orchestrator.study.task import Outcome

from .studies import PICKY, PLAIN, fill_store, open_small_chunks, plan_scenario, plan_study

SPEED = {"speed": ["components.flywheel.parameters.initial_speed"]}


def rows(store: Path) -> list[dict[str, str]]:
    """The table of a store."""
    path = store.with_suffix(".csv")
    with xarray.open_zarr(store) as found:
        write_table(found, path)
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_table_has_a_line_for_each_point_with_units_and_exact_numbers(tmp_path: Path) -> None:
    axes = {"y": [0.1, 0.2], "x": [1.0 / 3.0, -1.0, 2.0]}
    found = rows(fill_store(tmp_path / "s.zarr", plan_study({"kind": "grid", "axes": axes}, PICKY)))
    assert [(float(row["y"]), float(row["x [m]"])) for row in found] == [
        (y, x) for y in axes["y"] for x in axes["x"]
    ]
    for row in found:
        if float(row["x [m]"]) < 0.0:
            assert (row["status"], row["sum [m]"]) == ("failed", "")
            assert "no root" in row["message"]
        else:
            assert row["status"] == "done"
            assert float(row["sum [m]"]) == float(row["x [m]"]) + float(row["y"])


def test_the_table_of_single_points_has_their_parameters(tmp_path: Path) -> None:
    points = [{"x": 1.0, "mode": "plain"}, {"x": 3.0, "mode": "square"}]
    found = rows(fill_store(tmp_path / "s.zarr", plan_study({"kind": "list", "rows": points})))
    assert [(row["x [m]"], row["mode"], row["sum [m]"]) for row in found] == [
        ("1.0", "plain", "2.0"),
        ("3.0", "square", "16.0"),
    ]


def draw(folder: Path, axes: dict[str, Any], analysis: str = PLAIN) -> Any:
    """The first panel of the figure of a grid."""
    store = fill_store(folder / "s.zarr", plan_study({"kind": "grid", "axes": axes}, analysis))
    with xarray.open_zarr(store) as found:
        return draw_figure(found.load(), ["sum"]).axes[0]


def test_one_axis_is_a_curve(tmp_path: Path) -> None:
    axes = draw(tmp_path, {"x": [1.0, 2.0, 4.0]})
    (line,) = axes.lines
    assert np.array_equal(line.get_xydata(), [(1.0, 2.0), (2.0, 3.0), (4.0, 5.0)])
    assert axes.get_xlabel() == "abscissa (m)"


def test_an_axis_of_few_values_or_of_names_gives_curves(tmp_path: Path) -> None:
    axes = draw(tmp_path, {"mode": ["plain", "square"], "x": [1.0, 2.0, 3.0]})
    assert [line.get_label() for line in axes.lines] == ["plain", "square"]
    assert np.array_equal(axes.lines[1].get_ydata(), [4.0, 9.0, 16.0])


def test_two_long_axes_are_a_map_with_gaps_where_points_failed(tmp_path: Path) -> None:
    ys = [float(k) for k in range(1, 8)]
    (mesh,) = draw(tmp_path, {"x": [float(k) for k in range(-1, 7)], "y": ys}, PICKY).collections
    values = mesh.get_array().reshape(7, 8)
    assert values.mask[:, 0].all()
    assert not values.mask[:, 1:].any()
    assert np.array_equal(values[:, 1], ys)


def test_a_result_that_cannot_be_drawn_is_refused() -> None:
    for name in ("sun", "sign"):
        with pytest.raises(MistakeError, match=f"figure: .*'{name}'"):
            plan_study({"kind": "grid", "axes": {"x": [1.0, 2.0]}}, figure=[name])


@pytest.mark.parametrize(("stop", "doubted"), [(1400.0, True), ("14000 rpm", False)])
def test_numbers_without_a_unit_are_doubted_in_studies_too(stop: float | str, doubted: bool) -> None:
    axis = {"start": 60.0 if doubted else "600 rpm", "stop": stop, "count": 2}
    plan = plan_scenario({"kind": "grid", "axes": {"speed": axis}}, names=SPEED)
    said = plan.subject.list_warnings(plan.points[1])
    assert ["did you mean 1400 rpm?" in line for line in said] == [True] * doubted


def test_a_point_that_failed_keeps_its_message(tmp_path: Path) -> None:
    plan = plan_study({"kind": "grid", "axes": {"x": [1.0]}})
    with open_small_chunks(tmp_path / "s.zarr", plan) as store:
        store.record(0, Outcome({}, 'a "message", with a comma'))
        store.flush()
    assert rows(tmp_path / "s.zarr")[0]["message"] == 'a "message", with a comma'
