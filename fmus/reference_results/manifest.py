"""Reference results that FMUs of others ship by the layered standard FMI-LS-REF: a manifest names them.

The standard says nothing of how a result is written. Reference-FMUs write arrays as numbers between spaces,
truth values as true and false, and texts as they are.
"""

import csv
import io
from collections.abc import Mapping
from pathlib import PurePosixPath
from xml.etree import ElementTree

import numpy as np
from fmpy.model_description import ModelDescription

from .files import ComparisonError, Options, Table
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
        source = str(PurePosixPath(related.get("source", "")))
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
