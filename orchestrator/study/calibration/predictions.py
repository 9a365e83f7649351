"""Predictions of a model, evaluated in parallel, and kept in a file: the same fit goes on from there."""

import hashlib
import io
import json
import pickle
import sqlite3
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from models.core.quantities import Vector

from ..execution import Call, wait_for_some
from ..source import compute_fingerprint
from .measured import Experiment
from .models import Model, Prediction, Task, evaluate, failed

FILE = "predictions.sqlite"


@dataclass(frozen=True)
class Request:
    """The number of an experiment, the values of the parameters, a neighbour's state, and what is asked."""

    experiment: int
    values: tuple[tuple[str, float], ...]
    start: Vector | None = None
    task: Task = "predict"


class Predictions:
    """Of a model for experiments. Without a dask `client` they are evaluated in this process."""

    def __init__(
        self, model: Model, experiments: Sequence[Experiment], file: sqlite3.Connection, client: Any = None
    ) -> None:
        self.model, self._experiments, self._file, self._client = model, experiments, file, client
        about = json.dumps(compute_fingerprint(model)) + model.content()
        self._about = hashlib.sha256(about.encode())
        for one in experiments:
            self._about.update(repr((one.speed, one.shaft)).encode() + one.positions.tobytes())
        self.made = 0
        file.execute("CREATE TABLE IF NOT EXISTS predictions (key TEXT PRIMARY KEY, value BLOB)")

    def make(
        self, requests: Sequence[Request], show: Callable[[float], None] = lambda share: None
    ) -> list[Prediction]:
        """Those of the file, and the others; each is kept as soon as it is known. A failure is not kept.
        `show` gets the share that is done."""
        found = {i: kept for i, one in enumerate(requests) if (kept := self._read(one))}
        waiting = [i for i in range(len(requests)) if i not in found]
        for i, prediction in self._evaluate(requests, waiting):
            found[i] = prediction
            if not prediction.message:
                self.made += 1
                self._write(requests[i], prediction)
            show(len(found) / len(requests))
        return [found[i] for i in range(len(requests))]

    def _evaluate(
        self, requests: Sequence[Request], which: Sequence[int]
    ) -> Iterator[tuple[int, Prediction]]:
        def arguments(i: int) -> tuple[Any, ...]:
            one = requests[i]
            return self.model, one.task, dict(one.values), self._experiments[one.experiment], one.start

        if self._client is None or len(which) < 2:
            for i in which:
                yield i, evaluate(*arguments(i))
            return
        from distributed import as_completed

        calls = {i: pickle.dumps(Call(evaluate, arguments(i))) for i in which}
        futures = {self._client.submit(pickle.loads, call, pure=False): i for i, call in calls.items()}
        try:
            completed, waiting = as_completed(list(futures)), dict(futures)
            while waiting:
                for future in wait_for_some(completed):
                    error = future.exception()
                    found = failed(f"the worker failed: {error}") if error else future.result()
                    yield waiting.pop(future), found
        finally:
            self._client.cancel(list(futures))

    def _key(self, request: Request) -> str:
        digest = self._about.copy()
        alone = request.start is None
        digest.update(repr((request.task, request.experiment, request.values, alone)).encode())
        return digest.hexdigest()

    def _read(self, request: Request) -> Prediction | None:
        row = self._file.execute("SELECT value FROM predictions WHERE key = ?", (self._key(request),))
        for (data,) in row:
            with np.load(io.BytesIO(data), allow_pickle=False) as kept:
                return Prediction(kept["signals"], kept["others"], kept["state"])
        return None

    def _write(self, request: Request, made: Prediction) -> None:
        data = io.BytesIO()
        np.savez_compressed(data, signals=made.signals, others=made.others, state=made.state)
        key = self._key(request)
        self._file.execute("INSERT OR REPLACE INTO predictions VALUES (?, ?)", (key, data.getvalue()))
        self._file.commit()
