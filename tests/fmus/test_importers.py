"""Other tools and a C program run the packaged files and give the numbers of the component.

docs/reference/tools.csv has the whole table.
"""

import sys
from pathlib import Path

import pytest

from fmus.build import NAMES
from fmus.native.fmu import NAMES as NATIVE_NAMES
from interop.c_program import Host, compile_host, find_libpython
from interop.case import Case, list_equal_steps
from interop.comparison import KINDS, compare, compute_expected, make_case
from interop.document import make_result, read_results
from interop.processes import NAMES as NAMES_OF_TOOLS
from interop.processes import explain_missing, load_tool

from .names import mark_long

# What the extra `dev` installs.
TOOLS = ("fmpy", "libcosim", "ecos", "fmucontainer", "c_host")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", mark_long(NAMES, ["valve_spring"]))
@pytest.mark.parametrize("tool", TOOLS)
def test_other_masters(tool: str, name: str, kind: str, record) -> None:
    """All outputs after every step to the last bit; or a tool that says that it does not know FMI 3.0."""
    if why := explain_missing(tool):
        pytest.skip(why)
    if KINDS[kind].native and name not in NATIVE_NAMES:
        pytest.skip(f"{name} has no native FMU")
    difference, answer = compare(tool, name, KINDS[kind])
    if KINDS[kind].fmi in getattr(load_tool(tool), "FMI", (2, 3)):
        assert (answer.failed, answer.loaded) == ("", True)
        quantity = f"relative difference of all outputs in {tool}"
        record("Tools", quantity, difference, 0.0, "component in process", tolerance=0)
    else:
        assert "FMI version" in answer.failed


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["valve_spring", "slider_crank"])
@pytest.mark.parametrize("tool", sorted({*NAMES_OF_TOOLS} - {*TOOLS}))
def test_tools_that_are_not_always_here(tool: str, name: str, kind: str) -> None:
    """What docs/reference/tools.csv says of them."""
    if why := explain_missing(tool):
        pytest.skip(why)
    found = make_result(name, *compare(tool, name, KINDS[kind]))
    assert found.difference == read_results()[tool, name, kind].difference


@pytest.fixture(scope="session")
def c_host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The compiled program."""
    if not sys.platform.startswith("linux"):
        pytest.skip("needs Linux")
    if find_libpython() is None:
        pytest.skip("this Python was built without a shared library, which a C program would load")
    return compile_host(tmp_path_factory.mktemp("host"))


def case_and_truth(file: Path) -> tuple[Case, list[list[float]]]:
    kind = KINDS["python"]
    case = make_case("valve_spring", kind, file)
    return case, compute_expected("valve_spring", kind, case, list_equal_steps(case.steps, case.step))


@pytest.mark.parametrize("at_end", ["free", "keep"])
def test_c_program(at_end: str, c_host: Path, fmu_files: dict[str, Path], record) -> None:
    """To the last bit, also when the process ends with the instance alive, and without an abort."""
    case, truth = case_and_truth(fmu_files["valve_spring"])
    program = Host(c_host, preload=str(find_libpython()))
    found, quantity = program.values(case, at_end), "outputs of an FMU in Python in a C program"
    record("Tools", quantity, found, truth, "component in process", tolerance=0)
