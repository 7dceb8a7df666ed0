"""Long work: how far it is, for whoever watches, and when it must end."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

# Who is told; only of work inside `shown`, in the same thread.
_listener: ContextVar[Callable[[float, str], None] | None] = ContextVar("listener", default=None)


@contextmanager
def shown(listener: Callable[[float, str], None]) -> Iterator[None]:
    """Within, `listener` is told the share of long work that is done, 0 to 1, and what it is."""
    before = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(before)


def tell(share: float, what: str) -> None:
    """Say that so much of long work is done, 0 to 1; it ends with 1."""
    if listener := _listener.get():
        listener(min(max(share, 0.0), 1.0), what)


class Watch:
    """A search's clock. It says how far the search is, and when its time is over.

    seconds: of wall time from now on. A search stops of itself when it has converged or tried what it was to try, so
    that its answer hangs on its seed alone; the time is there for the case that this takes longer than anyone waits.
    """

    def __init__(self, seconds: float, what: str):
        self.end, self.what, self.cut = time.monotonic() + seconds, what, False

    def over(self) -> bool:
        """Whether time is over; then the search was cut short, which `cut` tells from then on."""
        self.cut = self.cut or time.monotonic() >= self.end
        return self.cut

    def tell(self, share: float) -> None:
        """Say that so much of the search is done, 0 to 1; it ends with 1."""
        tell(share, self.what)
