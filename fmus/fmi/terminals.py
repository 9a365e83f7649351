"""terminalsAndIcons.xml: which variables of a component are connected together, and its icon.

The file is that of FMI 3.0, which FMI 2.0.4 takes over. Each component's folder names its `TERMINALS`.
Members of connected terminals have the same name, and equal values.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import count
from xml.etree.ElementTree import Element, SubElement

from .description import to_xml

FOLDER = "terminalsAndIcons"

# In names and variables of terminals that an array has one of for each element.
EACH = "[*]"


@dataclass(frozen=True)
class Terminal:
    """Variables by their member names; `partial`: it may be connected to one that has fewer members."""

    kind: str
    description: str
    members: Mapping[str, str]
    partial: bool = False


def find_terminals(stated: Mapping[str, Terminal], variables: Collection[str]) -> dict[str, Terminal]:
    """The terminals, as a component's folder states them, of an FMU that has these variables."""
    return {
        label: terminal
        for each, stem in stated.items()
        for label, terminal in _elements(each, stem, variables)
    }


def _elements(name: str, stem: Terminal, variables: Collection[str]) -> Iterator[tuple[str, Terminal]]:
    if not name.endswith(EACH):
        yield name, stem
        return
    for i in count(1):
        members = {member: variable.replace(EACH, f"[{i}]") for member, variable in stem.members.items()}
        if not set(members.values()) <= set(variables):
            return
        yield name.replace(EACH, f"[{i}]"), Terminal(stem.kind, stem.description, members, stem.partial)


def terminals_and_icons(stated: Mapping[str, Terminal], variables: Collection[str]) -> str:
    """The XML text; the icon beside it is icon.png."""
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    drawn = SubElement(root, "GraphicalRepresentation")
    corners = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    SubElement(drawn, "CoordinateSystem", corners, suggestedScalingFactorTo_mm="0.1")
    SubElement(drawn, "Icon", corners)
    terminals = find_terminals(stated, variables)
    if not terminals:
        return to_xml(root)
    listed = SubElement(root, "Terminals")
    for label, terminal in terminals.items():
        entry = SubElement(
            listed,
            "Terminal",
            name=label,
            matchingRule="bus" if terminal.partial else "plug",
            terminalKind=f"_tribocosim_{terminal.kind}",
            description=terminal.description,
        )
        for member, variable in terminal.members.items():
            SubElement(
                entry,
                "TerminalMemberVariable",
                memberName=member,
                variableName=variable,
                variableKind="signal",
            )
    return to_xml(root)
