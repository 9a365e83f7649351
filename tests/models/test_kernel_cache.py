"""Compiled kernels kept on disk: reused wherever the same code is run, never one for another."""

import hashlib
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.compile.cache_eviction import KEPT_DAYS
from models.compile.kernel import COMPILED
from models.monolithic.problem import SystemProblem

from ..aged import aged
from .forked import Forked
from .systems import valve_train

ROOT = Path(__file__).parent.parent.parent

pytestmark = pytest.mark.skipif(not COMPILED, reason="there is nothing to keep without numba")

FACTORY = """
from models.compile.kernel import kernel

def made(factor):
    @kernel
    def inner(x):
        return factor * x
    return inner

def outer(function):
    @kernel
    def applied(x):
        return function(function(x))
    return applied

def symbols(*functions):
    return {c.fndesc.mangled_name for f in functions for c in f.overloads.values()}

def shared(*functions):
    codes = [{*c.library.machine_code} for f in functions if f(1) for c in f.overloads.values()]
    return len(set.intersection(*codes))
"""

# A kernel that calls another through a module, which has a constant, both on the way to a named tuple.
LAW = """
from typing import NamedTuple
from .compile.kernel import kernel

FACTOR = 2.0

class Pair(NamedTuple):
    one: float
    two: float

@kernel
def law(x):
    return Pair(x, FACTOR * x)
"""
USE = """
import numpy as np
from . import law
from .compile.kernel import kernel

POINT = np.dtype([("x", float), ("y", float)])
TURNED = np.dtype([("y", float), ("x", float)])

@kernel
def twice(x):
    pair = law.law(x)
    return law.Pair(pair.one, 2.0 * pair.two)

@kernel
def product(x):
    pair = twice(x)
    return pair.one * pair.two

@kernel
def apart(x):
    return x + 1.0

@kernel
def first(record):
    return record.x
"""


def process(folder: Path, code: str) -> Forked:
    """A fresh process that shares this test's cache and runs `code`."""
    return Forked(folder, [ROOT], code, {"TRIBOCOSIM_CACHE": str(folder / "cache")})


def run(folder: Path, code: str) -> str:
    """What `code` prints."""
    return process(folder, code).said()


def stored(folder: Path) -> dict[str, int]:
    return {str(file): file.stat().st_mtime_ns for file in (folder / "cache").rglob("*.nbc")}


def copied(folder: Path, name: str) -> Path:
    """The machinery of kernels, and two modules of kernels, as a package of that name."""
    package = folder.joinpath(*name.split("."))
    shutil.copytree(ROOT / "models" / "compile", package / "compile")
    (package / "__init__.py").write_text("")
    (package / "law.py").write_text(LAW)
    (package / "use.py").write_text(USE)
    return package


def test_closures_from_the_cache_and_from_this_process_keep_apart(tmp_path: Path) -> None:
    """Symbols are numbered per process: the same number must not make two closures one."""
    (tmp_path / "factory.py").write_text(FACTORY)
    first = "from factory import *; print(outer(made(3.0))(1.0))"
    assert float(run(tmp_path, first)) == 9.0
    kept = stored(tmp_path)
    assert float(run(tmp_path, first)) == 9.0
    assert kept
    assert stored(tmp_path) == kept, "the second process compiled again"
    # What is loaded bears the first process's numbers; what is compiled then begins to count anew.
    both = "from factory import *; a, b = outer(made(3.0)), outer(made(7.0)); print(a(1.0), b(1.0))"
    assert run(tmp_path, both).split() == ["9.0", "49.0"]
    assert run(tmp_path, f"{both}; print(len(symbols(a, b)))").split()[-1] == "2"


