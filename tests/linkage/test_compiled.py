"""What the compiled loop works out by itself, beside many digits."""

import itertools
import math

import numpy as np
import pytest
from mpmath import mp, mpf

ODD = [0.0, 1.0, 1e-300, 5e-324, 1e300, np.inf, np.nan]


@pytest.fixture(scope="module")
def angles():
    """The compiled atan2. Loaded here and not with this file, as it then works for the tests of other files, too."""
    compiled = pytest.importorskip("geomkin.linkage.solve.compiled", exc_type=ImportError)
    return lambda y, x: np.array([compiled._angle(*pair) for pair in zip(y, x)])


def test_angles_have_their_digits_all_around(angles):
    rng = np.random.default_rng(7)
    eighths = np.add.outer(np.arange(-8, 9) * np.pi / 8, [-1e-3, -1e-9, 0, 1e-15, 1e-6]).ravel()
    told = np.concatenate([rng.uniform(-np.pi, np.pi, 3000), eighths])
    size = 10.0 ** rng.uniform(-20, 20, told.size)
    y, x = size * np.sin(told), size * np.cos(told)
    found = angles(y, x)
    with mp.workdps(40):
        exact = [mp.atan2(mpf(one), mpf(other)) for one, other in zip(y.tolist(), x.tolist())]
        off = [abs(float(mpf(one) - other)) for one, other in zip(found.tolist(), exact)]
    assert (np.array(off) <= 3 * np.spacing(np.abs(found))).all()


def test_angles_of_what_is_none_or_out_of_all_bounds_are_those_of_python(angles):
    signed = [*ODD, *(-one for one in ODD)]
    y, x = np.array(list(itertools.product(signed, signed))).T
    found, theirs = angles(y, x), np.array(list(map(math.atan2, y, x)))
    np.testing.assert_array_equal(found, theirs)
    here = ~np.isnan(theirs)
    np.testing.assert_array_equal(np.signbit(found[here]), np.signbit(theirs[here]))
