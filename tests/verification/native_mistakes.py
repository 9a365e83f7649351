"""Bad input to native FMUs: the status, and what is said."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator
from pathlib import Path

import fmpy

from fmus.native.fmu import build
from fmus.native.machine_code import this_platform
from tests.fmus.native import programs
from tests.fmus.native.test_c_hosts import PROGRAMS, arguments_of_fuzz, token_of
from tests.fmus.native.test_misuse import MISUSES, STATUSES, Host

from .table import Row

MISUSE = "fmus/native/test_misuse.py::"
REFUSALS = "fmus/native/test_fmi3_refusals.py::"
HOSTS = "fmus/native/test_c_hosts.py::"
CALLS = 300_000

# By promise: misuses of docs/native.md, and tests with FMI 3.0.
PROMISED = {
    "wrong types": (("a variable of another type",), ("test_wrong_types",)),
    "unknown value references": (
        ("unknown value reference",),
        ("test_unknown_references_and_numbers_of_values",),
    ),
    "NaN inputs": (("NaN or infinity set",), ("test_values_that_cannot_be",)),
    "steps backwards": (("a step backwards, or from elsewhere",), ("test_steps_that_cannot_be_made",)),
    "negative steps": (("a negative step", "a step of NaN"), ("test_steps_that_cannot_be_made",)),
    "calls in the wrong state": (("a call in the wrong phase",), ("test_calls_in_the_wrong_state",)),
    "damaged serialised state": (
        (
            "a damaged serialised state",
            "a truncated serialised state",
            "a serialised state of another FMU or version",
        ),
        ("test_damaged_states",),
    ),
    "wrong instantiation token": (("wrong GUID",), ("test_a_wrong_token",)),
}


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as folder:
        here = Path(folder)
        place = programs.library_in(build("valve_spring", here, platforms=[this_platform()]), here / "spring")
        for promise, (misuses, tests) in PROMISED.items():
            said = "; ".join(_answer(Host(*place), misuse) for misuse in misuses)
            yield Row(promise, said, (MISUSE + "test_answer", *(REFUSALS + test for test in tests)))
        yield _random(here)


def _answer(host: Host, misuse: str) -> str:
    host.said.clear()
    status = MISUSES[misuse](host)
    # Tokens change with every change of the code.
    words = " / ".join(re.sub(r"\{.*?\}", "{…}", text) for _, text in host.said)
    if host.instance:
        host.free()
    return f"{STATUSES[status]}, “{words}”"


def _random(folder: Path) -> Row:
    """Any function with any arguments, in the C hosts, under sanitizers where gcc has them."""
    said, count = [], 0
    sanitized = programs.sanitizing_compiler() is not None
    for fmi, source in PROGRAMS.items():
        program = programs.program(source, folder, sanitized)
        for name in ("valve_spring", "slider_crank"):
            file = build(name, folder, platforms=[this_platform()], fmi=fmi)
            place = folder / f"{name}{fmi}"
            place.mkdir()
            if sanitized:
                library, token = programs.sanitized_library(name, place, fmi), programs.TOKEN
                description = fmpy.read_model_description(str(file))
            else:
                library, description = programs.library_in(file, place)
                token = token_of(description)
            rest = arguments_of_fuzz(description, place, 7, CALLS)
            programs.run([program, library, token, *rest], 1800)
            said.append(f"{name} FMI {fmi}")
            count += CALLS
    return Row(
        "never a crash (fuzz the C interface)",
        f"{count} calls of random functions with random arguments ({', '.join(said)}), "
        + ("under sanitizers of addresses, leaks and undefined behaviour" if sanitized else "plain")
        + ": none crashed, none changed what it refused",
        (
            HOSTS + "test_random_calls",
            HOSTS + "test_random_calls_under_sanitizers",
            HOSTS + "test_random_calls_under_valgrind",
            REFUSALS + "test_no_sequence_of_calls_brings_it_down",
        ),
        short="" if sanitized else "without sanitizers: needs gcc.",
    )
