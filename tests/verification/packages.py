"""The FMUs as files."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

from fmus.build import NAMES, build
from tests.fmus.instance import Instance
from tests.fmus.reference import Reference, schedule
from tests.tools.programs import libpython
from tests.tools.running import missing

from .table import Row
from .validators import found

STEPS = 300


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as folder:
        files = {name: build(name, Path(folder)) for name in NAMES}
        yield _found(files)
        yield from _descriptions(files)
        yield from _states(files)
        yield from _behaviour(files)
        yield from _hosts()


def _found(files: dict[str, Path]) -> Row:
    faults, complaints = found(files.values())
    return Row(
        "`fmpy validate` and `fmutool -check` report nothing",
        f"{len(files)} FMUs: {faults} problems from fmpy and `tribocosim fmu validate`, {complaints} from "
        "fmutool",
        (
            "fmus/test_description.py::test_fmpy_finds_no_fault",
            "fmus/test_description.py::test_fmutool_finds_no_fault",
            "fmus/test_validate.py::test_our_own_are_valid",
        ),
    )


def _descriptions(files: dict[str, Path]) -> Iterator[Row]:
    variables, described = 0, 0
    for file in files.values():
        with zipfile.ZipFile(file) as archive:
            names = set(archive.namelist())
            described += {"documentation/index.html", "model.png"} <= names
            variables += archive.read("modelDescription.xml").count(b"<ScalarVariable ")
    yield Row(
        "README (equations, variable table, limits) shipped as documentation/index.html, icon",
        f"{described} of {len(files)} FMUs have both",
        (
            "fmus/test_description.py::test_every_file_that_the_standard_offers",
            "fmus/test_description.py::test_icons_are_what_the_script_draws",
        ),
    )
    yield Row(
        "units with base and display units, min, max, nominal, start, exact dependencies, InitialUnknowns, "
        "DefaultExperiment, licence, version",
        f"{variables} variables in all FMUs, compared with the components' metadata",
        (
            "fmus/test_description.py::test_every_quantity_is_described",
            "fmus/test_description.py::test_units_in_base_units",
            "fmus/test_description.py::test_display_units",
            "fmus/test_agreement.py::test_outputs_depend_on_declared_inputs_only",
        ),
    )


def _states(files: dict[str, Path]) -> Iterator[Row]:
    different, restored, resets = 0, 0, 0
    for name, file in files.items():
        reference = Reference(name)
        plan = schedule(reference.component, STEPS, 1e-5)
        one, two = Instance(file, "one").initialize(), Instance(file, "two").initialize()
        begin, saved, outputs = one.saved_bytes(), b"", []
        for i, step in enumerate(plan):
            if i == STEPS // 2:
                saved = one.saved_bytes()
            one.set(step["inputs"])
            one.step(step["t"], step["h"])
            reference.set_inputs(step["inputs"])
            reference.t = step["t"]
            reference.step(step["h"])
            outputs.append(one.outputs())
            different += outputs[-1] != reference.outputs()
        two.restore_bytes(saved)
        for i, step in enumerate(plan[STEPS // 2 :]):
            two.set(step["inputs"])
            two.step(step["t"], step["h"])
            restored += two.outputs() != outputs[STEPS // 2 + i]
        one.fmu.reset()
        one.initialize()
        resets += one.saved_bytes() != begin
        for slave in (one, two):
            slave.free()
    count = len(files) * STEPS
    yield Row(
        "in-process component and FMU agree to the last bit; variable communication step",
        f"{different} of {count} steps differ (held and varying inputs, equal and changing steps)",
        ("fmus/test_agreement.py::test_fmu_equals_component",),
        short="steps differ." if different else "",
    )
    yield Row(
        "full state save, restore and serialisation, bit-exact after any number of steps, also into a second "
        "instance; reset exact",
        f"serialised after {STEPS // 2} steps into another instance: {restored} of {count // 2} further "
        "steps "
        f"differ; {resets} of {len(files)} resets differ in a byte",
        (
            "fmus/test_state.py::test_restore_repeats_the_steps",
            "fmus/test_state.py::test_restore_in_another_instance",
            "fmus/test_state.py::test_rollback_at_any_moment",
            "fmus/test_state.py::test_reset_is_exact",
        ),
        short="states differ." if restored or resets else "",
    )


def _behaviour(files: dict[str, Path]) -> Iterator[Row]:
    slave = Instance(files["valve_spring"])
    try:
        slave.initialize(spring_rate=-3.5e4)
    except Exception as error:
        refusal = str(error).splitlines()[0]
    slave.free()
    said = next(text for _, category, text in slave.messages if category == "logStatusError")
    yield Row(
        "parameters refused with a clear message naming value and range; errors reach the host's log",
        f"“{said}” (the call: {refusal})",
        (
            "fmus/test_refusals.py::test_parameter_out_of_range",
            "fmus/test_refusals.py::test_input_that_is_no_number_discards_the_step",
            "fmus/test_refusals.py::test_instance_works_again_after_a_refusal",
        ),
        short="a refused parameter is fmi2Fatal and a refused step fmi2Discard, never fmi2Error: "
        "pythonfmu's C "
        "layer has no other answers.",
    )
    yield Row(
        "two versions of the FMUs in one process never mix code; instances can be many",
        "two versions and twenty instances",
        (
            "fmus/test_processes.py::test_two_versions_in_one_process",
            "fmus/test_processes.py::test_twenty_instances",
            "models/test_kernel_cache.py::test_closures_from_the_cache_and_from_this_process_keep_apart",
        ),
    )
    yield Row(
        "a second start from another tool is fast (no recompilation)",
        "no file of compiled code is added by a second process, unpacked elsewhere; times below",
        ("fmus/test_processes.py::test_second_start_compiles_nothing",),
    )
    yield Row(
        "runs where numba isn't installed",
        "in an interpreter where numba cannot be imported: equal to 1e-9 (rounding)",
        (
            "fmus/test_processes.py::test_without_numba",
            "models/test_plain_python.py::test_plain_python_equals_compiled_code",
        ),
    )


def _hosts() -> Iterator[Row]:
    present = {name: not missing(name) for name in ("libcosim", "ecos")}
    words = ", ".join(f"{name} {'runs' if found else 'is missing'}" for name, found in present.items())
    yield Row(
        "run in at least one importer that isn't fmpy, with equal results",
        f"where this table was made: {words}; outputs equal to the last bit",
        ("fmus/test_importers.py::test_other_masters",),
        short=""
        if all(present.values())
        else "an importer that is missing is skipped by its test (ecos needs Debian's libtbb12).",
    )
    ready = libpython()
    yield Row(
        "run in a small host that isn't Python, with equal results",
        f"C program (tests/tools/host.c): {'compiled and run' if ready else 'skipped'} where this table was "
        "made",
        ("fmus/test_importers.py::test_c_program",),
        short="" if ready else "needs a Python with a shared library.",
    )
    yield Row("the documentation says what each kind of host needs", "docs/fmus.md, “What a host needs”")
