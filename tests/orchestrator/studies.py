"""Plans and stores of studies for tests."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from orchestrator.study import store as module
from orchestrator.study.files import Plan, build_subject, parse_study, resolve
from orchestrator.study.source import compute_fingerprint
from orchestrator.study.store import Store, open_store
from orchestrator.study.task import Outcome, evaluate

PLAIN, PICKY = (f"tests.orchestrator.known_analyses:{name}" for name in ("PLAIN", "PICKY"))
VERSIONS = {"tribocosim": "1234", "numba": "0.60"}


def refuse_build(name: str, structure: Any, kind: str = "") -> Path:
    raise AssertionError("no FMU is built here")


def plan_study(points: dict[str, Any], analysis: str | None = PLAIN, **study: Any) -> Plan:
    content = {"name": "test", "analysis": analysis, "points": points} | study
    study = parse_study(content)
    return resolve(study, build_subject(study, Path(), refuse_build))


def plan_scenario(points: dict[str, Any], **study: Any) -> Plan:
    return plan_study(points, None, scenario="valve-train", **study)


def compute_outcome(plan: Plan, index: int) -> Outcome:
    found = evaluate(plan.subject, plan.points[index], compute_fingerprint(plan.subject))
    assert isinstance(found, Outcome)
    return found


@contextlib.contextmanager
def open_small_chunks(path: Path, plan: Plan, overwrite: bool = False) -> Iterator[Store]:
    """A store with four points in a chunk."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "CHUNK", 4)
        with open_store(path, plan, VERSIONS, overwrite) as store:
            yield store


def fill_store(path: Path, plan: Plan) -> Path:
    """A store with the outcomes of all points."""
    with open_small_chunks(path, plan) as store:
        for index in store.pending():
            store.record(index, compute_outcome(plan, index))
        store.flush()
    return path


def read_files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
