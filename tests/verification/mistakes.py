"""Bad input through the command line: what is said, and the exit status."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from fmus.build import build
from tests.orchestrator.commands import IN_PROCESS
from tests.orchestrator.test_fmu_commands import BROKEN, _escaping, _tampered, _truncated

from .shell import summary, tribocosim
from .table import Row

CLI = "orchestrator/test_command_line.py::"
FMUS = "orchestrator/test_fmu_commands.py::"
SCENARIO = "orchestrator/test_scenario.py::"
MISTAKE = SCENARIO + "test_a_mistake_is_one_message_that_names_it"
IMPOSSIBLE = SCENARIO + "test_an_impossible_system_is_one_message"

SETTINGS = (
    ("unknown keys", ("macro_stp=1e-6", "components.camshaft.parameters.lft=1"), MISTAKE),
    ("wrong units", ("macro_step=3 kg", "components.camshaft.parameters.lift=3 kg"), MISTAKE),
    ("wrong types", ("stop_time=[1]", "components.camshaft.parameters.lift=true"), MISTAKE),
    ("non-positive masses", ("components.valve_spring.parameters.valve_mass=-0.2",), IMPOSSIBLE),
    ("non-positive steps", ("macro_step=0", "macro_step=-1"), MISTAKE),
)
CONNECTIONS = (
    ("missing variables", "camshaft.lift -> contact.approach"),
    ("two sources for one input", "camshaft.cam_lift -> contact.approach"),
    ("wrong units of a connection", "camshaft.cam_lift -> flywheel.drive_torque"),
)


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        yield from _scenario(folder)
        yield from _files(folder)
        yield from _failing(folder)
        yield from _ending(folder)


def _row(promise: str, said: list[str], *tests: str, short: str = "") -> Row:
    return Row(promise, "; ".join(said), tests, command="tribocosim run", short=short)


def _scenario(folder: Path) -> Iterator[Row]:
    out = ("--out", str(folder / "none"))
    for promise, settings, test in SETTINGS:
        yield _row(promise, [str(tribocosim("run", "valve-train", "--set", s, *out)) for s in settings], test)
    for promise, connection in CONNECTIONS:
        file = folder / "bad.toml"
        file.write_text(f'extends = "valve-train"\nconnections = ["{connection}"]\n')
        said = str(tribocosim("run", str(file), *out))
        yield _row(promise, [said], SCENARIO + "test_a_bad_connection_is_one_message")


def _with(file: Path) -> list[str]:
    others = [text for text in IN_PROCESS if "camshaft" not in text]
    return ["--set=stop_time=2 ms", *others, f"--set=components.camshaft.participant={file}"]


def _files(folder: Path) -> Iterator[Row]:
    camshaft, spoilt = build("camshaft", folder), folder / "spoilt.fmu"
    out = ("--out", str(folder / "refused"), "--overwrite")
    test = FMUS + "test_a_damaged_or_foreign_fmu_is_refused"
    _truncated(camshaft, spoilt)
    foreign = build("flywheel", folder / "foreign.fmu")
    said = [str(tribocosim("run", "valve-train", *_with(f), *out)) for f in (spoilt, foreign)]
    yield _row(
        "a damaged or foreign .fmu", said, test, "fmus/test_validate.py::test_damage_anywhere_is_found"
    )
    _escaping(camshaft, spoilt)
    said = [str(tribocosim("run", "valve-train", *_with(spoilt), *out))]
    yield _row("an archive with paths outside itself", said, test)


def _failing(folder: Path) -> Iterator[Row]:
    camshaft = build("camshaft", folder)
    words = {
        "raises": "an FMU that returns an error in mid-run",
        "discards": "an FMU that discards a step in mid-run",
        "nan": "an FMU that yields NaN in mid-run",
    }
    for kind, promise in words.items():
        file, out = _tampered(camshaft, folder / f"{kind}.fmu", BROKEN[kind][0]), folder / kind
        said = tribocosim("run", "valve-train", "--out", str(out), *_with(file))
        kept = summary(out)
        state = f"{kept['macro_steps']} steps kept, complete: {kept['complete']}"
        short = "" if "reduce macro_step" in said.message else "the message names no remedy. "
        short += "The FMU itself says nothing." if "no message" in said.message else ""
        yield _row(
            promise, [f"{said}; {state}"], FMUS + "test_an_fmu_that_fails_in_mid_run_is_named", short=short
        )


def _ending(folder: Path) -> Iterator[Row]:
    out = folder / "out"
    long = ["--set=stop_time=100 s", "--set=output_step=1 ms", *IN_PROCESS]
    said = tribocosim("run", "valve-train", "--out", str(out), *long, interrupt_after="coupled run")
    kept = summary(out)
    again = str(tribocosim("run", "valve-train", "--out", str(out)))
    yield _row(
        "an output folder that already holds a result",
        [again],
        CLI + "test_an_existing_result_is_kept_unless_told",
    )
    yield _row(
        "Ctrl-C; what was computed so far is kept and marked incomplete",
        [f"{said}; {kept['macro_steps']} steps kept, complete: {kept['complete']}"],
        CLI + "test_ctrl_c_keeps_what_was_computed",
        "orchestrator/test_results.py::test_what_was_flushed_survives_a_killed_process",
    )
