"""Properties that are kept: worked out once a thing, and by many threads side by side."""

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from geomkin.cached import cached_property


class Counted:
    def __init__(self, work=lambda: None):
        self.calls, self._work = 0, work

    @cached_property
    def answer(self):
        """What it tells."""
        self.calls += 1
        self._work()
        return [self.calls]


def test_it_is_worked_out_once_for_each_thing_until_it_is_forgotten():
    one, other = Counted(), Counted()
    assert one.answer is one.answer and one.calls == 1 and other.calls == 0
    assert one.answer == other.answer and one.answer is not other.answer
    del one.answer
    assert one.answer == [2]


def test_of_the_class_it_is_the_property_with_its_words():
    assert isinstance(Counted.answer, cached_property)
    assert Counted.answer.__doc__ == "What it tells." and Counted.answer.attrname == "answer"


def test_what_fails_is_not_kept():
    def fail():
        raise ZeroDivisionError

    one = Counted(fail)
    for _ in range(2):
        with pytest.raises(ZeroDivisionError):
            _ = one.answer
    assert one.calls == 2 and "answer" not in vars(one)


def test_two_threads_each_with_a_thing_of_its_own_do_not_wait_for_each_other():
    # Each goes on only when the other has come as far.
    meeting = threading.Barrier(2, timeout=20)
    with ThreadPoolExecutor(2) as pool:
        told = [pool.submit(lambda: Counted(meeting.wait).answer) for _ in range(2)]
        assert [one.result() for one in told] == [[1], [1]]
