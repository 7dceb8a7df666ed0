"""Long work apart from requests: a search or the making of files, with progress, which can be stopped."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from threading import Event, Lock, Thread
from typing import Any

from ..core.progress import progress_to

# Jobs that are remembered; the oldest is forgotten.
MOST_JOBS = 20


class _Stopped(BaseException):
    """Raised inside the work at its next report of progress. It is no Exception, so that no work swallows it."""


class BackgroundJob:
    """Work in a thread of its own.

    Parameters
    ----------
    work : callable
        Returns the result, a dict; reports its progress as long work does.
    """

    def __init__(self, work: Callable[[], dict[str, Any]]):
        self.share, self.what = 0.0, ""
        self.result: dict[str, Any] | None = None
        self.done, self._stop = Event(), Event()
        self._work = work
        self.thread = Thread(target=self._run, daemon=True)
        self.thread.start()

    def stop(self) -> None:
        """Stop the work at its next report of progress."""
        self._stop.set()

    @property
    def state(self) -> dict[str, Any]:
        """Progress, and the result once it is there."""
        word = "stopped" if self._stop.is_set() else "done" if self.done.is_set() else "running"
        return {"state": word, "share": self.share, "what": self.what, "result": self.result}

    def _run(self) -> None:
        with progress_to(self._report), suppress(_Stopped):
            self.result = self._work()
        self.done.set()

    def _report(self, share: float, what: str) -> None:
        if self._stop.is_set():
            raise _Stopped
        self.share, self.what = share, what


class Jobs:
    """The jobs of a server, by number."""

    def __init__(self) -> None:
        self._jobs: dict[str, BackgroundJob] = {}
        self._lock, self._count = Lock(), 0

    def start(self, work: Callable[[], dict[str, Any]]) -> tuple[str, BackgroundJob]:
        """Start a job, and return its number and itself."""
        job = BackgroundJob(work)
        with self._lock:
            self._count += 1
            self._jobs[str(self._count)] = job
            while len(self._jobs) > MOST_JOBS:
                self._jobs.pop(next(iter(self._jobs))).stop()
            return str(self._count), job

    def get(self, id: str) -> BackgroundJob | None:
        """The job of this number; None if there is none."""
        return self._jobs.get(id)

    def stop_all(self, seconds: float) -> None:
        """Stop all jobs, and wait for their end, at most so many seconds in total."""
        jobs = list(self._jobs.values())
        for job in jobs:
            job.stop()
        join_all([job.thread for job in jobs], seconds)


def join_all(threads: Iterable[Thread], seconds: float) -> None:
    """Wait for the end of all threads, at most so many seconds in total."""
    end = time.monotonic() + seconds
    for thread in threads:
        thread.join(max(0.0, end - time.monotonic()))
