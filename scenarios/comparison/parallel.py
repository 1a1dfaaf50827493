"""Parallel simulation of many cases in worker processes; results come in the order of the cases."""

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from typing import TypeVar

from foreride.files.collector import import_unsearched
from foreride.scenarios.bound.simulate_case import simulate_case
from foreride.scenarios.cases import Case
from foreride.scenarios.simulation.simulate import Run

Item = TypeVar("Item")
Result = TypeVar("Result")
Advance = Callable[[Case, int], None]
"""Called with every number of ticks that a case has completed."""


class WorkerDied(RuntimeError):
    """Failure of a worker process that ended without an answer, most likely for lack of memory."""


def simulate_each(
    selected: Sequence[Case], jobs: int, keep_images: bool, advance: Advance = lambda case, ticks: None
) -> Iterator[Run]:
    """Yield the run of each case in order; `jobs` > 1 computes that many at a time.

    A run depends on its case alone, so the number of jobs changes no result. An InputError of any case ends
    all; a worker that dies raises `WorkerDied`.
    """
    if jobs == 1 or len(selected) < 2:
        for case in selected:
            yield simulate_case(case, keep_images, lambda ticks, case=case: advance(case, ticks))  # type: ignore[misc]
        return
    with _pool(simulate_case, min(jobs, len(selected))) as pool:
        waiting = [pool.submit(simulate_case, case, keep_images) for case in selected]
        try:
            for case, future in zip(selected, waiting, strict=True):
                future.add_done_callback(lambda _, case=case: advance(case, case.scenario.ticks))  # type: ignore[misc]
            for future in waiting:
                yield future.result()
        except BrokenProcessPool:
            raise WorkerDied("a worker process died; fewer --jobs take less memory") from None
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def each_result(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int, chunk: int = 1
) -> Iterator[Result]:
    """Yield `function` of each item in order, computed in `jobs` processes; it must be known by name.

    For results that are small: they are held until all before them have been computed. `chunk` neighbouring
    items are computed by the same process.
    """
    if jobs == 1 or len(items) < 2:
        yield from map(function, items)
        return
    with _pool(function, min(jobs, len(items))) as pool:
        try:
            yield from pool.map(function, items, chunksize=chunk)
        except BrokenProcessPool:
            raise WorkerDied("a worker process died; fewer --jobs take less memory") from None
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _pool(function: Callable[..., object], workers: int) -> ProcessPoolExecutor:
    """Processes for calls of a function."""
    # Spawned: forking a process whose libraries have started threads may hang.
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(workers, context, import_unsearched, (_module(function),))


def _module(function: Callable[..., object]) -> str:
    return (function.func if isinstance(function, partial) else function).__module__
