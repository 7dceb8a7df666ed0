"""Work shared among processes, one for each core."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from threading import Thread
from typing import TypeVar

T = TypeVar("T")
R = TypeVar("R")
# Fewer tasks are done in this process, since a new process takes about half a second for its imports.
FEWEST_TASKS = 8
METHOD = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"


def each(work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[R | None]:
    """Yield `work(task)` for each task, in the order of the tasks. Only the main thread may call it.

    Parameters
    ----------
    work : callable
        Can be pickled, and raises nothing.
    tasks : sequence
        A task whose process is killed, for example for want of memory, gives None.
    """
    workers = min(worker_count(), len(tasks))
    if workers < 2 or len(tasks) < FEWEST_TASKS:
        yield from map(work, tasks)
        return
    # The pool must be shut down even if the command has a handler that ends the process at once.
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield from _shared(work, tasks, workers)
    finally:
        signal.signal(signal.SIGINT, handler)


def _shared(work: Callable[[T], R], tasks: Sequence[T], workers: int) -> Iterator[R | None]:
    done = 0
    while done < len(tasks):
        pool = ProcessPoolExecutor(workers, multiprocessing.get_context(METHOD), _end_with_parent)
        try:
            for future in [pool.submit(work, task) for task in tasks[done:]]:
                yield future.result()
                done += 1
        except BrokenProcessPool:
            # Any of the running tasks may have ended its process. With one worker it is the first without a result.
            if workers == 1:
                yield None
                done += 1
            workers = 1
        except BaseException:
            for worker in multiprocessing.active_children():
                worker.terminate()
            raise
        finally:
            pool.shutdown(cancel_futures=True)


def worker_count() -> int:
    """Number of cores that this process may use; in a container they can be fewer than the machine has."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _end_with_parent() -> None:
    """In a worker: on Ctrl-C its parent ends it; if its parent is killed, it ends itself."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_wait_for_parent, daemon=True).start()


def _wait_for_parent() -> None:
    if parent := multiprocessing.parent_process():
        parent.join()
    os._exit(1)
