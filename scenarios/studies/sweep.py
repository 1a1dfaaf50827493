"""Execution of a study on a Dask cluster: local, reached by an address, or started by a recipe."""

from __future__ import annotations

import asyncio
import json
import os
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent import futures
from contextlib import chdir, contextmanager
from itertools import islice
from typing import TYPE_CHECKING, Any

from foreride.files.errors import InputError, shown
from foreride.files.extras import install_command
from foreride.files.writing.sharing import shared_name, shared_target, without_folders
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.comparison.document import flat
from foreride.scenarios.comparison.parallel import WorkerDied
from foreride.scenarios.runs.write import row, to_json
from foreride.scenarios.studies.recipes import Recipe, start
from foreride.scenarios.studies.results import Results
from foreride.scenarios.studies.study import Sample

if TYPE_CHECKING:  # the extra `sweep`
    from distributed import Client, Future

QUEUED_PER_WORKER = 4
"""Drives submitted per worker thread: enough to keep it busy, few enough to stop quickly."""
REACH_S = 10
PATIENCE_S = 120
"""Time without any result after which the cluster is asked whether it has workers, s."""
LOOPBACK = "127.0.0.1:0"
_CANCELLED = (futures.CancelledError, asyncio.CancelledError)

_SIMULATION_LOCK = threading.Lock()
"""Prediction models are shared within a process, so worker threads must take turns."""


def simulate_sample(sample: Sample, folder: str = ".") -> dict[str, Any]:
    """Simulate one sample on a worker; return its row or its error. Compiled models stay in the process.

    folder: the one in which the study was read and its relative paths hold; a worker may run in another.
    """
    try:
        with _SIMULATION_LOCK, chdir(folder):
            columns = json.loads(to_json(flat(row(simulate_case(sample.case())))))
        return sample_columns(sample, None) | columns
    except Exception as error:  # any failure of a case is its result
        return sample_columns(
            sample, without_folders(f"{type(error).__name__}: {' '.join(str(error).split())}")
        )


def sample_columns(sample: Sample, error: str | None) -> dict[str, Any]:
    """Common columns of every row: key, error and inputs."""
    settings = {f"set.{path}": value for path, value in sample.point}
    names = {"scenario": shared_name(sample.scenario), "controller": shared_target(sample.controller)}
    drive = {"perception": sample.perception, "seed": sample.seed}
    return {"key": sample.key, "error": error, **names, **drive, **settings}


def run(
    client: Client, samples: Sequence[Sample], results: Results, advance: Callable[[], None] = lambda: None
) -> None:
    """Run all samples; each row is in `results` before `advance` is called. The order is arbitrary.

    The drives of a worker that dies are given to others; one that kills its worker four times is recorded as
    failed. Raises `WorkerDied` if no worker is left, or the scheduler is gone.
    """

    waiting, folder = iter(samples), os.getcwd()
    submitted: dict[str, Sample] = {}

    def hand_out(count: int) -> list[Future]:
        submitted_futures = []
        for sample in islice(waiting, count):
            key = f"foreride-{sample.key}"
            future = client.submit(simulate_sample, sample, folder=folder, key=key, pure=False)
            submitted[str(future.key)] = sample
            submitted_futures.append(future)
        return submitted_futures

    running = set(hand_out(QUEUED_PER_WORKER * max(1, _threads(client))))
    while running:
        finished, running = _wait(client, running)
        for future in finished:
            sample, problem = submitted.pop(str(future.key)), future.exception()
            failure_row = sample_columns(sample, f"{type(problem).__name__}: {problem}")
            results.add(future.result() if problem is None else failure_row)
            advance()
        running |= set(
            hand_out(QUEUED_PER_WORKER * max(1, _threads(client)) - len(running))
        )  # more may have come


def _wait(client: Client, running: set[Future]) -> tuple[set[Future], set[Future]]:
    """Wait for results; return the finished futures, at least one, and the others."""
    from distributed import wait

    while True:
        try:
            done, others = wait(running, timeout=PATIENCE_S, return_when="FIRST_COMPLETED")
            if any(future.status in ("cancelled", "lost") for future in done):
                raise WorkerDied("the scheduler is gone")
            return done, others
        except TimeoutError:
            if not _threads(client):
                raise WorkerDied("no worker is left") from None
        except _CANCELLED:
            raise WorkerDied("the scheduler is gone") from None


def _wait_for_workers(client: Client, recipe: Recipe) -> None:
    """Wait for the first worker of a recipe; the others join when they come."""
    try:
        client.wait_for_workers(1, timeout=recipe.wait_s)
    except TimeoutError:
        raise WorkerDied(f"no worker of the {recipe.kind} cluster came within {recipe.wait_s:g} s") from None


def _threads(client: Client) -> int:
    """Threads of all workers; none if the scheduler does not answer."""
    try:
        return sum(client.nthreads().values())
    except (OSError, TimeoutError, *_CANCELLED):
        return 0


@contextmanager
def cluster(
    address: str | None, workers: int, dashboard: str = LOOPBACK, recipe: Recipe | None = None
) -> Iterator[Client]:
    """Connect to the cluster at `address`, or start that of a recipe or `workers` processes on this machine.

    A cluster of this machine talks over the loopback interface only; its dashboard listens at `dashboard`.
    """
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise InputError(f"sweep needs Dask: {install_command('sweep')}") from None
    host, _, port = dashboard.rpartition(":")
    if not host or not (port.isascii() and port.isdigit()) or int(port) > 65535:
        raise InputError(f"--dashboard: must be HOST:PORT, such as 0.0.0.0:8787, got {shown(dashboard)}")
    if address is not None:
        try:
            client = Client(address, timeout=REACH_S)
        except (OSError, ValueError) as error:
            reason = " ".join(str(error).split()) or type(error).__name__
            raise InputError(f"--scheduler {address}: cannot be reached ({reason})") from None
        with client:
            yield client
        return
    if recipe is not None:
        with start(recipe) as started, Client(started) as client:
            _wait_for_workers(client, recipe)
            yield client
        return
    with (
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address=dashboard,
            worker_dashboard_address=LOOPBACK,
            silence_logs=50,
        ) as local,
        Client(local) as client,
    ):
        yield client
