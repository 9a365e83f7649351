"""C programs host native FMUs: instances that come and go, and calls at random, without a leak, an access to
what is not theirs, or an answer that the standard does not know.

Where gcc's sanitizers are, the runtime is compiled with them; valgrind runs the library as it is shipped.
"""

import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.model_description import ModelDescription

from fmus.native.fmu import NAMES
from fmus.native.machine_code import FMI_HEADERS
from tests.shared import made_once
from tests.third_party.c_fmus import compiler

from ..native import programs
from .programs import TOKEN, library_in, needs_sanitizers, run, sanitizing_compiler, variables_for_c

LIVES = 5_000
VALGRIND = [
    "valgrind", "-q", "--error-exitcode=9", "--leak-check=full", "--show-leak-kinds=all",
    "--errors-for-leak-kinds=all",
]  # fmt: skip
# Step size; an input, and base and swing of what it is given; the first and last of the outputs to compare.
# The first has states, the second formulas alone, the third looks for events inside steps.
HOSTED = {
    "valve_spring": (1e-5, "load", 400.0, 100.0, "position", "seat_force"),
    "ehl_contact": (1e-5, "approach", 0.0, 1e-6, "load", "damping_margin"),
    "slider_crank": (1e-4, "crank_speed", 100.0, 50.0, "psi", "wall_radius"),
}

# By version of FMI: functions that are only ever refused, or only taken.
NEVER_TAKEN = {
    2: {"fmi2CancelStep", "fmi2GetStatus", "fmi2GetIntegerStatus", "fmi2GetStringStatus"},
    3: {
        "fmi3ActivateModelPartition",
        "fmi3EnterConfigurationMode",
        "fmi3ExitConfigurationMode",
        "fmi3EvaluateDiscreteStates",
        "fmi3GetNumberOfVariableDependencies",
        "fmi3GetVariableDependencies",
    },
}
NEVER_REFUSED = {
    2: {"fmi2SetDebugLogging", "fmi2Reset", "fmi2FreeFMUstate"},
    3: {"fmi3SetDebugLogging", "fmi3Reset", "fmi3FreeFMUState"},
}


def functions(fmi: int) -> set[str]:
    """Those of the standard's header that are called at random."""
    header = (FMI_HEADERS / f"fmi{fmi}Functions.h").read_text()
    declared = re.findall(rf"^\s*FMI{fmi}_Export fmi{fmi}\w+TYPE\s+(fmi{fmi}\w+);", header, re.MULTILINE)
    return {name for name in declared if not re.search("Instan|TypesPlatform|GetVersion", name)}


@pytest.fixture(scope="session")
def compiled():
    """compiled(name, sanitized, fmi): the program, compiled once."""

    def get(name, sanitized, fmi=2):
        made = f"program-{name}-{sanitized}-{fmi}"
        (program,) = made_once(made, lambda folder: programs.program(name, folder, sanitized, fmi)).iterdir()
        return program

    return get


@pytest.fixture(scope="session")
def sanitized_library():
    """sanitized_library(name, fmi), compiled once."""

    def get(name, fmi):
        folder = made_once(f"sanitized-{name}-{fmi}", lambda f: programs.sanitized_library(name, f, fmi))
        return folder / f"{name}.so"

    return get


def arguments_of_lives(name: str, count: int, description: ModelDescription) -> list[object]:
    """The arguments of host.c from the number of lives on."""
    at = {v.name: v.valueReference for v in description.modelVariables}
    step, given, base, swing, first, last = HOSTED[name]
    return [count, step, at[given], base, swing, at[first], at[last] - at[first] + 1]


def token_of(description: ModelDescription) -> str:
    return description.guid or description.instantiationToken


def arguments_of_fuzz(description: ModelDescription, folder: Path, seed: int, calls: int) -> list[object]:
    """The arguments of fuzz.c from the file of variables on."""
    variables = folder / "variables"
    variables.write_text(variables_for_c(description))
    states, indicators = description.numberOfContinuousStates, description.numberOfEventIndicators
    return [variables, states, indicators, seed, calls]


@pytest.mark.parametrize(
    ("name", "count"),
    [("valve_spring", LIVES), *(pytest.param(name, 1_000_000, marks=pytest.mark.long) for name in HOSTED)],
)
def test_lives_under_sanitizers(name, count, native_files, compiled, sanitized_library, tmp_path):
    """No leak, no access outside of what is allocated, nothing that C leaves undefined."""
    needs_sanitizers()
    _, description = library_in(native_files[name], tmp_path)
    rest = arguments_of_lives(name, count, description)
    run([compiled("host", True), sanitized_library(name, 2), TOKEN, *rest], 1800)