@pytest.mark.parametrize("large", ["", "from models.compile import kernel_cache as k; k.LARGE = 0; "])
def test_a_kernel_serves_callers_and_python(large: str, tmp_path: Path) -> None:
    """In either order: what is for callers has no entry for Python, which gets one when it calls.

    A large one has machine code that all callers share."""
    (tmp_path / "factory.py").write_text(FACTORY)
    begin = f"{large}from factory import *; a = made(3.0)"
    of_numba = "numba.njit(outer(a).py_func)(1.0)"
    inner_last = f"import numba; {begin}; print(outer(a)(1.0), a(1.0), outer(outer(a))(2.0), {of_numba})"
    inner_first = f"{begin}; print(a(1.0), outer(a)(1.0), a(2.0))"
    for _ in "compiled", "from the cache":
        assert run(tmp_path, inner_last).split() == ["9.0", "3.0", "162.0", "9.0"]
        assert run(tmp_path, inner_first).split() == ["3.0", "9.0", "6.0"]
    # Another caller, of whole numbers, links what another process compiled.
    once = f"{begin}; b = outer(a); print(b(1), sum(a._cache_hits.values()), shared(b, outer(b)))"
    assert run(tmp_path, once) == f"9.0 1 {2 if large else 0}\n", "those of a for whole and for real numbers"
    # A caller that is compiled after Python has called the kernel from the cache is whole in another process.
    for calls, said in ("b(1j)", "9j"), ("b(1j), outer(b)(1j)", "9j 81j"), ("outer(b)(1j)", "81j"):
        assert run(tmp_path, f"{begin}; b = outer(a); print({calls})") == f"{said}\n"


def test_kernels_of_a_wheel_are_loaded_and_none_is_compiled(tmp_path: Path) -> None:
    (tmp_path / "factory.py").write_text(FACTORY)
    code = "from factory import *; print(outer(made(3.0))(1.0))"
    assert run(tmp_path, code) == "9.0\n"
    wheel = tmp_path / "wheel"
    (tmp_path / "cache" / "kernels").rename(wheel)
    with_wheel = {"TRIBOCOSIM_CACHE": str(tmp_path / "cache"), "TRIBOCOSIM_KERNELS": str(wheel)}
    assert Forked(tmp_path, [ROOT], code, with_wheel).said() == "9.0\n"
    assert not stored(tmp_path)
    for file in wheel.rglob("*.nbc"):
        file.write_bytes(file.read_bytes()[:-1])
    assert Forked(tmp_path, [ROOT], code, with_wheel).said() == "9.0\n"
    assert stored(tmp_path), "what is damaged is compiled"


def test_settings_of_numba_are_its_users(tmp_path: Path) -> None:
    """Only the processor is set, also where numba was imported before."""
    code = (
        "import numba, os; c = numba.config; c.THREADING_LAYER = 'workqueue'; "
        "os.environ.pop('NUMBA_CPU_NAME', None); import models.compile.kernel; "
        "print(c.THREADING_LAYER, c.CPU_NAME == os.environ.get('NUMBA_CPU_NAME'))"
    )
    assert run(tmp_path, code) == "workqueue True\n"


def test_kernels_are_compiled_for_all_processors_of_a_kind(monkeypatch: pytest.MonkeyPatch) -> None:
    """Unless the user says for which."""
    from models.compile import processor

    def chosen(machine: str, features: set[str], **variables: str) -> tuple[str | None, str | None]:
        monkeypatch.setattr("platform.machine", lambda: machine)
        monkeypatch.setattr("llvmlite.binding.get_host_cpu_features", lambda: dict.fromkeys(features, True))
        for name in (processor.NAME, processor.FEATURES):
            monkeypatch.setenv(name, "")
            monkeypatch.delenv(name)
        for name, value in variables.items():
            monkeypatch.setenv(name, value)
        processor.choose()
        return os.environ.get(processor.NAME), os.environ.get(processor.FEATURES)

    v3 = set(processor.V3)
    assert chosen("x86_64", v3 | {"avx512f"}) == chosen("AMD64", v3) == ("x86-64-v3", "")
    assert chosen("arm64", set()) == chosen("aarch64", set()) == ("generic", "")
    assert chosen("x86_64", v3 - {"fma"}) == chosen("riscv64", set()) == (None, None)
    assert chosen("x86_64", v3, NUMBA_CPU_NAME="haswell") == ("haswell", None)
    assert chosen("x86_64", v3, NUMBA_CPU_FEATURES="-fma") == (None, "-fma")
    name, features = chosen("x86_64", v3, NUMBA_CPU_NAME="native")
    assert name not in ("native", "x86-64-v3")
    assert features is None


