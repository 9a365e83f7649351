"""docs/reference/tools.md is what its program writes, and its tables say what they are made of."""

from __future__ import annotations

from fmus.build import NAMES
from interop.comparison import KINDS
from interop.document import FILE, Section, format_page, read_sections
from interop.processes import NAMES as TOOLS
from interop.processes import Answer


def test_the_page_is_what_the_program_makes_of_its_sections() -> None:
    assert FILE.read_text("utf-8") == format_page(read_sections())


def test_every_section_has_every_fmu_and_tools_without_one_are_named() -> None:
    sections = read_sections()
    assert all(list(section.rows) == list(NAMES) for section in sections.values())
    for tool in {*TOOLS} - {*sections}:
        (line,) = (line for line in FILE.read_text("utf-8").splitlines() if "Not run yet" in line)
        assert f" {tool} " in line


def answered() -> Section:
    """Two FMUs, of which one runs as FMI 3, none as native FMI 2."""
    section = Section(TOOLS[0], "", "a machine")
    for fmu, difference, rate in (("one", 0.0, 1000.0), ("two", 2.5e-16, 81723.0)):
        section.add(fmu, "python", difference, Answer(version="1.0", loaded=True, rate=rate))
        section.add(fmu, "native", None, Answer(version="1.0", failed="no"))
        failed = "" if fmu == "one" else "two is too much"
        section.add(fmu, "native3", None if failed else 0.0, Answer("1.0", True, rate=9.96, failed=failed))
    return section


def test_the_first_table_sums_up_a_section() -> None:
    """How many run, their largest difference, their rates; or why none does."""
    assert answered().summary()[1:] == [
        "1.0",
        "2 of 2, difference 2.5e-16, 1 000 to 81 700 steps/s",
        "does not load",
        "1 of 2, difference 0, 10 to 10 steps/s",
    ]


def test_failures_stand_below_the_table() -> None:
    _, second, third = (kind.title for kind in KINDS.values())
    lines = answered().lines()
    assert f"- {second}, all: “no”" in lines
    assert f"- {third}, two: “NAME is too much”" in lines


def test_a_section_is_read_as_it_was_written() -> None:
    section = answered()
    lines = [section.lines()[0].removeprefix("## "), *section.lines()[1:]]
    assert Section.read(section.tool, lines) == section


def test_a_new_answer_replaces_the_one_before() -> None:
    section = answered()
    section.add("two", "native3", 0.0, Answer("1.1", True, rate=20.0))
    assert section.rows["two"][4:] == ["0", "20"]
    assert {kind for _, kind in section.failures} == {KINDS["native"].title}
    assert section.version == "1.1"