@pytest.mark.long
@pytest.mark.parametrize("name", HOSTED)
def test_lives_under_valgrind(name, native_files, compiled, tmp_path):
    """The library as it is shipped, with its kernels: no leak, no invalid access, no jump by unset memory."""
    if shutil.which("valgrind") is None:
        pytest.skip("needs valgrind")
    library, description = library_in(native_files[name], tmp_path)
    rest = arguments_of_lives(name, 50_000, description)
    run([*VALGRIND, compiled("host", False), library, description.guid, *rest], 1800)


@pytest.fixture
def files(native_files, fmi3_files):
    """FMUs by version of FMI."""
    return {2: native_files, 3: fmi3_files}


@pytest.mark.long
@pytest.mark.parametrize("fmi", [2, 3])
def test_random_calls_under_valgrind(fmi, files, compiled, tmp_path):
    if shutil.which("valgrind") is None:
        pytest.skip("needs valgrind")
    library, description = library_in(files[fmi]["valve_spring"], tmp_path)
    rest = arguments_of_fuzz(description, tmp_path, 6, 3_000)
    run([*VALGRIND, compiled("fuzz", False, fmi), library, token_of(description), *rest], 1800)


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(
    ("name", "calls"),
    [
        ("valve_spring", 40_000),
        *(
            pytest.param(name, 1_000_000 if name in HOSTED else 40_000, marks=pytest.mark.long)
            for name in NAMES
        ),
    ],
)
def test_random_calls(name, calls, fmi, files, compiled, sanitized_library, tmp_path):
    """Any function with any arguments in any phase: what fuzz.c says must hold, and every function is taken
    as well as refused, but for those that can only be one of them. With sanitizers where they are."""
    library, description = library_in(files[fmi][name], tmp_path)
    rest = arguments_of_fuzz(description, tmp_path, 1, calls)
    sanitized = sanitizing_compiler() is not None
    hosted = [sanitized_library(name, fmi), TOKEN] if sanitized else [library, token_of(description)]
    said = run([compiled("fuzz", sanitized, fmi), *hosted, *rest], 1800)
    counts = [line.split() for line in said.splitlines()]
    assert {call for call, *_ in counts} == functions(fmi)
    assert {call for call, taken, _ in counts if taken == "0"} == NEVER_TAKEN[fmi]
    assert {call for call, _, refused in counts if refused == "0"} == NEVER_REFUSED[fmi]


PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "native-fmus.md"


@pytest.mark.skipif(sys.platform != "linux", reason="the page's commands are Linux's")
def test_the_page_s_host_steps_an_fmu(native_files, tmp_path):
    """Its rows are those of another host, to the digits that it prints."""
    page = PAGE.read_text("utf-8")
    code = re.search(r"```c\n(.+?)```", page, re.DOTALL)
    assert code
    (tmp_path / "host.c").write_text(code[1])
    command = [*compiler(), "-std=c99", f"-I{FMI_HEADERS}", "host.c", "-o", "host", "-ldl"]
    subprocess.run(command, cwd=tmp_path, check=True, timeout=300)
    file = native_files["valve_spring"]
    described = fmpy.read_model_description(str(file))
    position = next(v for v in described.modelVariables if v.name == "position")
    with zipfile.ZipFile(file) as archive:
        archive.extractall(tmp_path)
    library = next((tmp_path / "binaries" / "linux64").glob("*.so"))
    rest = [str(position.valueReference), "1e-4", "1e-3"]
    assert f'valve_spring.so "{{GUID}}" {" ".join(rest)}\n' in page
    arguments = [str(library), described.guid, *rest]
    done = subprocess.run([str(tmp_path / "host"), *arguments], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    rows = [tuple(map(float, line.split(","))) for line in done.stdout.splitlines()]
    assert [time for time, _ in rows] == pytest.approx([1e-4 * n for n in range(1, 11)])
    expected = fmpy.simulate_fmu(
        str(file), stop_time=1e-3, step_size=1e-4, output_interval=1e-4, output=["position"]
    )
    assert [value for _, value in rows] == pytest.approx(list(expected["position"][1:]), rel=1e-8, abs=1e-15)
