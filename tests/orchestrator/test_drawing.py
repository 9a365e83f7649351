"""Drawings of shafts in scenarios."""

import math
from pathlib import Path

import pytest

from models.core.evaluation import Evaluation
from models.valve_train.beam import Disc, Shaft, find_torsion
from orchestrator.scenario import ScenarioError, build_scenario
from orchestrator.scenario.files import list_shipped, load, override, read_contents
from orchestrator.scenario.system import build_system, resolve_start

GOOD = (
    'length = "100 mm"\ndiameter = "20 mm"\ncams = [{ place = "40 mm" }, { place = 0.08, inertia = 2e-4 }]\n'
)


def write(folder: Path, drawing: str) -> Path:
    file = folder / "shaft.toml"
    file.write_text(
        'stop_time = "1 ms"\nmacro_step = "10 us"\nconnections = []\n'
        '[tolerance]\n"turning.twist[1]" = 1e-3\n'
        f'[components.turning]\ncomponent = "shaft"\n[components.turning.drawing]\n{drawing}'
    )
    return file


def test_a_drawing_becomes_modes(tmp_path: Path) -> None:
    table = load(write(tmp_path, GOOD)).components["turning"]
    assert table.drawing is None
    modes = find_torsion(
        Shaft(0.1, 0.02, [Disc(0.04, 0.1, 1.2e-4, 0.7e-4), Disc(0.08, 0.1, 2e-4, 0.7e-4)]), 3
    )
    assert table.structure == {"cams": 2, "torsion_modes": modes.frequency.size, "bending_modes": 1}
    frequency = float(table.parameters["torsion_frequency[1]"])
    assert frequency == pytest.approx(modes.frequency[0] / (2.0 * math.pi), rel=1e-12)
    assert float(table.parameters["torsion_damping[1]"]) == 0.02
    assert float(table.parameters["bending_shape[1]"]) == 0.0


def test_bearings_let_it_bend(tmp_path: Path) -> None:
    table = load(write(tmp_path, GOOD + 'bearings = [0.0, "100 mm"]\n')).components["turning"]
    assert table.structure["bending_modes"] > 1
    assert max(abs(float(v)) for n, v in table.parameters.items() if n.startswith("bending_shape")) == 1.0


def test_journals_have_the_numbers_after_the_cams(tmp_path: Path) -> None:
    table = load(write(tmp_path, GOOD + 'journals = [0.0, "100 mm"]\n')).components["turning"]
    assert table.structure["cams"] == 4
    assert [float(table.parameters[f"bending_frequency[{j}]"]) for j in (1, 2)] == [0.0, 0.0]
    assert float(table.parameters["bending_frequency[3]"]) > 0.0


@pytest.mark.parametrize(
    ("drawing", "message"),
    [
        ("", r"drawing.length: missing"),
        (GOOD.replace('"20 mm"', '"20 N"'), r"drawing.diameter: .*'20 N'"),
        (GOOD.replace('"20 mm"', "-0.02"), r"drawing.diameter = -0.02: must be > 0"),
        (GOOD.replace('"40 mm"', '"140 mm"'), r"drawing.cams\[1\].place = 0.14 m: must be <= length"),
        (GOOD + "bearings = [0.05]\n", r"drawing.bearings: 1 bearings and journals: .* at least two"),
        (GOOD + "journals = [0.05]\n", r"drawing.bearings: 1 bearings and journals: .* at least two"),
        (GOOD + "journals = [0.0, 0.2]\n", r"drawing.journals\[2\] = 0.2 m: must be <= length"),
        (GOOD + 'bore = "30 mm"\n', r"drawing.bore = 0.03 m: must be < diameter"),
        (GOOD + "colour = 3\n", r"drawing.colour"),
    ],
)
def test_mistakes_in_a_drawing_are_named(tmp_path: Path, drawing: str, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        load(write(tmp_path, drawing))


@pytest.mark.long
@pytest.mark.parametrize(("speed", "preload"), [(1000, 330), (10, 330), (20, 3000)])
def test_a_slow_shaft_finds_its_rest_in_its_bearings(speed: int, preload: int) -> None:
    """The journals sink until film or asperities carry the cam's load, which Newton's method overshoots."""
    content = read_contents(list_shipped()["shaft-in-bearings"])
    values = f"flywheel.parameters.initial_speed={speed} rpm", f"spring.parameters.preload={preload}"
    override(content, [f"components.{value}" for value in values])
    scenario = build_scenario(content)
    system = resolve_start(scenario, build_system(scenario))
    evaluation = Evaluation(system)
    outputs = dict(zip(system.outputs.names, evaluation.outputs(0.0, system.x0).tolist(), strict=True))
    rates = dict(zip(system.state.names, evaluation.derivative(0.0, system.x0).tolist(), strict=True))
    carried = sum(outputs[f"bearing_{i}.force_y"] for i in (1, 2))
    assert carried == pytest.approx(outputs["contact.load"], rel=1e-9)
    assert max(abs(rates[f"bearing_{i}.eccentricity_{end}"]) for i in (1, 2) for end in "xy") < 1e-12
