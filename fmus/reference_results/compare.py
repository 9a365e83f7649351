"""Runs an FMU, ours or third-party, with its reference inputs, and compares with its reference results.

Reference results that FMUs of others ship by the layered standard FMI-LS-REF: a manifest names them.

The standard says nothing of how a result is written. Reference-FMUs write arrays as numbers between spaces,
truth values as true and false, and texts as they are.
"""

import contextlib
import csv
import io
import posixpath
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from urllib.parse import quote, unquote
from xml.etree import ElementTree

import fmpy
import numpy as np
from fmpy.model_description import ModelDescription
from numpy.typing import NDArray

from fmus.fmi.archive import FmuFileError, one_line, open_archive
from fmus.fmi.validate import read_sound_description
from models.core.remedies import Option

from .files import ComparisonError, Options, Table, read_csv, read_options
from .inside import FOLDER, MANIFEST

TRUTH = {"true": "1", "false": "0"}
# Where neither file nor FMU states a tolerance: what is seen in a plot.
VISIBLE = 1e-3


def find_results(files: Mapping[str, str]) -> str:
    """The name of the CSV file with results that the manifest among `files` names; empty without one."""
    manifest = files.get(MANIFEST.removeprefix(FOLDER + "/"))
    if manifest is None:
        return ""
    if "<!DOCTYPE" in manifest:
        raise ComparisonError(f"{MANIFEST}: has a document type, which manifests do not need; leave it out")
    try:
        root = ElementTree.fromstring(manifest)
    except ElementTree.ParseError as error:
        raise ComparisonError(f"{MANIFEST}: cannot be read: {error}") from None
    for related in root.iter("Related"):
        source = posixpath.normpath(unquote(related.get("source", "")))
        if related.get("role") == "result" and source.endswith(".csv"):
            if source not in files:
                raise ComparisonError(f"{MANIFEST}: names {source}, which is not in {FOLDER}")
            return source
    return ""


def read_results(text: str, name: str) -> Table:
    """The numbers of a result, arrays by element; columns of texts are left out."""
    header, *rows = [row for row in csv.reader(io.StringIO(text)) if row] or [[]]
    if len(header) < 2 or not rows or any(len(row) != len(header) for row in rows):
        raise ComparisonError(f"{name}: must have a line of names, and as many values in each line after it")
    columns: dict[str, np.ndarray] = {}
    for name_of, *texts in zip(header, *rows, strict=True):
        try:
            values = np.array([[float(TRUTH.get(word, word)) for word in cell.split()] for cell in texts])
        except ValueError:  # texts, or arrays of changing sizes
            continue
        if values.ndim == 2 and values.shape[1] == 1:
            columns[name_of] = values[:, 0]
        elif values.ndim == 2:
            columns |= {f"{name_of}[{i + 1}]": values[:, i] for i in range(values.shape[1])}
    times = columns.pop(header[0], np.zeros(0))
    if not times.size or not columns or np.any(np.diff(times) < 0.0):
        raise ComparisonError(f"{name}: must have a time that never falls, and a variable that is a number")
    return Table(times, columns)


def state_options(described: ModelDescription, results: Table) -> Options:
    """Those of the FMU's default experiment; the step is the result's where it states none."""
    experiment = described.defaultExperiment

    def read(name: str, default: float) -> float:
        stated = getattr(experiment, name, None)
        return default if stated is None else float(stated)

    steps = np.diff(np.unique(results.times))
    step = read("stepSize", float(steps.min()) if steps.size else 0.0)
    start, stop = read("startTime", float(results.times[0])), float(results.times[-1])
    return Options(start, stop, step, read("tolerance", VISIBLE))


@dataclass(frozen=True)
class Reference:
    """What an FMU is compared with."""

    options: Options
    inputs: Table | None
    results: Table


@dataclass(frozen=True)
class Deviation:
    """The largest difference of a variable: itself, over the largest value of the reference, and when (s)."""

    variable: str
    unit: str
    largest: float
    relative: float
    time: float


