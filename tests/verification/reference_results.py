"""Reference results that ship with the FMUs."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

from fmpy.cross_check.validate_vendor_repo import validate_test_fmu

from fmus.build import NAMES
from fmus.build import build as build_python
from fmus.cross_check.compare import Comparison, compare
from fmus.cross_check.course import course_of
from fmus.cross_check.inside import FOLDER
from fmus.cross_check.layout import lay_out
from fmus.cross_check.reference import results
from fmus.native.fmu import build
from fmus.native.machine_code import this_platform

from .table import Row

TESTS = "fmus/cross_check/"


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        yield _independent()
        files = [build_python(name, folder) for name in NAMES]
        files += [
            build(name, folder, platforms=[this_platform()], fmi=fmi) for name in NAMES for fmi in (2, 3)
        ]
        yield _shipped(files, folder / "out")
        yield _reproduced(files)


def _independent() -> Row:
    found = {name: results(name, course) for name in NAMES if (course := course_of(name))}
    uncertain, name = max((max(r.uncertainty.values()), name) for name, r in found.items())
    apart, other = max((max(r.stepped.values()), name) for name, r in found.items())
    return Row(
        "reference results that do not come from the FMU",
        f"{len(found)} of {len(NAMES)} components, solved by CVODE and DOP853 with location of events: they "
        f"differ by at most {uncertain:.0e} ({name}) of an output's largest value, the component's own steps "
        f"by {apart:.0e} ({other})",
        (
            TESTS + "test_reference.py::test_shipped_results_are_what_the_physics_gives",
            TESTS + "test_reference.py::test_a_drift_of_a_millionth_in_the_physics_is_seen",
            "models/monolithic/test_driven.py::test_an_oscillator_under_a_ramp",
        ),
        command="python -m fmus.cross_check",
        short="" if len(found) == len(NAMES) else "components without.",
    )


def _shipped(files: list[Path], out: Path) -> Row:
    sizes, problems, folders = [], [], 0
    for file in files:
        name = file.stem.partition("-native")[0]
        with zipfile.ZipFile(file) as archive:
            inside = [entry for entry in archive.infolist() if entry.filename.startswith(FOLDER)]
        sizes.append(sum(entry.compress_size for entry in inside) / 1000.0)
        for folder in lay_out(name, file, file.stem, out):
            problems += validate_test_fmu(str(folder))
            folders += 1
    return Row(
        "reference results in FMI cross-check layout ship with each FMU",
        f"inside {sum(size > 0.0 for size in sizes)} of {len(files)} files (in Python, native FMI 2.0, 3.0), "
        f"{min(sizes):.1f} to {max(sizes):.1f} kB; the project's own script finds {len(problems)} problems "
        f"in the {folders} folders that `fmu cross-check` makes of them",
        (
            TESTS + "test_layout.py::test_the_projects_script_finds_nothing",
            TESTS + "test_inside.py::test_the_manifest_tells_of_every_file_and_of_no_other",
        ),
        command="tribocosim fmu cross-check --native",
        short="" if min(sizes) > 0.0 and not problems else "see the numbers.",
    )


def _reproduced(files: list[Path]) -> Row:
    found: list[tuple[Path, Comparison]] = [(file, one) for file in files for one in compare(file)]
    agreeing = sum(one.agrees for _, one in found)
    worst = {
        kind: max((one.worst.relative, file.stem) for file, one in found if one.kind == kind)
        for kind in {one.kind for _, one in found}
    }
    said = "; ".join(f"{kind} within {size:.0e} ({stem})" for kind, (size, stem) in sorted(worst.items()))
    return Row(
        "a user checks in place that an FMU gives them",
        f"{agreeing} of {len(found)} runs agree with what the files state: {said}",
        (
            TESTS + "test_compare.py::test_fmus_in_python_reproduce_their_references",
            "fmus/native/test_reference_results.py::test_fmi2",
            "fmus/native/test_reference_results.py::test_fmi3",
            TESTS + "test_compare.py::test_a_difference_is_found_in_the_variable_and_at_the_time_where_it_is",
        ),
        command="tribocosim fmu compare FILE",
        short="" if agreeing == len(found) else "not all.",
    )
