"""What the compiled loop works out by itself, beside many digits."""

import itertools
import math

import numpy as np
import pytest
from mpmath import mp, mpf

from geomkin.linkage.solve.program import TapeProgram
from geomkin.linkage.solve.tape import Tape

ODD = [0.0, 1.0, 1e-300, 5e-324, 1e300, np.inf, np.nan]


@pytest.fixture(scope="module")
def angles():
    """The compiled atan2. Loaded here and not with this file, as it then works for the tests of other files, too."""
    compiled = pytest.importorskip("geomkin.linkage.solve.compiled", exc_type=ImportError)
    return lambda y, x: np.array([compiled._angle(*pair) for pair in zip(y, x)])


def test_angles_have_their_digits_all_around(angles):
    rng = np.random.default_rng(7)
    eighths = np.add.outer(np.arange(-8, 9) * np.pi / 8, [-1e-3, -1e-9, 0, 1e-15, 1e-6]).ravel()
    reported = np.concatenate([rng.uniform(-np.pi, np.pi, 3000), eighths])
    size = 10.0 ** rng.uniform(-20, 20, reported.size)
    y, x = size * np.sin(reported), size * np.cos(reported)
    found = angles(y, x)
    with mp.workdps(40):
        exact = [mp.atan2(mpf(one), mpf(other)) for one, other in zip(y.tolist(), x.tolist())]
        off = [abs(float(mpf(one) - other)) for one, other in zip(found.tolist(), exact)]
    assert (np.array(off) <= 3 * np.spacing(np.abs(found))).all()


def test_angles_of_nan_and_huge_values_equal_python(angles):
    signed = [*ODD, *(-one for one in ODD)]
    y, x = np.array(list(itertools.product(signed, signed))).T
    found, theirs = angles(y, x), np.array(list(map(math.atan2, y, x)))
    np.testing.assert_array_equal(found, theirs)
    here = ~np.isnan(theirs)
    np.testing.assert_array_equal(np.signbit(found[here]), np.signbit(theirs[here]))


def operands(kind, rng, count, none):
    """Numbers of a kind, small, large and, where asked for, none, in both parts of complex ones."""
    if kind == "b":
        return rng.random(count) < 0.5
    size = rng.choice([-1, 1], 2 * count) * 10.0 ** rng.uniform(-150, 150, 2 * count)
    odd = rng.choice([0.0, -0.0, 1.0, *([np.inf, -np.inf, np.nan] if none else [])], 2 * count)
    numbers = np.where(rng.random(2 * count) < 0.2, odd, size)
    return numbers[:count] if kind == "f" else numbers.view(complex)


def test_every_operation_of_the_loop_is_that_of_numpy():
    """One by one on rows of all kinds of numbers, longer than a block."""
    compiled = pytest.importorskip("geomkin.linkage.solve.compiled", exc_type=ImportError)
    rng, count = np.random.default_rng(5), 3 * compiled.WIDTH + 7
    kinds = {"f": float, "c": complex, "b": bool}
    for operation, of in compiled.ON_ROWS:
        tape = Tape()
        starts = [tape.start(f"{k}", kinds[kind]) for k, kind in enumerate(of)]
        # There are many rules for products of complex numbers at infinity, and for what is over zero.
        none = "c" not in of or operation not in {np.multiply, np.divide}
        given = {one.number: operands(kind, rng, count, none) for one, kind in zip(starts, of)}
        if (operation, of) == (np.divide, "cf"):
            given[1] = np.where(given[1] == 0, 3.0, given[1])
        if (operation, of) == (np.divide, "cc"):
            below, share = 10.0 ** rng.uniform([[-150], [-3]], [[150], [3]], (2, count))
            turns = np.exp(1j * rng.uniform(0, 7, (2, count)))
            given = {0: below * share * turns[0], 1: below * turns[1]}
            given[1] = np.where(rng.random(count) < 0.3, below * rng.choice([1, 1j, -1, -1j], count), given[1])
        result = tape.record(operation, starts).number
        program = TapeProgram.of(tape, [result], {result})
        assert compiled.runs(program)
        reported, found = dict(given), dict(given)
        program.run(reported, count, ())
        compiled.run(program, found, count, ())
        one, other = found[result], reported[result]
        assert one.dtype == other.dtype and one.shape == other.shape == (count,)
        if one.dtype == bool:
            assert np.array_equal(one, other), (operation, of)
            continue
        size = np.where(np.isfinite(other), np.abs(other), 0)
        for ours, theirs in ((one.real, other.real), (one.imag, other.imag)):
            known = np.isfinite(theirs)
            assert np.array_equal(np.where(known, 0, ours), np.where(known, 0, theirs), equal_nan=True), (operation, of)
            off, most = np.abs(ours[known] - theirs[known]), np.maximum(size, np.abs(theirs))[known]
            assert (off <= 6e-16 * most).all(), (operation, of)