def test_equal_closures_of_a_process_share_their_code(tmp_path: Path) -> None:
    """One outlives the other, and is still known to numba: a kernel that calls it can be compiled."""
    (tmp_path / "factory.py").write_text(FACTORY)
    code = "; ".join([
        "import gc", "from factory import *", "a, b = made(3.0), made(3.0)", "a(1.0), b(1.0)",
        "code = [next(iter(f.overloads.values())).library for f in (a, b)]", "shared = code[0] is code[1]",
        "del a", "gc.collect()", "print(outer(b)(1.0), shared)",
    ])  # fmt: skip
    assert run(tmp_path, code) == "9.0 True\n"
    assert run(tmp_path, code) == "9.0 True\n"


def test_records_from_the_cache_keep_apart(tmp_path: Path) -> None:
    """So are types: the first record type of one process must not be taken for that of another."""
    copied(tmp_path, "one")
    code = "from one.use import *; print(first(np.array([(1.0, 2.0)], {0})[0]))"
    assert run(tmp_path, code.format("POINT")) == "1.0\n"
    assert run(tmp_path, code.format("TURNED")) == "2.0\n"
    both = "; ".join(["from one.use import *", *(
        f"print(first(np.array([(1.0, 2.0)], {dtype})[0]))" for dtype in ("TURNED", "POINT")
    )])  # fmt: skip
    kept = stored(tmp_path)
    assert run(tmp_path, both).split() == ["2.0", "1.0"]
    assert stored(tmp_path) == kept


def test_copies_of_a_package_share_code_and_have_named_tuples_of_their_own(tmp_path: Path) -> None:
    """In another place and under another name, as in an FMU; also when both run in a process, and when the
    copy whose class the first code named is gone."""
    copied(tmp_path, "one")
    copied(tmp_path, "another.models")
    code = "from {0}.use import *; print(product(3.0), twice(1.0), type(twice(1.0)) is law.Pair)"
    said = "36.0 Pair(one=1.0, two=4.0) True\n"
    assert run(tmp_path, code.format("one")) == said
    kept = stored(tmp_path)
    assert run(tmp_path, f"{code}\n{code}".format("one").replace("one", "another.models", 1)) == 2 * said
    shutil.rmtree(tmp_path / "one")
    assert run(tmp_path, code.format("another.models")) == said
    # What gives a tuple to Python names the class of its package.
    assert {Path(name).name.partition("-")[0] for name in stored(tmp_path).keys() - kept.keys()} == {"twice"}


@pytest.mark.parametrize(("old", "new"), [("FACTOR = 2.0", "FACTOR = 3.0"), ("FACTOR * x", "FACTOR + x")])
def test_an_edited_source_is_compiled_anew(old: str, new: str, tmp_path: Path) -> None:
    """Of a constant or a kernel in another file, even where size and date of the file stay; and only what
    depends on it."""
    file = copied(tmp_path, "one") / "law.py"
    code = "from one.use import *; print(twice(4.0).two, apart(1.0))"
    assert run(tmp_path, code) == "16.0 2.0\n"
    before, date = stored(tmp_path), file.stat()
    file.write_text(LAW.replace(old, new))
    os.utime(file, ns=(date.st_atime_ns, date.st_mtime_ns))
    assert file.stat().st_size == date.st_size
    assert run(tmp_path, code) == ("24.0 2.0\n" if "3.0" in new else "12.0 2.0\n")
    added = {Path(name).name.partition("-")[0] for name in stored(tmp_path).keys() - before.keys()}
    assert added == {"law", "twice"}
    file.write_text(LAW)
    after = stored(tmp_path)
    assert run(tmp_path, code) == "16.0 2.0\n"
    assert stored(tmp_path) == after


