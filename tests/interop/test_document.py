"""docs/reference/tools.md is what its program writes, and its table sums up the results."""

from itertools import product

from fmus.native.fmu import NAMES
from interop import document
from interop.comparison import KINDS, TRAINS
from interop.document import PAGE, Results, format_page, list_findings, make_result, read_results, summarise
from interop.processes import NAMES as TOOLS
from interop.processes import Answer


def test_the_page_is_what_the_program_makes_of_its_results() -> None:
    assert PAGE.read_text("utf-8") == format_page(read_results())


def test_every_tool_has_every_fmu_or_is_named_as_missing() -> None:
    results = read_results()
    tools = {tool for tool, _, _ in results}
    assert {key for key in results if key[1] not in TRAINS} == set(product(tools, NAMES, KINDS))
    for tool in {*TOOLS} - tools:
        (line,) = (line for line in PAGE.read_text("utf-8").splitlines() if "Not run yet" in line)
        assert f" {tool} " in line


def two_fmus() -> Results:
    """Both run in Python, none as native FMI 2, the first as FMI 3."""
    tool, (one, two) = TOOLS[0], NAMES[:2]
    fails = Answer("1.0", failed="no")
    return {
        (tool, one, "python"): make_result(one, 0.0, Answer("1.0", loaded=True)),
        (tool, two, "python"): make_result(two, 2.5e-16, Answer("1.0", loaded=True)),
        (tool, one, "native"): make_result(one, None, fails),
        (tool, two, "native"): make_result(two, None, fails),
        (tool, one, "native3"): make_result(one, 0.0, Answer("1.0", loaded=True)),
        (tool, two, "native3"): make_result(two, None, Answer("1.0", True, failed=f"{two} is too much")),
    }


def test_the_table_sums_up_a_tool() -> None:
    """How many run, their largest difference; or why none does."""
    results = {key[1:]: result for key, result in two_fmus().items()}
    assert summarise(TOOLS[0], results)[1:] == [
        "1.0", "2 of 2, 2.5e-16", "does not load", "1 of 2, 0",
    ]  # fmt: skip
    findings = list_findings(TOOLS[0], results)
    assert f"- {KINDS['native'].title}, all: “no”" in findings
    assert f"- {KINDS['native3'].title}, {NAMES[1]}: “NAME is too much”" in findings


def test_results_are_read_as_they_were_written(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(document, "TABLE", tmp_path / "tools.csv")
    monkeypatch.setattr(document, "PAGE", tmp_path / "tools.md")
    document.write_results(two_fmus())
    assert read_results() == two_fmus()
