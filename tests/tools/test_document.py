"""docs/tools.md is what its program writes, and its tables say what they are made of."""

from __future__ import annotations

from fmus.build import NAMES

from .document import FILE, Section, cells_of, summary, text, written
from .plan import KINDS
from .running import NAMES as TOOLS
from .running import host


def test_the_page_is_what_the_program_makes_of_its_sections() -> None:
    assert FILE.read_text("utf-8") == text(written())


def test_every_section_has_every_fmu_and_tools_without_one_are_named() -> None:
    sections = written()
    for tool in TOOLS:
        if host(tool).TITLE in sections:
            assert list(cells_of(sections[host(tool).TITLE])) == list(NAMES)
        else:
            (line,) = (line for line in FILE.read_text("utf-8").splitlines() if "Not run yet" in line)
            assert f" {tool} " in line


def test_the_first_table_sums_up_a_section() -> None:
    """How many run, their largest difference, their rates; or why none does."""
    _, second, third = (kind.title for kind in KINDS.values())
    section = Section("a tool", "1.0")
    section.rows["one"] = ["0", "1 000", "does not load", "–", "0", "10"]
    section.rows["two"] = ["2.5e-16", "81 700", "does not load", "–", "stops", "–"]
    section.said["no", second] = ["one", "two"]
    section.said["no", third] = ["two"]
    lines = section.lines("nothing", ["a finding"])
    assert summary(lines) == [
        "a tool",
        "1.0",
        "2 of 2, difference 2.5e-16, 1 000 to 81 700 steps/s",
        "does not load",
        "1 of 2, difference 0, 10 to 10 steps/s",
    ]
    assert lines[-6:] == [
        "Where it failed:",
        "",
        f"- {second}, all: “no”",
        f"- {third}, two: “no”",
        "",
        "- a finding",
    ]
