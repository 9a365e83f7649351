"""An output's own name wins over the grammar of connections, in which it may read as a number."""

from pathlib import Path

import pytest

from orchestrator.scenario import Line, ScenarioError
from orchestrator.scenario.connection import parse_line

from .described import describe2, real2
from .runs import scenario

NAMES = ("Sensor", "Sensor - 1", "Sensor * 2", "a -&gt; b", "plain")
READ = {
    "s.Sensor - 1 -> e.u": Line("s.Sensor - 1", "e.u"),
    "s.Sensor - 2 -> e.u": Line("s.Sensor", "e.u", None, -2.0),
    "s.Sensor - 1 - 1 -> e.u": Line("s.Sensor - 1", "e.u", None, -1.0),
    "'s.Sensor' - 1 -> e.u": Line("s.Sensor", "e.u", None, -1.0),
    "s.Sensor * 2 -> e.u": Line("s.Sensor * 2", "e.u"),
    "'s.Sensor' * 2 - 1 -> e.u": Line("s.Sensor", "e.u", 2.0, -1.0),
    "'s.Sensor * 2' - 1 -> e.u": Line("s.Sensor * 2", "e.u", None, -1.0),
    "s.a -> b * 3 -> e.u": Line("s.a -> b", "e.u", 3.0),
    "s.plain->e.x -> y": Line("s.plain", "e.x -> y"),
}


def lines_of(text: str, folder: Path) -> list[Line]:
    outputs = "".join(real2(name, i, "output") for i, name in enumerate(NAMES))
    inputs = "".join(real2(name, i, "input", 'start="0"') for i, name in enumerate(("u", "x -&gt; y")))
    tables = {
        "s": {"participant": describe2(folder / "s.fmu", outputs)},
        "e": {"participant": describe2(folder / "e.fmu", inputs)},
    }
    return [parse_line(line) for line in scenario(tables, connections=[text]).connections]


@pytest.mark.parametrize(("text", "line"), READ.items(), ids=READ)
def test_names_win(text: str, line: Line, tmp_path: Path) -> None:
    """And what is written of a connection reads as the same."""
    assert lines_of(text, tmp_path) == [line]
    assert parse_line(str(line)) == line


def test_what_may_be_two_outputs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        ScenarioError, match=r"write 's\.Sensor \* 2' - 1 or 's\.Sensor' \* 2 - 1, with the q"
    ):
        lines_of("s.Sensor * 2 - 1 -> e.u", tmp_path)
