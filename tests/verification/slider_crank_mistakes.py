"""Bad input around the slider-crank through the command line."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from .shell import tribocosim
from .table import Row

MACHINE = "models/test_bouncing.py::test_machine_out_of_range_is_refused"
COMPONENT = "models/test_slider_crank.py::test_parameters_out_of_range_are_named"
START = "models/test_bouncing.py::test_start_outside_the_walls_is_refused"


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        out = ("--out", str(folder / "none"))
        for promise, setting, parameter, test in (
            ("e outside [0, 1]", "restitution=1.2", "restitution=1.2", MACHINE),
            ("negative ρ", "gap=-0.01", "clearance=-1 mm", MACHINE),
            ("negative λ", "damping=-0.1", "joint_friction=-1", MACHINE),
            ("ξ ≥ 1", "xi=1.0", "crank_radius=0.2 m", MACHINE),
            ("start outside the walls", "psi=0.02", "psi=0.1", START),
        ):
            kind = "start" if parameter.startswith("psi") else "parameters"
            path = f"components.slider_crank.{kind}.{parameter}"
            said = [
                tribocosim("analyse", "trace", "--set", setting, *out),
                tribocosim("run", "slider-crank", "--set", path, *out),
            ]
            yield Row(
                promise, "; ".join(map(str, said)), (test, COMPONENT), command="tribocosim analyse, run"
            )
        yield from _studies(folder)


def _studies(folder: Path) -> Iterator[Row]:
    study = folder / "study.toml"
    text = 'analysis = "exponents"\n[points]\nkind = "list"\nrows = [{ %s = 0.05 }]\n'
    study.write_text(text % "dampng", "utf-8")
    yield Row(
        "a study with an unknown parameter",
        str(tribocosim("study", str(study), "--out", str(folder / "a.zarr"))),
        ("orchestrator/test_study_points.py::test_a_mistaken_study_is_one_message",),
        command="tribocosim study",
    )
    study.write_text(text % "damping", "utf-8")
    arguments = ("--scheduler", "tcp://127.0.0.1:1", "--out", str(folder / "b.zarr"))
    yield Row(
        "an unreachable scheduler",
        str(tribocosim("study", str(study), *arguments)),
        ("orchestrator/test_study.py::test_an_unreachable_scheduler_is_one_message",),
        command="tribocosim study --scheduler",
    )
