"""What cannot be cut is refused with the numbers that were given, and the advised number works."""

import re
from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.cut import cut
from geomkin.export.still import frame_at
from geomkin.export.text import LONGEST, Title
from geomkin.model.check import Check
from geomkin.page.sections import verdict
from tests.export.test_film import scene_of


def square(side, *holes, at=0j):
    corners = at + side * np.array([0, 1, 1 + 1j, 1j])
    return gk.Part("plate", gk.plane.Polyline(corners), tuple(gk.plane.Circle(at + z, r) for z, r in holes), 3.0)


def refusal(*given, **more):
    with pytest.raises(gk.DesignError) as caught:
        cut(*given, **more)
    return str(caught.value)


def test_a_kerf_that_closes_a_gap_is_told_as_it_was_given():
    notch = np.array([0, 40, 40 + 40j, 22 + 40j, 22 + 10j, 18 + 10j, 18 + 40j, 40j])
    part = gk.Part("fork", gk.plane.Polyline(notch), (), 3.0)
    assert cut(part, 0.01, kerf=3.8).area > gk.area(part.outline)
    assert refusal(part, 0.01, kerf=4.5).startswith("kerf: found 4.5 mm, wider than a gap or a neck of the fork")
    slot = gk.Part("eye", gk.plane.Circle(20, 40.0), (gk.plane.Polyline(notch[::-1]),), 3.0)
    assert cut(gk.Part("eye", gk.plane.Circle(20 + 20j, 60.0), slot.holes, 3.0), 0.01, kerf=3.0).area > 0
    wide = gk.Part("eye", gk.plane.Circle(20 + 20j, 60.0), slot.holes, 3.0)
    assert refusal(wide, 0.01, kerf=19.0).startswith("kerf: found 19 mm, wider than a gap or a neck of the eye")
    assert refusal(square(20, (10 + 10j, 1.0)), 0.01, kerf=2.5).startswith("kerf: found 2.5 mm, wider than a hole of")


def test_parts_of_sizes_that_no_file_tells_are_refused_with_those_that_it_does():
    for tolerance in (0.01, 0.1):
        told = refusal(square(4 * tolerance), tolerance)
        numbers = re.search(
            r"about (\S+) mm across; .* between (\S+) mm \(ten times the tolerance\) and (\S+) mm", told
        )
        size, low, high = map(float, numbers.groups())
        assert (low, high) == pytest.approx((10 * tolerance, 1e5)) and 4 * tolerance <= size <= 8 * tolerance
        assert cut(square(1.01 * low), tolerance)
    assert cut(square(0.6 * high), 1.0)
    assert "make parts between 10 mm" in refusal(square(1.01 * high), 1.0)
    assert cut(square(10, at=0.9e5 + 0j), 0.1)
    far = refusal(square(10, at=1.2e5j), 0.1)
    assert "it lies about 1.2e+05 mm from the origin; stay within 100000 mm" in far


@pytest.mark.parametrize("side", [300.0, 20_000.0])
def test_a_tolerance_too_fine_for_the_part_is_refused_with_one_that_is_not(side):
    told = refusal(square(side), 1e-9 * side)
    assert told.startswith(f"tolerance: found {1e-9 * side:g} mm for the plate, which is about ")
    (least,) = re.findall(r"give at least (\S+) mm", told)
    # Told to two digits.
    assert cut(square(side), 1.05 * float(least)).area == pytest.approx(side**2)
    assert "give at least" in refusal(square(side), 0.9 * float(least))


@pytest.mark.parametrize("wrong", [0, 1, 2])
def test_the_hole_that_is_too_near_is_told_by_its_number(wrong):
    places = [(8 + 8j, 2.0), (20 + 20j, 2.0), (32 + 8j, 2.0)]
    places[wrong] = (places[wrong][0].real + 1.99j, 2.0)
    told = refusal(square(40, *places), 0.1)
    assert told.startswith(f"plate: hole {wrong + 1} meets the outline, or comes nearer than the tolerance of 0.1 mm")


def checks(*held):
    return tuple(Check("no_k", f"no. {k}", 1.0, "at least", 0.5 if good else 2.0, "deg") for k, good in enumerate(held))


@pytest.mark.parametrize(
    ("held", "told"),
    [
        ((), ""),
        ((True,), '<p class="verdict holds">Its one check holds.</p>'),
        ((True, True), '<p class="verdict holds">All 2 checks hold.</p>'),
        ((True, False), '<p class="verdict fails">1 of 2 checks fails: no. 1'),
        ((False, True, False), '<p class="verdict fails">2 of 3 checks fail: no. 0'),
    ],
)
def test_the_verdict_counts_the_checks_and_names_the_first_that_fails(held, told):
    found = verdict(checks(*held))
    assert found.startswith(told) and bool(found) == bool(held)
    assert " deg" not in found and found.count("°") == (2 if "fail" in told else 0)


def test_a_driver_stands_at_the_frame_next_to_where_it_is_asked_for():
    scene = scene_of(frames=37)
    assert [frame_at(scene, at) for at in (0.0, 90.0, 94.0, 96.0, 360.0, 369.0, -9.0)] == [0, 9, 9, 10, 36, 36, 0]
    for at in (371.0, -11.0, 720.0):
        with pytest.raises(
            gk.DesignError, match=f"assembly_at: found {at:g} deg, outside the range of the driver; give 0 to 360"
        ):
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
        with pytest.raises(
            gk.DesignError, match=f"found {at:g} deg, where the mechanism cannot be assembled; give {best}, the nearest"
        ):
            frame_at(half, at)
    with pytest.raises(gk.DesignError, match="assembly_at"):
        frame_at(replace(half, assembled=closed & False), None)


def test_a_title_is_as_long_as_its_refusal_says():
    assert Title("x" * LONGEST).name and Title(material="Ä°±µ²³Øøß§é").material
    with pytest.raises(gk.DesignError, match=f"which has {LONGEST + 1} letters; give at most {LONGEST} letters"):
        Title(revision="x" * (LONGEST + 1))
    assert list(Title("a", "7", date="May", general_tolerance="0.1").lines()) == [
        "number: 7",
        "general tolerance: 0.1",
        "date: May",
    ]
