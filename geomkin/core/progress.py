"""Progress of long work, for a listener, and its time limit."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from .errors import DesignError

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