@dataclass(frozen=True)
class Comparison:
    """How far each variable of an FMU was off, and what is allowed (relative)."""

    options: Options
    place: str
    tolerance: float
    deviations: Sequence[Deviation]

    @property
    def worst(self) -> Deviation:
        """The variable that is furthest off."""
        return max(self.deviations, key=lambda deviation: deviation.relative)

    @property
    def agrees(self) -> bool:
        """Whether all variables are within the tolerance (a value that is no number is not)."""
        return all(deviation.relative <= self.tolerance for deviation in self.deviations)

    def __str__(self) -> str:
        """A table for reading."""
        o = self.options
        steps = f"steps of {o.step_size:g} s" if o.step_size > 0.0 else "steps between the results"
        rows = [("variable", "largest difference", "relative", "at t (s)")]
        rows += [
            (d.variable, f"{d.largest:.2e} {d.unit}".strip(), f"{d.relative:.1e}", f"{d.time:g}")
            for d in self.deviations
        ]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        table = ("    " + "  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)
        verdict = "agrees" if self.agrees else f"DIFFERS: {self.worst.variable}"
        return "\n".join(
            [
                f"  {o.start_time:g} to {o.stop_time:g} s in {steps}; {self.place}",
                *table,
                f"    {verdict}; largest {self.worst.relative:.1e}, allowed {self.tolerance:.0e}",
            ]
        )


def compare(path: Path, tolerance: float | None = None) -> Comparison:
    """The FMU at `path` in co-simulation.

    The reference lies beside the file (`NAME_ref.csv`, `NAME_ref.opt`, and `NAME_in.csv` if there are
    inputs), or else inside it (`extra/`), also as a manifest of FMI-LS-REF names it. `tolerance` replaces
    that of the .opt file.
    ComparisonError, in one line, where there is nothing to compare with or the FMU does not run.
    """
    described = _read_description(path)
    files, place = _beside(path), "reference beside the file"
    if not files:
        files, place = _inside(path), "reference inside the file"
    try:
        own = {name: text for name, text in files.items() if not name.startswith("../")}
        related = "" if any(name.endswith("_ref.csv") for name in own) else find_results(files)
        reference = _related(related, files, described) if related else _reference(own)
        _check_variables(described, reference)
        allowed = tolerance or reference.options.tolerance
        if allowed == 0.0:
            raise ComparisonError("RelTol = 0 in the .opt file says nothing", ("give ", Option("tolerance")))
        result = _simulate(path, described, reference)
    except ComparisonError as error:
        raise ComparisonError((f"{path}: ", error)) from None
    return Comparison(reference.options, place, allowed, _deviations(described, reference.results, result))


def _read_description(path: Path) -> ModelDescription:
    try:
        described = read_sound_description(path)
    except FmuFileError as error:
        raise ComparisonError(str(error)) from None
    if described.fmiVersion == "1.0":
        raise ComparisonError(f"{path}: is of FMI 1.0, which is not run here; give one of FMI 2.0 or 3.0")
    if described.coSimulation is None:
        raise ComparisonError(
            f"{path}: is not for co-simulation, in which FMUs are compared; a scenario can integrate it"
        )
    return described


def _beside(path: Path) -> dict[str, str]:
    """Reference files that lie in the FMU's folder, by name."""
    names = [f"{path.stem}{suffix}" for suffix in ("_ref.csv", "_ref.opt", "_in.csv")]
    places = [path.parent / name for name in names]
    if not places[0].is_file():
        return {}
    return {place.name: place.read_text("utf-8", "replace") for place in places if place.is_file()}


def _inside(path: Path) -> dict[str, str]:
    """Reference files that the FMU, whose archive has no faults, ships, by name."""
    with open_archive(path) as archive:
        names = [n for n in archive.namelist() if n.endswith((".csv", ".opt", ".xml"))]
        told = archive.read(MANIFEST).decode("utf-8", "replace") if MANIFEST in names else ""
        # A manifest may name a file that has its place elsewhere, relative to its own.
        kept = [n for n in names if n.startswith(FOLDER) or (n.endswith(".csv") and quote(n) in told)]
        texts = {name: archive.read(name).decode("utf-8", "replace") for name in kept}
    return {posixpath.relpath(name, FOLDER): text for name, text in texts.items()}


def _reference(files: Mapping[str, str]) -> Reference:
    """What the files say. ComparisonError if it is missing or not as the rules say."""
    results = next((name for name in files if name.endswith("_ref.csv")), None)
    if results is None:
        raise ComparisonError(
            f"has no reference results: NAME_ref.csv must lie beside the FMU or inside it, in {FOLDER}. To "
            "know its error in a coupling, give the file as participant of a scenario, whose run is compared "
            "with the reference"
        )
    name = results.removesuffix("_ref.csv")
    chosen = f"{name}_ref.opt"
    if chosen not in files:
        raise ComparisonError(f"{chosen} is missing: it has the times and the tolerance")
    inputs = files.get(f"{name}_in.csv")
    options = read_options(files[chosen], chosen)
    return Reference(
        options=options,
        inputs=None if inputs is None else read_csv(inputs, f"{name}_in.csv"),
        results=_select_instants(read_csv(files[results], results), options, results),
    )


def _related(name: str, files: Mapping[str, str], described: ModelDescription) -> Reference:
    """The default experiment's results that a manifest names."""
    results = read_results(files[name], name)
    options = state_options(described, results)
    return Reference(options=options, inputs=None, results=_select_instants(results, options, name))


def _select_instants(results: Table, options: Options, name: str) -> Table:
    """The results within the run, without instants that stand more than once: events, where values jump."""
    instants, counts = np.unique(results.times, return_counts=True)
    near = 1e-9 * (options.stop_time - options.start_time)
    inside = np.abs(np.clip(results.times, options.start_time, options.stop_time) - results.times) <= near
    kept = inside & np.isin(results.times, instants[counts == 1])
    if np.count_nonzero(kept) < 2:
        raise ComparisonError(f"{name}: must have two instants from StartTime to StopTime at least")
    return Table(results.times[kept], {n: column[kept] for n, column in results.columns.items()})


def _check_variables(described: ModelDescription, reference: Reference) -> None:
    known = {variable.name: variable for variable in described.modelVariables}
    inputs = [(name, None) for name in (reference.inputs.columns if reference.inputs else ())]
    for name, place in [*(_find_variable(described, name) for name in reference.results.columns), *inputs]:
        if name not in known:
            raise ComparisonError(f"has no variable {name}, which its reference files name")
        array = bool(known[name].dimensions) and place is None
        if array or known[name].type in ("String", "Binary", "Clock"):
            raise ComparisonError(f"{name}, which its reference files name, is no single number")


def _find_variable(described: ModelDescription, name: str) -> tuple[str, int | None]:
    """The variable that is recorded for a column, and the place of the element where it is an array of FMI 3:
    x[2] is the second one of x."""
    stem, bracket, index = name.partition("[")
    for variable in described.modelVariables:
        if bracket and variable.name == stem and len(variable.shape or ()) == 1 and index[:-1].isdigit():
            return stem, int(index[:-1]) - 1
    return name, None


def _simulate(path: Path, described: ModelDescription, reference: Reference) -> NDArray[np.void]:
    """The run's variables over time, as fmpy gives them; an instant may stand more than once."""
    columns = (_find_variable(described, name)[0] for name in reference.results.columns)
    o, named = reference.options, list(dict.fromkeys(columns))
    times = np.unique(reference.results.times)
    with _silence() as said:
        try:
            result: NDArray[np.void] = fmpy.simulate_fmu(
                str(path),
                validate=False,
                start_time=o.start_time,
                stop_time=o.stop_time,
                output_interval=o.step_size or o.interval or float(np.min(np.diff(times))),
                fmi_type="CoSimulation",
                input=None if reference.inputs is None else reference.inputs.to_structured_array(),
                output=named,
                model_description=described,
            )
            return result
        except Exception as error:  # whatever the FMU, fmpy or the system's loader say
            last = [line for line in said.getvalue().splitlines() if "missing input" not in line][-1:]
            logged = "".join(f" ({line})" for line in last)
            raise ComparisonError(f"{one_line(error)}{logged}") from None


@contextlib.contextmanager
def _silence() -> Iterator[io.StringIO]:
    """What fmpy prints goes into a buffer: that inputs have no column, and what the FMU logs."""
    buffer = io.StringIO()
    with contextlib.redirect_stdout(buffer):
        yield buffer


def _deviations(described: ModelDescription, reference: Table, result: NDArray[np.void]) -> list[Deviation]:
    """How far each variable is off at the reference's instants; between the run's own by interpolation."""
    times = np.asarray(result["time"], dtype=np.float64)
    units = {variable.name: variable.unit or "" for variable in described.modelVariables}
    close = 1e-9 * max(abs(times[-1]), abs(times[0]))
    found = []
    for name, values in reference.columns.items():
        recorded, place = _find_variable(described, name)
        run = np.asarray(result[recorded], dtype=np.float64)
        run = run if place is None else run[:, place]
        apart = np.array(
            [_apart(t, value, times, run, close) for t, value in zip(reference.times, values, strict=True)]
        )
        worst = int(np.argmax(np.where(np.isnan(apart), np.inf, apart)))
        size = float(np.max(np.abs(values))) or 1.0
        unit = "" if units[recorded] == "1" else units[recorded]
        largest, when = float(apart[worst]), float(reference.times[worst])
        found.append(Deviation(name, unit, largest, largest / size, when))
    return found


def _apart(
    t: float, value: float, times: NDArray[np.float64], run: NDArray[np.float64], close: float
) -> float:
    """The difference at t; where the run has t more than once, at an event, the least."""
    same = np.abs(times - t) <= close
    if np.any(same):
        return float(np.min(np.abs(run[same] - value)))
    if not times[0] <= t <= times[-1]:
        return float("nan")
    return abs(float(np.interp(t, times, run)) - value)


def compare_in_process(
    paths: Sequence[Path], tolerance: float | None
) -> Iterator[tuple[Path, Comparison | ComparisonError]]:
    """What `compare` says of each file, or why nothing can be said.

    They are compared in a process of their own, so that one that crashes is an answer and not the end.
    """
    pool = _pool()
    try:
        for path in paths:
            try:
                yield path, pool.submit(compare, path, tolerance).result()
            except ComparisonError as error:
                yield path, error
            except BrokenProcessPool:
                pool.shutdown()
                pool = _pool()
                yield path, ComparisonError(f"{path}: the FMU crashed: it ended the process that ran it")
    finally:
        pool.shutdown(cancel_futures=True)


def _pool() -> ProcessPoolExecutor:
    """One worker, a fresh interpreter: a copy of this process would have its threads' locks."""
    return ProcessPoolExecutor(1, get_context("spawn"))
