"""FMUs in Python with FMI 3, and in hosts that are not Python."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import metadata

from tests.tools.programs import libpython
from tests.tools.running import missing

from .table import Row

IMPORTERS = "fmus/test_importers.py::"


def rows() -> Iterator[Row]:
    yield Row(
        "FMI 3 Python FMUs through pythonfmu3, if it can be made correct; otherwise say why not",
        "not made: its C layer drops the start time, leaves results of fmi3DoStep unset, answers errors of "
        "the host with fmi3Fatal and takes any token; docs/fmus.md, “FMI 3.0”. FMI 3.0 FMUs are native",
        short="there are none, for faults of the packager that cannot be mended from Python.",
    )
    ready = libpython()
    yield Row(
        "pythonfmu FMUs in hosts that aren't Python: the libpython needed-entry or preload, the thread-state "
        "remedy, and no crash at exit, tested in a C host and in another importer; documented",
        f"pythonfmu {metadata.version('pythonfmu')}; a C program {'runs' if ready else 'cannot run'} here, "
        "with the library loaded before and with an FMU that loads it (`fmu build --libpython`), to the "
        "last bit, with the instance freed and kept at exit, below 1 ms a step; libcosim "
        f"{'is missing' if missing('libcosim') else 'runs'}; docs/fmus.md, “What a host needs”",
        (
            IMPORTERS + "test_c_program",
            IMPORTERS + "test_c_program_that_knows_nothing_of_python",
            IMPORTERS + "test_other_masters",
        ),
        short="" if ready else "needs a Python with a shared library.",
    )
