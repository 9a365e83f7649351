"""A component in a user's own file: FMUs that need nothing else, runs, references, refusals."""

import re
import sys
import tomllib
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import tribocosim
from models.catalogue import CATALOGUE, find_factory
from models.core import kernel_check
from models.core.kernel_check import check_kernels
from orchestrator.scenario import build_scenario
from orchestrator.scenario.system import build_system, list_moved_starts, resolve_start
from orchestrator.scenario.values import build_component

from ..orchestrator.commands import tribocosim as run_command

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "write-a-component.md"
CODE, SCENARIO = (
    re.search(rf"```{kind}\n(.+?)```", PAGE.read_text("utf-8"), re.DOTALL)[1] for kind in ("python", "toml")
)

STEPPED = """
import sys
slave = Instance({fmu!r}).initialize(0.0, **{{"angle_start": 0.5}})
for k in range(200):
    slave.step(k * 0.005, 0.005)
ours = sorted({{name.partition(".")[0] for name in sys.modules}} & {{"models", "fmus", "my_parts"}})
report([slave.get(["angle"])[0], ours])
"""

# A kernel that another one passes its record, and an output that follows an input in some states only.
HELPER = """
@kernel
def inertia_of(p: Parameters) -> float:
    return p.mas * p.length**2
"""
THROUGH = "    y.speed = x.speed + u.torque * (x.angle > 1.0)\n"
# Components whose tables take seconds to check as plain Python.
SLOW = {"camshaft", "ehl_line_contact", "finger", "journal_bearing", "tappet"}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The page's file in an empty folder, which is the current one; forgotten afterwards."""
    (tmp_path / "my_parts.py").write_text(f"{CODE}\nEXPERIMENT = (2.0, 1e-3)\n", "utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.delitem(sys.modules, "my_parts", raising=False)
    find_factory.cache_clear()
    return tmp_path


def solve_pendulum(time: float) -> float:
    """m l^2 phi'' = -c phi' - m g l sin phi from 0.5 rad, by an independent solver."""

    def rates(t: float, x: np.ndarray) -> list[float]:
        return [x[1], (-0.01 * x[1] - 9.81 * 0.5 * np.sin(x[0])) / 0.25]

    return float(solve_ivp(rates, (0.0, time), [0.5, 0.0], "DOP853", rtol=1e-12, atol=1e-14).y[0, -1])


@pytest.mark.parametrize("native", [False, pytest.param(True, marks=pytest.mark.long)])
def test_its_fmu_moves_by_its_equations_where_nothing_else_is(native, folder, isolated):
    path = tribocosim.build_fmu("my_parts:pendulum", folder, native=native)
    assert float(fmpy.read_model_description(path).defaultExperiment.stopTime) == 2.0
    angle, ours = isolated(STEPPED.format(fmu=str(path)))
    assert ours == []
    assert angle == pytest.approx(solve_pendulum(1.0), abs=1e-8)


def test_the_page_s_scenario_is_within_its_tolerance_of_the_reference(folder):
    (folder / "pendulums.toml").write_text(SCENARIO, "utf-8")
    result = tribocosim.run("pendulums.toml")
    assert result.within
    assert float(result.coupled["arm.angle"].min()) < -0.4


def test_a_start_that_the_equilibrium_replaces_is_told(folder):
    said = {}
    for start in ("given", "equilibrium"):
        tables = tomllib.loads(SCENARIO) | {"name": "pendulums", "start": start}
        system = build_system(scenario := build_scenario(tables))
        said[start] = list_moved_starts(system, resolve_start(scenario, system))
    assert said["given"] == []
    assert [line.partition(" = ")[0] for line in said["equilibrium"]] == [
        "components.arm.start.angle",
        "components.short.start.angle",
    ]


def test_a_change_of_the_file_or_its_icon_makes_another_fmu(folder):
    """Also without a name for it: the cached one is of the old code."""
    first = tribocosim.build_fmu("my_parts:pendulum", folder / "one").read_bytes()
    again = tribocosim.build_fmu("my_parts:pendulum", folder / "two").read_bytes()
    assert first == again
    (folder / "my_parts.png").write_bytes(b"icon")
    with zipfile.ZipFile(tribocosim.build_fmu("my_parts:pendulum", folder / "drawn")) as archive:
        assert archive.read("model.png") == b"icon"
    (folder / "my_parts.py").write_text(CODE.replace("9.81", "1.62"), "utf-8")
    assert tribocosim.build_fmu("my_parts:pendulum", folder / "three").read_bytes() != first


@pytest.mark.parametrize(
    ("added", "name", "said"),
    [
        ("import scipy", "my_parts:pendulum", "imports scipy"),
        ("import models.catalogue", "my_parts:pendulum", "from models"),
        ("", "my_parts:nothing", "cannot be imported"),
        ("", "nowhere:pendulum", "cannot be imported"),
        ("", "my_parts:State", "must be a models.core.component.Component"),
    ],
)
def test_what_cannot_be_an_fmu_is_named(added, name, said, folder):
    text = CODE.replace("import math\n", f"import math\n{added}\n")
    (folder / "my_parts.py").write_text(text, "utf-8")
    with pytest.raises(tribocosim.MistakeError, match=said):
        tribocosim.build_fmu(name, folder)


SPEED = "    y.speed = x.speed\n"
SLIPS = {
    "field": ("p.damping * x", "p.dampin * x", r"my_parts.py, line 38: p.dampin: Parameters .* damping"),
    "output": ("y.speed = x", "y.sped = x", r"my_parts.py, line 44: y.sped: State has .* speed\?"),
    "name": ("/ inertia", "/ inertja", r"my_parts.py, line 38: there is no 'inertja'; did you mean inertia"),
    "function": ("math.sin(", "math.sinn(", r"line 38: math.sinn: math has no 'sinn'; did you mean sin\?"),
    "arguments": ("output(t: float, x", "output(x", r"line 41: output\(x, u, p, y\): must take \(t, x, u,"),
    "kernel": ("output=output", "output=None", r"output: must be a function \(t, x, u, p, y\) with @kernel"),
    "passed on": (
        "p.mass * p.length**2",
        "inertia_of(p)",
        r"line 69: no record has 'mas'; did you mean mass\?",
    ),
    "factory": ("feedthrough={}", "feedthrough=none", r"name 'none' is not defined \(my_parts.py, line 63\)"),
    "feedthrough": ("={}", "={'speed': ['turn']}", "input 'turn' of feedthrough must be one of torque"),
    "bond": ('Bond("torque"', 'Bond("turn"', "variable 'turn' of a bond must be one of torque, angle, speed"),
    "not set": (SPEED, "", "output speed: not set; assign a value at every call"),
    "not always set": (
        SPEED,
        "    if x.angle > 0.0:\n    " + SPEED,
        "output speed: not set in every case, as ",
    ),
    "rate": ("    dx.angle = x.speed\n", "", r"the rate dx.angle: not set"),
    "added to": ("e[2] = 0.0", "e[2] += 0.0", r"the source power e\[2\]: not set"),
    "overwritten": (SPEED, SPEED + "    x.angle = 0.0\n", r"a kernel sets x\.angle: only a transition may"),
    "undeclared": (
        SPEED,
        THROUGH,
        r"output speed depends on input torque .*\{'speed': \['torque'\], \.\.\.\}",
    ),
}


@pytest.mark.plain
@pytest.mark.parametrize("slip", SLIPS)
def test_what_kernels_misspell_or_leave_out_is_named(slip, folder):
    """Before a run, with file and line: the compiler's own words name neither. An output that is left out
    would be zero, one that follows an input undeclared would be wrong, and the reference with it."""
    right, wrong, said = SLIPS[slip]
    assert right in CODE
    (folder / "my_parts.py").write_text(CODE.replace(right, wrong, 1) + HELPER, "utf-8")
    with pytest.raises(ValueError, match=said):
        build_component(f"{folder / 'my_parts.py'}:pendulum")


def test_a_compiled_kernel_that_writes_beyond_its_results_is_named(folder):
    """Compiled code asks no bounds: it would overwrite other memory of the run."""
    (folder / "my_parts.py").write_text(CODE.replace("e[2] = 0.0", "e[2] = 0.0\n    e[7] = 1.0", 1), "utf-8")
    with pytest.raises(ValueError, match=r"a kernel writes e\[7\]: its last is e\[2\]"):
        build_component(f"{folder / 'my_parts.py'}:pendulum")


@pytest.mark.plain
def test_a_loop_that_ends_for_some_states_only_is_named(folder, monkeypatch):
    """Compiled code that does not return hears of no signal. Here it does, later than the check waits."""
    monkeypatch.setattr(kernel_check, "PATIENCE_S", 0.1)
    loop = "    turns = 0\n    while x.angle < 0.0 and turns < 3_000_000:\n        turns += 1\n"
    (folder / "my_parts.py").write_text(CODE.replace(SPEED, loop + SPEED, 1), "utf-8")
    with pytest.raises(ValueError, match=r"does not return within 0\.1 s with angle = -0\.\d+, .* limit"):
        build_component(f"{folder / 'my_parts.py'}:pendulum")


@pytest.mark.plain
@pytest.mark.parametrize("name", sorted({*CATALOGUE} - SLOW))
def test_every_component_computes_what_it_declares(name):
    check_kernels(CATALOGUE[name]())


def test_the_command_builds_it(folder):
    done = run_command("fmu", "build", "my_parts:pendulum", "--out", str(folder), cwd=folder)
    assert (done.returncode, done.stdout.strip()) == (0, str(folder / "pendulum.fmu"))
