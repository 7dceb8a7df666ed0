"""Work on all cores: copies of this process, made when it has loaded what the work takes, which end when it ends."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, TypeVar, cast

from .progress import shown

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.context import ForkProcess


T = TypeVar("T")
R = TypeVar("R")
# Tasks from which copies are worth their start, some 20 ms: with fewer, hardly any is left when the first is done.
MANY = 4
# What ends this process, and its copies with it.
ENDS = (signal.SIGINT, signal.SIGTERM)


def each(
    work: Callable[[T], R], tasks: Sequence[T], begun: Callable[[T], None] = lambda _: None
) -> Iterator[tuple[int, R | None]]:
    """The number of each task and what `work` makes of it, as they come; None where its process was killed.

    The first is done here, which loads what it needs; the rest by copies of this process, one for each core that it
    may use, or here, where there is one core, few tasks, or a system or a library that does not bear copying.
    work: raises nothing. begun: called here with each task that is taken up. For the main thread.
    """
    for number, task in enumerate(tasks[:1]):
        begun(task)
        yield number, work(task)
    most = min(_cores(), len(tasks) - 1)
    if len(tasks) >= MANY and most > 1 and _can_be_copied():
        yield from _shared(work, tasks, begun, most)
        return
    for number, task in enumerate(tasks[1:], 1):
        begun(task)
        yield number, work(task)


def _cores() -> int:
    """Those that this process may use, which in a container are fewer than there are."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1


def _can_be_copied() -> bool:
    """A copy has this thread only: what a library left to another would be waited for without end."""
    try:
        return sys.platform == "linux" and len(os.listdir("/proc/self/task")) == 1
    except OSError:
        return False


def _shared(
    work: Callable[[T], R], tasks: Sequence[T], begun: Callable[[T], None], most: int
) -> Iterator[tuple[int, R | None]]:
    """All but the first task, dealt out one by one to so many copies."""
    from multiprocessing.connection import wait

    copies: dict[Connection, ForkProcess] = {}
    busy: dict[Connection, int] = {}
    left = iter(range(1, len(tasks)))

    def deal(connection: Connection) -> None:
        number = next(left, None)
        if number is None:
            connection.close()
            copies.pop(connection).join()
        else:
            begun(tasks[number])
            connection.send(number)
            busy[connection] = number

    with _ending_with_us(copies):
        for _ in range(most):
            deal(_copied(work, tasks, copies))
        while busy:
            for connection in cast("list[Connection]", wait(list(busy))):
                number = busy.pop(connection)
                try:
                    result = connection.recv()
                except (EOFError, OSError):
                    # It was killed: most likely for want of memory. Another takes its place.
                    connection.close()
                    copies.pop(connection).join()
                    yield number, None
                    deal(_copied(work, tasks, copies))
                    continue
                deal(connection)
                yield number, result


def _copied(work: Callable[[Any], Any], tasks: Sequence[Any], copies: dict[Connection, ForkProcess]) -> Connection:
    """Starts a copy, and adds it under the connection by which it takes numbers of tasks."""
    from multiprocessing import get_context

    context = get_context("fork")
    ours, its = context.Pipe()
    copy = context.Process(target=_serve, args=(work, tasks, its, [ours, *copies]), daemon=True)
    # A copy that is interrupted before it has let go of this process's handlers would lose that, and outlive us.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDS)
    try:
        copy.start()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    its.close()
    copies[ours] = copy
    return ours


def _serve(work: Callable[[Any], Any], tasks: Sequence[Any], connection: Connection, others: list[Connection]) -> None:
    """In a copy: works on tasks by number until none comes any more, be it that the one that deals them is gone."""
    for number in ENDS:
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDS)
    # While a copy holds these ends, no other would see that nobody deals any more.
    for other in others:
        other.close()
    try:
        with shown(lambda *_: None):
            while True:
                connection.send(work(tasks[connection.recv()]))
    except (EOFError, OSError):
        return


class _ending_with_us:  # noqa: N801  # reads as what it does
    """Within, an interrupt ends the copies first, as an interrupt: files that they are writing become whole."""

    def __init__(self, copies: dict[Connection, ForkProcess]):
        self.copies = copies
        self.before: dict[int, Any] = {}

    def __enter__(self) -> None:
        for number in ENDS:
            self.before[number] = signal.signal(number, self._end)

    def __exit__(self, *_: object) -> None:
        self._interrupt()
        for number, handler in self.before.items():
            signal.signal(number, handler)

    def _interrupt(self) -> None:
        for copy in self.copies.values():
            if copy.pid and copy.is_alive():
                os.kill(copy.pid, signal.SIGINT)
        for copy in self.copies.values():
            copy.join()

    def _end(self, number: int, frame: Any) -> None:
        self._interrupt()
        handler = self.before[number]
        signal.signal(number, handler)
        if callable(handler):
            handler(number, frame)
        os.kill(os.getpid(), number)
