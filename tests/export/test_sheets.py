"""How parts lie on a sheet, and what a column of a table shows."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.cut import cut
from geomkin.export.layout import lay_out


def sheet_of(width, height, count):
    return lay_out(
        [
            cut(
                gk.Part(
                    "plate",
                    gk.plane.rounded_hull([0, width, width + 1j * height, 1j * height], 1),
                    (),
                    3.0,
                    count=count,
                ),
                0.01,
            )
        ]
    )


@pytest.mark.parametrize(("width", "height"), [(200, 10), (10, 200), (60, 60)])
def test_a_sheet_of_many_is_about_as_wide_as_it_is_high_whatever_they_are(width, height):
    sheet = sheet_of(width, height, 60)
    assert 0.6 < sheet.width / sheet.height < 2
    boxes = np.array([placed.loops[-1].box for placed in sheet.placed])
    low, high = boxes.T
    assert (
        low.real.min() > 0 and low.imag.min() > 0 and high.real.max() < sheet.width and high.imag.max() < sheet.height
    )
    for k in range(len(boxes)):
        apart = (
            (low.real > high.real[k])
            | (high.real < low.real[k])
            | (low.imag > high.imag[k])
            | (high.imag < low.imag[k])
        )
        assert apart.sum() == len(boxes) - 1


def test_small_parts_lie_beside_each_other_as_far_as_a_long_one_reaches():
    """Beside a high one they lie in a sheet that is about square."""
    long, high, small = (gk.Part(name, gk.plane.rounded_hull([0, w, w + 1j * h, 1j * h], 1), (), 3.0, count=count)
                         for name, w, h, count in (("long", 500, 5, 1), ("high", 5, 500, 1), ("small", 30, 30, 10)))  # fmt: skip
    assert lay_out([cut(long, 0.01), cut(small, 0.01)]).height < 60
    assert lay_out([cut(high, 0.01), cut(small, 0.01)]).width < 250


def test_a_single_long_part_needs_no_more_than_its_own_width():
    for width, height in ((500, 5), (5, 500)):
        sheet = sheet_of(width, height, 1)
        assert width + 2 < sheet.width < width + 30 and height + 2 < sheet.height < height + 30
