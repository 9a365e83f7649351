"""Workers for the points of a study: local processes, or those of a running scheduler."""

import logging
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import Any

import dask
from dask.system import CPU_COUNT
from distributed import Client, LocalCluster, Security
from distributed.comm.core import FatalCommClosedError

from models.compile.cache_folder import private_folder
from models.compile.temporary import TemporaryFolder

from ..errors import MistakeError, Option

# Workers that may die on a point before it is evaluated alone.
DEATHS = 1


@contextmanager
def connect(scheduler: str | None, workers: int | None, timeout: float) -> Iterator[Client]:
    """Open a client of `scheduler`, or of `workers` local processes (default: one for each core)."""
    # The store and our messages report all failures; dask's threads log on after the study.
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
        "distributed.worker.memory.pause": False,  # points hold no data: pausing frees no memory
        "distributed.scheduler.http.routes": [],  # no web pages for other users of this machine
        "distributed.worker.http.routes": [],
    }
    with (
        _hide_main(),
        _create_scratch() as scratch,
        dask.config.set({**settings, "temporary-directory": scratch}),
    ):
        with _block_interrupts():
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                security=Security.temporary(),  # other users cannot run code through the port
                dashboard_address="127.0.0.1:0",  # any free port
                scheduler_kwargs={"dashboard": False},  # bokeh, if installed, would show it to all
                silence_logs=logging.CRITICAL,
            )
        with cluster, Client(cluster) as client:
            yield client


@contextmanager
def _hide_main() -> Iterator[None]:
    """Processes started inside do not import the main module: a script without a guard would run anew."""
    names = sys.modules["__main__"].__dict__
    kept: dict[str, Any] = {name: names.pop(name) for name in ("__file__", "__spec__") if name in names}
    names["__spec__"] = None
    try:
        yield
    finally:
        names.update(kept)


@contextmanager
def _create_scratch() -> Iterator[str]:
    """The folder of the workers' files: in the cache, where the next start removes those of a killed one."""
    try:
        folder = private_folder("studies")
    except OSError:
        with TemporaryFolder() as temporary:
            yield str(temporary)
    else:
        yield str(folder)


@contextmanager
def _block_interrupts() -> Iterator[None]:
    """Threads and processes started inside ignore Ctrl-C, which a terminal sends to the whole group.

    A Ctrl-C that comes inside is delivered afterwards.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows has no such mask
        yield
        return
    resource_tracker.ensure_running()  # its start lifts the mask, so it comes first
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
        given = Option("scheduler", address)
        raise MistakeError((given, ": ", reason), "leave it out to use this machine") from None
    with client:
        yield client