def test_a_constant_changed_while_running_is_not_kept(tmp_path: Path) -> None:
    """Compiled code has the constant that was there at the first call; files say what the source says."""
    copied(tmp_path, "one")
    changed = "from one.use import *; law.law(1.0); law.FACTOR = 5.0; print(twice(1.0).two)"
    run(tmp_path, changed)
    assert run(tmp_path, "from one.use import *; print(twice(1.0).two)") == "4.0\n"
    assert run(tmp_path, "from one.use import *; law.FACTOR = 5.0; print(twice(1.0).two)") == "10.0\n"


def test_processes_at_the_same_time(tmp_path: Path) -> None:
    """All get the result, and what they leave is whole: a later process compiles nothing."""
    copied(tmp_path, "one")
    code = "from one.use import *; print(twice(1.0).two)"
    assert {running.said() for running in [process(tmp_path, code) for _ in range(4)]} == {"4.0\n"}
    kept = stored(tmp_path)
    assert len(kept) == 2
    assert run(tmp_path, code) == "4.0\n"
    assert stored(tmp_path) == kept


def test_a_damaged_file_is_compiled_anew(tmp_path: Path) -> None:
    copied(tmp_path, "one")
    code = "from one.use import *; print(apart(1.0))"
    run(tmp_path, code)
    (file,) = map(Path, stored(tmp_path))
    whole = file.read_bytes()
    middle = len(whole) // 2
    changed = whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :]
    gone = b"cnowhere\nThing\n."  # names a class of another copy of the package
    for damaged in (b"", whole[:-1], changed, hashlib.sha256(gone).digest() + gone):
        file.write_bytes(damaged)
        assert run(tmp_path, code) == "2.0\n"
        assert hashlib.sha256(file.read_bytes()[32:]).digest() == file.read_bytes()[:32]
        assert file.read_bytes() != damaged


def test_what_was_not_used_of_late_goes_when_another_is_added(tmp_path: Path) -> None:
    """Once a day; a kernel that is fetched is used."""
    copied(tmp_path, "one")
    code = "from one.use import *; {0}"
    fetched = code.format("apart(1.0)")
    run(tmp_path, fetched)
    (used,) = map(Path, stored(tmp_path))
    run(tmp_path, code.format("law.law(1.0)"))
    (unused,) = (file for file in map(Path, stored(tmp_path)) if file != used)
    young = aged(unused.with_name("other-0.nbc"), KEPT_DAYS - 1)
    rest = aged(unused.with_name(f"{unused.name}.0123"), KEPT_DAYS + 1)  # of a process killed as it wrote
    aged(used, KEPT_DAYS + 1)
    aged(unused, KEPT_DAYS + 1)
    run(tmp_path, fetched)
    added = code.format("print(first(np.array([(1.0, 2.0)], {0})[0]))")
    run(tmp_path, added.format("POINT"))
    assert all(file.exists() for file in (used, unused, young, rest)), "the day is not over"
    (mark,) = tmp_path.rglob("tidied")
    aged(mark, 2.0)
    assert run(tmp_path, added.format("TURNED")) == "2.0\n"
    assert [file.exists() for file in (used, unused, young, rest)] == [True, False, True, False]


def test_constants_of_other_values_have_other_descriptions() -> None:
    """Or code would run with what was compiled for another array."""
    from models.compile.kernel_content import describe

    ones = np.ones(4)
    others = [2.0 * ones, np.ones(5), ones.reshape(2, 2), ones.astype(np.float32), (1.0,) * 4, 1.0, 1]
    assert len({describe(value) for value in [ones, *others]}) == 1 + len(others)


def test_every_kernel_of_components_and_systems_can_be_kept() -> None:
    """All that steps, outputs, energies and a system's rates refer to has a description that is equal in
    every process."""
    from models.compile.kernel_content import compute_digest

    problem = SystemProblem(valve_train(1000))
    made = [problem.evaluation.flat_outputs, problem.flat_rate, problem._end_rate]
    for component in (make() for make in CATALOGUE.values()):
        made += [component.step, component.flat_output, component.flat_energy]
    for function in [kernel.py_func for kernel in made if hasattr(kernel, "py_func")]:
        assert len(compute_digest(function)) == 64
