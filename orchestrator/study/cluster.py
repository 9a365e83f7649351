"""Where points are evaluated: processes of this machine, or the workers of a scheduler that runs already."""

from __future__ import annotations

import logging
import signal
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker

import dask
from dask.system import CPU_COUNT
from distributed import Client, LocalCluster, Security
from distributed.comm.core import FatalCommClosedError

from models.compile.cache_folder import private_folder

from ..errors import MistakeError

# Deaths of workers that a point may have been on. It is then judged alone, so that few are enough.
DEATHS = 1


@contextmanager
def connect(scheduler: str | None, workers: int | None, timeout: float) -> Iterator[Client]:
    """A client of the scheduler at the address, or of as many processes as there are cores."""
    # What goes wrong is in the store or in our messages; dask's come from threads that outlive the study.
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with (
        _connect_scheduler(scheduler, timeout)
        if scheduler
        else _start_cluster(workers or CPU_COUNT) as client
    ):
        yield client


@contextmanager
def _start_cluster(workers: int) -> Iterator[Client]:
    settings = {
        "distributed.scheduler.allowed-failures": DEATHS,
        "distributed.worker.memory.pause": False,  # points hold no data: a full memory ends the worker
        "distributed.scheduler.http.routes": [],  # nothing is shown to other users of this machine
        "distributed.worker.http.routes": [],
    }
    with _create_scratch() as scratch, dask.config.set({**settings, "temporary-directory": scratch}):
        with _block_interrupts():
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                security=Security.temporary(),  # others, who can reach the port, cannot run code through it
                dashboard_address="127.0.0.1:0",  # any free port: none can be taken
                silence_logs=logging.CRITICAL,
            )
        with cluster, Client(cluster) as client:
            yield client


@contextmanager
def _create_scratch() -> Iterator[str]:
    """Where workers have their files: in the cache folder, so that the next start clears up after a kill."""
    try:
        folder = private_folder("studies")
    except OSError:
        with tempfile.TemporaryDirectory(prefix="tribocosim-study-") as made:
            yield made
    else:
        yield str(folder)


@contextmanager
def _block_interrupts() -> Iterator[None]:
    """Threads and processes that start inside never see Ctrl-C, which a terminal sends to all of them:
    workers end when they are told to. One that comes meanwhile arrives afterwards."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows has no such mask
        yield
        return
    resource_tracker.ensure_running()  # which lifts the mask at its own start, before the first worker's
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _connect_scheduler(address: str, timeout: float) -> Iterator[Client]:
    try:
        client = Client(address, timeout=timeout)
    except (OSError, ValueError, TypeError, RuntimeError) as error:
        if isinstance(error, FatalCommClosedError | TypeError | RuntimeError):
            reason = f"{error}; docs/how-to/run-a-study.md shows how to name its certificate"
        elif isinstance(error, OSError):
            reason = f"no answer within {timeout:g} s; start one with 'dask scheduler'"
        else:
            reason = str(error)
        raise MistakeError(
            f"--scheduler {address}: {reason}, or leave --scheduler out to use this machine"
        ) from None
    with client:
        yield client
