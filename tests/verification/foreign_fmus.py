"""FMUs from elsewhere in our master."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tests.foreign.c_fmus import fmu
from tests.foreign.models import MODELS, VICES
from tests.foreign.runs import ran, scenario

from .table import Row

PARTICIPANTS = "foreign/test_participants.py::"
VERSIONS, PROCESSES = (2, 3), ("shared", "own")


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as folder:
        yield _decay(Path(folder))
        yield _crash(Path(folder))
    yield Row(
        "what an FMU cannot do is refused before the run, by name",
        "rollback, step sizes, units, kinds of variables, platforms, a second instance",
        (
            "foreign/test_refused.py::test_what_an_fmu_cannot_do_is_refused_before_the_run",
            "foreign/test_refused.py::test_a_file_for_another_platform_is_refused",
            "foreign/test_refused.py::test_two_of_an_fmu_that_fills_its_process_take_processes_of_their_own",
        ),
        short="binary values, arrays of texts, structural parameters that must be set, clocks and event mode "
        "of other tools' FMUs are not supported (they run without event mode).",
    )


def _decay(folder: Path) -> Row:
    said = []
    for version in VERSIONS:
        for process in PROCESSES:
            table = {"participant": fmu("dahlquist", version, folder), "process": process}
            _, found = ran(scenario({"decay": table}), folder / f"{version}{process}")
            error = float(np.abs(found["decay.x"] - np.exp(-found["time"])).max())
            said.append(f"FMI {version}, process {process}: {error:.0e}")
    return Row(
        "any FMI 2 or 3 Co-Simulation FMU can be a participant in a scenario file, in-process or in a "
        "process of its own",
        f"{len(MODELS) - len(VICES)} FMUs written in C here; x' = -x against its closed form: "
        f"{'; '.join(said)}",
        (
            PARTICIPANTS + "test_decay_is_the_closed_form",
            PARTICIPANTS + "test_an_fmu_alone_does_what_it_does_in_another_master",
            PARTICIPANTS + "test_a_process_of_its_own_changes_no_bit",
            PARTICIPANTS + "test_arrays_are_their_elements",
            PARTICIPANTS + "test_inputs_follow_signals_by_the_standards_call",
        ),
        command="tribocosim run SCENARIO.toml",
    )


def _crash(folder: Path) -> Row:
    said, kept = [], True
    for vice in ("crashing", "aborting", "hanging"):
        table = {"participant": fmu(vice, 3, folder), "process": "own"}
        limits = {"call_time_limit": 5.0} if vice == "hanging" else {}
        summary, found = ran(scenario({"decay": table}, **limits), folder / vice)
        said.append(f"“{summary.message.splitlines()[0]}”, {len(found['time'])} rows kept")
        kept &= summary.exit_status == 3 and len(found["time"]) == 51
    return Row(
        "a crash of it ends the run cleanly with results kept",
        "; ".join(said),
        (
            "foreign/test_vices.py::test_the_run_ends_with_what_it_has",
            "foreign/test_vices.py::test_one_that_crashes_before_the_start_is_named",
            "foreign/test_vices.py::test_one_that_hangs_is_ended",
            "foreign/test_vices.py::test_no_process_is_left",
        ),
        short="" if kept else "not met.",
    )
