"""Native FMUs against those in Python: results, speed, and a million lives."""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import fmpy
import numpy as np

from benchmarks import native as benchmark
from fmus.native.fmu import build
from fmus.native.machine_code import this_platform
from orchestrator.scenario_files import load
from orchestrator.summary import NOT_COMPARED
from tests.fmus.native import programs
from tests.fmus.native.test_c_hosts import HOSTED, arguments_of_lives
from tests.foreign.runs import recorded

from .shell import tribocosim
from .table import Row

HOSTS = "fmus/native/test_c_hosts.py::"

AGREED, FASTER, FASTER_THERE, LIVES = 1e-12, 3.0, 10.0, 1_000_000


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as folder:
        yield _revolution(Path(folder))
        yield from _lives(Path(folder))
    yield from _speed()


def _revolution(folder: Path) -> Row:
    """The coupled valve train with FMUs of each kind, every output of every macro step that is recorded."""
    length = load("valve-train").stop_time
    for kind, options in (("python", ()), ("native", ("--native",))):
        changes = ("--no-figures", "--set=reference.enabled=false", "--set=output_step=50 us")
        done = tribocosim("run", "valve-train", *options, *changes, "--out", str(folder / kind))
        assert done.status == NOT_COMPARED, done
    one, other = (recorded(folder / kind) for kind in ("python", "native"))
    worst, where = 0.0, "none"
    for name, column in one.items():
        size = np.abs(column).max() or 1.0
        difference = float(np.abs(column - other[name]).max() / size)
        if difference > worst:
            worst, where = difference, name
    steps = json.loads((folder / "native" / "summary.json").read_text("utf-8"))["macro_steps"]
    equal = all(np.array_equal(column, other[name]) for name, column in one.items())
    return Row(
        "native against Python FMU: results equal to 1e-12 relative over a cam revolution, and bit-equal to "
        "the numba kernels where the same libm is used",
        f"valve-train coupled for {length:g} s, {steps} macro steps, {len(one) - 1} outputs: "
        + ("every recorded number equal to the last bit" if equal else f"at most {worst:.1e} ({where})"),
        (
            "fmus/native/test_valve_train.py::test_both_turns_of_the_cam_are_the_same_to_the_last_bit",
            "fmus/native/test_agreement.py::test_native_fmu_equals_component",
            "fmus/native/test_fmi3.py::test_it_equals_the_component",
        ),
        command="tribocosim run valve-train --native",
        short="" if worst <= AGREED else "not met.",
    )


def _lives(folder: Path) -> Iterator[Row]:
    said = []
    host = programs.program("host", folder, True) if programs.sanitizing_compiler() else None
    for name in HOSTED if host else ():
        description = fmpy.read_model_description(str(build(name, folder, platforms=[this_platform()])))
        place = folder / name
        place.mkdir()
        library = programs.sanitized_library(name, place, 2)
        rest = arguments_of_lives(name, LIVES, description)
        began = time.perf_counter()
        programs.run([host, library, programs.TOKEN, *rest], 1800)
        said.append(f"{name} in {time.perf_counter() - began:.0f} s")
    yield Row(
        "10⁶ create/free/step/rollback cycles under valgrind or a sanitizer in the C host without a leak or "
        "an invalid access (representative part in CI)",
        f"{LIVES} lives each under the sanitizers of addresses, leaks and undefined behaviour: "
        f"{', '.join(said)}; "
        "nothing found"
        if said
        else "not run: needs gcc with its sanitizers",
        (
            HOSTS + "test_lives_under_sanitizers",
            HOSTS + "test_lives_under_valgrind",
            HOSTS + "test_instances_come_and_go_in_steady_memory",
        ),
        short="" if said else "not run.",
    )


def _speed() -> Iterator[Row]:
    for figure, value in benchmark.rows():
        way = figure.rpartition(": ")[2]
        there = "ecos" in figure
        wished = FASTER_THERE if there else FASTER
        times = float(value.partition("(")[2].partition(" x")[0] or 0.0)
        yield Row(
            f"`valve-train` at least {wished:g} times faster than with Python FMUs: {way}",
            f"macro steps/s, Python and native: {value}",
            command="python -m benchmarks native",
            short="" if times >= wished else f"{times:g} times.",
        )
