"""Terminals: what they join is what the scenarios connect, and what is wrong with a file is said."""

import re
import tomllib
from pathlib import Path

import pytest

import orchestrator
from fmus.build import NAMES
from fmus.declared import find_extra
from fmus.fmi.terminals import Terminal, find_terminals, terminals_and_icons
from fmus.fmi.validate import terminal_faults
from fmus.variable_layout import Memory
from models.catalogue import CATALOGUE

SCENARIOS = Path(orchestrator.__file__).parent / "scenario" / "shipped"


def stated(name: str) -> dict[str, Terminal]:
    return find_extra(name, "TERMINALS", {})


def variables_of(name: str, **structure: int) -> set[str]:
    component = CATALOGUE[name](**structure)
    return {v.name for v in Memory(component).variables()}


@pytest.mark.parametrize("name", NAMES)
def test_the_file_is_valid(name: str) -> None:
    variables = variables_of(name)
    assert terminal_faults(terminals_and_icons(stated(name), variables).encode(), variables) == []


def scenario(name: str) -> dict:
    content = tomllib.loads((SCENARIOS / f"{name}.toml").read_text())
    return scenario(content["extends"]) | content if "extends" in content else content


@pytest.mark.parametrize(
    "name",
    ["valve-train", "slider-crank", "engine", "piston-slap", "bouncing-mass", "two-masses", "quarter-car"],
)
def test_terminals_join_what_scenarios_connect(name: str) -> None:
    """Each connection is between members of the same name in terminals of the same kind."""
    content = scenario(name)

    def members(end: str) -> set[tuple[str, str]]:
        instance, _, variable = end.partition(".")
        entry = content["components"][instance]
        component = entry.get("component", instance)
        terminals = find_terminals(stated(component), variables_of(component, **entry.get("structure", {})))
        found = set[tuple[str, str]]()
        for terminal in terminals.values():
            found |= {(terminal.kind, m) for m, v in terminal.members.items() if v == variable}
        return found

    for connection in content["connections"]:
        source, target = re.split(r"\s*->\s*", connection)
        assert members(source) & members(target), connection


def test_members_of_one_kind_are_the_same() -> None:
    """Of terminals that are connected whole; a partial one has some of them, or more."""
    kinds: dict[str, list[Terminal]] = {}
    for name in NAMES:
        for terminal in find_terminals(stated(name), variables_of(name)).values():
            kinds.setdefault(terminal.kind, []).append(terminal)
    for kind, terminals in kinds.items():
        known = set().union(*(t.members for t in terminals))
        for terminal in terminals:
            assert terminal.partial or set(terminal.members) >= known - {"impulse"}, kind


def test_arrays_have_a_terminal_for_each_element() -> None:
    terminals = find_terminals(stated("flywheel"), variables_of("flywheel", loads=3))
    assert list(terminals) == ["load[1]", "load[2]", "load[3]"]
    assert terminals["load[3]"].members["torque"] == "load_torque[3]"


def test_faults_are_said() -> None:
    xml = terminals_and_icons(stated("valve_spring"), {"load"})
    assert terminal_faults(xml.encode(), {"position", "load", "gas_force"}) == [
        "terminalsAndIcons/terminalsAndIcons.xml: terminal load: there is no variable velocity"
    ]
    twice = xml.replace('memberName="velocity"', 'memberName="force"')
    assert (
        "members need names of their own" in terminal_faults(twice.encode(), variables_of("valve_spring"))[0]
    )
    assert "not XML" in terminal_faults(b"<fmi", set())[0]
    assert "line" in terminal_faults(xml.replace("matchingRule", "rule").encode(), set())[0]
