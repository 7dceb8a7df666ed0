"""What a shell shows of geomkin's things: one line of at most 120 characters that tells what it is."""

import dataclasses

import numpy as np
import pytest

from geomkin.core.reprs import LONGEST, clipped, one_line


@dataclasses.dataclass(frozen=True)
class Toy:
    what: object
    left: float = 0.5
    count: int = 1
    name: str = "toy"
    held: tuple[object, ...] = ()
    hidden: object = dataclasses.field(default=None, repr=False)
    __repr__ = one_line


def test_what_is_left_at_its_default_or_hidden_is_not_told():
    assert repr(Toy(1, 0.25, 1, "toy", (), 7)) == "Toy(what=1, left=0.25)"
    # True is no count of 1.
    assert repr(Toy(1, count=True)) == "Toy(what=1, count=True)"
    assert repr(Toy(1, left=np.zeros(2))) == "Toy(what=1, left=<2 real>)"


def test_a_line_too_long_is_cut_and_says_so():
    line = repr(Toy("x" * 90, 1 / 3, 10**30, "y" * 90, (1, 2)))
    assert len(line) == LONGEST and line.endswith("...)")
    assert len(repr(Toy(10**5000))) < LONGEST


@pytest.mark.parametrize("count", [LONGEST - 1, LONGEST, LONGEST + 1, 3 * LONGEST])
def test_a_line_is_cut_where_it_is_too_long_and_ends_as_it_did(count):
    text = "ab\n" + "x" * (count - 4) + ")"
    line = clipped(text)
    if count <= LONGEST:
        assert line == text.replace("\n", "?")
    else:
        assert len(line) == LONGEST and line.startswith("ab?xxx") and line.endswith("x...)")
    assert clipped("abcdef)", 6) == "ab...)" and clipped("abcdef", 6) == "abcdef"
