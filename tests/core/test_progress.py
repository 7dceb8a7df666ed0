"""Progress reported to a listener, inside its context; and a search's clock."""

import threading

from geomkin.core import processes as progress
from geomkin.core.processes import Watch, progress_to, report


def test_shares_are_reported_from_0_to_1_to_the_innermost_listener():
    outer, inner = [], []
    report(0.5, "nobody listens")
    with progress_to(lambda *said: outer.append(said)):
        report(-0.5, "a")
        with progress_to(lambda *said: inner.append(said)):
            report(0.25, "b")
            report(1.5, "b")
        report(1, "c")
        # Another thread has listeners of its own.
        other = threading.Thread(target=report, args=(0.5, "elsewhere"))
        other.start()
        other.join()
    report(0.5, "nobody listens any more")
    assert outer == [(0.0, "a"), (1, "c")] and inner == [(0.25, "b"), (1.0, "b")]


def test_a_watch_is_over_when_its_time_is_and_says_so_from_then_on(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(progress.time, "thread_time", lambda: now[0])
    watch, said = Watch(5.0, "looking"), []
    for at, over in ((100.0, False), (104.9, False), (105.0, True), (103.0, True)):
        now[0] = at
        # It is cut short only where it was asked and the time was over.
        assert watch.cut == (at == 103.0) and watch.over() == watch.cut == over
    with progress_to(lambda *reported: said.append(reported)):
        watch.report(0.75)
    assert said == [(0.75, "looking")]
