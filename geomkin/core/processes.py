"""Work done by this process, shared among processes, one for each core, or given to an executor."""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from contextvars import ContextVar
from functools import partial
from itertools import islice
from threading import Thread
from typing import Protocol, TypeVar

from .errors import DesignError, GeomkinError, printable

T = TypeVar("T")
R = TypeVar("R")
# Fewer tasks than these are not worth new processes, each of which takes about half a second for its imports.
FEWEST_TASKS = 8
# Largest number of tasks that wait in an executor. A smaller one leaves a large cluster idle; a larger one fills its
# memory.
MOST_WAITING = 256
METHOD = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"


class Runner(Protocol):
    """Does work on each task; yields the number of the task and its result, in any order. None if it was killed."""

    def __call__(self, work: Callable[[T], R], tasks: Sequence[T], /) -> Iterator[tuple[int, R | None]]: ...


def by_this_process(work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[int, R | None]]:
    """Do the tasks one after another."""
    yield from enumerate(map(work, tasks))


def by_processes(
    work: Callable[[T], R], tasks: Sequence[T], fewest: int = FEWEST_TASKS
) -> Iterator[tuple[int, R | None]]:
    """Do the tasks on all cores, for the command: each process starts the main program again."""
    yield from enumerate(each(work, tasks, fewest))


def by(executor: Executor | None) -> Runner:
    """Do the tasks by an executor, in which a limited number wait; without one, by this process."""
    return by_this_process if executor is None else partial(_by_executor, executor)


def _by_executor(executor: Executor, work: Callable[[T], R], tasks: Sequence[T], /) -> Iterator[tuple[int, R | None]]:
    waiting: dict[Future[R], int] = {}
    remaining = iter(enumerate(tasks))
    try:
        while True:
            for index, task in islice(remaining, MOST_WAITING - len(waiting)):
                waiting[executor.submit(work, task)] = index
            if not waiting:
                return
            done = wait(waiting, return_when=FIRST_COMPLETED).done
            # Results first, so that they are used before an error is raised.
            for future in sorted(done, key=lambda future: future.exception() is not None):
                yield waiting.pop(future), future.result()
    except GeomkinError:
        raise
    except Exception as error:
        problem = f"it failed ({type(error).__name__}: {printable(error, 200)})"
        remedy = "check the executor; results that were written remain"
        raise DesignError("executor", problem, remedy, "internal") from error
    finally:
        for future in waiting:
            future.cancel()


def each(work: Callable[[T], R], tasks: Sequence[T], fewest: int = FEWEST_TASKS) -> Iterator[R | None]:
    """Yield `work(task)` for each task, in the order of the tasks. Only the main thread may call it.

    Parameters
    ----------
    work : callable
        Can be pickled, and raises nothing.
    tasks : sequence
        A task whose process is killed, for example for want of memory, gives None.
    fewest : int
        Fewer tasks are done in this process.
    """
    workers = min(worker_count(), len(tasks))
    if workers < 2 or len(tasks) < fewest:
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


# The listener to work inside `shown`, in the same thread.
_listener: ContextVar[Callable[[float, str], None] | None] = ContextVar("listener", default=None)


@contextmanager
def progress_to(listener: Callable[[float, str], None]) -> Iterator[None]:
    """Within this context `listener` is called with the share of long work that is done, 0 to 1, and its name."""
    before = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(before)


def report(share: float, what: str) -> None:
    """Report the share of long work that is done, 0 to 1; the last report is 1."""
    if listener := _listener.get():
        listener(min(max(share, 0.0), 1.0), what)


class Watch:
    """The clock of a search: it reports progress, and whether the time limit has passed.

    time_limit: s of the thread's processor time, from now on, so that other programs do not shorten a search. A search
    ends by itself when it has converged or tried all starts, so that its result depends only on its seed; the time
    limit is for the case that this takes too long.
    """

    def __init__(self, time_limit: float, what: str):
        self.time_limit, self.end, self.what, self.cut = time_limit, time.thread_time() + time_limit, what, False

    def over(self) -> bool:
        """Whether the time is over; `cut` then records that the search was cut short."""
        self.cut = self.cut or time.thread_time() >= self.end
        return self.cut

    def too_short(self) -> DesignError:
        """The error of a search that was cut short before its first result."""
        problem = f"no linkage was found in {self.time_limit:g} s"
        return DesignError("time_limit", problem, "give a longer time, such as twice as much", "out-of-range")

    def report(self, share: float) -> None:
        """Report the share of the search that is done, 0 to 1; the last report is 1."""
        report(share, self.what)
