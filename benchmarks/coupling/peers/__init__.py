"""Other tools' masters on the same FMU files. To add one: a file with `simulate(job)`, listed here.

A peer's file stands alone: it runs as a program in a process of its own (a crash there is a row that failed
here, and no tool sees another's libraries), reads jobs as JSON lines and answers each with a line. It is
looked up when it is needed; none is a dependency.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import read_model_description

from models.core.system import System
from orchestrator.run.participants import FmuFile

from ..problem import CouplingProblem
from ..row import Row, compute_errors

PEERS = {
    "fmpy script": "fmpy_script",
    "ecos": "ecos",
    "libcosim": "libcosim",
    "OMSimulator": "omsimulator",
}
ANSWER = "ANSWER "
# A tool that hangs is given up after this time for one run.
PATIENCE_S = 120.0


def measure_peer(problem: CouplingProblem, files: Mapping[str, FmuFile], name: str) -> Iterator[Row]:
    """The peer's runs over the problem's macro steps; one row with a note if it is not there."""
    jobs = [describe_job(problem, files, step) for step in problem.held_ladder]
    module = f"{__name__}.{PEERS[name]}"
    process = subprocess.run(
        [sys.executable, "-P", "-m", module],
        input="".join(json.dumps(one) + "\n" for one in jobs),
        capture_output=True,
        text=True,
        timeout=PATIENCE_S * len(jobs),
        check=False,
    )
    answers = [line.removeprefix(ANSWER) for line in process.stdout.splitlines() if line.startswith(ANSWER)]
    for i, step in enumerate(problem.held_ladder):
        if i >= len(answers):
            said = process.stderr.strip().splitlines()
            note = f"the process ended with {process.returncode}: {said[-1] if said else 'no message'}"
            yield Row(name, step, note=note)
            return
        answer = json.loads(answers[i])
        if "missing" in answer:
            yield Row(name, step, note=f"not installed: {answer['missing']}")
            return
        yield _row(problem, name, step, answer)


def _row(problem: CouplingProblem, name: str, step: float, answer: Mapping[str, Any]) -> Row:
    if "failed" in answer:
        return Row(name, step, note=answer["failed"])
    calls = round(problem.duration / step) * len(problem.system.instances)
    values = np.array(answer["values"])
    if not np.all(np.isfinite(values)):
        return Row(name, step, calls, note="values that are not finite")
    return Row(name, step, calls, compute_errors(problem, problem.times, values))


def describe_system(system: System, paths: Mapping[str, Path]) -> dict[str, Any]:
    """A system of FMUs as plain data: files, connections, and values other than the files' own, by name."""
    values: dict[str, dict[str, Any]] = {}
    for name, instance in system.instances.items():
        known = {v.name: v for v in read_model_description(str(paths[name])).modelVariables}
        component = instance.component
        starts = {component.state.field(k).add_suffix("_start"): v for k, v in instance.start.items()}
        given = {**instance.parameters, **starts, **instance.inputs}
        values[name] = {
            key: _convert(known[key].type, value)
            for key, value in given.items()
            if value != _number(known[key].start)
        }
    return {
        "files": {name: str(path) for name, path in paths.items()},
        "values": values,
        "connections": [(str(c.source), str(c.target)) for c in system.connections],
    }


def describe_job(problem: CouplingProblem, files: Mapping[str, FmuFile], step: float) -> dict[str, Any]:
    """A run of the problem as plain data."""
    return {
        **describe_system(problem.system, {name: file.path for name, file in files.items()}),
        "outputs": list(problem.outputs),
        "step": step,
        "every": round(problem.spacing / step),
        "samples": len(problem.times),
    }


def _convert(kind: str, value: float) -> Any:
    return float(value) if kind == "Real" else bool(value) if kind == "Boolean" else int(value)


def _number(text: str) -> float:
    return float({"true": "1", "false": "0"}.get(text, text))
