"""Every analysis by its command: the numbers that it prints and the files that it writes."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import xarray

from orchestrator.analyses import load, names

from .shell import tribocosim
from .table import Row

# Promise, analysis, settings that keep it short, tests.
PROMISED = (
    ("time trace", "trace", ()),
    ("phase portrait", "phase", ()),
    ("constraint force against crank angle", "force", ()),
    ("regions I-III in (λ, ρ)", "regions", ()),
    ("Poincaré map (upper wall, with magnification windows)", "poincare", ("cycles=3000",)),
    ("impact distribution profile (F 3.6)", "profile", ("cycles=3000",)),
    ("impact spectra (F 3.7, polar)", "spectrum", ("cycles=3000",)),
    ("bifurcation diagram over any parameter", "bifurcation", ("x_count=60",)),
    ("largest-exponent map over two parameters", "exponent_map", ("x_count=15", "y_count=15")),
    ("period map over two parameters", "period_map", ("x_count=15", "y_count=15")),
    ("basins of attraction", "basins", ()),
    ("length of transient chaos", "transient", ()),
    ("wear measure (uniformity of impacts)", "wear", ("cycles=3000",)),
    ("full Lyapunov spectrum", "exponents", ()),
    ("end peaks of the cam's contact by profile", "finite_line", ()),
    (
        "end peaks and end films through the cam's cycle",
        "finite_line_cycle",
        ("instants=7", "alignment=1", "shaft_length=0.04", "end_cell=0.3"),
    ),
)


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as name:
        for promise, analysis, settings in PROMISED:
            yield _row(Path(name), promise, analysis, settings)
        yield _classified(Path(name))
    others = set(names()) - {analysis for _, analysis, _ in PROMISED} - {"classification"}
    assert not others, f"analyses without a line: {others}"


def _run(folder: Path, analysis: str, settings: tuple[str, ...]) -> tuple[xarray.Dataset, str]:
    out = folder / analysis
    said = tribocosim("analyse", analysis, "--out", str(out), *(f"--set={text}" for text in settings))
    assert said.status == 0, said
    data = xarray.load_dataset(out / f"{analysis}.nc")
    return data, ", ".join(sorted(file.name for file in out.iterdir()))


def _row(folder: Path, promise: str, analysis: str, settings: tuple[str, ...]) -> Row:
    data, files = _run(folder, analysis, settings)
    results = [name for name in load(analysis).results if name in data and data[name].ndim == 0]
    values = ", ".join(f"{name} {_shown(data[name].item())}" for name in results[:4])
    command = " ".join([f"tribocosim analyse {analysis}", *(f"--set {text}" for text in settings)])
    return Row(promise, f"{values}; {files}", command=command)


def _classified(folder: Path) -> Row:
    data, files = _run(folder, "classification", ())
    return Row(
        "classification states its evidence, not a threshold alone",
        f"“{data['evidence'].item()}”; {files}",
        (
            "models/test_classification.py::test_stable_orbit_has_the_exponent_of_its_multipliers",
            "models/test_classification.py::test_sustained_chaos_of_the_thesis",
            "models/test_classification.py::test_transient_chaos_of_the_thesis",
        ),
        command="tribocosim analyse classification",
    )


def _shown(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
