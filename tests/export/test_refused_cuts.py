"""What cannot be cut is refused with the numbers that were given, and the advised number works."""

import re
from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.cut import cut
from geomkin.export.still import frame_at
from tests.export.test_animated_marks import scene_of


def square(side, *holes, at=0j):
    corners = at + side * np.array([0, 1, 1 + 1j, 1j])
    return gk.Part("plate", gk.plane.Polyline(corners), tuple(gk.plane.Circle(at + z, r) for z, r in holes), 3.0)


def refusal(*given, **more):
    with pytest.raises(gk.DesignError) as caught:
        cut(*given, **more)
    return str(caught.value)


@pytest.mark.parametrize("side", [300.0, 20_000.0])
def test_a_tolerance_too_fine_for_the_part_is_refused_with_one_that_is_not(side):
    reported = refusal(square(side), 1e-9 * side)
    assert reported.startswith(f"tolerance: found {1e-9 * side:g} mm for the plate, which is about ")
    (least,) = re.findall(r"give at least (\S+) mm", reported)
    # Told to two digits.
    assert cut(square(side), 1.05 * float(least)).area == pytest.approx(side**2)
    assert "give at least" in refusal(square(side), 0.9 * float(least))


def test_a_driver_stands_at_the_frame_next_to_where_it_is_asked_for():
    scene = scene_of(frames=37)
    assert [frame_at(scene, at) for at in (0.0, 90.0, 94.0, 96.0, 360.0, 369.0, -9.0)] == [0, 9, 9, 10, 36, 36, 0]
    for at in (371.0, -11.0, 720.0):
        with pytest.raises(gk.DesignError, match=f"assembly_at: found {at:g} deg.* 0 to 360"):
            frame_at(scene, at)
    # A share of a turn, or half of a way; the nearest to it where the mechanism can be.
    assert frame_at(scene, None) == 5
    there_and_back = scene_of(frames=37, cyclic=False)
    assert frame_at(there_and_back, None) == 18
    closed = np.ones(37, dtype=bool)
    closed[12:30] = False
    half = replace(there_and_back, assembled=closed)
    assert frame_at(half, None) == 11 and frame_at(half, 110.0) == 11
    for at, best in ((120.0, 110), (200.0, 110), (290.0, 300)):
        with pytest.raises(gk.DesignError, match=f"found {at:g} deg.* {best}"):
            frame_at(half, at)
    with pytest.raises(gk.DesignError):
        frame_at(replace(half, assembled=closed & False), None)
